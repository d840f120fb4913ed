//! [`Cuboid`]: a box, turned any way. Runs on the GPU and on the CPU.
//!
//! A line is in it where it is between the planes of each of three pairs of sides: from the latest
//! of where it comes between them to the soonest of where it leaves (T. Kay and J. Kajiya, Ray
//! tracing complex scenes, SIGGRAPH 1986). Its origin is moved to where it is nearest to the
//! centre.
//!
//! The textbook's formula is that of I. Quilez (iquilezles.org, *Box - intersection*), in the box's
//! frame.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

#[cfg(not(target_arch = "spirv"))]
use super::Measures;
use super::frame::Frame;
use super::span::{Slab, Span, splat3};
#[cfg(not(target_arch = "spirv"))]
use super::span::{next_down, next_up};
use super::{Shape, Solid};
use crate::lane::{Lane, Lane3};
use crate::ray::Ray;
#[cfg(not(target_arch = "spirv"))]
use crate::sphere::Sphere;
use crate::surface::{Surface, unit};

/// A box: a grain, a cell, a wall.
///
/// ```
/// use spherule_kernel::shape::{Cuboid, Solid};
/// use spherule_kernel::{Ray, Rung, glam::{Quat, Vec3}};
///
/// let cell = Cuboid::new(Vec3::new(0.0, 0.0, -3.0), Vec3::new(2.0, 1.0, 0.5), Quat::IDENTITY);
/// let ray = Ray::new(Vec3::ZERO, Vec3::NEG_Z);
/// assert_eq!(cell.intersect(Rung::Robust, &ray), 2.5);
/// assert!(cell.contains(Vec3::new(2.0, 1.0, -3.5)));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Cuboid {
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

impl Cuboid {
    /// The box around a centre with these halves of its sides, in scene units, turned by a
    /// rotation.
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

impl Solid for Cuboid {
    #[inline(always)]
    fn span<L: Lane>(&self, o: Lane3<L>, d: Lane3<L>) -> Span<L> {
        let (nearest, p, d) = self.frame().line(o, d);
        let half = splat3(o.x, self.half_axes);
        let inside = Slab::of(p.x, d.x, half.x)
            .and(Slab::of(p.y, d.y, half.y))
            .and(Slab::of(p.z, d.z, half.z));
        Span {
            near: nearest + inside.near,
            far: nearest + inside.far,
            meets: inside.near.simd_le(inside.far),
        }
    }

    #[inline]
    fn textbook_span(&self, ray: &Ray) -> Span<f32> {
        let frame = self.frame();
        let (ro, rd) = (
            frame.local(ray.origin - self.center),
            frame.local(ray.direction),
        );
        let m = Vec3::ONE / rd;
        let n = m * ro;
        let k = m.abs() * self.half_axes;
        let (t1, t2) = (-n - k, -n + k);
        let (near, far) = (t1.x.max(t1.y).max(t1.z), t2.x.min(t2.y).min(t2.z));
        Span {
            near,
            far,
            meets: near <= far,
        }
    }

    #[inline]
    fn surface(&self, ray: &Ray, t: f32) -> Surface {
        let frame = self.frame();
        let half = self.half_axes.abs();
        let local = frame.local((ray.origin - self.center) + ray.direction * t);
        // The side that is nearest.
        let away = (local.abs() - half).abs();
        let is_x = (away.x <= away.y) & (away.x <= away.z);
        let is_y = !is_x & (away.y <= away.z);
        let side = if is_x {
            Vec3::X
        } else if is_y {
            Vec3::Y
        } else {
            Vec3::Z
        };
        let side = if local.dot(side) < 0.0 { -side } else { side };
        let on_side = local + side * (half.dot(side.abs()) - local.dot(side));
        let size = self.center.abs().max_element() + half.element_sum();
        Surface {
            point: self.center + frame.global(on_side.clamp(-half, half)),
            normal: unit(frame.global(side)),
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
        let local = self.frame().local(point - self.center);
        local.abs().cmple(self.half_axes.abs()).all()
    }
}

#[cfg(not(target_arch = "spirv"))]
impl Measures for Cuboid {
    fn bounds(&self) -> (Vec3, Vec3) {
        // The reach is off by a few units in the last place.
        let reach = self.frame().reach(self.half_axes.abs()) * (1.0 + 1e-6);
        (next_down(self.center - reach), next_up(self.center + reach))
    }

    fn hull(&self) -> [Sphere; 2] {
        [Sphere::new(self.center, self.half_axes.length()); 2]
    }

    fn is_valid(&self) -> bool {
        self.frame().is_valid() && self.half_axes.is_finite() && self.half_axes.min_element() > 0.0
    }
}

const _: () = {
    assert!(size_of::<Cuboid>() == 48);
    assert!(core::mem::offset_of!(Cuboid, half_axes) == 16);
    assert!(core::mem::offset_of!(Cuboid, rotation) == 32);
};
