//! Textbook: the quadratic formula as textbooks print it, in f32. Runs on the GPU and on the CPU.
//!
//! A point of the sphere satisfies |P − C|² = r². With P = O + t·D this is a quadratic in t,
//!
//! > a t² + b t + c = 0,  a = D·D,  b = 2 (O − C)·D,  c = |O − C|² − r²,
//!
//! whose roots are (−b ± √(b² − 4ac)) / 2a. It is the quickest form to write down and the first to
//! lose digits: c cancels when the ray starts near the surface of a large sphere, the discriminant
//! cancels when the sphere is small and far, and −b cancels against the root when b² is much larger
//! than 4ac.

use glam::Vec3;
// On the CPU, std has `f32::sqrt`.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use super::root::{Precision, choose_root};
use crate::arithmetic::U;
use crate::hit::Hit;
use crate::ray::Ray;
use crate::sphere::Sphere;

/// The rung of this module.
#[derive(Clone, Copy, Debug)]
pub struct Textbook;

impl Precision for Textbook {
    #[inline]
    fn intersect(sphere: Sphere, ray: &Ray) -> f32 {
        let from_center = ray.origin - sphere.center();
        let a = ray.direction.dot(ray.direction);
        let b = 2.0 * from_center.dot(ray.direction);
        let c = from_center.dot(from_center) - sphere.radius() * sphere.radius();
        let discriminant = b * b - 4.0 * a * c;
        if discriminant >= 0.0 {
            let root = discriminant.sqrt();
            choose_root((-b - root) / (2.0 * a), (-b + root) / (2.0 * a), ray)
        } else {
            Hit::NONE_T
        }
    }

    #[inline]
    fn widening(far: Vec3, smallest_radius: f32) -> f32 {
        let (r, squared) = (smallest_radius, far.dot(far) * (24.0 * U));
        // √(r² + e) − r, without cancellation.
        squared / ((r * r + squared).sqrt() + r).max(f32::MIN_POSITIVE)
    }
}
