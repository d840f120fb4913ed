//! Certified: right answers everywhere, with more digits only where few cannot decide. Runs on the
//! GPU and on the CPU.
//!
//! Whether a line meets a sphere is decided exactly, and a root is the float that is nearest to the
//! exact root (ties to even). That float is compared with the ray's interval. So every device finds
//! the same, bit for bit. Each step is evaluated only where the ones before cannot decide, after J.
//! R. Shewchuk's adaptive predicates (Discrete Comput. Geom. 18 (1997) 305):
//!
//! 1. With 64-bit floats, three steps:
//!    - where bounds in 32-bit floats say for certain that the ray enters, and about where: a root
//!      in 32-bit floats, corrected by what it leaves in 64-bit floats ([`corrected`]);
//!    - otherwise the formulas of [`double`](super::double) with bounds on their errors ([`wide`]);
//!    - the midpoint between two floats in pairs of 64-bit floats (`midpoint.rs`), for hits that
//!      the former leaves there, one in 2¹⁸ or so.
//!
//!    Without them, three:
//!    - a filter (`filter.rs`) in f32, for misses;
//!    - pairs of floats, as in [`super::compensated`]: the sign of Δ is certain where |Δ| is more
//!      than 2⁻⁴³ (a r² + k·k + |k||o||d|), and a root where its error does not reach to the
//!      midpoint between two floats (`rounding.rs`). Where k cancels, Δ is off by 50u⁴ o·o a more,
//!      which is too little to change its sign: then k·k is far below a r²;
//!    - the same with c as a sum without loss, where c may be too close to zero.
//! 2. All coefficients as sums without loss (`distilled.rs`). Where that does not round a root for
//!    certain, the midpoint's place on the line does, by the exact sign of the quadratic there.
//!
//! On a GPU the last steps would take registers from every ray, though next to none needs them. So
//! there a first launch has the first steps alone ([`DEFERRING`](super::DEFERRING)), and lists the
//! rays that they leave open; a second, small launch answers those.
//!
//! No step sees more than floats can hold: components must be at least 2⁻⁷⁵ of the largest length,
//! and t must be a normal float.

pub mod corrected;
mod distilled;
mod filter;
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
mod midpoint;
mod rounding;
pub mod wide;

use self::rounding::{Root, choose, choose_exactly};
use super::compensated::{Quadratic, two_to_minus};
use super::root::Precision;
use crate::hit::Hit;
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
use crate::lane::Lane3;
use crate::ray::Ray;
use crate::sphere::Sphere;

/// The rung of this module.
#[derive(Clone, Copy, Debug)]
pub struct Certified;

/// The relative error of |q| below which c may be all that leaves a root open: 2⁻²⁸.
const WORTH_A_TRY: f32 = two_to_minus(28);

/// The step that decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u32)]
pub enum Stage {
    /// 64-bit floats.
    Wide = 0,
    /// The midpoint between two floats, in pairs of 64-bit floats.
    Midpoint = 1,
    /// The filter.
    Filter = 2,
    /// Pairs of floats.
    Pairs = 3,
    /// Pairs of floats, with c distilled.
    DistilledC = 4,
    /// Distillation of everything.
    Distilled = 5,
}

impl Precision for Certified {
    #[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
    #[inline]
    fn intersect(sphere: Sphere, ray: &Ray) -> f32 {
        intersect_with_stage(sphere, ray).0
    }

    #[cfg(all(target_arch = "spirv", not(feature = "f64")))]
    #[inline]
    fn intersect(sphere: Sphere, ray: &Ray) -> f32 {
        intersect_in_single(sphere, ray).0
    }
}

/// The parameter of the hit or [`Hit::NONE_T`], and the step that decided.
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
#[inline]
#[must_use]
pub fn intersect_with_stage(sphere: Sphere, ray: &Ray) -> (f32, Stage) {
    let line = wide::WideRay::of(ray);
    let (center, radius) = (
        Lane3::of(sphere.center()).widened(),
        f64::from(sphere.radius()),
    );
    let roots = line.roots(center, radius);
    let answer = line.choose(&roots);
    if answer.is_certain {
        return (answer.t as f32, Stage::Wide);
    }
    let rounded = line.round(center, radius, &roots);
    if rounded.is_certain {
        return (rounded.t, Stage::Midpoint);
    }
    let pairs = Quadratic::of(sphere, ray);
    (intersect_distilled(&pairs, ray), Stage::Distilled)
}

