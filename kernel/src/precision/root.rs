//! What every rung answers: the trait, and the choice between two roots. Runs on the GPU and on the CPU.

use glam::Vec3;

use crate::hit::Hit;
use crate::ray::Ray;
use crate::sphere::Sphere;

/// One rung: a way to intersect a ray with a sphere.
pub trait Precision {
    /// The smaller root in the ray's interval as a parameter along the ray, or
    /// [`Hit::NONE_T`]. A NaN anywhere is no hit.
    fn intersect(sphere: Sphere, ray: &Ray) -> f32;

    /// How much wider boxes must be, in scene units, so that they keep no ray from what the rung finds without them: by how far
    /// the rung may find a sphere that is not there. `far` is how far from the ray's origin spheres are at most along
    /// each axis, and `smallest_radius` that of the smallest. [`slabs`](crate::accel::slabs) derives the rungs' answers.
    #[inline]
    #[must_use]
    fn widening(far: Vec3, smallest_radius: f32) -> f32 {
        let _ = (far, smallest_radius);
        0.0
    }
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
