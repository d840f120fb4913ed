//! [`Cone`]: a cone with flat ends, cut off or up to its tip. Runs on the GPU and on the CPU.
//!
//! # The part of a line in a cone
//!
//! At the height y, from −1 to 1 between the ends, the radius is ρ = R + K y. Let s count from
//! where the line is nearest to the axis, at the distance g, E = e·e with e what of d is across the
//! axis, W the radius at that height, and k what ρ grows by with s. The line is in the double cone
//! where
//!
//! > g² + E s² ≤ (W + k s)²,
//!
//! a quadratic with the roots (W k ± √Δ) / (E − k²), Δ = E (W² − g²) + k² g². One root is computed
//! as a sum of numbers of one sign, and the other as the quotient of their product by it. Where E >
//! k² the line is in one of the two cones, between the roots. Otherwise it is in both, up to one
//! root and from the other on; the cone with ρ ≥ 0 is the one in which ρ grows. Then it must be
//! between the planes of the ends, as in a [cylinder](super::cylinder).
//!
//! Where E < k² the line may be nearest to the axis far away. Then s counts from where it is
//! nearest to the middle, with q across the axis there and W the radius at its height: the roots
//! are (W k − q·e ± √Δ) / (E − k²), Δ = k (k q·q − 2W q·e) + E (W² − g²).
//!
//! The textbook's formula is that of I. Quilez (iquilezles.org, *Capped cone - intersection*).

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

#[cfg(not(target_arch = "spirv"))]
use super::Measures;
#[cfg(not(target_arch = "spirv"))]
use super::axis::ends;
use super::axis::{AxisLine, AxisPoint};
use super::span::{FAR, Slab, Span};
#[cfg(not(target_arch = "spirv"))]
use super::span::{next_down, next_up};
use super::{Shape, Solid};
use crate::lane::{Lane, Lane3};
use crate::ray::Ray;
#[cfg(not(target_arch = "spirv"))]
use crate::sphere::Sphere;
use crate::surface::{Surface, unit};

/// A cone from one disc to another: an arrow's head, a tapered rod.
///
/// ```
/// use spherule_kernel::shape::{Cone, Solid};
/// use spherule_kernel::{Ray, Rung, glam::Vec3};
///
/// let head = Cone::new(Vec3::new(-1.0, 0.0, -3.0), Vec3::new(1.0, 0.0, -3.0), 1.0, 0.0);
/// let ray = Ray::new(Vec3::ZERO, Vec3::NEG_Z);
/// assert_eq!(head.intersect(Rung::Double, &ray), 2.5);
/// assert!(!head.contains(Vec3::new(0.5, 0.5, -3.0)));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Cone {
    /// The middle of one end, in scene units.
    pub start: Vec3,
    /// The radius there, in scene units; zero for a tip.
    pub start_radius: f32,
    /// The middle of the other end, in scene units; not the same.
    pub end: Vec3,
    /// The radius there, in scene units; zero for a tip, but not both.
    pub end_radius: f32,
}

impl Cone {
    /// The cone with these middles of its ends and these radii there, in scene units.
    #[inline]
    #[must_use]
    pub const fn new(start: Vec3, end: Vec3, start_radius: f32, end_radius: f32) -> Self {
        Self {
            start,
            start_radius,
            end,
            end_radius,
        }
    }

    #[inline]
    pub(crate) fn from_shape(shape: &Shape) -> Self {
        let (start, end) = (shape.first.truncate(), shape.second.truncate());
        Self::new(start, end, shape.first.w, shape.second.w)
    }

    #[inline]
    pub(crate) fn to_shape(self) -> Shape {
        Shape {
            first: self.start.extend(self.start_radius),
            second: self.end.extend(self.end_radius),
            third: Vec4::new(0.0, 0.0, 0.0, Self::KIND as f32),
        }
    }

