//! [`Capsule`]: a cylinder with a half ball at each end. Runs on the GPU and on the CPU.
//!
//! # The part of a line in a capsule
//!
//! Let h be half of the segment, so that its ends are at −h and h from the middle, and p the point
//! of the line that is nearest to the middle. The infinite cylinder is met where
//!
//! > |g|² + A (s − m)² = r²,
//!
//! with q and e what of p and d is perpendicular to h, A = e·e, m = −q·e / A and g = q + m e, the
//! foot of the perpendicular in the cross-section. The height of a point, in halves of the segment,
//! is (p + s d)·h / h·h. A line that enters the cylinder between the heights −1 and 1 enters the
//! capsule there. One that enters it below −1 can only enter the ball around −h, and one above 1
//! the ball around h; the same holds for where lines leave.
//!
//! Every discriminant is r² less the square of a perpendicular, and all is measured from p, so that
//! no digit is lost to a capsule that is small and far away. p is off by 16u|o| as for a
//! [sphere](crate::precision::robust), q and g by a few u(|p| + |h|) more.
//!
//! The textbook's formula is that of I. Quilez (iquilezles.org, *Capsule - intersection*).

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

#[cfg(not(target_arch = "spirv"))]
use super::Measures;
use super::axis::{AxisLine, AxisPoint};
use super::span::Span;
#[cfg(not(target_arch = "spirv"))]
use super::span::{next_down, next_up};
use super::{Shape, Solid};
use crate::lane::{Lane, Lane3};
use crate::ray::Ray;
#[cfg(not(target_arch = "spirv"))]
use crate::sphere::Sphere;
use crate::surface::{Surface, unit};

/// All points within a radius of a segment: a bond, or a rod with round ends.
///
/// ```
/// use spherule_kernel::shape::{Capsule, Solid};
/// use spherule_kernel::{Ray, Rung, glam::Vec3};
///
/// let rod = Capsule::new(Vec3::new(-1.0, 0.0, -3.0), Vec3::new(1.0, 0.0, -3.0), 0.5);
/// let ray = Ray::new(Vec3::ZERO, Vec3::NEG_Z);
/// assert_eq!(rod.intersect(Rung::Robust, &ray), 2.5);
/// assert!(rod.contains(Vec3::new(1.25, 0.0, -3.0)));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Capsule {
    /// One end of the segment, in scene units.
    pub start: Vec3,
    /// The radius, in scene units.
    pub radius: f32,
    /// The other end of the segment, in scene units. If it is the same, the capsule is a sphere.
    pub end: Vec3,
    /// Makes the type as long as the vectors' alignment on GPUs calls for.
    pub unused: f32,
}

/// What of a capsule a line meets at one of the ends of its part.
#[derive(Clone, Copy)]
struct Ball<L: Lane> {
    /// Where the line enters and leaves the ball.
    near: L,
    far: L,
    /// r² less the square of the perpendicular.
    discriminant: L,
}

impl<L: Lane> Ball<L> {
    /// The ball around the end on one side of the middle, −1 or 1.
    #[inline(always)]
    fn at(line: &AxisLine<L>, d: Lane3<L>, side: L, radius_squared: L) -> Self {
        let c = line.p.minus_scaled(line.half, side);
        let b = c.dot(d) * line.inverse;
        let foot = c.minus_scaled(d, b);
        let discriminant = radius_squared - foot.dot(foot);
        let root = AxisLine::root(discriminant * line.inverse);
        Self {
            near: -b - root,
            far: root - b,
            discriminant,
        }
    }
}

impl Capsule {
    /// The capsule with these ends of its segment and this radius, in scene units.
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
}

impl Solid for Capsule {
    #[inline(always)]
    fn span<L: Lane>(&self, o: Lane3<L>, d: Lane3<L>) -> Span<L> {
        let line = AxisLine::of(o, d, self.start, self.end);
        let like = o.x;
        let (zero, one) = (like.splat(0.0), like.splat(1.0));
        let radius_squared = like.splat(self.radius) * like.splat(self.radius);
        let discriminant = radius_squared - line.distance_squared;
        let root = AxisLine::root(discriminant * line.inverse_across);
        let (body_near, body_far) = (line.m - root, line.m + root);

        // A line along the axis comes from and goes to infinite heights.
        let ahead = L::select(line.d_height.simd_lt(zero), -one, one);
        let near_height = line.p_height + body_near * line.d_height;
        let near_height = L::select(line.is_across, near_height, -(ahead + ahead));
        let far_height = line.p_height + body_far * line.d_height;
        let far_height = L::select(line.is_across, far_height, ahead + ahead);
        let near_side = L::select(near_height.simd_lt(zero), -one, one);
        let far_side = L::select(far_height.simd_lt(zero), -one, one);
        let near_ball = Ball::at(&line, d, near_side, radius_squared);
        let far_ball = Ball::at(&line, d, far_side, radius_squared);
        let is_near_body = near_height.abs().simd_le(one);
        let is_far_body = far_height.abs().simd_le(one);
        let near = L::select(is_near_body, body_near, near_ball.near);
        let far = L::select(is_far_body, body_far, far_ball.far);
        let of_near = L::select(is_near_body, discriminant, near_ball.discriminant);
        Span {
            near: line.nearest + near,
            far: line.nearest + L::select(far.simd_gt(near), far, near),
            meets: discriminant.simd_ge(zero) & of_near.simd_ge(zero),
        }
    }

