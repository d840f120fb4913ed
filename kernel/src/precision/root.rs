//! [`Precision`]: what every rung implements, and the choice between two roots. Runs on the GPU and
//! on the CPU.

use glam::Vec3;

use crate::hit::Hit;
use crate::lane::Lane;
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
    let (t, is_within) = root_within(near, far, ray.t_min, ray.t_max);
    if is_within { t } else { Hit::NONE_T }
}

/// The smaller of two roots that is `t_min` or more, in lanes, and whether it lies in the interval
/// from `t_min` up to `t_max`, without `t_max`.
#[inline(always)]
#[must_use]
pub fn root_within<L: Lane>(near: L, far: L, t_min: L, t_max: L) -> (L, L::Mask) {
    let t = L::select(near.simd_ge(t_min), near, far);
    (t, t.simd_ge(t_min) & t.simd_lt(t_max))
}
