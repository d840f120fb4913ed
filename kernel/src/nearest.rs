//! The nearest hit among many spheres, and whether there is any, by testing every one. Runs on the GPU and on the CPU.

use glam::Vec4;
use spirv_std::arch::IndexUnchecked;

use crate::effects::Effects;
use crate::hit::Hit;
use crate::precision::{Rung, intersect};
use crate::ray::Ray;
use crate::sphere::Sphere;

/// The nearest hit of `ray` among `spheres`; of two equally near, the one of lower index.
///
/// ```
/// use spherule_kernel::{Hit, Ray, Sphere, glam::Vec3, nearest_hit};
///
/// let world = [
///     Sphere::new(Vec3::new(0.0, 0.0, -3.0), 0.5),
///     Sphere::new(Vec3::new(0.0, -100.5, -3.0), 100.0),
/// ];
/// let ahead = Ray::new(Vec3::ZERO, Vec3::NEG_Z);
/// assert_eq!(nearest_hit(&ahead, &world), Hit { t: 2.5, sphere: 0 });
/// let up = Ray::new(Vec3::ZERO, Vec3::Y);
/// assert_eq!(nearest_hit(&up, &world), Hit::NONE);
/// ```
#[inline]
#[must_use]
pub fn nearest_hit(ray: &Ray, spheres: &[Sphere]) -> Hit {
    nearest_hit_in(Rung::default().to_u32(), ray, spheres, 0, u32::MAX)
}

/// [`nearest_hit`] on this rung (a value of [`Rung::to_u32`]), among
/// `spheres[first..first + count]`; a range that leaves the slice is cut to it. The hit's index
/// counts from the start of the slice.
#[inline]
#[must_use]
pub fn nearest_hit_in(rung: u32, ray: &Ray, spheres: &[Sphere], first: u32, count: u32) -> Hit {
    let len = spheres.len().min(u32::MAX as usize) as u32;
    let first = first.min(len);
    let end = first + count.min(len - first);

    let mut ray = *ray;
    let mut hit = Hit::NONE;
    let mut index = first;
    while index < end {
        // SAFETY: `end` is at most the length of the slice.
        let sphere = unsafe { *spheres.index_unchecked(index as usize) };
        let t = intersect(rung, sphere, &ray);
        if t < ray.t_max {
            ray.t_max = t;
            hit = Hit { t, sphere: index };
        }
        index += 1;
    }
    hit
}

/// Whether `ray` hits any of `spheres` on this rung: exactly where [`nearest_hit_in`] finds
/// something, because both ask the same questions of the same interval.
#[inline]
#[must_use]
pub fn is_occluded(rung: u32, ray: &Ray, spheres: &[Sphere]) -> bool {
    let mut index = 0;
    let mut occluded = false;
    while (index < spheres.len()) & !occluded {
        // SAFETY: `index` is below the length of the slice.
        let sphere = unsafe { *spheres.index_unchecked(index) };
        occluded = intersect(rung, sphere, ray) < ray.t_max;
        index += 1;
    }
    occluded
}

/// The sphere with this index, below the length of the slice, where it is at `time` if spheres move.
#[inline]
#[must_use]
pub(crate) fn sphere_at(
    effects: Effects,
    spheres: &[Sphere],
    velocities: &[Vec4],
    index: usize,
    time: f32,
) -> Sphere {
    // SAFETY: the callers' indices are below the length of the slice.
    let sphere = unsafe { *spheres.index_unchecked(index) };
    if effects.any(Effects::MOTION_BLUR) && index < velocities.len() {
        let moved = sphere.center() + velocities[index].truncate() * time;
        Sphere::new(moved, sphere.radius())
    } else {
        sphere
    }
}

/// [`nearest_hit_in`] among all spheres, where each is at `time`.
#[inline]
#[must_use]
pub fn nearest_hit_at(
    effects: Effects,
    rung: u32,
    ray: &Ray,
    spheres: &[Sphere],
    velocities: &[Vec4],
    time: f32,
) -> Hit {
    let mut ray = *ray;
    let mut hit = Hit::NONE;
    let mut index = 0;
    while index < spheres.len() {
        let sphere = sphere_at(effects, spheres, velocities, index, time);
        let t = intersect(rung, sphere, &ray);
        if t < ray.t_max {
            ray.t_max = t;
            hit = Hit {
                t,
                sphere: index as u32,
            };
        }
        index += 1;
    }
    hit
}

/// [`is_occluded`] by spheres that are where they are at `time`.
#[inline]
#[must_use]
pub fn is_occluded_at(
    effects: Effects,
    rung: u32,
    ray: &Ray,
    spheres: &[Sphere],
    velocities: &[Vec4],
    time: f32,
) -> bool {
    let mut index = 0;
    let mut occluded = false;
    while (index < spheres.len()) & !occluded {
        let sphere = sphere_at(effects, spheres, velocities, index, time);
        occluded = intersect(rung, sphere, ray) < ray.t_max;
        index += 1;
    }
    occluded
}
