//! The step of [`Certified`](super::Certified) in 64-bit floats, in lanes. Runs on the CPU, and on
//! GPUs whose module declares 64-bit floats.
//!
//! The formulas are those of [`double`](crate::precision::double); here are the bounds on their
//! errors. Let v = 2⁻⁵³. No product overflows or is subnormal: floats of 32 bits are between 2⁻¹⁴⁹
//! and 2¹²⁸, and no term has more than four factors.
//!
//! - o = O − C is off by v in each component, and d by nothing. So each component of k = o × d is
//!   off by 2v of the sum of its two products' magnitudes, and by its rounding: |δk| is at most
//!   2.31v|o||d| + v|k|, because the vector of such sums is at most 2/√3 |o||d| long.
//! - k·k is off by 2|k||δk| + |δk|² + 3v k·k, and a r² by 3v a r². With |k||o||d| ≤ 2⁶ k·k + 2⁻⁸
//!   o·o a, and k·k ≤ a r² + |Δ|, Δ is off by
//!
//!   > E = 2⁻⁴⁴ (a r² + |Δ|) + 2⁻⁵⁸ a o·o
//!
//!   at most; these are 1.6 times what was derived. Where Δ is b² − ac, it is off by 8v|b||o||d| +
//!   16v² a o·o from b, and by 4v b² and (2⁻⁵¹ a|c| + 2⁻⁷² a (o·o + r²)) besides. With |b||o||d| ≤
//!   2¹⁰ b² + 2⁻¹² a o·o that is less than
//!
//!   > E = 2⁻³⁹ b² + 2⁻⁶¹ a o·o + 2⁻⁵⁰ a|c|.
//!
//!   The sign of Δ is certain where |Δ| > E.
//! - √Δ is off by E/√Δ, and b by 4v|o||d| ≤ |q| (2⁻⁴² + 2⁻⁶² a o·o/q²). |q| = |b| + √Δ is off by
//!   both.
//! - c is off by 6v (o·o + r²), or by v|c| + 2⁻⁷³ (o·o + r²) where it is the
//!   [`residual`](crate::precision::double::residual).
//! - Quotients and the root are right to 2⁻⁴³ together, also where a device's own begin with 24
//!   bits, off by 3u, because of the Newton step after each. The canary refuses devices that are
//!   not.
//!
//! Together they bound the error of a root. A root is certain if both ends of its bounds round to
//! the same 32-bit float; one in 2¹⁸ or so is not.

use crate::hit::Hit;
use crate::lane::{Lane, Lane3};
use crate::precision::compensated::two_to_minus;
use crate::precision::double::Quadratic;
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
use crate::ray::Ray;

/// What 64-bit floats tell of a ray and a sphere.
#[derive(Clone, Copy, Debug)]
pub struct Answer<L: Lane> {
    /// Whether the rest is right.
    pub is_certain: L::Mask,
    /// Whether the ray hits.
    pub is_hit: L::Mask,
    /// The parameter of the hit, rounded to 32 bits; [`Hit::NONE_T`] for no hit.
    pub t: L,
}

/// The roots of a line and a sphere, with bounds on their errors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounded<L: Lane> {
    /// Whether the line certainly misses the sphere.
    misses: L::Mask,
    /// Whether the line certainly meets the sphere; the rest is right there.
    pub(super) meets: L::Mask,
    /// The smaller root.
    pub(super) near: L,
    /// How far it may be off.
    pub(super) near_error: L,
    /// The larger root.
    pub(super) far: L,
    /// How far it may be off.
    pub(super) far_error: L,
}

/// The line and the interval of a ray, in lanes of 64-bit floats.
#[derive(Clone, Copy, Debug)]
pub struct WideRay<L> {
    /// The ray's origin.
    pub origin: Lane3<L>,
    /// The ray's direction.
    pub direction: Lane3<L>,
    /// The start of the interval.
    pub t_min: L,
    /// The end of the interval.
    pub t_max: L,
}

#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
impl WideRay<f64> {
    /// The line and the interval of a ray.
    #[inline(always)]
    #[must_use]
    pub(super) fn of(ray: &Ray) -> Self {
        Self {
            origin: Lane3::of(ray.origin).widened(),
            direction: Lane3::of(ray.direction).widened(),
            t_min: f64::from(ray.t_min),
            t_max: f64::from(ray.t_max),
        }
    }
}

impl<L: Lane> WideRay<L> {
    /// The roots of the line and a sphere. With NaN nothing is certain.
    // No closures: in lanes they would be compiled without the caller's instructions.
    #[inline(always)]
    #[must_use]
    pub(super) fn roots(&self, center: Lane3<L>, radius: L) -> Bounded<L> {
        let quadratic = Quadratic::of(self.origin, self.direction, center, radius);
        let Quadratic {
            a,
            b,
            c,
            discriminant,
            oo,
            rr,
            c_has_digits,
            ..
        } = quadratic;

        let of_cross = (a * rr + discriminant.abs()) * a.splat(two_to_minus(44))
            + a * oo * a.splat(two_to_minus(58));
        let of_squares = b * b * a.splat(two_to_minus(39))
            + a * oo * a.splat(two_to_minus(61))
            + a * c.abs() * a.splat(two_to_minus(50));
        let error = L::select(c_has_digits, of_cross, of_squares);
        let misses = discriminant.simd_lt(-error);
        let meets = discriminant.simd_gt(error);

        let all = oo + rr;
        let of_rest = c.abs() * a.splat(two_to_minus(52)) + all * a.splat(two_to_minus(72));
        let c_error = L::select(c_has_digits, all * a.splat(two_to_minus(50)), of_rest);
        let roots = quadratic.roots();
        let of_b = a * oo * (roots.over_size * roots.over_size) * a.splat(two_to_minus(62));
        let relative = error * roots.over_both + of_b + a.splat(two_to_minus(41));
        let (none, of_c) = (a.splat(0.0), c_error * roots.over_size);
        let near_error = roots.near.abs() * relative + L::select(roots.leaves, none, of_c);
        let far_error = roots.far.abs() * relative + L::select(roots.leaves, of_c, none);
        Bounded {
            misses,
            meets,
            near: roots.near,
            near_error,
            far: roots.far,
            far_error,
        }
    }

    /// Intersects the ray with a sphere.
    #[inline(always)]
    #[must_use]
    pub fn intersect(&self, center: Lane3<L>, radius: L) -> Answer<L> {
        self.choose(&self.roots(center, radius))
    }

    /// The smaller root that lies in the ray's interval once it is rounded.
    #[inline(always)]
    #[must_use]
    pub(super) fn choose(&self, roots: &Bounded<L>) -> Answer<L> {
        let Bounded {
            misses,
            meets,
            near_error,
            far_error,
            ..
        } = *roots;
        // The smaller root, rounded, is certainly in the interval, or certainly before it.
        let is_ahead = (roots.near - near_error).to_single().simd_ge(self.t_min);
        let is_before = (roots.near + near_error).to_single().simd_lt(self.t_min);
        let root = L::select(is_ahead, roots.near, roots.far);
        let root_error = L::select(is_ahead, near_error, far_error);
        let t = (root - root_error).to_single();
        let is_rounded = t.simd_ge((root + root_error).to_single());
        let is_right = meets & (is_ahead | is_before) & is_rounded;
        let is_hit = is_right & t.simd_ge(self.t_min) & t.simd_lt(self.t_max);
        Answer {
            is_certain: misses | is_right,
            is_hit,
            t: L::select(is_hit, t, t.splat(Hit::NONE_T)),
        }
    }
}
