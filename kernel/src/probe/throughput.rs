//! The most multiplications in registers that a device does a second. Runs on the GPU; the host has
//! its own version for the CPU, with vectors as wide as the machine's.

use glam::Vec4;

/// The number of multiplications in one round of [`wide_products`].
pub const WIDE_MULTIPLICATIONS: u32 = 32;

/// The number of multiplications in one round of [`products`].
pub const MULTIPLICATIONS: u32 = 128;

/// The sum of sixteen products of `rounds` times eight factors each. No product waits for another.
#[inline]
#[must_use]
pub fn products(first: f32, factor: f32, rounds: u32) -> f32 {
    let factor = Vec4::splat(factor);
    let mut a = Vec4::splat(first);
    let (mut b, mut c, mut d) = (a + 1.0, a + 2.0, a + 3.0);
    let mut left = rounds;
    while left > 0 {
        left -= 1;
        a = a * factor * factor * factor * factor * factor * factor * factor * factor;
        b = b * factor * factor * factor * factor * factor * factor * factor * factor;
        c = c * factor * factor * factor * factor * factor * factor * factor * factor;
        d = d * factor * factor * factor * factor * factor * factor * factor * factor;
    }
    (a + b + c + d).element_sum()
}

/// As [`products`], of four products in 64-bit floats.
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
#[inline]
#[must_use]
pub fn wide_products(first: f32, factor: f32, rounds: u32) -> f32 {
    let factor = f64::from(factor);
    let mut a = f64::from(first);
    let (mut b, mut c, mut d) = (a + 1.0, a + 2.0, a + 3.0);
    let mut left = rounds;
    while left > 0 {
        left -= 1;
        a = a * factor * factor * factor * factor * factor * factor * factor * factor;
        b = b * factor * factor * factor * factor * factor * factor * factor * factor;
        c = c * factor * factor * factor * factor * factor * factor * factor * factor;
        d = d * factor * factor * factor * factor * factor * factor * factor * factor;
    }
    (a + b + c + d) as f32
}
