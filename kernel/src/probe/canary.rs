//! The canary: whether a device's compiler and arithmetic keep the operations that the upper rungs
//! depend on. Runs on the GPU and on the CPU; the host judges the results.

use bytemuck::{Pod, Zeroable};
// On the CPU, std has the square roots.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use crate::arithmetic::error_free::{split, two_diff, two_product, two_sum};
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
use crate::precision::double;

/// Two numbers for the canary to compute with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Operands {
    /// The first operand.
    pub a: f32,
    /// The second operand.
    pub b: f32,
}

/// What a device computes from two numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Outcome {
    /// a + b, rounded, and its rounding error.
    pub sum: [f32; 2],
    /// a − b, rounded, and its rounding error.
    pub difference: [f32; 2],
    /// a · b, rounded, and its rounding error.
    pub product: [f32; 2],
    /// The two halves of a, by [`split`].
    pub halves: [f32; 2],
    /// a / b.
    pub quotient: f32,
    /// √|a|.
    pub root: f32,
    /// 1 if a compares equal to itself. For NaN, 0 on a device that follows IEEE 754.
    pub equals_itself: u32,
    /// The bits of 2⁻¹⁰⁰ · a, which is subnormal if a is small; zero if the device flushes
    /// subnormal numbers.
    pub small_product: u32,
}

/// Computes everything that the host judges.
#[inline]
#[must_use]
pub fn sing(operands: Operands) -> Outcome {
    let Operands { a, b } = operands;
    let pair = |(high, low): (f32, f32)| [high, low];
    Outcome {
        sum: pair(two_sum(a, b)),
        difference: pair(two_diff(a, b)),
        product: pair(two_product(a, b)),
        halves: pair(split(a)),
        quotient: a / b,
        root: a.abs().sqrt(),
        #[expect(clippy::eq_op, reason = "only a NaN differs from itself")]
        equals_itself: u32::from(a == a),
        // 2⁻¹⁰⁰
        small_product: (a * f32::from_bits((127 - 100) << 23)).to_bits(),
    }
}

/// What a device computes from two numbers in 64-bit floats.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct WideOutcome {
    /// 2³⁰ · a + b, where 32-bit floats would lose b.
    pub sum: f64,
    /// 2⁴⁵ · a + b as its rounded value and the rounding error.
    pub large_sum: [f64; 2],
    /// The square of that sum, rounded, and its rounding error.
    pub large_square: [f64; 2],
    /// a · b, which 64 bits hold exactly.
    pub product: f64,
    /// a / b.
    pub quotient: f64,
    /// √|a|.
    pub root: f64,
}

/// Computes everything that the host judges in 64-bit floats.
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
#[inline]
#[must_use]
pub fn sing_wide(operands: Operands) -> WideOutcome {
    let (a, b) = (f64::from(operands.a), f64::from(operands.b));
    let root = a.abs().sqrt();
    // 2⁴⁵
    let (large_sum, rest) = two_sum(a * f64::from(f32::from_bits((127 + 45) << 23)), b);
    let (square, error) = two_product(large_sum, large_sum);
    WideOutcome {
        sum: a * 1_073_741_824.0 + b,
        large_sum: [large_sum, rest],
        large_square: [square, error],
        product: a * b,
        quotient: double::quotient(a, b, 1.0 / b),
        root: double::square_root(a.abs(), root, 1.0 / root),
    }
}
