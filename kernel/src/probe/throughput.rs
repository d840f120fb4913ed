//! What a machine does at most: multiplications in registers, and numbers through memory. Runs on the GPU; on the CPU
//! vectors are as wide as the machine's, which is the host's business.

use glam::Vec4;

/// Multiplications in one round of [`products`].
pub const MULTIPLICATIONS: u32 = 128;

/// Sixteen products of which none waits for another, of `rounds` times eight factors each.
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
