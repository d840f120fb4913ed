//! Certified: right answers everywhere, with more digits only where 32-bit floats cannot decide.
//! Runs on the GPU and on the CPU.
//!
//! There are three stages. Each is evaluated only where the one before cannot decide, after J. R.
//! Shewchuk's adaptive predicates (Discrete Comput. Geom. 18 (1997) 305).
//!
//! **1. A filter in f32.** The errors, with u = 2⁻²⁴, from o = O − C through b/a to the foot
//! f = o − (b/a)d:
//!
//! - Each component of f is off by at most 11u|o|, because |(b/a)d| ≤ |o|. So f·f is off by
//!   22u|f||o| + 121u²o·o + 3u f·f ≤ 16u (f·f + o·o), and r² by u r².
//! - A line misses for certain where f·f − r² > 32u (f·f + o·o + r²).
//! - Where c is certainly positive, a ray with b > 0 and `t_min` ≥ 0 leaves and misses: if b were
//!   truly negative, it would be so by 8u|o||d| at most, and a hit needs b² ≥ ac.
//! - Where the ray enters, t is at least (|b| − √(a(r² − f·f + E)))/a, minus 32u of its terms, with
//!   E = 32u (f·f + o·o + r²). Beyond the end of the ray's interval the hit does not matter.
//!
//! Operations may be fused or not, and division and root off by a few units in the last place: the
//! factor 32 covers all of these errors twice over.
//!
//! **2. Pairs of floats**, as in [`super::compensated`], where Δ, c and b are far enough from zero
//! for their errors. Let E₂ = 2⁻³⁸ (a r² + k·k + |k||o||d|). The sign of Δ is certain where |Δ| >
//! E₂. t is within 1 ulp where E₂ ≤ 2⁻²⁶ √Δ·|q|, |c| ≥ 2⁻¹⁹ (o·o + r²) and |q| ≥ 2⁻¹⁸ |o||d|.
//!
//! **3. Distillation**, of c alone if only c is too close to zero, otherwise of all. Δ, b and c are
//! written as sums of exact products, and summed without loss ([`crate::arithmetic::distill`]).
//! Each is then right to about 40 bits, whatever cancels, and zero where it is zero; the exception
//! is a sum within 2⁻¹⁰⁰ of cancelling completely, which floats of one binade cannot reach. The
//! remaining operations add numbers of one sign, so t is within 1 ulp. Lengths and directions are
//! multiplied by 2²⁸ before, so that no product of theirs is subnormal that counts: a component may
//! be 2⁻⁷⁵ of the largest length. The largest sum, Δ, stays below 2¹²³.

// On the CPU, std has `f32::sqrt`.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use super::compensated::{Quadratic, scale};
use super::root::{Precision, choose_root};
use crate::arithmetic::DoubleSingle;
use crate::arithmetic::distill::distill;
use crate::arithmetic::elements::{get, set};
use crate::arithmetic::error_free::two_product;
use crate::arithmetic::strict::{add, mul, sub};
use crate::hit::Hit;
use crate::ray::Ray;
use crate::sphere::Sphere;

/// The rung of this module.
#[derive(Clone, Copy, Debug)]
pub struct Certified;

/// What lengths and directions are multiplied by before the last stage: 2²⁸.
const LARGE: f32 = (1 << 28) as f32;

/// 32u.
const FILTER: f32 = 1.0 / (1 << 19) as f32;

/// The stage that decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u32)]
pub enum Stage {
    /// The filter.
    Filter = 0,
    /// Pairs of floats.
    Pairs = 1,
    /// Pairs of floats, with c distilled.
    DistilledC = 2,
    /// Distillation of everything.
    Distilled = 3,
}

impl Precision for Certified {
    #[inline]
    fn intersect(sphere: Sphere, ray: &Ray) -> f32 {
        intersect_with_stage(sphere, ray).0
    }
}

/// The parameter of the hit or [`Hit::NONE_T`], and the stage that decided.
#[inline]
#[must_use]
pub fn intersect_with_stage(sphere: Sphere, ray: &Ray) -> (f32, Stage) {
    if misses_for_certain(sphere, ray) {
        return (Hit::NONE_T, Stage::Filter);
    }
    let quadratic = Quadratic::of(sphere, ray);
    if quadratic.misses_for_certain() {
        return (Hit::NONE_T, Stage::Pairs);
    }
    if quadratic.size_is_certain() {
        // c may still be uncertain: for an origin near the surface, or near that of a very large
        // sphere.
        let c_is_certain = quadratic.c_is_certain();
        let quadratic = if c_is_certain {
            quadratic
        } else {
            with_distilled_c(&quadratic)
        };
        let (near, far) = quadratic.roots();
        let stage = if c_is_certain {
            Stage::Pairs
        } else {
            Stage::DistilledC
        };
        return (choose_root(near, far, ray), stage);
    }
    let quadratic = distilled(&quadratic);
    let meets = (quadratic.discriminant.high >= 0.0) & (quadratic.a.high > 0.0);
    if meets {
        let (near, far) = quadratic.roots();
        (choose_root(near, far, ray), Stage::Distilled)
    } else {
        (Hit::NONE_T, Stage::Distilled)
    }
}

/// What is added to the filter's sum of squares, so that a subnormal square decides nothing.
const SMALLEST: f32 = 1e-30;

