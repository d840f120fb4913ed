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

// On the CPU, std has `f32::sqrt`.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use glam::Vec3;

use crate::candidates::{SLACK, power_of_two_under};
use crate::ray::Ray;
use crate::sphere::Sphere;

/// What is added to and taken from m − √(q/a), in parts of m: 512u.
pub const OFF: f32 = 1.0 / (1 << 15) as f32;
/// The same, in parts of r: 1024u.
pub const OFF_BY_RADIUS: f32 = 1.0 / (1 << 14) as f32;
/// An origin is outside for certain where o·o, times this, is more than r²: 1 − 64u.
pub const OUTSIDE: f32 = 1.0 - 1.0 / (1 << 18) as f32;

/// The doubt e about q, of o·o and r²; and what squares must be above for their errors to be relative.
#[inline]
#[must_use]
pub fn doubt(oo: f32, rr: f32) -> f32 {
    oo * (1.0 / (1 << 28) as f32) + (rr * (1.0 / (1 << 6) as f32) + 1e-30)
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
    /// What a discriminant may lose where its terms are no normal numbers.
    pub const SMALLEST: f32 = -1e-36;

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

    /// Whether any rung may find a hit, by the discriminant of [`candidates`](crate::candidates) and its slack. Where a
    /// number is none, it is to be asked.
    #[expect(
        clippy::neg_cmp_op_on_partial_ord,
        reason = "a number that is none is not smaller"
    )]
    #[inline]
    #[must_use]
    pub fn may_hit(&self, sphere: Sphere) -> bool {
        let o = sphere.center() - self.origin;
        let (oo, rr) = (o.dot(o), sphere.radius() * sphere.radius());
        let b = o.dot(self.direction);
        let c = (oo - rr) - SLACK * (oo + rr);
        !(b * b - self.a * c < Self::SMALLEST)
    }

    /// What is certain of a sphere. Numbers that are none make nothing certain.
    #[inline]
    #[must_use]
    pub fn bounds(&self, sphere: Sphere) -> Bounds {
        let o = sphere.center() - self.origin;
        let r = sphere.radius().abs();
        let (oo, rr) = (o.dot(o), r * r);
        let b = o.dot(self.direction);
        let middle = b * self.inverse;
        let foot = o - self.direction * middle;
        let q = rr - foot.dot(foot);
        let doubt = doubt(oo, rr);
        let enters = middle - (q * self.inverse).sqrt();
        let off = middle.abs() * OFF + r * OFF_BY_RADIUS;
        let (low, high) = (enters - off, enters + off);
        Bounds {
            misses: (q < -doubt) | ((b < self.behind) & (oo * OUTSIDE > rr)),
            hits: (q > doubt) & (low >= self.start),
            low,
            high,
        }
    }
}
