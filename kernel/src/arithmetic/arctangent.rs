//! [`arctangent`]: the angle of a vector in the upper half of the plane, in 32-bit floats. Runs on
//! the GPU and on the CPU.
//!
//! Vulkan lets the arctangent of a device be off by 4096 units in the last place. This one is off
//! by less than four on every device: the angle is brought to within 22.5° of 0, 45° or 90°, and
//! there it is the polynomial of S. L. Moshier's Cephes library (`atanf`, 1989).

use core::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// The tangent of 67.5°.
const STEEP: f32 = 2.414_213_6;

/// The angle between the x axis and the vector (`x`, `y`), between 0 and π. `y` is not negative,
/// and not both are zero.
#[inline]
#[must_use]
pub fn arctangent(y: f32, x: f32) -> f32 {
    let along = x.abs();
    let (tangent, base) = if y * STEEP < along {
        (y / along, 0.0)
    } else if y < along * STEEP {
        ((y - along) / (y + along), FRAC_PI_4)
    } else {
        (-along / y, FRAC_PI_2)
    };
    let square = tangent * tangent;
    let series =
        ((8.053_745e-2 * square - 0.138_776_85) * square + 0.199_777_1) * square - 0.333_329_5;
    let angle = base + (tangent + tangent * (square * series));
    if x < 0.0 { PI - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_off_by_less_than_four_units() {
        // Miri is a thousand times slower.
        const STEPS: u32 = if cfg!(miri) { 50 } else { 200_000 };
        let mut largest = 0.0_f64;
        for step in 0..=STEPS {
            let t = f64::from(step) / f64::from(STEPS);
            for (y, x) in [(t, 1.0), (1.0, t), (1.0, -t), (t, -1.0), (1e-6 * t, 1.0)] {
                let (y, x) = (y as f32, x as f32);
                let exact = f64::from(y).atan2(f64::from(x));
                let found = f64::from(arctangent(y, x));
                let unit = f64::from(f32::EPSILON) * exact.max(f64::from(f32::MIN_POSITIVE));
                largest = largest.max((found - exact).abs() / unit);
            }
        }
        assert!(largest < 4.0, "{largest}");
    }
}