    /// The radius at a share of the way from the start to the end.
    #[inline]
    fn radius_at(&self, share: f32) -> f32 {
        self.start_radius + (self.end_radius - self.start_radius) * share
    }
}

impl Solid for Cone {
    #[inline(always)]
    fn span<L: Lane>(&self, o: Lane3<L>, d: Lane3<L>) -> Span<L> {
        let line = AxisLine::of(o, d, self.start, self.end);
        let like = o.x;
        let (zero, one, half) = (like.splat(0.0), like.splat(1.0), like.splat(0.5));
        let (at_start, at_end) = (like.splat(self.start_radius), like.splat(self.end_radius));
        let growth = (at_end - at_start) * half;
        let k = growth * line.d_height;
        let (e, gg) = (line.across, line.distance_squared);
        let a = e - k * k;
        let is_wide = a.simd_gt(zero);
        // Where the line is nearly along the axis, the place where it is nearest to it is far away:
        // then s counts from p, where the distance is that of q.
        let from = L::select(is_wide, line.m, zero);
        let (qe, qq) = (-(line.m * e), gg + line.m * line.m * e);
        let w = (at_start + at_end) * half + growth * (line.p_height + from * line.d_height);
        let c = L::select(is_wide, gg, qq) - w * w;
        let b = w * k - L::select(is_wide, zero, qe);
        let wide = k * k * gg + e * (w * w - gg);
        let narrow = k * (k * qq - (w + w) * qe) + e * (w * w - gg);
        let discriminant = L::select(is_wide, wide, narrow);
        let root = AxisLine::root(discriminant);
        let q = b + L::select(b.simd_lt(zero), -root, root);
        let has_q = q.abs().simd_gt(zero);
        let inner = L::select(has_q, c / L::select(has_q, q, one), zero);
        // Beyond that it is as good as infinite: the cone is met from within its slope.
        let is_finite = a.abs().simd_gt(q.abs() * like.splat(1.0 / FAR));
        let grows = k.simd_gt(zero);
        let infinite = L::select(grows, like.splat(-FAR), like.splat(FAR));
        let outer = L::select(is_finite, q / L::select(is_finite, a, one), infinite);
        let is_first = outer.simd_lt(inner);
        let (low, high) = (
            L::select(is_first, outer, inner),
            L::select(is_first, inner, outer),
        );
        // The cone with ρ ≥ 0, where the line is in both.
        let is_in_one = is_wide & is_finite;
        let near = L::select(grows, high, like.splat(-FAR));
        let far = L::select(grows, like.splat(FAR), low);
        let near = from + L::select(is_in_one, low, near);
        let far = from + L::select(is_in_one, high, far);
        // A cylinder, and a line along its axis.
        let is_constant = !(k.abs().simd_gt(zero) | e.simd_gt(zero));
        let near = L::select(is_constant, like.splat(-FAR), near);
        let far = L::select(is_constant, like.splat(FAR), far);
        let meets = discriminant.simd_ge(zero) & (!is_constant | c.simd_le(zero));

        let slab = Slab::of(line.p_height, line.d_height, one);
        let part = Slab { near, far }.and(slab);
        Span {
            near: line.nearest + part.near,
            far: line.nearest + part.far,
            meets: meets & part.near.simd_le(part.far),
        }
    }

