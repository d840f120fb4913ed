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

use crate::lane::{Lane, Word};

/// `a + b` as its rounded value and the rounding error; exact for any two floats.
#[inline(always)]
#[must_use]
pub fn two_sum<L: Lane>(a: L, b: L) -> (L, L) {
    let sum = a.add_strict(b);
    let b_in_sum = sum.sub_strict(a);
    let a_in_sum = sum.sub_strict(b_in_sum);
    (
        sum,
        a.sub_strict(a_in_sum).add_strict(b.sub_strict(b_in_sum)),
    )
}

/// `a - b` as its rounded value and the rounding error; exact for any two floats.
#[inline(always)]
#[must_use]
pub fn two_diff<L: Lane>(a: L, b: L) -> (L, L) {
    let difference = a.sub_strict(b);
    let b_in_difference = a.sub_strict(difference);
    let a_in_difference = difference.add_strict(b_in_difference);
    (
        difference,
        a.sub_strict(a_in_difference)
            .add_strict(b_in_difference.sub_strict(b)),
    )
}

/// As [`two_sum`], for |a| ≥ |b| or a = 0, with half the operations.
#[inline(always)]
#[must_use]
pub fn fast_two_sum<L: Lane>(a: L, b: L) -> (L, L) {
    let sum = a.add_strict(b);
    (sum, b.sub_strict(sum.sub_strict(a)))
}

/// Splits the float into two halves of 12 bits each, or of 26, whose products with other halves are
/// exact. Overflows above 2¹¹⁵, or 2⁹⁹⁶.
#[inline(always)]
#[must_use]
pub fn split<L: Word>(a: L) -> (L, L) {
    let scaled = a.mul_strict(L::SPLITTER);
    let high = scaled.sub_strict(scaled.sub_strict(a));
    (high, a.sub_strict(high))
}

/// `a · b` as its rounded value and the rounding error. It is exact if the error is normal or zero,
/// which |a·b| ≥ 2⁻⁷⁹ ensures for 32 bits (on devices that keep subnormal numbers, |a·b| ≥ 2⁻¹⁰²),
/// and |a·b| ≥ 2⁻⁹¹⁷ for 64.
#[inline(always)]
#[must_use]
pub fn two_product<L: Word>(a: L, b: L) -> (L, L) {
    let product = a.mul_strict(b);
    let (a_high, a_low) = split(a);
    let (b_high, b_low) = split(b);
    let error = a_high.mul_strict(b_high).sub_strict(product);
    let error = error.add_strict(a_high.mul_strict(b_low));
    let error = error.add_strict(a_low.mul_strict(b_high));
    (product, error.add_strict(a_low.mul_strict(b_low)))
}
