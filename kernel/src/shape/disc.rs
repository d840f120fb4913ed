//! [`Disc`]: a flat disc. Runs on the GPU and on the CPU.
//!
//! A line meets its plane in one point, where it enters and leaves at once. The line's origin is
//! moved to where it is nearest to the centre, so that the point keeps the digits of a disc that is
//! small and far away.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

#[cfg(not(target_arch = "spirv"))]
use super::Measures;
#[cfg(not(target_arch = "spirv"))]
use super::axis::ends;
use super::span::{FAR, Span, splat3};
#[cfg(not(target_arch = "spirv"))]
use super::span::{next_down, next_up};
use super::{Shape, Solid};
use crate::lane::{Lane, Lane3};
use crate::ray::Ray;
#[cfg(not(target_arch = "spirv"))]
use crate::sphere::Sphere;
use crate::surface::{Surface, unit};

/// A flat disc: a slice, a mirror, a lamp. It has no inside.
///
/// ```
/// use spherule_kernel::shape::Disc;
/// use spherule_kernel::{Ray, Rung, glam::Vec3};
///
/// let disc = Disc::new(Vec3::new(0.0, 0.0, -3.0), Vec3::Z, 0.5);
/// let ray = Ray::new(Vec3::ZERO, Vec3::NEG_Z);
/// assert_eq!(disc.intersect(Rung::Robust, &ray), 3.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Disc {
    /// The centre, in scene units.
    pub center: Vec3,
    /// The radius, in scene units.
    pub radius: f32,
    /// What is perpendicular to the disc, of any length but zero.
    pub normal: Vec3,
    /// Makes the type as long as the vectors' alignment on GPUs calls for.
    pub unused: f32,
}

impl Disc {
    /// The disc around a centre, across a direction of any length but zero, with this radius in
    /// scene units.
    #[inline]
    #[must_use]
    pub const fn new(center: Vec3, normal: Vec3, radius: f32) -> Self {
        Self {
            center,
            radius,
            normal,
            unused: 0.0,
        }
    }

    #[inline]
    pub(crate) fn from_shape(shape: &Shape) -> Self {
        Self::new(
            shape.first.truncate(),
            shape.second.truncate(),
            shape.first.w,
        )
    }

    #[inline]
    pub(crate) fn to_shape(self) -> Shape {
        Shape {
            first: self.center.extend(self.radius),
            second: self.normal.extend(0.0),
            third: Vec3::ZERO.extend(Self::KIND as f32),
        }
    }
}

impl Solid for Disc {
    #[inline(always)]
    fn span<L: Lane>(&self, o: Lane3<L>, d: Lane3<L>) -> Span<L> {
        let like = o.x;
        let one = like.splat(1.0);
        let normal = splat3(like, self.normal);
        let o = o.minus(splat3(like, self.center));
        let nearest = -(o.dot(d) / d.dot(d));
        let p = o.minus_scaled(d, -nearest);
        let (height, slope) = (p.dot(normal), d.dot(normal));
        // Beyond that parameter it is as good as beside the plane forever.
        let is_met = slope.abs().simd_gt(height.abs() * like.splat(1.0 / FAR));
        let s = -(height / L::select(is_met, slope, one));
        let beside = p.minus_scaled(d, -s);
        let radius = like.splat(self.radius);
        let t = nearest + s;
        Span {
            near: t,
            far: t,
            meets: is_met & beside.dot(beside).simd_le(radius * radius),
        }
    }

    #[inline]
    fn textbook_span(&self, ray: &Ray) -> Span<f32> {
        let o = ray.origin - self.center;
        let t = -self.normal.dot(o) / ray.direction.dot(self.normal);
        let q = o + ray.direction * t;
        Span {
            near: t,
            far: t,
            meets: q.dot(q) <= self.radius * self.radius,
        }
    }

    #[inline]
    fn surface(&self, ray: &Ray, t: f32) -> Surface {
        let normal = unit(self.normal);
        let outward = (ray.origin - self.center) + ray.direction * t;
        let size = self.center.abs().max_element() + self.radius.abs();
        Surface {
            point: self.center + (outward - normal * outward.dot(normal)),
            normal,
            error: Surface::error(size),
        }
    }

    #[inline]
    fn moved(&self, by: Vec3) -> Self {
        Self::new(self.center + by, self.normal, self.radius)
    }

    /// The radius: a disc is as thin as can be.
    #[inline]
    fn thickness(&self) -> f32 {
        self.radius.abs()
    }

    #[inline]
    fn contains(&self, point: Vec3) -> bool {
        let outward = point - self.center;
        outward.dot(self.normal) == 0.0 && outward.dot(outward) <= self.radius * self.radius
    }
}

#[cfg(not(target_arch = "spirv"))]
impl Measures for Disc {
    fn bounds(&self) -> (Vec3, Vec3) {
        let around = (self.center, self.radius);
        let (low, high) = ends(self.normal, around, around);
        (next_down(low), next_up(high))
    }

    fn hull(&self) -> [Sphere; 2] {
        [Sphere::new(self.center, self.radius.abs()); 2]
    }

    fn is_valid(&self) -> bool {
        let squared = self.normal.dot(self.normal);
        let is_direction = (1e-30..1e30).contains(&squared);
        self.center.is_finite() && self.radius.is_finite() && self.radius > 0.0 && is_direction
    }
}

const _: () = {
    assert!(size_of::<Disc>() == 32);
    assert!(core::mem::offset_of!(Disc, radius) == 12);
    assert!(core::mem::offset_of!(Disc, normal) == 16);
};
