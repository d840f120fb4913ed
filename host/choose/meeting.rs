//! What a rung's errors move where two spheres meet, or all but meet. [`super`] derives the bound.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;
use rayon::prelude::*;
use spherule_kernel::Rung;

use super::neighbours::{self, MOST_TESTS, Neighbours};
use super::sight::{Sight, distances};
use crate::scene::Scene;
use crate::scene::world::{GRAIN, bits_of};

/// Where one sphere's shift is a larger angle than this, nothing is said of two.
const LARGEST: f64 = 0.1;
/// Spheres are looked for at least at this 1 − cos θ.
const SLANT: f64 = 1e-3;

/// A sphere, where it is in the middle of the shutter's time, how it moves from there to its ends,
/// and the shift that the rung's error causes on it.
struct Seen {
    sight: Sight,
    middle: DVec3,
    half_way: DVec3,
    shift: f64,
}

/// The spheres of a scene, as its camera sees them on a rung.
pub(super) struct View<'a> {
    pub(super) scene: &'a Scene,
    pub(super) eye: DVec3,
    pub(super) rung: Rung,
    /// The times of the image.
    pub(super) shutter: [f64; 2],
}

impl View<'_> {
    fn velocity(&self, index: usize) -> DVec3 {
        let velocities = &self.scene.world.velocities;
        velocities
            .get(index)
            .map_or(DVec3::ZERO, |velocity| velocity.as_dvec3())
    }

    /// How the eye sees the sphere of this index.
    pub(super) fn sight(&self, index: usize) -> Sight {
        let times = self.shutter.map(|time| self.velocity(index) * time);
        Sight::of(self.eye, &self.scene.world.spheres[index], times)
    }

    /// Where the centre is in the middle of the shutter's time.
    fn middle(&self, index: usize) -> DVec3 {
        let [open, close] = self.shutter;
        let center = self.scene.world.spheres[index].center().as_dvec3();
        center + self.velocity(index) * (0.5 * (open + close))
    }

    /// How the centre moves from there to the end of the shutter's time.
    fn half_way(&self, index: usize) -> DVec3 {
        let [open, close] = self.shutter;
        self.velocity(index) * (0.5 * (close - open))
    }

    fn seen(&self, index: usize) -> Seen {
        let sight = self.sight(index);
        Seen {
            middle: self.middle(index),
            half_way: self.half_way(index),
            shift: sight.shift(self.rung),
            sight,
        }
    }

    /// The largest shift, as an angle, on any one sphere, and the spheres around the eye.
    pub(super) fn largest_shift_on_one(&self) -> (f64, Vec<usize>) {
        let none = || (0.0_f64, Vec::new());
        (0..self.scene.world.spheres.len())
            .into_par_iter()
            .with_min_len(GRAIN)
            .fold(none, |(largest, mut around), index| {
                let sight = self.sight(index);
                if sight.is_around_the_eye() {
                    around.push(index);
                }
                (largest.max(sight.shift(self.rung)), around)
            })
            .reduce(none, |(one, mut around), (other, more)| {
                around.extend(more);
                (one.max(other), around)
            })
    }

    /// The largest shift, as an angle, where two spheres meet; those below `floor` need not be
    /// found. `largest` is the largest shift on any one sphere; `around` are the spheres around the
    /// eye.
    pub(super) fn largest_shift_between(&self, largest: f64, floor: f64, around: &[usize]) -> f64 {
        let count = self.scene.world.spheres.len();
        if largest > LARGEST || around.len().saturating_mul(count) > MOST_TESTS {
            return f64::INFINITY;
        }
        let between = |one: usize, other: usize| {
            if one == other || self.are_the_same(one, other) {
                0.0
            } else {
                between(&self.seen(one), &self.seen(other))
            }
        };
        // sin θ below which two shifts together are beyond the floor: at any angle if they are.
        let sine = 2.0 * largest / floor;
        let slant = if sine < 1.0 {
            1.0 - (1.0 - sine * sine).sqrt()
        } else {
            2.0
        };
        let spheres = Bodies {
            view: self,
            largest,
            floor,
        };
        let of_most = Neighbours::of(&spheres, slant.max(SLANT))
            .and_then(|neighbours| neighbours.largest(between));
        let of_around = |index: usize| {
            let shifts = around.iter().map(|other| between(index, *other));
            shifts.fold(0.0, f64::max)
        };
        let of_around = (0..if around.is_empty() { 0 } else { count })
            .into_par_iter()
            .with_min_len(GRAIN)
            .map(of_around)
            .reduce(|| 0.0, f64::max);
        of_most.unwrap_or(f64::INFINITY).max(of_around)
    }

    /// Whether two spheres are the same at any time: their answers are the same on every rung, and
    /// the first of them is seen.
    fn are_the_same(&self, one: usize, other: usize) -> bool {
        let world = &self.scene.world;
        let bits = |index: usize| {
            let velocity = world.velocities.get(index).copied().unwrap_or_default();
            bits_of(&world.spheres[index], velocity)
        };
        bits(one) == bits(other)
    }
}

