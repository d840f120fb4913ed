//! The accurate sum of many floats, whatever cancels. Runs on the GPU and on the CPU.
//!
//! T. Ogita, S. M. Rump and S. Oishi, Accurate sum and dot product, SIAM J. Sci. Comput. 26 (2005):
//! a pass of two-sums from the first term to the last leaves the rounded sum in the last term and
//! the rounding errors in the others, and loses nothing. K − 1 passes and an ordinary sum give a
//! result as if in K-fold precision: it is off by about (n u)^K of the sum of the terms'
//! magnitudes, and relative to the result by u at best.

use super::DoubleSingle;
use super::elements::{get, set};
use super::error_free::two_sum;
use super::strict::add;

/// The number of passes. With 240 terms, the largest number in use, and u = 2⁻²⁴, the error is
/// below 2⁻¹¹⁰ of the sum of the terms' magnitudes.
const PASSES: u32 = 7;

/// The sum of `terms`, which are overwritten.
#[inline]
#[must_use]
pub fn distill<const N: usize>(terms: &mut [f32; N]) -> DoubleSingle {
    let mut pass = 0;
    while pass < PASSES {
        let mut index = 1;
        while index < N {
            let (sum, error) = two_sum(get(terms, index), get(terms, index - 1));
            set(terms, index, sum);
            set(terms, index - 1, error);
            index += 1;
        }
        pass += 1;
    }
    let mut rest = 0.0;
    let mut index = 0;
    while index < N - 1 {
        rest = add(rest, get(terms, index));
        index += 1;
    }
    let (high, low) = two_sum(get(terms, N - 1), rest);
    DoubleSingle { high, low }
}
