//! [`Ellipsoid`]: a sphere that is stretched along three axes. Runs on the GPU and on the CPU.
//!
//! In its own frame, with each coordinate divided by the half-axis, an ellipsoid is the unit sphere
//! and a line is a line with the same parameters. The line's origin is moved to where it is nearest
//! to the centre before it is divided, and to where it is nearest to the unit sphere's centre
//! after, so that Δ is one less a square of about its size, and no digit is lost to an ellipsoid
//! that is small and far away, or flat.
//!
//! The textbook's formula is that of I. Quilez (iquilezles.org, *Ellipsoid - intersection*), in the
//! ellipsoid's frame.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

#[cfg(not(target_arch = "spirv"))]
use super::Measures;
use super::axis::AxisLine;
use super::frame::Frame;
use super::span::{Span, splat3};
#[cfg(not(target_arch = "spirv"))]
use super::span::{next_down, next_up};
use super::{Shape, Solid};
use crate::lane::{Lane, Lane3};
use crate::ray::Ray;
#[cfg(not(target_arch = "spirv"))]
use crate::sphere::Sphere;
use crate::surface::{Surface, unit};

/// An ellipsoid: an aspherical particle.
///
/// ```
/// use spherule_kernel::shape::{Ellipsoid, Solid};
/// use spherule_kernel::{Ray, Rung, glam::{Quat, Vec3}};
///
/// let grain = Ellipsoid::new(Vec3::new(0.0, 0.0, -3.0), Vec3::new(1.0, 1.0, 0.5), Quat::IDENTITY);
/// let ray = Ray::new(Vec3::ZERO, Vec3::NEG_Z);
/// assert_eq!(grain.intersect(Rung::Robust, &ray), 2.5);
/// assert!(grain.contains(Vec3::new(0.9, 0.0, -3.0)));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Ellipsoid {
    /// The centre, in scene units.
    pub center: Vec3,
    /// Makes the next vector begin where GPUs have it.
    pub unused: f32,
    /// Half of the length along each of its own axes, in scene units.
    pub half_axes: Vec3,
    /// See `unused`.
    pub unused_too: f32,
    /// The quaternion that turns its own axes into the scene's, of any length but zero.
    pub rotation: Vec4,
}

impl Ellipsoid {
    /// The ellipsoid around a centre with these half-axes, in scene units, turned by a rotation.
    #[cfg(not(target_arch = "spirv"))]
    #[inline]
    #[must_use]
    pub fn new(center: Vec3, half_axes: Vec3, rotation: glam::Quat) -> Self {
        Self::turned(center, half_axes, Frame::of_quat(rotation))
    }

    #[inline]
    const fn turned(center: Vec3, half_axes: Vec3, rotation: Vec4) -> Self {
        Self {
            center,
            unused: 0.0,
            half_axes,
            unused_too: 0.0,
            rotation,
        }
    }

    #[inline]
    pub(crate) fn from_shape(shape: &Shape) -> Self {
        let half_axes = Vec3::new(shape.first.w, shape.third.x, shape.third.y);
        Self::turned(shape.first.truncate(), half_axes, shape.second)
    }

    #[inline]
    pub(crate) fn to_shape(self) -> Shape {
        let half = self.half_axes;
        Shape {
            first: self.center.extend(half.x),
            second: self.rotation,
            third: Vec4::new(half.y, half.z, 0.0, Self::KIND as f32),
        }
    }

    #[inline]
    fn frame(&self) -> Frame {
        Frame {
            center: self.center,
            rotation: self.rotation,
        }
    }
}

impl Solid for Ellipsoid {
    #[inline(always)]
    fn span<L: Lane>(&self, o: Lane3<L>, d: Lane3<L>) -> Span<L> {
        let (nearest, p, d) = self.frame().line(o, d);
        let half = splat3(o.x, self.half_axes);
        let (zero, one) = (o.x.splat(0.0), o.x.splat(1.0));
        let p = Lane3 {
            x: p.x / half.x,
            y: p.y / half.y,
            z: p.z / half.z,
        };
        let d = Lane3 {
            x: d.x / half.x,
            y: d.y / half.y,
            z: d.z / half.z,
        };
        let inverse = one / d.dot(d);
        let middle = -(p.dot(d) * inverse);
        let foot = p.minus_scaled(d, -middle);
        let discriminant = one - foot.dot(foot);
        let root = AxisLine::root(discriminant * inverse);
        Span {
            near: nearest + (middle - root),
            far: nearest + (middle + root),
            meets: discriminant.simd_ge(zero),
        }
    }

    #[inline]
    fn textbook_span(&self, ray: &Ray) -> Span<f32> {
        let frame = self.frame();
        let oc = frame.local(ray.origin - self.center) / self.half_axes;
        let rd = frame.local(ray.direction) / self.half_axes;
        let (a, b, c) = (rd.dot(rd), oc.dot(rd), oc.dot(oc) - 1.0);
        let h = b * b - a * c;
        let root = h.max(0.0).sqrt();
        Span {
            near: (-b - root) / a,
            far: (-b + root) / a,
            meets: h >= 0.0,
        }
    }

    #[inline]
    fn surface(&self, ray: &Ray, t: f32) -> Surface {
        let frame = self.frame();
        let from_center = (ray.origin - self.center) + ray.direction * t;
        let on_sphere = unit(frame.local(from_center) / self.half_axes);
        let size = self.center.abs().max_element() + self.half_axes.abs().max_element();
        Surface {
            point: self.center + frame.global(on_sphere * self.half_axes),
            normal: unit(frame.global(on_sphere / self.half_axes)),
            error: 2.0 * Surface::error(size),
        }
    }

    #[inline]
    fn moved(&self, by: Vec3) -> Self {
        Self::turned(self.center + by, self.half_axes, self.rotation)
    }

    #[inline]
    fn thickness(&self) -> f32 {
        self.half_axes.abs().min_element()
    }

    #[inline]
    fn contains(&self, point: Vec3) -> bool {
        let local = self.frame().local(point - self.center) / self.half_axes;
        local.dot(local) <= 1.0
    }
}

#[cfg(not(target_arch = "spirv"))]
impl Measures for Ellipsoid {
    fn bounds(&self) -> (Vec3, Vec3) {
        // The reach is off by a few units in the last place.
        let reach = self.frame().reach_of_ellipsoid(self.half_axes.abs()) * (1.0 + 1e-6);
        (next_down(self.center - reach), next_up(self.center + reach))
    }

    fn hull(&self) -> [Sphere; 2] {
        [Sphere::new(self.center, self.half_axes.abs().max_element()); 2]
    }

    fn as_sphere(&self) -> Option<Sphere> {
        let half = self.half_axes;
        let is_round = (half.x == half.y) & (half.y == half.z);
        is_round.then(|| Sphere::new(self.center, half.x))
    }

    fn is_valid(&self) -> bool {
        self.frame().is_valid() && self.half_axes.is_finite() && self.half_axes.min_element() > 0.0
    }
}

const _: () = {
    assert!(size_of::<Ellipsoid>() == 48);
    assert!(core::mem::offset_of!(Ellipsoid, half_axes) == 16);
    assert!(core::mem::offset_of!(Ellipsoid, rotation) == 32);
};
