//! Brute force at the machine's rate: a test of few operations that tells which spheres a rung must
//! be asked about. Runs on the GPU and on the CPU.
//!
//! Rays of one origin O share o = C − O and c = o·o − r². With d of unit length and b = o·d the line misses
//! where b² < c. In 32-bit floats, u = 2⁻²⁴, d is of unit length to within 4u and off its way by 2u, so that b is off by
//! 6u|o| and b² by 13u o·o, and c counts for 8u too much or too little; c is off by 6u (o·o + r²), and the
//! difference by u more: together 28u (o·o + r²). What a rung calls a hit the exact numbers may miss by:
//! textbook by 24u (o·o + r²), the others by less, as their modules say. c is therefore taken less by 64u (o·o + r²),
//! and no rung's hit is passed by.

use glam::{UVec4, Vec3, Vec4};

use crate::sphere::Sphere;
use crate::surface::unit;

/// 64u.
pub const SLACK: f32 = 1.0 / (1 << 18) as f32;

/// What rays of one origin share of a sphere: o and c, lessened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shared(Vec4);

impl Shared {
    /// Of a sphere, for rays from `origin`.
    #[inline]
    #[must_use]
    pub fn of(sphere: Sphere, origin: Vec3) -> Self {
        let o = sphere.center() - origin;
        let (oo, rr) = (o.dot(o), sphere.radius() * sphere.radius());
        Self(o.extend((oo - rr) - SLACK * (oo + rr)))
    }

    /// As one load.
    #[inline]
    #[must_use]
    pub fn to_vec4(self) -> Vec4 {
        self.0
    }

    /// Out of one load.
    #[inline]
    #[must_use]
    pub fn from_vec4(vector: Vec4) -> Self {
        Self(vector)
    }

    /// Of no sphere: every line misses.
    #[inline]
    #[must_use]
    pub fn none() -> Self {
        Self(Vec4::new(0.0, 0.0, 0.0, 1.0))
    }

    /// Negative where a line along `unit`, of unit length, misses.
    #[inline]
    #[must_use]
    pub fn discriminant(self, unit: Vec3) -> f32 {
        let b = self.0.truncate().dot(unit);
        b * b - self.0.w
    }
}

/// A direction at unit length, whatever its length; zero for a zero vector.
#[inline]
#[must_use]
pub fn unit_of(direction: Vec3) -> Vec3 {
    unit(direction * power_of_two_under(direction))
}

/// The power of two that brings a vector's largest component between 1 and 2.
#[inline]
#[must_use]
pub fn power_of_two_under(vector: Vec3) -> f32 {
    let largest = vector.abs().max_element().max(f32::MIN_POSITIVE);
    f32::from_bits(0x7f00_0000 - (largest.to_bits() & 0x7f80_0000))
}

/// Whether all of four discriminants are negative: their sign bits, in the sign bit.
#[inline]
#[must_use]
pub fn all_miss(bits: UVec4) -> u32 {
    bits.x & bits.y & bits.z & bits.w
}

/// Which of four spheres are candidates, by the bits of their discriminants: a bit each.
#[inline]
#[must_use]
pub fn candidates(bits: UVec4) -> u32 {
    (!bits.x >> 31) | (!bits.y >> 31) << 1 | (!bits.z >> 31) << 2 | (!bits.w >> 31) << 3
}

/// The bits of four spheres' discriminants.
#[inline]
#[must_use]
pub fn discriminants(unit: Vec3, s0: Shared, s1: Shared, s2: Shared, s3: Shared) -> UVec4 {
    UVec4::new(
        s0.discriminant(unit).to_bits(),
        s1.discriminant(unit).to_bits(),
        s2.discriminant(unit).to_bits(),
        s3.discriminant(unit).to_bits(),
    )
}
