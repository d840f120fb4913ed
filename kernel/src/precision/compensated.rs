//! Everything as sums of two floats, about 48 bits. Runs on the GPU and on the CPU.
//!
//! o = O − C is exact as a pair. The components of k = o × d are differences of products whose
//! errors are kept (W. Kahan's way with `ad − bc`; C.-P. Jeannerod, N. Louvet and J.-M. Muller,
//! Further analysis of Kahan's algorithm, Math. Comp. 82 (2013), bound it for one float, here the
//! pairs carry the errors on), so that k is off by a few u² of |o||d|. Then
//!
//! - Δ = a r² − k·k is off by a few u² (a r² + |k||o||d|): it decides hit or miss outside of a band
//!   of about 2⁻⁴² (1 + |o|/r) on |Δ| / a r²;
//! - c = o·o − r² is off by a few u² (o·o + r²), so that c/q has all its digits wherever
//!   |c| ≥ 2⁻²⁰ o·o;
//! - q adds numbers of one sign, and each root is rounded to a float once, at the end.
//!
//! Lengths are scaled by a power of two before, and so are directions, so that no product
//! overflows, and none loses its error to the subnormals, from 2⁻⁶⁰ to 2⁶⁰.

use super::{Precision, choose_root};
use crate::arithmetic::DoubleSingle;
use crate::arithmetic::strict::mul;
use crate::hit::Hit;
use crate::ray::Ray;
use crate::sphere::Sphere;

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct Compensated;

impl Precision for Compensated {
    #[inline]
    fn intersect(sphere: Sphere, ray: &Ray) -> f32 {
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
        let discriminant = a.times(radius_squared).minus(k_squared);
        // False for a NaN in either.
        let meets = (discriminant.high >= 0.0) & (a.high > 0.0);
        if !meets {
            return Hit::NONE_T;
        }

        let b = o[0]
            .times_float(d[0])
            .plus(o[1].times_float(d[1]))
            .plus(o[2].times_float(d[2]));
        let c = o[0]
            .times(o[0])
            .plus(o[1].times(o[1]))
            .plus(o[2].times(o[2]))
            .minus(radius_squared);
        let root = discriminant.square_root();
        let leaves = b.high >= 0.0;
        // |q|
        let size = if leaves { root.plus(b) } else { root.minus(b) };
        let outer = size.divided_by(a).high;
        let inner = if size.high > 0.0 {
            c.divided_by(size).high
        } else {
            0.0
        };
        // t counts in lengths of the direction: undo both scales, in an order that cannot
        // overflow on the way.
        let unscale = |t: f32| t * direction_scale / length_scale;
        if leaves {
            choose_root(-unscale(outer), -unscale(inner), ray)
        } else {
            choose_root(unscale(inner), unscale(outer), ray)
        }
    }
}

#[inline]
fn scale(value: DoubleSingle, factor: f32) -> DoubleSingle {
    DoubleSingle {
        high: mul(value.high, factor),
        low: mul(value.low, factor),
    }
}

/// The power of two that brings a positive number between 1 and 2, or near it where that power
/// would not be a normal float; 1 for zero, infinities and NaN.
#[inline]
fn inverse_power_of_two(value: f32) -> f32 {
    let exponent = (value.to_bits() >> 23) & 0xff;
    if (exponent == 0) | (exponent == 255) {
        1.0
    } else {
        f32::from_bits((254 - exponent).max(1) << 23)
    }
}
