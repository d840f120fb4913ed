//! Robust: the discriminant from the perpendicular and the roots without cancellation, in f32. Runs
//! on the GPU and on the CPU.
//!
//! E. Haines, J. Günther and T. Akenine-Möller, Precision improvements for ray/sphere intersection,
//! in Ray Tracing Gems (2019), ch. 7. The foot of the perpendicular from the centre to the line is
//! f = o − (b/a) d, and Δ/a = r² − f·f. Both terms are of the size of r² where it matters, so that
//! a small sphere far away keeps its digits. The error of f is a few u·|o|, and that of Δ/a is a
//! few u·(r·|o| + r²) + (u·|o|)², while that of b² − ac is a few u·|o|². The roots are q/a and c/q,
//! where q adds numbers of one sign only.
//!
//! Two errors remain: c = o·o − r² loses its digits where the origin is near the surface, and
//! o = O − C is rounded. A huge ground sphere, or a ray that starts on a surface, needs a higher
//! rung.

use glam::Vec3;

use super::root::{Precision, choose_root};
use crate::arithmetic::U;
use crate::hit::Hit;
use crate::lane::{Lane, Lane3};
use crate::ray::Ray;
use crate::sphere::Sphere;

/// The rung of this module.
#[derive(Clone, Copy, Debug)]
pub struct Robust;

/// The quadratic of a line and a sphere, in lanes.
#[derive(Clone, Copy, Debug)]
pub struct Quadratic<L> {
    /// d·d
    pub a: L,
    /// o·d, with o from the sphere's centre to the origin.
    pub b: L,
    /// o·o − r²
    pub c: L,
    /// Δ / a
    pub discriminant: L,
    /// |q| = |b| + √Δ, a sum of numbers that are not negative.
    pub size: L,
}

impl<L: Lane> Quadratic<L> {
    /// The quadratic for o from the sphere's centre to the line's origin, the radius, the line's
    /// direction d, `a` = d·d and `inverse` = 1/a.
    #[inline(always)]
    #[must_use]
    pub fn of(o: Lane3<L>, radius: L, d: Lane3<L>, a: L, inverse: L) -> Self {
        let b = o.dot(d);
        let foot = o.minus_scaled(d, b * inverse);
        let radius_squared = radius * radius;
        let discriminant = radius_squared - foot.dot(foot);
        let c = o.dot(o) - radius_squared;
        let root = (a * discriminant).sqrt();
        let size = b.abs() + root;
        Self {
            a,
            b,
            c,
            discriminant,
            size,
        }
    }

    /// Whether the line meets the sphere.
    #[inline(always)]
    #[must_use]
    pub fn meets(&self) -> L::Mask {
        // The size is infinite only far outside the domain: for |d| above 2⁶⁰ or so.
        self.discriminant.simd_ge(self.b.splat(0.0)) & self.size.simd_le(self.b.splat(f32::MAX))
    }

    /// Whether the sphere's centre is ahead of the origin.
    #[inline(always)]
    #[must_use]
    pub fn is_ahead(&self) -> L::Mask {
        self.b.simd_lt(self.b.splat(0.0))
    }

    /// The absolute value of the root whose absolute value is larger: |q|/a.
    #[inline(always)]
    #[must_use]
    pub fn outer(&self) -> L {
        self.size / self.a
    }

    /// The other root if the centre is ahead, otherwise its negative; NaN if both roots are zero.
    ///
    /// It is not larger than the outer one. Where it would be, c is all but rounding, for an origin
    /// on the sphere and a line that touches it there; then it is as large.
    #[inline(always)]
    #[must_use]
    pub fn inner(&self) -> L {
        let inner = self.c / self.size;
        let is_too_large = (self.c.abs() * self.a).simd_gt(self.size * self.size);
        if L::are_all(!is_too_large) {
            return inner;
        }
        let (outer, zero) = (self.outer(), self.b.splat(0.0));
        let limited = L::select(self.c.simd_lt(zero), -outer, outer);
        L::select(is_too_large, limited, inner)
    }

    /// Both roots, the smaller first.
    #[inline(always)]
    #[must_use]
    pub fn roots(&self) -> (L, L) {
        let (inner, outer) = (self.inner(), self.outer());
        let is_ahead = self.is_ahead();
        L::choose_pair(is_ahead, || (inner, outer), || (-outer, -inner))
    }
}

impl Precision for Robust {
    #[inline]
    fn intersect(sphere: Sphere, ray: &Ray) -> f32 {
        let o = ray.origin - sphere.center();
        let d = ray.direction;
        let a = d.dot(d);
        // This is the same for every sphere that the ray is tested against.
        let inverse = 1.0 / a;
        let quadratic = Quadratic::of(Lane3::of(o), sphere.radius(), Lane3::of(d), a, inverse);
        let (near, far) = quadratic.roots();
        let t = choose_root(near, far, ray);
        // No early return: the threads of a GPU would wait for each other.
        if quadratic.meets() { t } else { Hit::NONE_T }
    }

    #[inline]
    fn widening(far: Vec3, _: f32) -> f32 {
        // At least the distance to the farthest corner.
        let distance = far.x + far.y + far.z;
        distance * (32.0 * U)
    }
}
