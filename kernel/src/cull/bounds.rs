//! [`Bounds`]: what few operations tell of a ray and a sphere, for all rungs from
//! [`Rung::Robust`](crate::Rung::Robust) up: that they miss, or that they hit, and about where. Runs on the GPU and on
//! the CPU.
//!
//! A walk through a tree keeps the sphere that is nearest by its bounds, and asks the rung once, at its end,
//! or where bounds leave it open.
//!
//! # The bounds
//!
//! With u = 2⁻²⁴, o = C − O, d the direction scaled by a power of two so that 1 ≤ |d| < 2√3, a = d·d, the
//! middle m = o·d / a, the foot of the perpendicular f = o − m d, and q = r² − f·f. In floats, fused or not,
//! quotients off by 2.5 units and roots by 4: m is off by 14u|o|/|d|, f by 17u|o| and q by
//!
//! > E = 34u|f||o| + 289u² o·o + 3u f·f + 3u r² ≤ 2⁻⁹ f·f + 2⁻²⁹ o·o + 3u r²,
//!
//! as 2xy ≤ kx² + y²/k, k = 2¹⁰. No rung from robust up, whose formula is this one or a better, is farther off. So
//! with the doubt e = 2⁻⁶ r² + 2⁻²⁸ o·o all of them have q < 0 where q < −e here, and q > 0 where q > e: E is at most e/2
//! then, f·f being r² − q.
//!
//! Where q > e, |f| ≤ r, √q ≥ r/8 and √q ≥ 2⁻¹⁴|o|, so that √q is off by E/√q ≤ 273u|o| + 48u r here and there together.
//! With what m, the root and the sum are off by, and robust's own 16u max(|o|, r) and 8u|o| for its c and b,
//! where the ray enters, at m − √(q/a), is the same to within 512u(|o| + r)/|d| for all of them, and |o| ≤ m|d| + r.
//!
//! A sphere is behind its ray, too, where o·d < 0 and c = o·o − r² > 32u (o·o + r²): the foot's error is 7u|o| only
//! where o·d is of the size of its own error, so that any hit would need (8u)² o·o ≥ c.

use glam::Vec3;

use crate::cull::discriminant::{Target, power_of_two_under};
use crate::lane::{Lane, Lane3};
use crate::ray::Ray;
use crate::sphere::Sphere;

/// What is added to and taken from m − √(q/a), in parts of m: 512u.
pub const OFF: f32 = 1.0 / (1 << 15) as f32;
/// The same, in parts of r: 1024u.
pub const OFF_BY_RADIUS: f32 = 1.0 / (1 << 14) as f32;
/// An origin is outside for certain where o·o, times this, is more than r²: 1 − 64u.
pub const OUTSIDE: f32 = 1.0 - 1.0 / (1 << 18) as f32;

/// The doubt e about q, of o·o and r²; and what squares must be above for their errors to be relative.
#[inline(always)]
#[must_use]
pub fn doubt<L: Lane>(oo: L, rr: L) -> L {
    let of = |value: f32| oo.splat(value);
    oo * of(1.0 / (1 << 28) as f32) + (rr * of(1.0 / (1 << 6) as f32) + of(1e-30))
}

/// What is the same of a ray from sphere to sphere.
#[derive(Clone, Copy, Debug)]
pub struct Aim<L> {
    /// The direction, whose largest component is between 1 and 2.
    pub direction: Lane3<L>,
    /// One over its squared length.
    pub inverse: L,
    /// The start of the ray's interval, as the direction counts it.
    pub start: L,
    /// What o·d must be below for a sphere to be behind.
    pub behind: L,
}

impl<L: Lane> Aim<L> {
    /// Whether a sphere is behind its ray for certain, or begins beyond `end`, as the direction counts it: no point of a sphere is nearer than
    /// o·d/a − r/|d|, |d| is at least one, and what the middle is off by is less than what bounds allow for.
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

    /// What is certain of a sphere, of o from the ray's origin to its centre, and of its radius: misses, hits, low and high, as
    /// [`Bounds`] has them. NaN makes nothing certain.
    #[inline(always)]
    #[must_use]
    pub fn bounds(&self, o: Lane3<L>, radius: L) -> (L::Mask, L::Mask, L, L) {
        let r = radius.abs();
        let (oo, rr) = (o.dot(o), r * r);
        let b = o.dot(self.direction);
        let middle = b * self.inverse;
        let foot = o.minus_scaled(self.direction, middle);
        let q = rr - foot.dot(foot);
        let doubt = doubt(oo, rr);
        let enters = middle - (q * self.inverse).sqrt();
        let off = middle.abs() * oo.splat(OFF) + r * oo.splat(OFF_BY_RADIUS);
        let (low, high) = (enters - off, enters + off);
        let is_behind = b.simd_lt(self.behind) & (oo * oo.splat(OUTSIDE)).simd_gt(rr);
        let misses = q.simd_lt(-doubt) | is_behind;
        let hits = q.simd_gt(doubt) & low.simd_ge(self.start);
        (misses, hits, low, high)
    }
}

/// A ray, for one sphere after the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Where the ray starts.
    pub origin: Vec3,
    /// Its direction, whose largest component was brought between 1 and 2.
    pub direction: Vec3,
    /// The direction's squared length.
    pub a: f32,
    /// One over it.
    pub inverse: f32,
    /// What a parameter of the ray is, times this, as this direction counts it: a power of two.
    pub unit: f32,
    /// The start of the ray's interval, as this direction counts it.
    pub start: f32,
    /// What o·d must be below for a sphere to be behind.
    pub behind: f32,
}

/// What is certain of a sphere. Neither, if the rung is to be asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Every rung misses.
    pub misses: bool,
    /// Every rung finds that the ray enters the sphere after its start, between `low` and `high`, as the line's
    /// direction counts it.
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
    /// Of a ray.
    #[inline(always)]
    #[must_use]
    pub fn of(ray: &Ray) -> Self {
        let scale = power_of_two_under(ray.direction);
        // One over it: exponents that add up to those of one.
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

    /// Whether any rung may find a hit, by the discriminant of [`candidates`](crate::cull::discriminant) and its slack. Where a
    /// number is none, it is to be asked.
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

    /// What is certain of a sphere. Numbers that are none make nothing certain.
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
