//! Compensated: everything in pairs of floats, about 48 bits. Runs on the GPU and on the CPU.
//!
//! o = O − C is exact as a pair. The components of k = o × d are differences of products whose
//! errors are kept. This is W. Kahan's algorithm for `ad − bc`, which C.-P. Jeannerod, N. Louvet
//! and J.-M. Muller, Further analysis of Kahan's algorithm, Math. Comp. 82 (2013), bound for one
//! float; here the pairs carry the errors on. So k is off by a few u² of |o||d|. Then:
//!
//! - Δ = a r² − k·k is off by a few u² (a r² + |k||o||d|). It decides hit or miss outside of a band
//!   of about 2⁻⁴² (1 + |o|/r) on |Δ| / a r².
//! - c = o·o − r² is off by about 11u² (o·o + r²), which is less than a quarter of an ulp where
//!   |c| ≥ 2⁻¹⁹ (o·o + r²). With the other errors and the one rounding at the end, t is within 1
//!   ulp there, and was never seen further off where |c| ≥ 2⁻²⁰ o·o.
//! - q adds numbers of one sign. Each root is rounded to a float once, at the end.
//!
//! Lengths and directions are first scaled by powers of two so that the largest of each is between
//! 1 and 2 and no product overflows. A product's error is normal where the product is above 2⁻⁷⁹,
//! so r may be as small as 2⁻³⁹ of |o|.

// On the CPU, std has `f32::sqrt`.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use super::root::{Precision, choose_root};
use crate::arithmetic::DoubleSingle;
use crate::arithmetic::strict::mul;
use crate::hit::Hit;
use crate::ray::Ray;
use crate::sphere::Sphere;

/// The rung of this module.
#[derive(Clone, Copy, Debug)]
pub struct Compensated;

impl Precision for Compensated {
    #[inline]
    fn intersect(sphere: Sphere, ray: &Ray) -> f32 {
        let quadratic = Quadratic::of(sphere, ray);
        // False if either is NaN.
        let meets = (quadratic.discriminant.high >= 0.0) & (quadratic.a.high > 0.0);
        if meets {
            let (near, far) = quadratic.roots();
            choose_root(near, far, ray)
        } else {
            Hit::NONE_T
        }
    }
}

/// The quadratic of a ray and a sphere in pairs of floats, for scaled lengths and directions.
#[derive(Clone, Copy, Debug)]
pub struct Quadratic {
    /// o = O − C, exactly, scaled.
    pub o: [DoubleSingle; 3],
    /// The direction, scaled.
    pub d: [f32; 3],
    /// The radius, scaled.
    pub r: f32,
    /// d·d
    pub a: DoubleSingle,
    /// o·d
    pub b: DoubleSingle,
    /// o·o − r²
    pub c: DoubleSingle,
    /// a r² − k·k
    pub discriminant: DoubleSingle,
    /// k·k, rounded to a float.
    pub k_squared: f32,
    /// The power of two that lengths were multiplied by.
    pub length_scale: f32,
    /// The power of two that the direction was multiplied by.
    pub direction_scale: f32,
}