/// Stage 1: whether the ray misses for certain. False for NaN, and for a direction whose square is
/// not between [`SMALLEST`] and the largest float.
#[inline]
fn misses_for_certain(sphere: Sphere, ray: &Ray) -> bool {
    let o = ray.origin - sphere.center();
    let d = ray.direction;
    let a = d.dot(d);
    let b = o.dot(d);
    // This is the same for every sphere that the ray is tested against.
    let inverse = 1.0 / a;
    let foot = o - d * (b * inverse);
    let (ff, oo) = (foot.dot(foot), o.dot(o));
    let rr = sphere.radius() * sphere.radius();
    let squares = oo + rr + SMALLEST;
    let has_length = (SMALLEST..f32::MAX).contains(&a);
    let passes_by = ff - rr > FILTER * (ff + squares);
    let is_outside = has_length & (oo - rr > FILTER * squares);
    if (has_length & passes_by) | (is_outside & (b > 0.0) & (ray.t_min >= 0.0)) {
        return true;
    }
    if is_outside {
        let discriminant = (rr - ff).max(0.0) + FILTER * (ff + squares);
        let root = (a * discriminant).sqrt();
        let size = (a * oo).sqrt() + root;
        let nearest = (-b - root - FILTER * size) / a;
        return nearest > ray.t_max + ray.t_max.abs() * FILTER;
    }
    false
}

/// Stage 3: the quadratic with every coefficient distilled. Its roots are those of `pairs`: lengths
/// and directions are multiplied by the same number.
#[inline]
fn distilled(pairs: &Quadratic) -> Quadratic {
    let (o, r) = enlarged(pairs);
    let d = [
        mul(pairs.d[0], LARGE),
        mul(pairs.d[1], LARGE),
        mul(pairs.d[2], LARGE),
    ];

    // a = d·d and r², exactly; b = o·d.
    let mut a_terms = [0.0; 6];
    let mut b_terms = [0.0; 12];
    let mut axis = 0;
    while axis < 3 {
        put_product(&mut a_terms, 2 * axis, get(&d, axis), get(&d, axis));
        put_product(&mut b_terms, 4 * axis, get(&o, axis).high, get(&d, axis));
        put_product(&mut b_terms, 4 * axis + 2, get(&o, axis).low, get(&d, axis));
        axis += 1;
    }
    let rr = two_product(r, r);

    // Δ = a r² − k·k, with each component of k as eight terms.
    let mut terms = [0.0; 240];
    let mut at = 0;
    let mut index = 0;
    while index < 6 {
        put_product(&mut terms, at, get(&a_terms, index), rr.0);
        put_product(&mut terms, at + 2, get(&a_terms, index), rr.1);
        at += 4;
        index += 1;
    }
    let mut axis = 0;
    while axis < 3 {
        let (y, z) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut k = [0.0; 8];
        put_product(&mut k, 0, get(&o, y).high, get(&d, z));
        put_product(&mut k, 2, get(&o, y).low, get(&d, z));
        let (negative_high, negative_low) = (sub(0.0, get(&o, z).high), sub(0.0, get(&o, z).low));
        put_product(&mut k, 4, negative_high, get(&d, y));
        put_product(&mut k, 6, negative_low, get(&d, y));
        let mut first = 0;
        while first < 8 {
            let negative = sub(0.0, get(&k, first));
            put_product(&mut terms, at, negative, get(&k, first));
            at += 2;
            let twice = add(negative, negative);
            let mut second = first + 1;
            while second < 8 {
                put_product(&mut terms, at, twice, get(&k, second));
                at += 2;
                second += 1;
            }
            first += 1;
        }
        axis += 1;
    }

    Quadratic {
        a: distill(&mut a_terms),
        b: distill(&mut b_terms),
        c: distilled_squares(&o, r),
        discriminant: distill(&mut terms),
        ..*pairs
    }
}

/// The vector from the centre to the origin, and the radius, times [`LARGE`].
#[inline]
fn enlarged(pairs: &Quadratic) -> ([DoubleSingle; 3], f32) {
    let o = pairs.o;
    let enlarged = [scale(o[0], LARGE), scale(o[1], LARGE), scale(o[2], LARGE)];
    (enlarged, mul(pairs.r, LARGE))
}

/// The quadratic with c distilled. Its roots are those of `pairs`, as in [`distilled`].
#[inline]
fn with_distilled_c(pairs: &Quadratic) -> Quadratic {
    let (o, r) = enlarged(pairs);
    let squared = LARGE * LARGE;
    Quadratic {
        a: scale(pairs.a, squared),
        b: scale(pairs.b, squared),
        c: distilled_squares(&o, r),
        discriminant: scale(scale(pairs.discriminant, squared), squared),
        ..*pairs
    }
}

/// Distils o·o − r².
#[inline]
fn distilled_squares(o: &[DoubleSingle; 3], r: f32) -> DoubleSingle {
    let mut terms = [0.0; 20];
    let mut axis = 0;
    while axis < 3 {
        let o = get(o, axis);
        put_product(&mut terms, 6 * axis, o.high, o.high);
        put_product(&mut terms, 6 * axis + 2, add(o.high, o.high), o.low);
        put_product(&mut terms, 6 * axis + 4, o.low, o.low);
        axis += 1;
    }
    let rr = two_product(r, r);
    set(&mut terms, 18, sub(0.0, rr.0));
    set(&mut terms, 19, sub(0.0, rr.1));
    distill(&mut terms)
}

/// Stores the exact product in the two elements from `at` on.
#[inline]
fn put_product<const N: usize>(terms: &mut [f32; N], at: usize, a: f32, b: f32) {
    let DoubleSingle { high, low } = DoubleSingle::product(a, b);
    set(terms, at, high);
    set(terms, at + 1, low);
}
