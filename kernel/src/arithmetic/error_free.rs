//! Error-free transformations: the result of a float operation together with its exact rounding
//! error. Runs on the GPU and on the CPU.
//!
//! D. E. Knuth, The Art of Computer Programming, vol. 2, 4.2.2 (the sum); T. J. Dekker, A
//! floating-point technique for extending the available precision, Numer. Math. 18 (1971) 224
//! (the ordered sum, the split and the product). The names follow J. R. Shewchuk, Adaptive
//! precision floating-point arithmetic, Discrete Comput. Geom. 18 (1997) 305.
//!
//! Each is exact unless a term overflows or its error is subnormal. The product does not use a
//! fused multiply-add, because Vulkan does not promise that it is fused.

use super::strict::{add, mul, sub};

/// `a + b` as its rounded value and the rounding error; exact for any two floats.
#[inline]
#[must_use]
pub fn two_sum(a: f32, b: f32) -> (f32, f32) {
    let sum = add(a, b);
    let b_in_sum = sub(sum, a);
    let a_in_sum = sub(sum, b_in_sum);
    (sum, add(sub(a, a_in_sum), sub(b, b_in_sum)))
}

/// `a - b` as its rounded value and the rounding error; exact for any two floats.
#[inline]
#[must_use]
pub fn two_diff(a: f32, b: f32) -> (f32, f32) {
    let difference = sub(a, b);
    let b_in_difference = sub(a, difference);
    let a_in_difference = add(difference, b_in_difference);
    (
        difference,
        add(sub(a, a_in_difference), sub(b_in_difference, b)),
    )
}

/// As [`two_sum`], for |a| ≥ |b| or a = 0, with half the operations.
#[inline]
#[must_use]
pub fn fast_two_sum(a: f32, b: f32) -> (f32, f32) {
    let sum = add(a, b);
    (sum, sub(b, sub(sum, a)))
}

/// Splits the float into two halves of 12 bits each, whose products with other halves are exact.
/// Overflows above 2¹¹⁵.
#[inline]
#[must_use]
pub fn split(a: f32) -> (f32, f32) {
    // 2¹² + 1
    let scaled = mul(a, 4097.0);
    let high = sub(scaled, sub(scaled, a));
    (high, sub(a, high))
}

/// `a · b` as its rounded value and the rounding error. It is exact if the error is normal or zero,
/// which |a·b| ≥ 2⁻⁷⁹ ensures (on devices that keep subnormal numbers, |a·b| ≥ 2⁻¹⁰²).
#[inline]
#[must_use]
pub fn two_product(a: f32, b: f32) -> (f32, f32) {
    let product = mul(a, b);
    let (a_high, a_low) = split(a);
    let (b_high, b_low) = split(b);
    let error = sub(mul(a_high, b_high), product);
    let error = add(error, mul(a_high, b_low));
    let error = add(error, mul(a_low, b_high));
    (product, add(error, mul(a_low, b_low)))
}