/// The spheres in the middle of the shutter's time.
struct Bodies<'a> {
    view: &'a View<'a>,
    /// The largest shift on any one sphere.
    largest: f64,
    /// Shifts below this need not be found.
    floor: f64,
}

impl neighbours::Bodies for Bodies<'_> {
    fn count(&self) -> usize {
        self.view.scene.world.spheres.len()
    }

    fn center(&self, index: usize) -> DVec3 {
        self.view.middle(index)
    }

    fn radius(&self, index: usize) -> f64 {
        f64::from(self.view.scene.world.spheres[index].radius()).abs()
    }

    fn motion(&self, index: usize) -> f64 {
        self.view.half_way(index).length()
    }

    fn thickness(&self, index: usize) -> f64 {
        let to_center = (self.center(index) - self.view.eye).abs().element_sum();
        2.0 * self.largest * (to_center + self.motion(index) + self.radius(index))
    }

    /// Whether all of the sphere's image is smaller than what need not be found.
    fn is_speck(&self, index: usize) -> bool {
        let radius = self.radius(index);
        let to_center = self.center(index).distance(self.view.eye);
        let nearest = to_center - self.motion(index) - radius;
        PI * radius < self.floor * nearest
    }
}

/// The largest shift, as an angle, of the curve in which two spheres meet.
fn between(one: &Seen, other: &Seen) -> f64 {
    let (small, large) = if one.sight.radius < other.sight.radius {
        (one, other)
    } else {
        (other, one)
    };
    let (s, l) = (small.sight.radius, large.sight.radius);
    let apart = distances(
        small.middle - large.middle - (small.half_way - large.half_way),
        2.0 * (small.half_way - large.half_way),
    );
    let shifts = small.shift + large.shift;
    // One of them is seen from inside, the other from outside: the normals face each other where
    // the spheres touch from outside, and else where they touch from inside.
    let is_turned = small.sight.is_around_the_eye() != large.sight.is_around_the_eye();
    let touching = if is_turned { l + s } else { l - s };
    let d = touching.max(apart.0).min(apart.1);
    // 2 r₁ r₂ cos θ, θ between the normals that face the eye.
    let cosine = (l * l - d * d + s * s) * if is_turned { -1.0 } else { 1.0 };
    if cosine <= 0.0 {
        return if apart.0 <= l + s && apart.1 >= l - s {
            shifts
        } else {
            0.0
        };
    }
    let ((near_s, far_s), (near_l, far_l)) = (small.sight.range(), large.sight.range());
    let (nearest, farthest) = (near_s.max(near_l), far_s.min(far_l));
    // Both heights times D: of the circle's plane over the small centre, towards the large one, and
    // from there to where the errors no longer decide. The spheres of equal centres have a height
    // of zero, or an infinite one.
    let plane = 0.5 * ((d - l) * (d + l) + s * s);
    let band = farthest * shifts * l;
    let angle = |height: f64| match height / (d * s) {
        cosine if cosine.is_nan() => FRAC_PI_2,
        cosine => cosine.clamp(-1.0, 1.0).acos(),
    };
    let from_plane = |height: f64| (angle(plane) - angle(height)).abs();
    let arc = from_plane(plane + band).max(from_plane(plane - band));
    // While the band is narrow, the arc is the band / sin φ, and the shift does not depend on the
    // distance.
    let sine = angle(plane).sin();
    let stretch = arc * sine * d * s / band;
    let slant = d * sine / l;
    let mut shift = arc * s / nearest;
    if plane.abs() < d * s && stretch <= 2.0 {
        shift = shift.min(shifts * stretch.max(1.0) / slant);
    }
    // The worst moment of a motion may be beside the one that touches most. At no moment of some
    // thousand pairs was the shift more than 1.62 times as large.
    if one.half_way == other.half_way {
        shift
    } else {
        2.0 * shift
    }
}
