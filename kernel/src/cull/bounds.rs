//! [`Bounds`]: what a few operations tell about a ray and a sphere, for all rungs from
//! [`Rung::Robust`](crate::Rung::Robust) up: whether they miss for certain, whether they hit for
//! certain, and between which parameters. Runs on the GPU and on the CPU.
//!
//! A walk through a tree keeps the sphere that is nearest by its bounds. It evaluates the rung
//! once, at its end, and where the bounds decide nothing.
//!
//! # The bounds
//!
//! Let u = 2⁻²⁴ and o = C − O. Let d be the direction, scaled by a power of two so that
//! 1 ≤ |d| < 2√3, and a = d·d. The middle is m = o·d / a, the foot of the perpendicular is
//! f = o − m d, and q = r² − f·f.
//!
//! **What floats are off by.** Operations may be fused or not; quotients are off by 2.5 units in
//! the last place, roots by 4. Then m is off by 14u|o|/|d|, and f by 17u|o|. The rungs from robust
//! up use this formula or a better one, so none of them is farther off.
//!
//! **Hit or miss.** So the feet of two of these computations are at most 34u|o| apart. Take the
//! doubt
//!
//! > e = s (2r + s), s = 40u|o|,
//!
//! which is (r + s)² − r². Where q + e < 0 here, all of these rungs have q < 0; where q − e > 0
//! here, all of them have q > 0. |o| is taken for the sum of its components' magnitudes, which is
//! larger.
//!
//! **Where the ray enters.** Where q − e > 0:
//!
//! - Each of these rungs has a q between q − e and q + e, but for what is relative in r² and f·f.
//!   Where that counts, the origin is deep inside the sphere, and it changes √q by 16u r.
//! - To that come the errors of m, of the roots and of the sums, and robust's own 16u max(|o|, r)
//!   and 8u|o| for its c and b.
//! - Together, the parameter at which the ray enters is for all of these rungs between m − √((q +
//!   e)/a) and m − √((q − e)/a), to within 64u(|m| + 2r); and |o| ≤ m|d| + r.
//!
//! **Behind the ray.** A sphere is behind its ray for certain where o·d < 0 and c = o·o − r² > 32u
//! (o·o + r²). A hit would need an o·d of the size of its own error. There the foot is off by only
//! 7u|o|, so that a hit would need (8u)² o·o ≥ c.

use glam::Vec3;

use crate::cull::discriminant::{Target, power_of_two_under};
use crate::lane::{Lane, Lane3};
use crate::ray::Ray;
use crate::sphere::Sphere;

/// The bounds are as far as `OFF` |m| + [`OFF_BY_RADIUS`] r beyond m − √((q ± e)/a). This is 64u.
pub const OFF: f32 = 1.0 / (1 << 18) as f32;
/// The share of r in that, see [`OFF`]: 128u.
pub const OFF_BY_RADIUS: f32 = 1.0 / (1 << 17) as f32;
/// What the feet of two computations differ by, and what is relative in their squares, is less than
/// this times |o|: 40u.
const OFF_FOOT: f32 = 40.0 / (1 << 24) as f32;
/// An origin is outside for certain where o·o times this is more than r²: 1 − 64u.
pub const OUTSIDE: f32 = 1.0 - 1.0 / (1 << 18) as f32;

/// What is the same for a ray from sphere to sphere, in lanes.
#[derive(Clone, Copy, Debug)]
pub struct Aim<L> {
    /// The direction, scaled so that its largest component is between 1 and 2.
    pub direction: Lane3<L>,
    /// One over the direction's squared length.
    pub inverse: L,
    /// The start of the ray's interval, in parameters of the scaled direction.
    pub start: L,
    /// What o·d must be below for a sphere to be behind.
    pub behind: L,
}

impl<L: Lane> Aim<L> {
    /// Whether a sphere is behind its ray for certain, or begins beyond `end`, a parameter of the
    /// scaled direction. No point of a sphere is nearer than o·d/a − r/|d|, |d| is at least one,
    /// and the middle is off by less than what the bounds allow for.
    #[inline(always)]
    #[must_use]
    pub fn is_out_of_reach(&self, target: &Target<L>, radius: L, end: L) -> L::Mask {
        let r = radius.abs();
        let b = target.o.dot_rough(self.direction);
        let middle = b * self.inverse;
        let off = middle.abs() * r.splat(OFF);
        let off = r.mul_add_rough(r.splat(OFF_BY_RADIUS), off);
        let is_behind = b.simd_lt(self.behind) & (target.oo * r.splat(OUTSIDE)).simd_gt(target.rr);
        (middle - r - off).simd_gt(end) | is_behind
    }