impl Quadratic {
    /// The quadratic of `ray` and `sphere`.
    #[inline]
    #[must_use]
    pub fn of(sphere: Sphere, ray: &Ray) -> Self {
        let center = sphere.center();
        let o = [
            DoubleSingle::difference(ray.origin.x, center.x),
            DoubleSingle::difference(ray.origin.y, center.y),
            DoubleSingle::difference(ray.origin.z, center.z),
        ];
        let d = ray.direction;
        let length_scale = inverse_power_of_two(
            o[0].high
                .abs()
                .max(o[1].high.abs())
                .max(o[2].high.abs())
                .max(sphere.radius().abs()),
        );
        let direction_scale = inverse_power_of_two(d.x.abs().max(d.y.abs()).max(d.z.abs()));
        let d = [
            mul(d.x, direction_scale),
            mul(d.y, direction_scale),
            mul(d.z, direction_scale),
        ];
        let o = [
            scale(o[0], length_scale),
            scale(o[1], length_scale),
            scale(o[2], length_scale),
        ];
        let r = mul(sphere.radius(), length_scale);

        let a = DoubleSingle::product(d[0], d[0])
            .plus(DoubleSingle::product(d[1], d[1]))
            .plus(DoubleSingle::product(d[2], d[2]));
        let radius_squared = DoubleSingle::product(r, r);
        let k = [
            o[1].times_float(d[2]).minus(o[2].times_float(d[1])),
            o[2].times_float(d[0]).minus(o[0].times_float(d[2])),
            o[0].times_float(d[1]).minus(o[1].times_float(d[0])),
        ];
        let k_squared = k[0]
            .times(k[0])
            .plus(k[1].times(k[1]))
            .plus(k[2].times(k[2]));
        Self {
            o,
            d,
            r,
            a,
            b: o[0]
                .times_float(d[0])
                .plus(o[1].times_float(d[1]))
                .plus(o[2].times_float(d[2])),
            c: o[0]
                .times(o[0])
                .plus(o[1].times(o[1]))
                .plus(o[2].times(o[2]))
                .minus(radius_squared),
            discriminant: a.times(radius_squared).minus(k_squared),
            k_squared: k_squared.high,
            length_scale,
            direction_scale,
        }
    }

    /// Both roots as parameters along the ray, the smaller first. The discriminant must not be
    /// negative.
    #[inline]
    #[must_use]
    pub fn roots(&self) -> (f32, f32) {
        let roots = self.raised_roots();
        let (inner, outer) = (
            self.unscale(roots.inner.high),
            self.unscale(roots.outer.high),
        );
        if roots.leaves {
            (-outer, -inner)
        } else {
            (inner, outer)
        }
    }

    /// The roots' magnitudes before they are unscaled. The discriminant must not be negative.
    #[inline]
    #[must_use]
    pub(super) fn raised_roots(&self) -> RaisedRoots {
        let root = self.discriminant.square_root();
        let leaves = self.b.high >= 0.0;
        // |q|
        let size = if leaves {
            root.plus(self.b)
        } else {
            root.minus(self.b)
        };
        let outer = scale(size.divided_by(self.a), RAISED);
        // While it is scaled, the root that is nearer to zero must not be subnormal.
        let inner = if size.high > 0.0 {
            scale(self.c, RAISED).divided_by(size)
        } else {
            DoubleSingle::default()
        };
        RaisedRoots {
            leaves,
            size: size.high,
            outer,
            inner,
        }
    }

    /// Converts a root of the scaled quadratic, times [`RAISED`], to a parameter along the ray,
    /// exactly. Both scales are powers of two, and the reciprocal of one is made from its exponent,
    /// because a device's quotients are not exact. The larger factor comes first, so that no digits
    /// are lost in a subnormal intermediate result; and no result is infinite that is finite in the
    /// end.
    #[inline]
    #[must_use]
    pub(super) fn unscale(&self, raised: f32) -> f32 {
        let inverse = reciprocal(self.length_scale);
        let larger = self.direction_scale.max(inverse);
        let smaller = self.direction_scale.min(inverse);
        let lower = 1.0 / RAISED;
        if larger > RAISED {
            mul(mul(raised, mul(larger, lower)), smaller)
        } else if smaller > 1.0 {
            mul(mul(mul(raised, larger), lower), smaller)
        } else {
            mul(mul(mul(raised, larger), smaller), lower)
        }
    }

    /// |o|²|d|², approximately.
    #[inline]
    fn size_squared(&self) -> f32 {
        let oo = self.o[0].high * self.o[0].high
            + self.o[1].high * self.o[1].high
            + self.o[2].high * self.o[2].high;
        oo * self.a.high
    }

