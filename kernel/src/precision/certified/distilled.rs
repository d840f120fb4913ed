//! The last step of [`Certified`](super::Certified): coefficients as sums without loss. Runs on the
//! GPU and on the CPU.
//!
//! Δ, b and c are written as sums of exact products, and summed by
//! [`distill`](crate::arithmetic::distill). Each is then right to about 40 bits, whatever cancels,
//! and zero where it is zero; the exception is a sum within 2⁻¹⁰⁰ of cancelling completely, which
//! floats of one binade cannot reach. The remaining operations add numbers of one sign, so roots
//! are right to [`ERROR`].
//!
//! Lengths and directions are multiplied by 2²⁸ before, so that no product of theirs is subnormal
//! that counts: a component may be 2⁻⁷⁵ of the largest length. The largest sum, Δ, stays below
//! 2¹²³.

use crate::arithmetic::DoubleSingle;
use crate::arithmetic::distill::distill;
use crate::arithmetic::elements::{get, set};
use crate::arithmetic::error_free::two_product;
use crate::arithmetic::strict::{add, mul, sub};
use crate::precision::compensated::{Quadratic, RAISED, scale, two_to_minus};

/// What lengths and directions are multiplied by: 2²⁸.
const LARGE: f32 = (1 << 28) as f32;

/// A bound on the relative errors of what is distilled, and of roots made of it: 2⁻³⁶.
pub const ERROR: f32 = two_to_minus(36);

/// The quadratic with every coefficient distilled. Its roots are those of `pairs`: lengths and
/// directions are multiplied by the same number.
#[inline]
#[must_use]
pub fn distilled(pairs: &Quadratic) -> Quadratic {
    let Enlarged { o, r, d } = Enlarged::of(pairs);

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

/// Lengths and directions times [`LARGE`].
struct Enlarged {
    /// From the sphere's centre to the ray's origin.
    o: [DoubleSingle; 3],
    /// The radius.
    r: f32,
    /// The direction.
    d: [f32; 3],
}

impl Enlarged {
    #[inline]
    fn of(pairs: &Quadratic) -> Self {
        let (o, d) = (pairs.o, pairs.d);
        Self {
            o: [scale(o[0], LARGE), scale(o[1], LARGE), scale(o[2], LARGE)],
            r: mul(pairs.r, LARGE),
            d: [mul(d[0], LARGE), mul(d[1], LARGE), mul(d[2], LARGE)],
        }
    }
}

/// The quadratic with c distilled. Its roots are those of `pairs`, as in [`distilled`].
#[inline]
#[must_use]
pub fn with_distilled_c(pairs: &Quadratic) -> Quadratic {
    let Enlarged { o, r, .. } = Enlarged::of(pairs);
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

/// Where a parameter is on a line that meets a sphere.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// The sign of the distance to the sphere's surface: positive outside.
    pub outside: f32,
    /// The sign of the parameter minus that of the line's middle.
    pub ahead: f32,
}

impl Side {
    /// Of a parameter of the scaled quadratic, times [`RAISED`], exactly, by
    /// p(t) = (o + td)·(o + td) − r² and p′(t)/2 = (o + td)·d.
    #[inline]
    #[must_use]
    pub fn of(pairs: &Quadratic, t: DoubleSingle) -> Self {
        let Enlarged { o, r, d } = Enlarged::of(pairs);
        let mut squares = [0.0; 128];
        let mut products = [0.0; 36];
        let mut axis = 0;
        while axis < 3 {
            let lowered = mul(get(&d, axis), 1.0 / RAISED);
            let (high, low) = (
                DoubleSingle::product(t.high, lowered),
                DoubleSingle::product(t.low, lowered),
            );
            let o = get(&o, axis);
            let sum = [o.high, o.low, high.high, high.low, low.high, low.low];
            let mut at = 42 * axis;
            let mut first = 0;
            while first < 6 {
                let term = get(&sum, first);
                put_product(&mut products, 12 * axis + 2 * first, term, get(&d, axis));
                put_product(&mut squares, at, term, term);
                at += 2;
                let twice = add(term, term);
                let mut second = first + 1;
                while second < 6 {
                    put_product(&mut squares, at, twice, get(&sum, second));
                    at += 2;
                    second += 1;
                }
                first += 1;
            }
            axis += 1;
        }
        let rr = two_product(r, r);
        set(&mut squares, 126, sub(0.0, rr.0));
        set(&mut squares, 127, sub(0.0, rr.1));
        Self {
            outside: distill(&mut squares).high,
            ahead: distill(&mut products).high,
        }
    }

    /// The sign of the smaller root minus the parameter, or of the larger one.
    #[inline]
    #[must_use]
    pub fn of_root(&self, is_near: bool) -> f32 {
        // Before the line's middle the smaller root is where the line comes from outside to inside.
        let is_on_the_side = if is_near {
            self.ahead <= 0.0
        } else {
            self.ahead >= 0.0
        };
        let beyond = if is_near { -1.0 } else { 1.0 };
        if !is_on_the_side {
            beyond
        } else if is_near {
            self.outside
        } else {
            -self.outside
        }
    }
}

/// Stores the exact product in the two elements from `at` on.
#[inline]
fn put_product<const N: usize>(terms: &mut [f32; N], at: usize, a: f32, b: f32) {
    let DoubleSingle { high, low } = DoubleSingle::product(a, b);
    set(terms, at, high);
    set(terms, at + 1, low);
}
