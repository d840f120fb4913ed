//! Double: the discriminant from the cross product and the roots without cancellation, in f64. Runs
//! on the CPU, and on GPUs whose module declares 64-bit floats.
//!
//! With v = 2⁻⁵³: o is off by v·|o| at most, k by a few v·|o||d|, and Δ = a r² − k·k by a few v (a
//! r² + |k||o||d|). c is off by a few v (o·o + r²), or by v|c| + 2⁻⁷³ (o·o + r²) where it is less
//! than 2⁻¹⁶ of these ([`residual`]). There Δ is b² − ac, off by a few v (|b||o||d| + a|c|).
//!
//! Each root is rounded to a float at the end. Vulkan promises little about 64-bit quotients and
//! roots, so one Newton step follows each.

use super::compensated::two_to_minus;
use super::root::Precision;
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
use super::root::choose_root;
use crate::arithmetic::error_free::two_sum;
use crate::hit::Hit;
use crate::lane::{Lane, Lane3};
use crate::ray::Ray;
use crate::sphere::Sphere;

/// The rung of this module.
#[derive(Clone, Copy, Debug)]
pub struct Double;

/// The quadratic of a line and a sphere, in lanes of 64-bit floats.
#[derive(Clone, Copy, Debug)]
pub struct Quadratic<L: Lane> {
    /// d·d
    pub a: L,
    /// o·d, with o from the sphere's centre to the origin.
    pub b: L,
    /// o·o − r²
    pub c: L,
    /// Δ = a r² − k·k, or b² − ac where c is the [`residual`].
    pub discriminant: L,
    /// o·o
    pub oo: L,
    /// r²
    pub rr: L,
    /// Where c is the difference of two numbers; elsewhere it is the [`residual`].
    pub c_has_digits: L::Mask,
}

impl<L: Lane> Quadratic<L> {
    /// The quadratic of the line through `origin` along `d`, and a sphere.
    #[inline(always)]
    #[must_use]
    pub fn of(origin: Lane3<L>, d: Lane3<L>, center: Lane3<L>, radius: L) -> Self {
        let o = origin.minus(center);
        let a = d.dot(d);
        let k = o.cross(d);
        let (oo, rr) = (o.dot(o), radius * radius);
        let rough = oo - rr;
        let c_has_digits = rough.abs().simd_ge((oo + rr) * a.splat(two_to_minus(16)));
        let b = o.dot(d);
        let (mut c, mut discriminant) = (rough, a * rr - k.dot(k));
        // NaN has no digits; a branch, because few spheres are so close to an origin. There b² and
        // ac do not cancel, while a r² and k·k do where a line passes the surface at a small angle.
        if !L::are_all(c_has_digits) {
            c = L::select(c_has_digits, rough, residual(origin, center, radius));
            discriminant = L::select(c_has_digits, discriminant, b * b - a * c);
        }
        Self {
            a,
            b,
            c,
            discriminant,
            oo,
            rr,
            c_has_digits,
        }
    }

    /// Whether the line meets the sphere; false for NaN.
    #[inline(always)]
    #[must_use]
    pub fn meets(&self) -> L::Mask {
        let zero = self.a.splat(0.0);
        self.discriminant.simd_ge(zero) & self.a.simd_gt(zero)
    }

    /// Both roots.
    ///
    /// 64-bit divisions are slow: one by a, which is the same for all spheres of a ray, and one by
    /// the product of √Δ and q.
    #[inline(always)]
    #[must_use]
    pub fn roots(&self) -> Roots<L> {
        let (zero, one) = (self.a.splat(0.0), self.a.splat(1.0));
        let leaves = self.b.simd_ge(zero);
        let root = self.discriminant.sqrt();
        let size = self.b.abs() + root;
        let divisor = L::select(root.simd_gt(zero), root, one);
        let over_both = one / (divisor * size);
        let root = square_root(self.discriminant, root, over_both * size);
        let over_size = over_both * divisor;
        let size = self.b.abs() + root;
        let outer = quotient(size, self.a, one / self.a);
        let inner = quotient(self.c, size, over_size);
        let inner = L::select(size.simd_gt(zero), inner, zero);
        Roots {
            near: L::select(leaves, -outer, inner),
            far: L::select(leaves, -inner, outer),
            leaves,
            over_size,
            over_both,
        }
    }
}

/// The roots of a quadratic, and what they were computed with.
#[derive(Clone, Copy, Debug)]
pub struct Roots<L: Lane> {
    /// The smaller root.
    pub near: L,
    /// The larger root.
    pub far: L,
    /// Whether the line's middle is not ahead: where that is so, `near` is q/a and `far` is c/q,
    /// otherwise the other way round.
    pub leaves: L::Mask,
    /// 1/|q|, approximately.
    pub over_size: L,
    /// 1/(√Δ|q|), approximately.
    pub over_both: L,
}

impl Precision for Double {
    #[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
    #[inline]
    fn intersect(sphere: Sphere, ray: &Ray) -> f32 {
        let (origin, d) = (
            Lane3::of(ray.origin).widened(),
            Lane3::of(ray.direction).widened(),
        );
        let center = Lane3::of(sphere.center()).widened();
        let quadratic = Quadratic::of(origin, d, center, f64::from(sphere.radius()));
        if !quadratic.meets() {
            return Hit::NONE_T;
        }
        let roots = quadratic.roots();
        choose_root(roots.near as f32, roots.far as f32, ray)
    }

    /// Always a miss: this module has no 64-bit floats.
    #[cfg(all(target_arch = "spirv", not(feature = "f64")))]
    #[inline]
    fn intersect(_: Sphere, _: &Ray) -> f32 {
        Hit::NONE_T
    }
}

/// c = o·o − r² where it is near zero. Each component of o is split into what 24 bits hold and the
/// rest, so that squares of the former are exact. Their sum and its rounding errors are summed
/// without loss, and the rest counts for 2⁻²³ of o·o at most.
#[inline(always)]
#[must_use]
pub fn residual<L: Lane>(origin: Lane3<L>, center: Lane3<L>, radius: L) -> L {
    let (x, rest_x) = square(origin.x, center.x);
    let (y, rest_y) = square(origin.y, center.y);
    let (z, rest_z) = square(origin.z, center.z);
    let (sum, error_1) = two_sum(x, y);
    let (sum, error_2) = two_sum(sum, z);
    let (sum, error_3) = two_sum(sum, -(radius * radius));
    sum + (error_1 + error_2 + error_3 + (rest_x + rest_y + rest_z))
}

/// (a − b)² as an exact square and the rest.
#[inline(always)]
fn square<L: Lane>(a: L, b: L) -> (L, L) {
    let (difference, error) = two_sum(a, -b);
    let high = difference.to_single();
    let low = difference.sub_strict(high) + error;
    (high * high, low * (high + high + low))
}

/// √x for x ≥ 0 from about √x and about 1/√x, by one Newton step; 0 for any other x.
#[inline(always)]
#[must_use]
pub fn square_root<L: Lane>(x: L, root: L, inverse: L) -> L {
    let half = x.splat(0.5);
    let newton = root + (x - root * root) * (inverse * half);
    L::select(x.simd_gt(x.splat(0.0)), newton, x.splat(0.0))
}

/// x / y from about 1/y, by one Newton step.
#[inline(always)]
#[must_use]
pub fn quotient<L: Lane>(x: L, y: L, inverse: L) -> L {
    let quotient = x * inverse;
    quotient + (x - quotient * y) * inverse
}