    #[inline]
    fn textbook_span(&self, ray: &Ray) -> Span<f32> {
        let (ba, oa) = (self.end - self.start, ray.origin - self.start);
        let rd = ray.direction;
        let (m0, m1, m2) = (ba.dot(ba), oa.dot(ba), rd.dot(ba));
        let (m3, m5, dd) = (rd.dot(oa), oa.dot(oa), rd.dot(rd));
        let (ra, rr) = (self.start_radius, self.start_radius - self.end_radius);
        let hy = m0 + rr * rr;
        let k2 = m0 * m0 * dd - m2 * m2 * hy;
        let k1 = m0 * m0 * m3 - m1 * m2 * hy + m0 * ra * (rr * m2);
        let k0 = m0 * m0 * m5 - m1 * m1 * hy + m0 * ra * (2.0 * rr * m1 - m0 * ra);
        let h = k1 * k1 - k2 * k0;
        let root = h.max(0.0).sqrt();
        let (one, other) = ((-k1 - root) / k2, (-k1 + root) / k2);
        let (first, last) = (one.min(other), one.max(other));
        let (near, far) = if k2 > 0.0 {
            (first, last)
        } else if rr * m2 < 0.0 {
            (last, FAR)
        } else {
            (-FAR, first)
        };
        let (low, high) = (-m1 / m2, (m0 - m1) / m2);
        let (near, far) = (near.max(low.min(high)), far.min(low.max(high)));
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
        let outward = point.from_start - axis * point.share;
        let long = axis.dot(axis).sqrt();
        let along = unit(axis);
        let largest = self.start_radius.max(self.end_radius);
        let size = self.start.abs().max(self.end.abs()).max_element() + largest;
        // The surface that is nearer to the point.
        let beyond = (point.share - 0.5).abs() - 0.5;
        let slope = (self.end_radius - self.start_radius) / long;
        let radius = self.radius_at(point.share.clamp(0.0, 1.0));
        let of_side = (outward.dot(outward).sqrt() - radius).abs() / (1.0 + slope * slope).sqrt();
        let side = if point.share < 0.5 { 0.0 } else { 1.0 };
        let is_end = ((beyond * long).abs() < of_side) & (self.radius_at(side) > 0.0);
        let (normal, from_start) = if is_end {
            (along * (2.0 * side - 1.0), outward + axis * side)
        } else {
            let away = unit(outward);
            // At a tip there is no other.
            let away = if away.dot(away) > 0.0 {
                away
            } else {
                -unit(ray.direction)
            };
            (
                unit(away - along * slope),
                axis * point.share + away * radius,
            )
        };
        Surface {
            point: self.start + from_start,
            normal,
            error: Surface::error(size),
        }
    }

    #[inline]
    fn moved(&self, by: Vec3) -> Self {
        Self::new(
            self.start + by,
            self.end + by,
            self.start_radius,
            self.end_radius,
        )
    }

    #[inline]
    fn thickness(&self) -> f32 {
        let axis = self.end - self.start;
        let largest = self.start_radius.max(self.end_radius);
        largest.min(0.5 * axis.dot(axis).sqrt())
    }

    #[inline]
    fn contains(&self, point: Vec3) -> bool {
        let point = AxisPoint::of(point - self.start, self.end - self.start);
        let outward = point.from_start - point.axis * point.share;
        let radius = self.radius_at(point.share);
        (0.0..=1.0).contains(&point.share) && outward.dot(outward) <= radius * radius
    }
}

#[cfg(not(target_arch = "spirv"))]
impl Measures for Cone {
    fn bounds(&self) -> (Vec3, Vec3) {
        let (low, high) = ends(
            self.end - self.start,
            (self.start, self.start_radius),
            (self.end, self.end_radius),
        );
        (next_down(low), next_up(high))
    }

    fn hull(&self) -> [Sphere; 2] {
        [
            Sphere::new(self.start, self.start_radius.abs()),
            Sphere::new(self.end, self.end_radius.abs()),
        ]
    }

    fn is_valid(&self) -> bool {
        let (one, other) = (self.start_radius, self.end_radius);
        let is_finite = self.start.is_finite() & self.end.is_finite() & (one + other).is_finite();
        is_finite & (one.min(other) >= 0.0) & (one.max(other) > 0.0) & (self.start != self.end)
    }
}

const _: () = {
    assert!(size_of::<Cone>() == 32);
    assert!(core::mem::offset_of!(Cone, start_radius) == 12);
    assert!(core::mem::offset_of!(Cone, end) == 16);
    assert!(core::mem::offset_of!(Cone, end_radius) == 28);
};
