//! Arithmetic that keeps more digits than one float holds. Runs on the GPU and on the CPU.
//!
//! | module | holds |
//! | --- | --- |
//! | [`arctangent`] | angles, to a few units in the last place on every device |
//! | [`strict`] | sum, difference and product that no compiler rearranges |
//! | [`error_free`] | the exact error of a sum, a difference, a product |
//! | [`distill`] | the accurate sum of many floats, whatever cancels |
//! | [`double_word`] | numbers as sums of two floats |
//! | [`turn`] | cosine and sine of shares of a turn |
//! | [`elements`] | elements of arrays and slices, read and written without a panic |

pub mod arctangent;
pub mod distill;
pub mod double_word;
pub mod elements;
pub mod error_free;
pub mod strict;
pub mod turn;

pub(crate) use double_word::DoubleSingle;
pub use double_word::DoubleWord;

/// The unit roundoff of `f32`, 2⁻²⁴: the largest relative error of one operation.
pub const U: f32 = 1.0 / (1 << 24) as f32;
