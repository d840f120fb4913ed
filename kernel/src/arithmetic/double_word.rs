//! [`DoubleWord`]: a number as the unevaluated sum of two floats. Runs on the GPU and on the CPU.
//!
//! The algorithms and their bounds are those of M. Joldes, J.-M. Muller and V. Popescu, Tight and
//! rigorous error bounds for basic building blocks of double-word arithmetic, ACM Trans. Math.
//! Softw. 44 (2017), with u = 2⁻²⁴ for 32 bits and u = 2⁻⁵³ for 64: the sum is off by at most 3u² /
//! (1 − 4u), the product by 7u², the product with a float by 3u², relative to the result. Quotient
//! and square root start from the device's own result, which may be off by a few units in the last
//! place, and correct it once: their relative error is the square of the start's error plus a few
//! u².

use super::error_free::{fast_two_sum, two_diff, two_product, two_sum};
use crate::lane::Word;

/// The number `high + low`, with `high` the float nearest to it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DoubleWord<L> {
    /// The float that is nearest to the number.
    pub high: L,
    /// The number minus `high`.
    pub low: L,
}

/// Two floats of 32 bits: about 48 bits.
pub(crate) type DoubleSingle = DoubleWord<f32>;

impl<L: Word> DoubleWord<L> {
    /// The float as a pair, exactly.
    #[inline]
    #[must_use]
    pub fn from_float(value: L) -> Self {
        Self {
            high: value,
            low: value.splat(0.0),
        }
    }

    /// `a - b`, exactly.
    #[inline]
    #[must_use]
    pub fn difference(a: L, b: L) -> Self {
        let (high, low) = two_diff(a, b);
        Self { high, low }
    }

    /// `a + b`, exactly.
    #[inline]
    #[must_use]
    pub fn total(a: L, b: L) -> Self {
        let (high, low) = two_sum(a, b);
        Self { high, low }
    }

    /// `a · b`, exactly.
    #[inline]
    #[must_use]
    pub fn product(a: L, b: L) -> Self {
        let (high, low) = two_product(a, b);
        Self { high, low }
    }

    /// `self + other`: `AccurateDWPlusDW`.
    #[inline]
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        let (high, high_error) = two_sum(self.high, other.high);
        let (low, low_error) = two_sum(self.low, other.low);
        let (high, carried) = fast_two_sum(high, high_error.add_strict(low));
        let (high, low) = fast_two_sum(high, low_error.add_strict(carried));
        Self { high, low }
    }

    /// `self - other`: the sum's algorithm with differences. Nothing is negated, because a driver
    /// folds a negated operand into the next sum and then simplifies that.
    #[inline]
    #[must_use]
    pub fn minus(self, other: Self) -> Self {
        let (high, high_error) = two_diff(self.high, other.high);
        let (low, low_error) = two_diff(self.low, other.low);
        let (high, carried) = fast_two_sum(high, high_error.add_strict(low));
        let (high, low) = fast_two_sum(high, low_error.add_strict(carried));
        Self { high, low }
    }

    /// `self · other`: `DWTimesDW1`.
    #[inline]
    #[must_use]
    pub fn times(self, other: Self) -> Self {
        let (high, error) = two_product(self.high, other.high);
        let cross = self.high.mul_strict(other.low);
        let cross = cross.add_strict(self.low.mul_strict(other.high));
        let (high, low) = fast_two_sum(high, error.add_strict(cross));
        Self { high, low }
    }

    /// `self · factor`: `DWTimesFP2`.
    #[inline]
    #[must_use]
    pub fn times_float(self, factor: L) -> Self {
        let (high, error) = two_product(self.high, factor);
        let (high, low) = fast_two_sum(high, error.add_strict(self.low.mul_strict(factor)));
        Self { high, low }
    }

    /// `self / other`, by one correction of the device's quotient.
    #[inline]
    #[must_use]
    pub fn divided_by(self, other: Self) -> Self {
        let quotient = self.high / other.high;
        let remainder = self.minus(other.times_float(quotient));
        let (high, low) = fast_two_sum(quotient, remainder.high / other.high);
        Self { high, low }
    }

    /// The square root of a number that is not negative, by one correction of the device's root.
    #[inline]
    #[must_use]
    pub fn square_root(self) -> Self {
        let zero = self.high.splat(0.0);
        if self.high.simd_gt(zero) {
            let root = self.high.sqrt();
            let remainder = self.minus(Self::product(root, root));
            let (high, low) = fast_two_sum(root, remainder.high / root.add_strict(root));
            Self { high, low }
        } else {
            Self {
                high: zero,
                low: zero,
            }
        }
    }
}
