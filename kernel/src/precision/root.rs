//! [`Precision`]: what every rung implements, and the choice between two roots. Runs on the GPU and
//! on the CPU.

use glam::Vec3;

use crate::hit::Hit;
use crate::ray::Ray;
use crate::sphere::Sphere;

/// One rung: a way to intersect a ray with a sphere.
pub trait Precision {
    /// The smaller root in the ray's interval, as a parameter along the ray; [`Hit::NONE_T`] if
    /// there is none. NaN anywhere means no hit.
    fn intersect(sphere: Sphere, ray: &Ray) -> f32;

    /// How much wider boxes must be, in scene units, so that the rung finds the same hits with
    /// boxes as without: by how far from a sphere the rung may still report a hit. `far` is the
    /// largest distance of a sphere from the ray's origin along each axis, and `smallest_radius`
    /// the smallest radius. [`slabs`](crate::accel::slabs) derives the value for each rung.
    #[inline]
    #[must_use]
    fn widening(far: Vec3, smallest_radius: f32) -> f32 {
        let _ = (far, smallest_radius);
        0.0
    }
}

/// The smaller of two roots that lies in the ray's interval; [`Hit::NONE_T`] if neither does.
/// `near ≤ far` unless one is NaN, and NaN lies in no interval.
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
