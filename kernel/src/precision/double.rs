//! The cross product's discriminant and the roots without cancellation, in f64. Runs on the CPU,
//! and on GPUs whose module declares 64-bit floats.
//!
//! With v = 2⁻⁵³: o is off by v·|o| at most, k by a few v·|o||d|, Δ = a r² − k·k by a few
//! v (a r² + |k||o||d|), and c by a few v (o·o + r²). Each root is rounded to a float at the end.
//! Vulkan promises little of 64-bit quotients and roots, so that one Newton step follows each.

// On the CPU, std has `f64::sqrt`.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use super::{Precision, choose_root};
use crate::hit::Hit;
use crate::ray::Ray;
use crate::sphere::Sphere;

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct Double;

impl Precision for Double {
    #[inline]
    fn intersect(sphere: Sphere, ray: &Ray) -> f32 {
        let center = sphere.center();
        let (ox, oy, oz) = (
            f64::from(ray.origin.x) - f64::from(center.x),
            f64::from(ray.origin.y) - f64::from(center.y),
            f64::from(ray.origin.z) - f64::from(center.z),
        );
        let (dx, dy, dz) = (
            f64::from(ray.direction.x),
            f64::from(ray.direction.y),
            f64::from(ray.direction.z),
        );
        let r = f64::from(sphere.radius());

        let a = dx * dx + dy * dy + dz * dz;
        let (kx, ky, kz) = (oy * dz - oz * dy, oz * dx - ox * dz, ox * dy - oy * dx);
        let discriminant = a * (r * r) - (kx * kx + ky * ky + kz * kz);
        // False for a NaN in either.
        let meets = (discriminant >= 0.0) & (a > 0.0);
        if !meets {
            return Hit::NONE_T;
        }
        let b = ox * dx + oy * dy + oz * dz;
        let c = ox * ox + oy * oy + oz * oz - r * r;
        let root = square_root(discriminant);
        let leaves = b >= 0.0;
        let size = if leaves { b + root } else { root - b };
        let outer = quotient(size, a) as f32;
        let inner = if size > 0.0 {
            quotient(c, size) as f32
        } else {
            0.0
        };
        if leaves {
            choose_root(-outer, -inner, ray)
        } else {
            choose_root(inner, outer, ray)
        }
    }
}

/// √x for x ≥ 0, with one Newton step.
#[inline]
#[must_use]
pub fn square_root(x: f64) -> f64 {
    if x > 0.0 {
        let root = x.sqrt();
        root + (x - root * root) / (root + root)
    } else {
        0.0
    }
}

/// x / y, with one Newton step.
#[inline]
#[must_use]
pub fn quotient(x: f64, y: f64) -> f64 {
    let quotient = x / y;
    quotient + (x - quotient * y) / y
}
