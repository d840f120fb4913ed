//! Double: the discriminant from the cross product and the roots without cancellation, in f64. Runs
//! on the CPU, and on GPUs whose module declares 64-bit floats.
//!
//! With v = 2⁻⁵³: o is off by v·|o| at most, k by a few v·|o||d|, Δ = a r² − k·k by a few v (a r² +
//! |k||o||d|), and c by a few v (o·o + r²). Each root is rounded to a float at the end. Vulkan
//! promises little about 64-bit quotients and roots, so one Newton step follows each.

use super::root::Precision;
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
use super::root::choose_root;
use crate::hit::Hit;
use crate::lane::{Lane, Lane3};
use crate::ray::Ray;
use crate::sphere::Sphere;

/// The rung of this module.
#[derive(Clone, Copy, Debug)]
pub struct Double;

/// The quadratic of a line and a sphere, in lanes of 64-bit floats.
#[derive(Clone, Copy, Debug)]
pub struct Quadratic<L> {
    /// d·d
    pub a: L,
    /// o·d, with o from the sphere's centre to the origin.
    pub b: L,
    /// o·o − r²
    pub c: L,
    /// a r² − k·k
    pub discriminant: L,
}

impl<L: Lane> Quadratic<L> {
    /// The quadratic for o from the sphere's centre to the line's origin, the radius, and the
    /// line's direction.
    #[inline(always)]
    #[must_use]
    pub fn of(o: Lane3<L>, radius: L, d: Lane3<L>) -> Self {
        let a = d.dot(d);
        let k = o.cross(d);
        let radius_squared = radius * radius;
        Self {
            a,
            b: o.dot(d),
            c: o.dot(o) - radius_squared,
            discriminant: a * radius_squared - k.dot(k),
        }
    }

    /// Whether the line meets the sphere; false for NaN.
    #[inline(always)]
    #[must_use]
    pub fn meets(&self) -> L::Mask {
        let zero = self.a.splat(0.0);
        self.discriminant.simd_ge(zero) & self.a.simd_gt(zero)
    }

    /// Both roots, the smaller first.
    ///
    /// 64-bit divisions are slow: one by a, which is the same for all spheres of a ray, and one by
    /// the product of √Δ and q.
    #[inline(always)]
    #[must_use]
    pub fn roots(&self) -> (L, L) {
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
        (
            L::select(leaves, -outer, inner),
            L::select(leaves, -inner, outer),
        )
    }
}

impl Precision for Double {
    #[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
    #[inline]
    fn intersect(sphere: Sphere, ray: &Ray) -> f32 {
        let center = sphere.center();
        let o = Lane3 {
            x: f64::from(ray.origin.x) - f64::from(center.x),
            y: f64::from(ray.origin.y) - f64::from(center.y),
            z: f64::from(ray.origin.z) - f64::from(center.z),
        };
        let d = Lane3 {
            x: f64::from(ray.direction.x),
            y: f64::from(ray.direction.y),
            z: f64::from(ray.direction.z),
        };
        let quadratic = Quadratic::of(o, f64::from(sphere.radius()), d);
        if !quadratic.meets() {
            return Hit::NONE_T;
        }
        let (near, far) = quadratic.roots();
        choose_root(near as f32, far as f32, ray)
    }

    /// Always a miss: this module has no 64-bit floats.
    #[cfg(all(target_arch = "spirv", not(feature = "f64")))]
    #[inline]
    fn intersect(_: Sphere, _: &Ray) -> f32 {
        Hit::NONE_T
    }
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
