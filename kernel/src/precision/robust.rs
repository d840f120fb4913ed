//! The discriminant from the perpendicular, the roots without cancellation, in f32. Runs on the
//! GPU and on the CPU.
//!
//! E. Haines, J. Günther and T. Akenine-Möller, Precision improvements for ray/sphere
//! intersection, in Ray Tracing Gems (2019), ch. 7. The foot of the perpendicular from the centre
//! to the line is f = o − (b/a) d, and Δ/a = r² − f·f. Both terms are of the size of r² where it
//! matters, so that a small sphere far away keeps its digits: the error of f is a few u·|o|, that
//! of Δ/a a few u·(r·|o| + r²) + (u·|o|)², where b² − ac has a few u·|o|². The roots are q/a and c/q, which
//! add numbers of one sign only.
//!
//! What is left is c itself: o·o − r² loses its digits where the origin is near the surface, and
//! o = O − C is rounded. A huge ground sphere and a ray that starts on a surface need more.

// On the CPU, std has `f32::sqrt`.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use super::{Precision, choose_root};
use crate::hit::Hit;
use crate::ray::Ray;
use crate::sphere::Sphere;

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct Robust;

impl Precision for Robust {
    #[inline]
    fn intersect(sphere: Sphere, ray: &Ray) -> f32 {
        let o = ray.origin - sphere.center();
        let d = ray.direction;
        let a = d.dot(d);
        let b = o.dot(d);
        // The same for every sphere that the ray is tested against.
        let inverse = 1.0 / a;
        let foot = o - d * (b * inverse);
        let radius_squared = sphere.radius() * sphere.radius();
        // Δ / a
        let discriminant = radius_squared - foot.dot(foot);
        let c = o.dot(o) - radius_squared;
        let root = (a * discriminant).sqrt();
        // |q|, a sum of numbers that are not negative.
        let size = b.abs() + root;
        let outer = size / a;
        // No number where both roots are zero: `near` is the other then.
        let inner = c / size;
        let (near, far) = if b < 0.0 {
            (inner, outer)
        } else {
            (-outer, -inner)
        };
        let t = choose_root(near, far, ray);
        // Infinite only far outside of the domain: |d| above 2⁶⁰ or so. No branches: the threads of a GPU would
        // wait for each other.
        if (discriminant >= 0.0) & (size <= f32::MAX) {
            t
        } else {
            Hit::NONE_T
        }
    }
}
