//! The step of [`Certified`](super::Certified) that rounds roots which 64-bit floats leave between
//! two 32-bit floats, in pairs of 64-bit floats. Runs on the CPU, and on GPUs whose module declares
//! 64-bit floats.
//!
//! Let m be the midpoint between the two floats. Whether the root is above or below m follows from
//! p(m) = (o + md)·(o + md) − r², and from the side of the line's middle on which m is, the sign of
//! (o + md)·d. With u = 2⁻⁵³:
//!
//! - o = O − C is exact as a pair, and so is md, whose factors have 25 and 24 bits, as one float.
//! - s = o + md is off by 3u² of itself in each component, its square by 13u², s·s by 20u², and
//!   p(m), of which r² is exact, by 20u² s·s + 3u² |p|. Its sign is certain where |p| > 2⁻¹⁰⁰
//!   s·s.
//! - s·d is off by 13u² of the sum of its products' magnitudes, which is at most |s||d|. Its sign
//!   is certain where (s·d)² > 2⁻²⁰⁰ (s·s)(d·d).
//!
//! No product overflows, and none that counts has a subnormal error.

use super::wide::{Bounded, WideRay};
use crate::arithmetic::DoubleWord;
use crate::hit::Hit;
use crate::lane::Lane3;
use crate::precision::compensated::two_to_minus;

/// A parameter, and whether it is right.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rounded {
    /// The float that is nearest to the exact number.
    pub(super) t: f32,
    /// Whether that is certain.
    pub(super) is_certain: bool,
}

impl WideRay<f64> {
    /// The parameter of the hit or [`Hit::NONE_T`], where the line certainly meets the sphere.
    #[inline]
    #[must_use]
    pub(super) fn round(&self, center: Lane3<f64>, radius: f64, roots: &Bounded<f64>) -> Rounded {
        let (mut root, mut error) = (roots.near, roots.near_error);
        let mut found = Rounded {
            t: Hit::NONE_T,
            is_certain: roots.meets,
        };
        // One copy of the code for both roots.
        let mut index = 0;
        while (index < 2) & found.is_certain {
            let rounded = self.rounded(center, radius, root, error, index == 0);
            found.is_certain = rounded.is_certain;
            let t = f64::from(rounded.t);
            if t >= self.t_min {
                if t < self.t_max {
                    found.t = rounded.t;
                }
                index = 2;
            }
            (root, error) = (roots.far, roots.far_error);
            index += 1;
        }
        found
    }

    /// The float that is nearest to a root.
    #[inline]
    fn rounded(
        &self,
        center: Lane3<f64>,
        radius: f64,
        root: f64,
        error: f64,
        is_near: bool,
    ) -> Rounded {
        let (low, high) = ((root - error) as f32, (root + error) as f32);
        if low == high {
            return Rounded {
                t: low,
                is_certain: true,
            };
        }
        let midpoint = 0.5 * (f64::from(low) + f64::from(high));
        let (outside, ahead) = self.side(center, radius, midpoint);
        // Before the line's middle the smaller root is where the line comes from outside to inside.
        let is_above = if is_near {
            (ahead < 0.0) & (outside > 0.0)
        } else {
            (ahead < 0.0) | (outside < 0.0)
        };
        let are_next = high.to_bits().wrapping_sub(low.to_bits()).wrapping_add(1) <= 2;
        Rounded {
            t: if is_above { high } else { low },
            is_certain: are_next & (outside != 0.0) & (ahead != 0.0),
        }
    }

    /// The signs of the distance to the sphere's surface, positive outside, and of the parameter
    /// minus that of the line's middle; zero for one that is not certain.
    #[inline]
    fn side(&self, center: Lane3<f64>, radius: f64, t: f64) -> (f64, f64) {
        let (origin, d) = (self.origin, self.direction);
        let x = DoubleWord::difference(origin.x, center.x).plus(DoubleWord::from_float(t * d.x));
        let y = DoubleWord::difference(origin.y, center.y).plus(DoubleWord::from_float(t * d.y));
        let z = DoubleWord::difference(origin.z, center.z).plus(DoubleWord::from_float(t * d.z));
        let squares = x.times(x).plus(y.times(y)).plus(z.times(z));
        let outside = squares.minus(DoubleWord::from_float(radius * radius)).high;
        let ahead = x
            .times_float(d.x)
            .plus(y.times_float(d.y))
            .plus(z.times_float(d.z))
            .high;
        let (bound, squared) = (f64::from(two_to_minus(100)), squares.high * d.dot(d));
        (
            if outside.abs() > bound * squares.high {
                outside
            } else {
                0.0
            },
            if ahead * ahead > bound * bound * squared {
                ahead
            } else {
                0.0
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Stage, intersect_with_stage};
    use crate::glam::Vec3;
    use crate::{Hit, Ray, Sphere};

    /// Along x the unit sphere begins 2²⁴ + 1 away, between the floats 2²⁴ and 2²⁴ + 2, and ends
    /// between 2²⁴ + 2 and 2²⁴ + 4. A ray beside the axis meets it later by y²/2, and leaves it
    /// earlier.
    #[test]
    fn roots_beside_a_midpoint_are_rounded_to_their_side() {
        let (far_away, last) = (16_777_216.0, 16_777_220.0);
        let unit = Sphere::new(Vec3::ZERO, 1.0);
        let intersect = |y: f32, t_min: f32| {
            let origin = Vec3::new(-far_away - 2.0, y, 0.0);
            let ray = Ray::within(origin, Vec3::X, t_min, f32::MAX);
            intersect_with_stage(unit, &ray)
        };
        for n in 1..=51 {
            let y = 2.0_f32.powi(-n);
            for (t_min, expected) in [(0.0, far_away + 2.0), (last, Hit::NONE_T)] {
                let (t, stage) = intersect(y, t_min);
                assert_eq!(t, expected, "y = 2^-{n}, from {t_min}");
                // The bound on the error of p is 2⁻¹⁰⁰.
                let is_decided = stage <= Stage::Midpoint;
                assert_eq!(is_decided, n < 50, "y = 2^-{n}, from {t_min}: {stage:?}");
            }
        }
        // Ties go to the even significand.
        assert_eq!(intersect(0.0, 0.0), (far_away, Stage::Distilled));
        assert_eq!(intersect(0.0, last), (last, Stage::Distilled));
    }
}