    #[inline]
    fn textbook_span(&self, ray: &Ray) -> Span<f32> {
        let (ba, oa) = (self.end - self.start, ray.origin - self.start);
        let rd = ray.direction;
        let (dd, baba, bard) = (rd.dot(rd), ba.dot(ba), ba.dot(rd));
        let (baoa, rdoa, oaoa) = (ba.dot(oa), rd.dot(oa), oa.dot(oa));
        let a = baba * dd - bard * bard;
        let b = baba * rdoa - baoa * bard;
        let c = baba * oaoa - baoa * baoa - self.radius * self.radius * baba;
        let h = b * b - a * c;
        let mut span = Span::none(0.0);
        if h >= 0.0 {
            let root = h.sqrt();
            let near = (-b - root) / a;
            let far = (-b + root) / a;
            let (y_near, y_far) = (baoa + near * bard, baoa + far * bard);
            span = Span {
                near,
                far,
                meets: true,
            };
            if !((y_near > 0.0) & (y_near < baba)) {
                let oc = if y_near <= 0.0 {
                    oa
                } else {
                    ray.origin - self.end
                };
                let (b, c) = (rd.dot(oc), oc.dot(oc) - self.radius * self.radius);
                let h = b * b - dd * c;
                span.meets = h > 0.0;
                span.near = (-b - h.max(0.0).sqrt()) / dd;
            }
            if !((y_far > 0.0) & (y_far < baba)) {
                let oc = if y_far <= 0.0 {
                    oa
                } else {
                    ray.origin - self.end
                };
                let (b, c) = (rd.dot(oc), oc.dot(oc) - self.radius * self.radius);
                let h = b * b - dd * c;
                span.far = (-b + h.max(0.0).sqrt()) / dd;
            }
        }
        span
    }

    #[inline]
    fn surface(&self, ray: &Ray, t: f32) -> Surface {
        // Relative to an end from the start, as for a sphere.
        let from_start = (ray.origin - self.start) + ray.direction * t;
        let (outward, foot) = AxisPoint::of(from_start, self.end - self.start).outward();
        let (length, radius) = (outward.dot(outward), self.radius * self.radius);
        // A capsule so small and far away that t has no digit of it is seen from the front.
        let is_there = (length * 4.0 >= radius) & (length <= radius * 4.0);
        let normal = if is_there {
            unit(outward)
        } else {
            -unit(ray.direction)
        };
        let size = self.start.abs().max(self.end.abs()).max_element() + self.radius.abs();
        Surface {
            point: self.start + (foot + normal * self.radius),
            normal,
            error: Surface::error(size),
        }
    }

    #[inline]
    fn moved(&self, by: Vec3) -> Self {
        Self::new(self.start + by, self.end + by, self.radius)
    }

    fn thickness(&self) -> f32 {
        self.radius.abs()
    }

    #[inline]
    fn contains(&self, point: Vec3) -> bool {
        let from_start = point - self.start;
        let (outward, _) = AxisPoint::of(from_start, self.end - self.start).outward();
        outward.dot(outward) <= self.radius * self.radius
    }
}

#[cfg(not(target_arch = "spirv"))]
impl Measures for Capsule {
    fn bounds(&self) -> (Vec3, Vec3) {
        let radius = self.radius.abs();
        (
            next_down(self.start.min(self.end) - radius),
            next_up(self.start.max(self.end) + radius),
        )
    }

    fn hull(&self) -> [Sphere; 2] {
        [self.start, self.end].map(|end| Sphere::new(end, self.radius.abs()))
    }

    fn as_sphere(&self) -> Option<Sphere> {
        (self.start == self.end).then(|| Sphere::new(self.start, self.radius))
    }

    fn is_valid(&self) -> bool {
        self.start.is_finite()
            && self.end.is_finite()
            && self.radius.is_finite()
            && self.radius > 0.0
    }
}

const _: () = {
    assert!(size_of::<Capsule>() == 32);
    assert!(core::mem::offset_of!(Capsule, radius) == 12);
    assert!(core::mem::offset_of!(Capsule, end) == 16);
};
