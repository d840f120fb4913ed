//! [`turn`]: cosine and sine of an angle that is given as a share of a whole turn. Runs on the GPU
//! and on the CPU.
//!
//! A GPU has instructions for both. On the CPU they are polynomials without a branch, so that
//! several angles are computed side by side; each is off by less than 2⁻²³.

use core::f32::consts::TAU;

use glam::Vec2;
// On the CPU, std has these functions.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// The point of the unit circle after so much of a whole turn from the x axis to the y axis, from 0
/// to 1.
#[cfg(target_arch = "spirv")]
#[inline]
#[must_use]
pub fn turn(share: f32) -> Vec2 {
    let angle = TAU * share;
    Vec2::new(angle.cos(), angle.sin())
}

/// The point of the unit circle after so much of a whole turn from the x axis to the y axis.
/// Shares of more than 2²⁰ turns give any point of the circle.
///
/// The angle is brought to within 45° of a quarter turn, which is exact; there sine and cosine are
/// the polynomials of S. L. Moshier's Cephes library (`sinf` and `cosf`, 1989).
#[cfg(not(target_arch = "spirv"))]
#[inline]
#[must_use]
pub fn turn(share: f32) -> Vec2 {
    // The sum is rounded to a whole number, whose last bits are the mantissa's.
    const WHOLE: f32 = 12_582_912.0;
    let sum = 4.0 * share + WHOLE;
    let quarters = sum.to_bits();
    let angle = (share - 0.25 * (sum - WHOLE)) * TAU;
    let square = angle * angle;
    let of_sine = (-1.951_529_6e-4 * square + 8.332_161e-3) * square - 0.166_666_55;
    let sine = angle + angle * (square * of_sine);
    let of_cosine = (2.443_315_7e-5 * square - 1.388_731_6e-3) * square + 4.166_664_6e-2;
    let cosine = 1.0 - 0.5 * square + square * square * of_cosine;
    let is_odd = quarters & 1 == 1;
    let (x, y) = if is_odd {
        (sine, cosine)
    } else {
        (cosine, sine)
    };
    // The sign bits: x is negative in the second and third quadrant, y in the third and fourth.
    let (of_x, of_y) = (quarters.wrapping_add(1) << 30, quarters << 30);
    let signed = |value: f32, sign: u32| f32::from_bits(value.to_bits() ^ sign & 1 << 31);
    Vec2::new(signed(x, of_x), signed(y, of_y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_on_the_circle_and_where_they_should_be() {
        // Miri is a thousand times slower.
        const STEPS: u32 = if cfg!(miri) { 100 } else { 1 << 20 };
        for step in 0..=STEPS {
            let share = step as f32 / STEPS as f32;
            let (sine, cosine) = (f64::from(share) * core::f64::consts::TAU).sin_cos();
            let found = turn(share);
            for (found, exact) in [(found.x, cosine), (found.y, sine)] {
                let off = (f64::from(found) - exact).abs();
                assert!(off < 0.5_f64.powi(23), "{share}: off by {off:e}");
            }
        }
    }

    /// The quarters are exact.
    #[test]
    fn quarters_of_a_turn_are_the_axes() {
        let quarters = [Vec2::X, Vec2::Y, Vec2::NEG_X, Vec2::NEG_Y, Vec2::X];
        for (quarter, expected) in quarters.into_iter().enumerate() {
            assert_eq!(turn(quarter as f32 / 4.0), expected);
        }
    }

    #[test]
    fn odd_shares_give_numbers() {
        for share in [-0.3, -7.0, 1e6, 3e9, f32::MAX] {
            let length = turn(share).length();
            assert!((length - 1.0).abs() < 1e-5 || share.abs() > 1e6, "{share}");
        }
    }
}