    /// The bounds of a sphere from o, the vector from the ray's origin to its centre, and its
    /// radius: misses, hits, low and high, as in [`Bounds`]. With NaN neither a miss nor a hit is
    /// certain.
    #[inline(always)]
    #[must_use]
    pub fn bounds(&self, o: Lane3<L>, radius: L) -> (L::Mask, L::Mask, L, L) {
        let r = radius.abs();
        let (oo, rr) = (o.dot(o), r * r);
        let b = o.dot(self.direction);
        let middle = b * self.inverse;
        let foot = o.minus_scaled(self.direction, middle);
        let q = rr - foot.dot(foot);
        let apart = (o.x.abs() + o.y.abs() + o.z.abs()) * oo.splat(OFF_FOOT);
        // The constant keeps squares decisive only where they are large enough for their errors to
        // be relative.
        let doubt = apart * (r + r + apart) + oo.splat(1e-30);
        let (least, most) = (q - doubt, q + doubt);
        let off = middle.abs() * oo.splat(OFF) + r * oo.splat(OFF_BY_RADIUS);
        let low = middle - (most * self.inverse).sqrt() - off;
        let high = middle - (least * self.inverse).sqrt() + off;
        let zero = oo.splat(0.0);
        let is_behind = b.simd_lt(self.behind) & (oo * oo.splat(OUTSIDE)).simd_gt(rr);
        let misses = most.simd_lt(zero) | is_behind;
        let hits = least.simd_gt(zero) & low.simd_ge(self.start);
        (misses, hits, low, high)
    }
}

/// A ray, prepared for testing it against one sphere after another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Where the ray starts.
    pub origin: Vec3,
    /// The ray's direction, scaled so that its largest component is between 1 and 2.
    pub direction: Vec3,
    /// The direction's squared length.
    pub a: f32,
    /// One over `a`.
    pub inverse: f32,
    /// A parameter t of the ray is t · `unit` in parameters of the scaled direction; a power of
    /// two.
    pub unit: f32,
    /// The start of the ray's interval, in parameters of the scaled direction.
    pub start: f32,
    /// What o·d must be below for a sphere to be behind.
    pub behind: f32,
}

/// What is certain about a ray and a sphere. If neither `misses` nor `hits` is true, the rung
/// decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Every rung misses.
    pub misses: bool,
    /// Every rung finds that the ray enters the sphere after its start, between `low` and `high`,
    /// in parameters of the scaled direction.
    pub hits: bool,
    /// See `hits`.
    pub low: f32,
    /// See `hits`.
    pub high: f32,
}

impl Bounds {
    /// Whether the rung may find a hit up to `end`.
    #[inline]
    #[must_use]
    pub fn is_open(&self, end: f32) -> bool {
        !(self.misses | (self.hits & (self.low > end)))
    }
}

impl Line {
    /// Prepares a ray.
    #[inline(always)]
    #[must_use]
    pub fn of(ray: &Ray) -> Self {
        let scale = power_of_two_under(ray.direction);
        // 1 / scale: the exponents add up to twice that of one.
        let unit = f32::from_bits(0x7f00_0000_u32.wrapping_sub(scale.to_bits()));
        let direction = ray.direction * scale;
        let a = direction.dot(direction);
        Self {
            origin: ray.origin,
            direction,
            a,
            inverse: 1.0 / a,
            unit,
            start: ray.t_min * unit,
            behind: if ray.t_min >= 0.0 { 0.0 } else { f32::MIN },
        }
    }

    /// Whether any rung may find a hit, by the [discriminant](crate::cull::discriminant) and its
    /// slack. NaN counts as a possible hit.
    #[inline]
    #[must_use]
    pub fn may_hit(&self, sphere: Sphere) -> bool {
        let o = sphere.center() - self.origin;
        Target::of(Lane3::of(o), sphere.radius()).may_hit(Lane3::of(self.direction), self.a)
    }

    /// What is the same of the ray from sphere to sphere.
    #[inline(always)]
    #[must_use]
    pub fn aim(&self) -> Aim<f32> {
        Aim {
            direction: Lane3::of(self.direction),
            inverse: self.inverse,
            start: self.start,
            behind: self.behind,
        }
    }

    /// The bounds of a sphere. With NaN neither a miss nor a hit is certain.
    #[inline]
    #[must_use]
    pub fn bounds(&self, sphere: Sphere) -> Bounds {
        let o = sphere.center() - self.origin;
        let (misses, hits, low, high) = self.aim().bounds(Lane3::of(o), sphere.radius());
        Bounds {
            misses,
            hits,
            low,
            high,
        }
    }
}
