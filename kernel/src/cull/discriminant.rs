//! A test of few operations that tells which spheres a rung must be asked about. Runs on the GPU and on
//! the CPU.
//!
//! For a ray of origin O let o = C − O and c = o·o − r². With d of unit length and b = o·d the line misses
//! where b² < c. In 32-bit floats, u = 2⁻²⁴, d is of unit length to within 4u and off its way by 2u, so that b is off by
//! 6u|o| and b² by 13u o·o, and c counts for 8u too much or too little; c is off by 6u (o·o + r²), and the
//! difference by u more: together 28u (o·o + r²). What a rung calls a hit the exact numbers may miss by:
//! textbook by 24u (o·o + r²), the others by less, as their modules say. c is therefore taken less by 64u (o·o + r²),
//! and no rung's hit is passed by.

use glam::Vec3;

use crate::lane::{Lane, Lane3};

/// What a discriminant may lose where its terms are no normal numbers.
pub const SMALLEST: f32 = -1e-36;

/// 64u.
pub const SLACK: f32 = 1.0 / (1 << 18) as f32;

/// The power of two that brings a vector's largest component between 1 and 2.
#[inline]
#[must_use]
pub fn power_of_two_under(vector: Vec3) -> f32 {
    let largest = vector.abs().max_element().max(f32::MIN_POSITIVE);
    f32::from_bits(0x7f00_0000_u32.wrapping_sub(largest.to_bits() & 0x7f80_0000))
}

/// A sphere that lines from one origin may hit.
#[derive(Clone, Copy, Debug)]
pub struct Target<L> {
    /// From the origin to the sphere's centre.
    pub o: Lane3<L>,
    /// o·o − r², less what the discriminant may be off by.
    pub c: L,
    /// o·o
    pub oo: L,
    /// r²
    pub rr: L,
}

impl<L: Lane> Target<L> {
    /// Of o from the origin to the sphere's centre, and of its radius.
    #[inline(always)]
    #[must_use]
    pub fn of(o: Lane3<L>, radius: L) -> Self {
        let (oo, rr) = (o.dot_rough(o), radius * radius);
        Self {
            o,
            c: (oo + rr).mul_add_rough(oo.splat(-SLACK), oo - rr),
            oo,
            rr,
        }
    }

    /// Whether any rung may find that the line along `d`, whose square is `a`, meets the sphere; true for NaN.
    #[inline(always)]
    #[must_use]
    pub fn may_hit(&self, d: Lane3<L>, a: L) -> L::Mask {
        let b = self.o.dot_rough(d);
        !b.mul_sub_rough(b, a * self.c).simd_lt(a.splat(SMALLEST))
    }
}
