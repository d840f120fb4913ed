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

/// 64u.
pub const SLACK: f32 = 1.0 / (1 << 18) as f32;

/// The power of two that brings a vector's largest component between 1 and 2.
#[inline]
#[must_use]
pub fn power_of_two_under(vector: Vec3) -> f32 {
    let largest = vector.abs().max_element().max(f32::MIN_POSITIVE);
    f32::from_bits(0x7f00_0000_u32.wrapping_sub(largest.to_bits() & 0x7f80_0000))
}
