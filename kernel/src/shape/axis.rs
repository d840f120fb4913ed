//! [`AxisLine`]: a line, measured by the axis of a round shape. Runs on the GPU and on the CPU.

use glam::Vec3;

use super::span::splat3;
use crate::lane::{Lane, Lane3};

/// A line, measured by a segment: from its middle, in parameters that count from the point of the
/// line that is nearest to the middle, and in heights that are −1 and 1 at the segment's ends.
///
/// The origin is moved there first, so that no digit is lost to a shape that is small and far away.
/// That point is off by 16u|o| as the foot is for a [sphere](crate::precision::robust), and what is
/// across the axis by a few u(|p| + |h|) more.
#[derive(Clone, Copy)]
pub(super) struct AxisLine<L: Lane> {
    /// The line's parameter of the point that is nearest to the middle.
    pub(super) nearest: L,
    /// That point, from the middle.
    pub(super) p: Lane3<L>,
    /// Half of the segment: its ends are at −h and h.
    pub(super) half: Lane3<L>,
    /// 1/d·d.
    pub(super) inverse: L,
    /// The height of p, and that of d.
    pub(super) p_height: L,
    pub(super) d_height: L,
    /// e·e, where e is what of d is across the axis; zero if the line is along the axis.
    pub(super) across: L,
    /// Whether it is not; then one over that, otherwise zero.
    pub(super) is_across: L::Mask,
    pub(super) inverse_across: L,
    /// The parameter where the line is nearest to the axis.
    pub(super) m: L,
    /// The square of its distance there.
    pub(super) distance_squared: L,
}

impl<L: Lane> AxisLine<L> {
    /// The line with origin `o` and direction `d`, by the segment from `start` to `end`.
    // No closures: in lanes they would be compiled without the caller's instructions.
    #[inline(always)]
    pub(super) fn of(o: Lane3<L>, d: Lane3<L>, start: Vec3, end: Vec3) -> Self {
        let like = o.x;
        let (zero, one, half_of) = (like.splat(0.0), like.splat(1.0), like.splat(0.5));
        let (start, end) = (splat3(like, start), splat3(like, end));
        let half = end.minus(start).scaled(half_of);
        let middle = o.minus(start).plus(o.minus(end)).scaled(half_of);
        let a = d.dot(d);
        let inverse = one / a;
        let nearest = -(middle.dot(d) * inverse);
        let p = middle.minus_scaled(d, -nearest);
        let half_squared = half.dot(half);
        let is_long = half_squared.simd_gt(zero);
        let inverse_half = L::select(is_long, one / half_squared, zero);
        let (p_height, d_height) = (p.dot(half) * inverse_half, d.dot(half) * inverse_half);
        let q = p.minus_scaled(half, p_height);
        let e = d.minus_scaled(half, d_height);
        let across = e.dot(e);
        // Below, it is all rounding.
        let along = like.splat(2.0 * L::ROUNDOFF);
        let is_across = across.simd_gt(a * along * along);
        let inverse_across = L::select(is_across, one / across, zero);
        let m = -(q.dot(e) * inverse_across);
        let foot = q.minus_scaled(e, -m);
        Self {
            nearest,
            p,
            half,
            inverse,
            p_height,
            d_height,
            across: L::select(is_across, across, zero),
            is_across,
            inverse_across,
            m,
            distance_squared: foot.dot(foot),
        }
    }

    /// The square root of a discriminant, zero if that is negative.
    #[inline(always)]
    pub(super) fn root(discriminant: L) -> L {
        let zero = discriminant.splat(0.0);
        L::select(discriminant.simd_gt(zero), discriminant, zero).sqrt()
    }
}

/// A point of a ray, measured by a segment, for the normal there.
pub(super) struct AxisPoint {
    /// The point, from the segment's start.
    pub(super) from_start: Vec3,
    /// The segment.
    pub(super) axis: Vec3,
    /// How far along the segment the point is: 0 at its start, 1 at its end.
    pub(super) share: f32,
}

impl AxisPoint {
    #[inline]
    pub(super) fn of(from_start: Vec3, axis: Vec3) -> Self {
        let squared = axis.dot(axis);
        let share = if squared > 0.0 {
            from_start.dot(axis) / squared
        } else {
            0.0
        };
        Self {
            from_start,
            axis,
            share,
        }
    }

    /// From the point of the segment that is nearest, and that from the start.
    #[inline]
    pub(super) fn outward(&self) -> (Vec3, Vec3) {
        let foot = self.axis * self.share.clamp(0.0, 1.0);
        (self.from_start - foot, foot)
    }
}

/// The lowest and the highest coordinates of two discs across an axis, each around a point.
#[cfg(not(target_arch = "spirv"))]
pub(super) fn ends(
    axis: Vec3,
    (start, of_start): (Vec3, f32),
    (end, of_end): (Vec3, f32),
) -> (Vec3, Vec3) {
    let axis = axis.as_dvec3();
    let length = axis.length();
    // A disc with the unit normal n reaches r √(1 − n²) along each axis; a few units in the last
    // place are added.
    let n = if length > 0.0 { axis / length } else { axis };
    let across = (glam::DVec3::ONE - n * n).max(glam::DVec3::ZERO);
    let across = glam::DVec3::from_array(across.to_array().map(f64::sqrt));
    let reach = |radius: f32| (across * f64::from(radius.abs())).as_vec3() * (1.0 + 1e-6);
    let (of_start, of_end) = (reach(of_start), reach(of_end));
    (
        (start - of_start).min(end - of_end),
        (start + of_start).max(end + of_end),
    )
}
