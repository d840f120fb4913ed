//! Brute force: finds the nearest hit among many spheres, or whether there is any, by testing each.
//! Runs on the GPU and on the CPU.

use glam::Vec4;
use spirv_std::arch::IndexUnchecked;

use super::node::Extent;
use super::primitives::Primitives;
use super::slabs::Slabs;
use crate::arithmetic::elements::read;
use crate::cull::bounds::{Bounds, Line};
use crate::effects::Effects;
use crate::hit::Hit;
use crate::precision::{Rung, entry_or_defer, intersect, intersect_at_once, intersect_or_defer};
use crate::ray::Ray;
use crate::sphere::Sphere;

/// Spheres by their indices: a slice of them, or [`MovingSpheres`].
pub trait Spheres {
    /// Whether a launch on [`DEFERRING`](crate::precision::DEFERRING) may ask about these spheres.
    /// For others its code is left out.
    const MAY_DEFER: bool;

    /// How many there are.
    fn count(&self) -> u32;

    /// The sphere with this index.
    ///
    /// # Safety
    ///
    /// `index` is below [`Spheres::count`].
    unsafe fn sphere(&self, index: u32) -> Sphere;

    /// Whether rays pass over the sphere with this index: see [`MovingSpheres::left`].
    #[inline]
    fn is_left(&self, index: u32) -> bool {
        let _ = index;
        false
    }

    /// Whether rays that ask for any hit pass over the sphere with this index: see
    /// [`MovingSpheres::target`].
    #[inline]
    fn is_passed(&self, index: u32) -> bool {
        self.is_left(index)
    }
}

impl<S: Spheres + ?Sized> Primitives for S {
    type One = Sphere;

    const HAVE_BOUNDS: bool = true;

    #[inline]
    fn total(&self) -> u32 {
        self.count()
    }

    #[inline]
    unsafe fn one(&self, index: u32) -> Sphere {
        // SAFETY: the caller ensures that `index` is below their number.
        unsafe { self.sphere(index) }
    }

    #[inline]
    fn is_passed_over<const ANY: bool>(&self, index: u32) -> bool {
        if ANY {
            self.is_passed(index)
        } else {
            self.is_left(index)
        }
    }

    /// [`intersect_or_defer`], or [`intersect`] for spheres about which nothing is deferred.
    #[inline]
    fn ask(rung: u32, sphere: Sphere, ray: &Ray) -> f32 {
        if S::MAY_DEFER {
            intersect_or_defer(rung, sphere, ray)
        } else {
            intersect(rung, sphere, ray)
        }
    }

    #[inline]
    fn ask_at_once(rung: u32, sphere: Sphere, ray: &Ray) -> f32 {
        intersect_at_once(rung, sphere, ray)
    }

    /// [`entry_or_defer`], or [`intersect`] for spheres about which nothing is deferred.
    #[inline]
    fn ask_entry(rung: u32, sphere: Sphere, ray: &Ray, line: &Line, low: f32, high: f32) -> f32 {
        if S::MAY_DEFER {
            let one = 1.0 / line.unit;
            entry_or_defer(rung, sphere, ray, low * one, high * one)
        } else {
            intersect(rung, sphere, ray)
        }
    }

    #[inline]
    fn bounds(line: &Line, sphere: Sphere) -> Bounds {
        line.bounds(sphere)
    }

    #[inline]
    fn may_hit(line: &Line, sphere: Sphere) -> bool {
        line.may_hit(sphere)
    }

    #[inline]
    fn slabs(rung: u32, ray: &Ray, world: &Extent) -> Slabs {
        Slabs::of(rung, ray, world)
    }
}

impl Spheres for [Sphere] {
    const MAY_DEFER: bool = true;

    #[inline]
    fn count(&self) -> u32 {
        self.len().min(u32::MAX as usize) as u32
    }

    #[inline]
    unsafe fn sphere(&self, index: u32) -> Sphere {
        // SAFETY: the caller ensures that `index` is below the number of spheres.
        unsafe { *self.index_unchecked(index as usize) }
    }
}

/// Spheres where they are at one time.
#[derive(Clone, Copy, Debug)]
pub struct MovingSpheres<'a> {
    /// The spheres where they are at time zero.
    pub spheres: &'a [Sphere],
    /// How each moves, in scene units per unit of time; those beyond its end are at rest.
    pub velocities: &'a [Vec4],
    /// The time.
    pub time: f32,
    /// The effects of the pipeline: without [`Effects::MOTION_BLUR`] all are at rest.
    pub effects: Effects,
    /// The index of the sphere that a ray leaves, over which it passes: rounding would decide
    /// whether it meets it where it starts. [`Hit::NONE_SPHERE`] for a ray that leaves none.
    pub left: u32,
    /// The index of the sphere up to which a ray goes that asks for any hit, and over which it
    /// passes, too. Compilers for GPUs do not round an intersection alike wherever it stands, so
    /// that the sphere might begin before the ray ends there. [`Hit::NONE_SPHERE`] for a ray that
    /// goes to none.
    pub target: u32,
}