    /// What the error of Δ is a share of: a r² + k·k + |k||o||d|.
    #[inline]
    fn discriminant_terms(&self) -> f32 {
        let mixed = (self.k_squared * self.size_squared()).sqrt();
        self.a.high * (self.r * self.r) + self.k_squared + mixed
    }

    /// A bound on the error of Δ where its sign is in doubt.
    #[inline]
    fn sign_error(&self) -> f32 {
        two_to_minus(43) * self.discriminant_terms()
    }

    /// Whether Δ is certainly negative.
    #[inline]
    #[must_use]
    pub fn misses_for_certain(&self) -> bool {
        -self.discriminant.high > self.sign_error()
    }

    /// Whether Δ is certainly positive.
    #[inline]
    #[must_use]
    pub fn meets_for_certain(&self) -> bool {
        self.discriminant.high > self.sign_error()
    }

    /// A bound on the relative error of |q|, where Δ is positive, and of its quotient by a. √Δ is
    /// off by E₂/√Δ, where E₂ = 2⁻³⁸ (a r² + k·k + |k||o||d|), and b by 16u² |o||d|. Quotient and
    /// root are off by up to 2⁻³⁷ of themselves if the device's own are off by 16 units in the last
    /// place, the most that the canary lets pass: E₂ holds what 2⁻³⁷ for both together does not.
    #[inline]
    #[must_use]
    pub fn size_error(&self) -> f32 {
        let root = self.discriminant.high.max(0.0).sqrt();
        let size = self.b.high.abs() + root;
        let error = two_to_minus(38) * self.discriminant_terms();
        let of_root = error / (root * size);
        let of_b = self.size_squared().sqrt() * two_to_minus(43) / size;
        of_root + of_b + two_to_minus(37)
    }

    /// A bound on the error of c: 16u² (o·o + r²).
    #[inline]
    #[must_use]
    pub fn c_error(&self) -> f32 {
        let oo_and_rr = self.r * self.r
            + self.o[0].high * self.o[0].high
            + self.o[1].high * self.o[1].high
            + self.o[2].high * self.o[2].high;
        oo_and_rr * two_to_minus(44)
    }
}

/// The magnitudes of the two roots of the scaled quadratic, times [`RAISED`].
#[derive(Clone, Copy, Debug)]
pub(super) struct RaisedRoots {
    /// Whether the line's middle is not ahead: the roots are −`outer` and −`inner` then, otherwise
    /// `inner` and `outer`.
    pub(super) leaves: bool,
    /// |q|
    pub(super) size: f32,
    /// |q|/a
    pub(super) outer: DoubleSingle,
    /// c/|q|
    pub(super) inner: DoubleSingle,
}

/// What roots are multiplied by before they are unscaled: 2⁴⁸.
pub(super) const RAISED: f32 = (1_u64 << 48) as f32;

/// 2⁻ⁿ for n below 127.
#[inline]
pub(super) const fn two_to_minus(n: u32) -> f32 {
    f32::from_bits((127 - n) << 23)
}

/// One over a power of two, exactly, or the smallest normal float if it is not one.
#[inline]
fn reciprocal(power_of_two: f32) -> f32 {
    let exponent = power_of_two.to_bits() >> 23;
    f32::from_bits(254_u32.wrapping_sub(exponent).max(1) << 23)
}

/// A pair times a power of two.
#[inline]
pub(super) fn scale(value: DoubleSingle, factor: f32) -> DoubleSingle {
    DoubleSingle {
        high: mul(value.high, factor),
        low: mul(value.low, factor),
    }
}

/// The power of two that scales a positive number to between 1 and 2, or as near as possible if
/// that power would not be a normal float; 1 for zero, subnormal numbers, infinities and NaN.
#[inline]
fn inverse_power_of_two(value: f32) -> f32 {
    let exponent = (value.to_bits() >> 23) & 0xff;
    if (exponent == 0) | (exponent == 255) {
        1.0
    } else {
        f32::from_bits(254_u32.wrapping_sub(exponent).max(1) << 23)
    }
}
