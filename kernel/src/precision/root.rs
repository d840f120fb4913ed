//! What every rung answers: the trait, and the choice between two roots. Runs on the GPU and on the CPU.

use crate::hit::Hit;
use crate::ray::Ray;
use crate::sphere::Sphere;

/// One rung: a way to intersect a ray with a sphere.
pub trait Precision {
    /// The smaller root in the ray's interval as a parameter along the ray, or
    /// [`Hit::NONE_T`]. A NaN anywhere is no hit.
    fn intersect(sphere: Sphere, ray: &Ray) -> f32;
}

/// The smaller of two roots that lies in the ray's interval, or [`Hit::NONE_T`]; `near ≤ far`
/// where neither is NaN, and a NaN is in no interval.
#[inline]
#[must_use]
pub fn choose_root(near: f32, far: f32, ray: &Ray) -> f32 {
    let t = if near >= ray.t_min { near } else { far };
    if (t >= ray.t_min) & (t < ray.t_max) {
        t
    } else {
        Hit::NONE_T
    }
}