impl MovingSpheres<'_> {
    /// The sphere with this index; for an index beyond them, one of zeros.
    #[inline]
    #[must_use]
    pub fn read(&self, index: usize) -> Sphere {
        self.moved(read(self.spheres, index), index)
    }

    /// The sphere with this index, which at time zero is this one, where it is at the time.
    #[inline]
    fn moved(&self, sphere: Sphere, index: usize) -> Sphere {
        if self.effects.any(Effects::MOTION_BLUR) && index < self.velocities.len() {
            let moved = sphere.center() + self.velocities[index].truncate() * self.time;
            Sphere::new(moved, sphere.radius())
        } else {
            sphere
        }
    }
}

impl Spheres for MovingSpheres<'_> {
    const MAY_DEFER: bool = false;

    #[inline]
    fn count(&self) -> u32 {
        self.spheres.count()
    }

    #[inline]
    unsafe fn sphere(&self, index: u32) -> Sphere {
        // SAFETY: the caller ensures that `index` is below the number of spheres.
        let sphere = unsafe { self.spheres.sphere(index) };
        self.moved(sphere, index as usize)
    }

    #[inline]
    fn is_left(&self, index: u32) -> bool {
        index == self.left
    }

    #[inline]
    fn is_passed(&self, index: u32) -> bool {
        let to_lamps = Effects::SOFT_SHADOWS.and(Effects::CAUSTICS);
        (index == self.left) | (self.effects.any(to_lamps) && index == self.target)
    }
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

/// [`nearest_hit`] on this rung (a value of [`Rung::to_u32`]), among the `count` spheres from
/// `first` on; a range that leaves them is cut to them. The hit's index counts from the first of
/// all.
#[inline]
#[must_use]
pub fn nearest_hit_in<S: Spheres + ?Sized>(
    rung: u32,
    ray: &Ray,
    spheres: &S,
    first: u32,
    count: u32,
) -> Hit {
    let len = spheres.count();
    let first = first.min(len);
    let end = first + count.min(len - first);

    let mut t_max = ray.end();
    let mut hit = Hit::NONE_SPHERE;
    let mut index = first;
    while index < end {
        // SAFETY: `end` is at most the number of spheres.
        let sphere = unsafe { spheres.sphere(index) };
        let t = intersect(rung, sphere, &Ray { t_max, ..*ray });
        if (t < t_max) & !spheres.is_left(index) {
            t_max = t;
            hit = index;
        }
        index += 1;
    }
    if hit == Hit::NONE_SPHERE {
        Hit::NONE
    } else {
        Hit {
            t: t_max,
            sphere: hit,
        }
    }
}

/// [`nearest_hit_in`] for [lazy](crate::precision::is_lazy) rungs, with the same answer for less:
/// [bounds](crate::cull::bounds) find the nearest sphere, and the rung is evaluated for that one
/// and where they leave open which it is.
#[inline]
#[must_use]
pub fn nearest_hit_by_bounds<S: Spheres + ?Sized>(
    rung: u32,
    ray: &Ray,
    spheres: &S,
    first: u32,
    count: u32,
) -> Hit {
    let len = spheres.count();
    let first = first.min(len);
    let stop = first + count.min(len - first);

    let line = Line::of(ray);
    let ray = &Ray {
        t_max: ray.end(),
        ..*ray
    };
    // As in a walk through a tree: the nearest hit so far, and its sphere. Where the nearest sphere
    // may begin, and where it certainly has begun, in the line's parameters: `low` is below `end`
    // as long as the rung was not evaluated for it.
    let mut t = ray.t_max;
    let mut hit = Hit::NONE_SPHERE;
    let mut end = t * line.unit;
    let mut low = end;
    let mut index = first;
    while index < stop {
        // SAFETY: `stop` is at most the number of spheres.
        let bounds = line.bounds(unsafe { spheres.sphere(index) });
        let is_left = spheres.is_left(index);
        if bounds.hits & (bounds.high < low) & !is_left {
            (hit, low, end) = (index, bounds.low, bounds.high);
        } else if bounds.is_open(end) & !is_left {
            // The nearest sphere comes first, if the rung was not evaluated for it.
            let mut asked = if low < end { hit } else { index };
            loop {
                // SAFETY: both are below the number of spheres.
                let answer = S::ask(rung, unsafe { spheres.sphere(asked) }, ray);
                if (answer < t) | ((answer == t) & (asked < hit)) {
                    (t, hit) = (answer, asked);
                }
                end = t * line.unit;
                low = end;
                if asked == index {
                    break;
                }
                asked = index;
            }
        }
        index += 1;
    }
    if low < end {
        // SAFETY: a sphere was found that begins at `low` or later.
        let sphere = unsafe { spheres.sphere(hit) };
        t = S::ask_entry(rung, sphere, ray, &line, low, end);
    }
    if t < ray.t_max {
        Hit { t, sphere: hit }
    } else {
        Hit::NONE
    }
}

/// Whether `ray` hits any of `spheres` on this rung: exactly where [`nearest_hit_in`] finds
/// something, because both ask the same questions of the same interval.
#[inline]
#[must_use]
pub fn is_occluded<S: Spheres + ?Sized>(rung: u32, ray: &Ray, spheres: &S) -> bool {
    let ray = &Ray {
        t_max: ray.end(),
        ..*ray
    };
    let mut index = 0;
    let mut occluded = false;
    while (index < spheres.count()) & !occluded {
        // SAFETY: `index` is below the number of spheres.
        let sphere = unsafe { spheres.sphere(index) };
        occluded = (intersect(rung, sphere, ray) < ray.t_max) & !spheres.is_passed(index);
        index += 1;
    }
    occluded
}
