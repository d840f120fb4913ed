//! The step of [`Certified`](super::Certified) that corrects a root in 32-bit floats by what it
//! leaves of the sphere's equation in 64-bit floats, in lanes. Runs on the CPU, and on GPUs whose
//! module declares 64-bit floats.
//!
//! Let t₀ be any parameter near a root, p = o + t₀d with o = O − C, g = p·p − r² and h = p·d. The
//! quadratic in δ = t − t₀ is a δ² + 2h δ + g, so that
//!
//! > δ = −g / (h (1 + √(1 − x))), x = a g / h².
//!
//! Where x < 1 the line meets the sphere; this is its smaller root if h < 0, and its larger one if
//! h > 0.
//!
//! g cancels: it is computed in 64-bit floats. What is left of it is small, so that 32-bit floats
//! do for the rest. Let u = 2⁻²⁴ and v = 2⁻⁵³. Products of two 32-bit floats are exact, fused or
//! not.
//!
//! - o is off by v in each component, and the sum by v again: p is off by v(|o| + |p|).
//! - Where |x| ≤ ¼, |p·d| ≤ |p||d| makes |g| ≤ p·p/4, so that |p| ≤ 1.16r; and |o| ≤ |t₀||d| + |p|.
//! - So g is off by 2|p|v(|o| + |p|) + 3v p·p + v|g| ≤ v r (2.4|t₀||d| + 10r), and δ by 0.58/|h| of
//!   that.
//! - h is off by v|d|(|o| + 5|p|), of which δ takes as large a share.
//! - g, h, two quotients, a root and two products in 32-bit floats put δ off by 19u of itself: 5u a
//!   quotient, and what the root and x add.
//!
//! Together that is less than
//!
//! > E = 2⁻⁵¹ (r + |δ||d|)(|t₀||d| + 2r) / |h| + 2⁻¹⁹|δ|.
//!
//! The sum t = t₀ + δ is rounded once, and what it loses is computed without loss. If that and E
//! are less than half of the distance to the next float towards zero, which is never farther than
//! the one on the other side, then t is the float nearest to the root.

use super::wide::WideRay;
use crate::lane::{Lane, Lane3};
use crate::precision::compensated::two_to_minus;
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
use crate::{Ray, Sphere};

/// What a guess of a root leaves of a sphere's equation.
#[derive(Clone, Copy, Debug)]
pub struct Residual<L> {
    /// g = p·p − r².
    pub g: L,
    /// h = p·d, half of the slope.
    pub h: L,
}

/// A root of a line and a sphere.
#[derive(Clone, Copy, Debug)]
pub struct Corrected<L: Lane> {
    /// The root, rounded.
    pub t: L,
    /// Whether it is the smaller root, and not the larger one.
    pub is_near: L::Mask,
    /// Whether the line certainly meets the sphere, and `t` is the float nearest to that root.
    pub is_certain: L::Mask,
}

impl<L: Lane> WideRay<L> {
    /// What a parameter of 32 bits leaves, in lanes of 64-bit floats.
    #[inline(always)]
    #[must_use]
    pub fn residual(&self, center: Lane3<L>, radius: L, guess: L) -> Residual<L> {
        let o = self.origin.minus(center);
        let p = o.plus(self.direction.scaled(guess));
        Residual {
            g: p.dot(p) - radius * radius,
            h: p.dot(self.direction),
        }
    }
}

impl<L: Lane> Residual<L> {
    /// The root from the guess, for a ray's direction and a radius, in lanes of 32-bit floats.
    // No closures: in lanes they would be compiled without the caller's instructions.
    #[inline(always)]
    #[must_use]
    pub fn correct(self, guess: L, d: Lane3<L>, radius: L) -> Corrected<L> {
        let Self { g, h } = self;
        let (one, half) = (guess.splat(1.0), guess.splat(0.5));
        let a = d.dot(d);
        let inverse = one / h;
        let ratio = g * inverse;
        let share = a * ratio * inverse;
        let delta = -ratio / (one + (one - share).sqrt());
        let t = guess.add_strict(delta);
        let lost = delta.sub_strict(t.sub_strict(guess));

        let (r, length) = (radius.abs(), d.x.abs() + d.y.abs() + d.z.abs());
        let reach = guess.abs() * length + (r + r);
        let of_wide = (r + delta.abs() * length) * reach;
        let error = of_wide * inverse.abs() * guess.splat(two_to_minus(51))
            + delta.abs() * guess.splat(two_to_minus(19));
        // The next float towards zero: what is subtracted is between half of a unit in the last
        // place and one.
        let next = t.mul_strict(one - guess.splat(two_to_minus(24)));
        let is_rounded = (lost.abs() + error).simd_lt(half * t.sub_strict(next).abs());
        // Where nothing in 32-bit floats is subnormal or overflows.
        let is_normal = (r * reach).simd_gt(guess.splat(two_to_minus(70)))
            & t.abs().simd_gt(guess.splat(two_to_minus(90)));
        Corrected {
            t,
            is_near: h.simd_lt(guess.splat(0.0)),
            is_certain: share.abs().simd_le(guess.splat(0.25)) & is_rounded & is_normal,
        }
    }
}

#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
impl WideRay<f64> {
    /// The root near a guess. A second step corrects what the first one leaves open: that is one
    /// root in ten thousand, and after it next to none.
    #[inline]
    #[must_use]
    pub(super) fn corrected(&self, ray: &Ray, sphere: Sphere, guess: f32) -> Corrected<f32> {
        let center = Lane3::of(sphere.center()).widened();
        let radius = sphere.radius();
        let mut guess = guess;
        let mut steps = 0;
        loop {
            let Residual { g, h } = self.residual(center, f64::from(radius), f64::from(guess));
            let residual = Residual {
                g: g as f32,
                h: h as f32,
            };
            let corrected = residual.correct(guess, Lane3::of(ray.direction), radius);
            steps += 1;
            if corrected.is_certain | (steps == 2) {
                return corrected;
            }
            guess = corrected.t;
        }
    }
}
