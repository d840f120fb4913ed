//! The discriminant in few operations, which tells for which spheres a rung must be evaluated. Runs
//! on the GPU and on the CPU.
//!
//! For a ray of origin O let o = C − O and c = o·o − r². With d of unit length and b = o·d, the
//! line misses where b² < c. In 32-bit floats, with u = 2⁻²⁴:
//!
//! - d is of unit length to within 4u, and its direction is off by 2u. So b is off by 6u|o|, b² by
//!   13u o·o, and c counts for 8u too much or too little.
//! - c is off by 6u (o·o + r²), and the difference by u more. Together that is 28u (o·o + r²).
//! - A rung may find a hit that exact arithmetic misses: textbook by 24u (o·o + r²), the others by
//!   less, as their modules say.
//!
//! So 64u (o·o + r²) is subtracted from c, and no rung's hit is lost.

use glam::Vec3;

use crate::lane::{Lane, Lane3};

/// What a discriminant may lose where its terms are subnormal.
pub const SMALLEST: f32 = -1e-36;

/// 64u.
pub const SLACK: f32 = 1.0 / (1 << 18) as f32;

/// The power of two that scales a vector's largest component to between 1 and 2.
#[inline]
#[must_use]
pub fn power_of_two_under(vector: Vec3) -> f32 {
    let largest = vector.abs().max_element().max(f32::MIN_POSITIVE);
    f32::from_bits(0x7f00_0000_u32.wrapping_sub(largest.to_bits() & 0x7f80_0000))
}

/// A sphere, prepared for testing lines from one origin against it.
#[derive(Clone, Copy, Debug)]
pub struct Target<L> {
    /// From the origin to the sphere's centre.
    pub o: Lane3<L>,
    /// o·o − r², minus the slack: what the discriminant may be off by.
    pub c: L,
    /// o·o
    pub oo: L,
    /// r²
    pub rr: L,
}

impl<L: Lane> Target<L> {
    /// Prepares a sphere from o, the vector from the origin to its centre, and its radius.
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

    /// Whether any rung may find that the line along `d` meets the sphere; `a` is d·d. NaN counts
    /// as a possible hit.
    #[inline(always)]
    #[must_use]
    pub fn may_hit(&self, d: Lane3<L>, a: L) -> L::Mask {
        let b = self.o.dot_rough(d);
        !b.mul_sub_rough(b, a * self.c).simd_lt(a.splat(SMALLEST))
    }
}
