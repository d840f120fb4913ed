//! The nearest hit among many spheres, and whether there is any, by testing every one. Runs on the GPU and on the CPU.

use glam::Vec4;
use spirv_std::arch::IndexUnchecked;

use crate::effects::Effects;
use crate::hit::Hit;
use crate::precision::{Rung, intersect, may_hit};
use crate::ray::Ray;
use crate::sphere::Sphere;

/// How many spheres are tried at once. A loop that loads and tries several in a row hides the time
/// that each takes; more than four crowd a GPU's registers.
const AT_ONCE: u32 = 4;

/// Whether any of the spheres from `$at` up to `$stop` may be hit; true for fewer than [`AT_ONCE`].
macro_rules! may_hit_any {
    ($rung:expr, $ray:expr, $at:expr, $stop:expr, |$index:ident| $load:expr) => {{
        macro_rules! load {
            ($offset:expr) => {{
                let $index = $at + $offset;
                $load
            }};
        }
        if $stop - $at == AT_ONCE {
            let (a, b, c, d) = (load!(0), load!(1), load!(2), load!(3));
            let (may_a, may_b) = (may_hit($rung, a, $ray), may_hit($rung, b, $ray));
            let (may_c, may_d) = (may_hit($rung, c, $ray), may_hit($rung, d, $ray));
            may_a | may_b | may_c | may_d
        } else {
            true
        }
    }};
}

/// The nearest hit among the spheres that `$load` gives for the indices from `$first` to `$end`. A
/// macro, because a closure's captures would be pointers to pointers, which SPIR-V has not.
macro_rules! for_each_candidate {
    ($rung:expr, $ray:expr, $first:expr, $end:expr, |$index:ident| $load:expr) => {{
        let mut ray = *$ray;
        let mut hit = Hit::NONE;
        let mut at: u32 = $first;
        let end: u32 = $end;
        while at < end {
            let stop = end.min(at + AT_ONCE);
            if may_hit_any!($rung, &ray, at, stop, |$index| $load) {
                while at < stop {
                    let $index = at;
                    let sphere = $load;
                    let t = intersect($rung, sphere, &ray);
                    if t < ray.t_max {
                        ray.t_max = t;
                        hit = Hit { t, sphere: at };
                    }
                    at += 1;
                }
            }
            at = stop;
        }
        hit
    }};
}

/// Whether any of the spheres that `$load` gives for the indices up to `$end` is hit.
macro_rules! any_candidate {
    ($rung:expr, $ray:expr, $end:expr, |$index:ident| $load:expr) => {{
        let ray = $ray;
        let mut found = false;
        let mut at: u32 = 0;
        let end: u32 = $end;
        while (at < end) & !found {
            let stop = end.min(at + AT_ONCE);
            if may_hit_any!($rung, ray, at, stop, |$index| $load) {
                while (at < stop) & !found {
                    let $index = at;
                    let sphere = $load;
                    found = intersect($rung, sphere, ray) < ray.t_max;
                    at += 1;
                }
            }
            at = stop;
        }
        found
    }};
}

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
    // SAFETY: `index` is below `end`, which is at most the length of the slice.
    for_each_candidate!(rung, ray, first, end, |index| unsafe {
        *spheres.index_unchecked(index as usize)
    })
}

/// Whether `ray` hits any of `spheres` on this rung: exactly where [`nearest_hit_in`] finds
/// something, because both ask the same questions of the same interval.
#[inline]
#[must_use]
pub fn is_occluded(rung: u32, ray: &Ray, spheres: &[Sphere]) -> bool {
    let len = spheres.len().min(u32::MAX as usize) as u32;
    // SAFETY: `index` is below the length of the slice.
    any_candidate!(rung, ray, len, |index| unsafe {
        *spheres.index_unchecked(index as usize)
    })
}

/// The sphere with this index, below the length of the slice, where it is at `time` if spheres move.
#[inline]
#[must_use]
pub fn sphere_at(
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
    let len = spheres.len().min(u32::MAX as usize) as u32;
    for_each_candidate!(rung, ray, 0, len, |index| sphere_at(
        effects,
        spheres,
        velocities,
        index as usize,
        time
    ))
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
    let len = spheres.len().min(u32::MAX as usize) as u32;
    any_candidate!(rung, ray, len, |index| sphere_at(
        effects,
        spheres,
        velocities,
        index as usize,
        time
    ))
}
