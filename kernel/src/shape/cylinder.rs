//! [`Cylinder`]: a cylinder with flat ends. Runs on the GPU and on the CPU.
//!
//! A line is in it where it is in the infinite cylinder, as for a
//! [capsule](super::capsule), and between the planes of the ends, where its height is from −1 to 1:
//! from the later of where it enters both to the sooner of where it leaves one.
//!
//! The textbook's formula is that of I. Quilez (iquilezles.org, *Cylinder - intersection*).

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

#[cfg(not(target_arch = "spirv"))]
use super::Measures;
#[cfg(not(target_arch = "spirv"))]
use super::axis::ends;
use super::axis::{AxisLine, AxisPoint};
use super::span::{Slab, Span};
#[cfg(not(target_arch = "spirv"))]
use super::span::{next_down, next_up};
use super::{Shape, Solid};
use crate::lane::{Lane, Lane3};
use crate::ray::Ray;
#[cfg(not(target_arch = "spirv"))]
use crate::sphere::Sphere;
use crate::surface::{Surface, unit};

/// All points between the planes through a segment's ends, and within a radius of its line: a rod,
/// a can, a coin.
///
/// ```
/// use spherule_kernel::shape::{Cylinder, Solid};
/// use spherule_kernel::{Ray, Rung, glam::Vec3};
///
/// let rod = Cylinder::new(Vec3::new(-1.0, 0.0, -3.0), Vec3::new(1.0, 0.0, -3.0), 0.5);
/// let ray = Ray::new(Vec3::ZERO, Vec3::NEG_Z);
/// assert_eq!(rod.intersect(Rung::Robust, &ray), 2.5);
/// assert!(!rod.contains(Vec3::new(1.25, 0.0, -3.0)));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Cylinder {
    /// The middle of one end, in scene units.
    pub start: Vec3,
    /// The radius, in scene units.
    pub radius: f32,
    /// The middle of the other end, in scene units; not the same.
    pub end: Vec3,
    /// Makes the type as long as the vectors' alignment on GPUs calls for.
    pub unused: f32,
}

impl Cylinder {
    /// The cylinder with these middles of its ends and this radius, in scene units.
    #[inline]
    #[must_use]
    pub const fn new(start: Vec3, end: Vec3, radius: f32) -> Self {
        Self {
            start,
            radius,
            end,
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
            first: self.start.extend(self.radius),
            second: self.end.extend(0.0),
            third: Vec3::ZERO.extend(Self::KIND as f32),
        }
    }

    /// How far a point is from the axis, and how far beyond the ends: see [`Solid::contains`].
    #[inline]
    fn beside(&self, point: &AxisPoint) -> (Vec3, f32) {
        let beyond = (point.share - 0.5).abs() - 0.5;
        (point.from_start - point.axis * point.share, beyond)
    }
}

impl Solid for Cylinder {
    #[inline(always)]
    fn span<L: Lane>(&self, o: Lane3<L>, d: Lane3<L>) -> Span<L> {
        let line = AxisLine::of(o, d, self.start, self.end);
        let (zero, one) = (o.x.splat(0.0), o.x.splat(1.0));
        let radius_squared = o.x.splat(self.radius) * o.x.splat(self.radius);
        let discriminant = radius_squared - line.distance_squared;
        let root = AxisLine::root(discriminant * line.inverse_across);
        let slab = Slab::of(line.p_height, line.d_height, one);
        let is_later = (line.m - root).simd_gt(slab.near) & line.is_across;
        let is_sooner = (line.m + root).simd_lt(slab.far) & line.is_across;
        let near = L::select(is_later, line.m - root, slab.near);
        let far = L::select(is_sooner, line.m + root, slab.far);
        Span {
            near: line.nearest + near,
            far: line.nearest + far,
            meets: discriminant.simd_ge(zero) & near.simd_le(far),
        }
    }

    #[inline]
    fn textbook_span(&self, ray: &Ray) -> Span<f32> {
        let (ba, oc) = (self.end - self.start, ray.origin - self.start);
        let rd = ray.direction;
        let (dd, baba, bard, baoc) = (rd.dot(rd), ba.dot(ba), ba.dot(rd), ba.dot(oc));
        let k2 = baba * dd - bard * bard;
        let k1 = baba * oc.dot(rd) - baoc * bard;
        let k0 = baba * oc.dot(oc) - baoc * baoc - self.radius * self.radius * baba;
        let h = k1 * k1 - k2 * k0;
        let root = h.max(0.0).sqrt();
        let (near, far) = ((-k1 - root) / k2, (-k1 + root) / k2);
        let (low, high) = (-baoc / bard, (baba - baoc) / bard);
        let (low, high) = (low.min(high), low.max(high));
        let (near, far) = (near.max(low), far.min(high));
        Span {
            near,
            far,
            meets: (h >= 0.0) & (near <= far),
        }
    }

    #[inline]
    fn surface(&self, ray: &Ray, t: f32) -> Surface {
        let axis = self.end - self.start;
        let from_start = (ray.origin - self.start) + ray.direction * t;
        let point = AxisPoint::of(from_start, axis);
        let (outward, beyond) = self.beside(&point);
        let length = outward.dot(outward).sqrt();
        let (along, long) = (unit(axis), axis.dot(axis).sqrt());
        let size = self.start.abs().max(self.end.abs()).max_element() + self.radius.abs();
        // The surface that is nearer to the point.
        let is_end = (beyond * long).abs() < (length - self.radius.abs()).abs();
        let side = if point.share < 0.5 { 0.0 } else { 1.0 };
        let (normal, from_start) = if is_end {
            (along * (2.0 * side - 1.0), outward + axis * side)
        } else {
            let normal = unit(outward);
            (normal, axis * point.share + normal * self.radius.abs())
        };
        Surface {
            point: self.start + from_start,
            normal,
            error: Surface::error(size),
        }
    }

    #[inline]
    fn moved(&self, by: Vec3) -> Self {
        Self::new(self.start + by, self.end + by, self.radius)
    }

    #[inline]
    fn thickness(&self) -> f32 {
        let axis = self.end - self.start;
        self.radius.abs().min(0.5 * axis.dot(axis).sqrt())
    }

    #[inline]
    fn contains(&self, point: Vec3) -> bool {
        let point = AxisPoint::of(point - self.start, self.end - self.start);
        let (outward, beyond) = self.beside(&point);
        (outward.dot(outward) <= self.radius * self.radius) & (beyond <= 0.0)
    }
}

#[cfg(not(target_arch = "spirv"))]
impl Measures for Cylinder {
    fn bounds(&self) -> (Vec3, Vec3) {
        let (low, high) = ends(
            self.end - self.start,
            (self.start, self.radius),
            (self.end, self.radius),
        );
        (next_down(low), next_up(high))
    }

    fn hull(&self) -> [Sphere; 2] {
        [self.start, self.end].map(|end| Sphere::new(end, self.radius.abs()))
    }

    fn is_valid(&self) -> bool {
        let is_finite = self.start.is_finite() & self.end.is_finite() & self.radius.is_finite();
        is_finite & (self.radius > 0.0) & (self.start != self.end)
    }
}

const _: () = {
    assert!(size_of::<Cylinder>() == 32);
    assert!(core::mem::offset_of!(Cylinder, radius) == 12);
    assert!(core::mem::offset_of!(Cylinder, end) == 16);
};
