//! The float that is nearest to a root. Runs on the GPU and on the CPU.

use super::distilled::Side;
use crate::arithmetic::DoubleSingle;
use crate::arithmetic::strict::{mul, sub};
use crate::hit::Hit;
use crate::precision::compensated::{Quadratic, RAISED, two_to_minus};
use crate::ray::Ray;

/// A root of a scaled quadratic, times [`RAISED`], and a bound on its error.
#[derive(Clone, Copy, Debug)]
pub struct Root {
    /// The root.
    pub value: DoubleSingle,
    /// How far the true root may be from it.
    pub error: f32,
}

/// A root as a float.
#[derive(Clone, Copy, Debug)]
struct Rounded {
    nearest: f32,
    /// The float beyond the midpoint that is next to the root.
    other: f32,
    /// Whether `nearest` is the float nearest to the true root.
    is_certain: bool,
}

impl Root {
    /// Both roots of a quadratic, the smaller first. Its discriminant must not be negative. |q| is
    /// off by `size_error` of itself, and c by `c_error`.
    #[inline]
    #[must_use]
    pub fn both(quadratic: &Quadratic, size_error: f32, c_error: f32) -> (Self, Self) {
        let roots = quadratic.raised_roots();
        let outer_error = roots.outer.high * size_error;
        let of_c = if roots.size > 0.0 {
            c_error * RAISED / roots.size
        } else {
            0.0
        };
        let inner_error = roots.inner.high.abs() * size_error + of_c;
        let root = |value, error| Self { value, error };
        if roots.leaves {
            (
                root(negative(roots.outer), outer_error),
                root(negative(roots.inner), inner_error),
            )
        } else {
            (
                root(roots.inner, inner_error),
                root(roots.outer, outer_error),
            )
        }
    }

    /// A float that is above the root for certain.
    #[inline]
    fn upper_bound(self) -> f32 {
        let DoubleSingle { high, low } = self.value;
        high + ((low.abs() + self.error) * 2.0 + high.abs() * two_to_minus(22))
    }

    #[inline]
    fn rounded(self) -> Rounded {
        let DoubleSingle { high, low } = self.value;
        let other = next_towards(high, low);
        // What is left until the midpoint, exactly. On the other side of `high` it may be half as
        // far, if that is a power of two.
        let half = 0.5 * sub(other, high).abs();
        let is_inside = (low.abs() + self.error < half) & (self.error < 0.5 * half);
        Rounded {
            nearest: high,
            other,
            is_certain: is_inside | ((low == 0.0) & (self.error == 0.0)),
        }
    }

    /// The float nearest to the root by the exact position of the midpoint; of two equally near
    /// ones the even one, as IEEE 754 says.
    #[inline]
    fn rounded_exactly(self, pairs: &Quadratic, is_near: bool) -> f32 {
        let Rounded {
            nearest,
            other,
            is_certain,
        } = self.rounded();
        if is_certain {
            return nearest;
        }
        let half = mul(0.5, sub(other, nearest));
        let midpoint = DoubleSingle {
            high: nearest,
            low: half,
        };
        let beyond = Side::of(pairs, midpoint).of_root(is_near);
        let beyond = if half < 0.0 { -beyond } else { beyond };
        let is_odd = nearest.to_bits() & 1 == 1;
        if (beyond > 0.0) | ((beyond == 0.0) & is_odd) {
            other
        } else {
            nearest
        }
    }
}

/// The smaller of two roots that lies in the ray's interval once it is rounded, or
/// [`Hit::NONE_T`]; and whether that is certain.
#[inline]
#[must_use]
pub fn choose(pairs: &Quadratic, (near, far): (Root, Root), ray: &Ray) -> (f32, bool) {
    let first = near.rounded();
    let t = pairs.unscale(first.nearest);
    let latest = if first.is_certain {
        t
    } else {
        pairs.unscale(near.upper_bound())
    };
    let is_ahead = first.is_certain & (t >= ray.t_min);
    let is_before = latest < ray.t_min;
    let root = if is_ahead { first } else { far.rounded() };
    let is_certain = (is_ahead | is_before) & root.is_certain;
    (within(pairs.unscale(root.nearest), ray), is_certain)
}

/// As [`choose`], for certain.
#[inline]
#[must_use]
pub fn choose_exactly(pairs: &Quadratic, (near, far): (Root, Root), ray: &Ray) -> f32 {
    // One copy of the code for both roots.
    let mut root = near;
    let mut index = 0;
    let mut found = Hit::NONE_T;
    while index < 2 {
        let t = pairs.unscale(root.rounded_exactly(pairs, index == 0));
        if t >= ray.t_min {
            found = within(t, ray);
            break;
        }
        root = far;
        index += 1;
    }
    found
}

/// A parameter that is in the ray's interval, or [`Hit::NONE_T`].
#[inline]
fn within(t: f32, ray: &Ray) -> f32 {
    if (t >= ray.t_min) & (t < ray.t_max) {
        t
    } else {
        Hit::NONE_T
    }
}

/// The next float above `value`, or below it for a negative `direction`.
#[inline]
fn next_towards(value: f32, direction: f32) -> f32 {
    let bits = value.to_bits();
    let grows = (value > 0.0) == (direction > 0.0);
    f32::from_bits(if grows {
        bits.wrapping_add(1)
    } else {
        bits.wrapping_sub(1)
    })
}

#[inline]
fn negative(value: DoubleSingle) -> DoubleSingle {
    DoubleSingle {
        high: sub(0.0, value.high),
        low: sub(0.0, value.low),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Below a power of two floats are twice as close to each other.
    #[test]
    fn a_power_of_two_is_certain_if_the_midpoint_below_it_is_not_reached() {
        let root = |low: f32, error: f32| Root {
            value: DoubleSingle { high: 1.0, low },
            error,
        };
        let ulp = f32::EPSILON;
        for (low, within) in [(0.0, 0.1), (1e-4 * ulp, 0.2), (-1e-4 * ulp, 0.1)] {
            assert!(root(low, within * ulp).rounded().is_certain, "{low}");
            assert!(!root(low, 0.3 * ulp).rounded().is_certain, "{low}");
        }
        assert!(root(0.3 * ulp, 0.1 * ulp).rounded().is_certain);
        assert!(!root(0.3 * ulp, 0.21 * ulp).rounded().is_certain);
        assert!(!root(-0.2 * ulp, 0.06 * ulp).rounded().is_certain);
    }
}