/// The parameter of the hit or [`Hit::NONE_T`], if one step in 64-bit floats decides;
/// [`Hit::DEFERRED_T`] otherwise.
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
#[inline]
#[must_use]
pub fn intersect_or_defer(sphere: Sphere, ray: &Ray) -> f32 {
    let center = Lane3::of(sphere.center()).widened();
    let answer = wide::WideRay::of(ray).intersect(center, f64::from(sphere.radius()));
    if answer.is_certain {
        answer.t as f32
    } else {
        Hit::DEFERRED_T
    }
}

/// [`intersect_or_defer`] for a ray that certainly enters the sphere, first and within its interval
/// but for the end: from a guess of where.
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
#[inline]
#[must_use]
pub fn entry_or_defer(sphere: Sphere, ray: &Ray, guess: f32) -> f32 {
    let corrected = wide::WideRay::of(ray).corrected(ray, sphere, guess);
    if !(corrected.is_certain & corrected.is_near) {
        Hit::DEFERRED_T
    } else if corrected.t < ray.t_max {
        corrected.t
    } else {
        Hit::NONE_T
    }
}

/// [`intersect_or_defer`]; the guess is of no use to pairs of floats.
#[cfg(all(target_arch = "spirv", not(feature = "f64")))]
#[inline]
#[must_use]
pub fn entry_or_defer(sphere: Sphere, ray: &Ray, _: f32) -> f32 {
    intersect_or_defer(sphere, ray)
}

/// The parameter of the hit or [`Hit::NONE_T`], if the filter and pairs of floats decide;
/// [`Hit::DEFERRED_T`] otherwise.
#[cfg(all(target_arch = "spirv", not(feature = "f64")))]
#[inline]
#[must_use]
pub fn intersect_or_defer(sphere: Sphere, ray: &Ray) -> f32 {
    if filter::misses_for_certain(sphere, ray) {
        return Hit::NONE_T;
    }
    let pairs = Quadratic::of(sphere, ray);
    if pairs.misses_for_certain() {
        return Hit::NONE_T;
    }
    if pairs.meets_for_certain() {
        let roots = Root::both(&pairs, pairs.size_error(), pairs.c_error());
        let (t, is_certain) = choose(&pairs, roots, ray);
        if is_certain {
            return t;
        }
    }
    Hit::DEFERRED_T
}

/// As [`intersect_with_stage`], in 32-bit floats alone.
#[inline]
#[must_use]
pub fn intersect_in_single(sphere: Sphere, ray: &Ray) -> (f32, Stage) {
    if filter::misses_for_certain(sphere, ray) {
        return (Hit::NONE_T, Stage::Filter);
    }
    let pairs = Quadratic::of(sphere, ray);
    if pairs.misses_for_certain() {
        return (Hit::NONE_T, Stage::Pairs);
    }
    if pairs.meets_for_certain() {
        let size_error = pairs.size_error();
        let (mut quadratic, mut c_error, mut stage) = (pairs, pairs.c_error(), Stage::Pairs);
        // With c as it is, and with c distilled: it is uncertain for an origin near the surface or
        // near that of a very large sphere. A loop, so that there is one copy of the code.
        let mut tries = 0;
        while tries < 2 {
            let (t, is_certain) = choose(&pairs, Root::both(&quadratic, size_error, c_error), ray);
            if is_certain {
                return (t, stage);
            }
            if size_error > WORTH_A_TRY {
                break;
            }
            quadratic = distilled::with_distilled_c(&pairs);
            c_error = quadratic.c.high.abs() * distilled::ERROR;
            stage = Stage::DistilledC;
            tries += 1;
        }
    }
    (intersect_distilled(&pairs, ray), Stage::Distilled)
}

/// By sums without loss alone.
#[inline]
fn intersect_distilled(pairs: &Quadratic, ray: &Ray) -> f32 {
    let quadratic = distilled::distilled(pairs);
    let meets = (quadratic.discriminant.high >= 0.0) & (quadratic.a.high > 0.0);
    if meets {
        let c_error = quadratic.c.high.abs() * distilled::ERROR;
        let roots = Root::both(&quadratic, distilled::ERROR, c_error);
        choose_exactly(pairs, roots, ray)
    } else {
        Hit::NONE_T
    }
}
