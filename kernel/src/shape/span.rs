//! [`Span`]: the part of a line that is in a convex shape. Runs on the GPU and on the CPU.

use glam::Vec3;

use crate::hit::Hit;
use crate::lane::{Lane, Lane3};
use crate::precision::root::choose_root;
use crate::ray::Ray;

/// The part of a line that is in a convex shape, in lanes: from one parameter to another.
#[derive(Clone, Copy, Debug)]
pub struct Span<L: Lane> {
    /// Where the line enters the shape.
    pub near: L,
    /// Where it leaves the shape; not below `near`.
    pub far: L,
    /// Whether the line meets the shape.
    pub meets: L::Mask,
}

impl<L: Lane> Span<L> {
    /// No part of the line; `like` says how many lanes there are.
    #[inline(always)]
    #[must_use]
    pub fn none(like: L) -> Self {
        let zero = like.splat(0.0);
        Self {
            near: zero,
            far: zero,
            meets: zero.simd_lt(zero),
        }
    }
}

#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
impl Span<f64> {
    /// Rounded to 32 bits.
    #[inline(always)]
    #[must_use]
    pub fn narrowed(self) -> Span<f32> {
        Span {
            near: self.near as f32,
            far: self.far as f32,
            meets: self.meets,
        }
    }
}

impl Span<f32> {
    /// Where `ray` meets the surface first within its interval; [`Hit::NONE_T`] if it does not.
    #[inline]
    #[must_use]
    pub fn first(&self, ray: &Ray) -> f32 {
        let t = choose_root(self.near, self.far, ray);
        if self.meets { t } else { Hit::NONE_T }
    }

    /// The same for a ray that starts on the surface: where it leaves the shape if it goes into it.
    ///
    /// One of the two ends is where the ray starts, and rounding would say whether it is in the
    /// interval. A ray that goes out has the shape behind it; one that goes in has it ahead. Which
    /// it is, the middle of the span says, unless that is as short as the rounding.
    #[inline]
    #[must_use]
    pub fn exit(&self, ray: &Ray) -> f32 {
        let goes_in = (self.near + self.far > 0.0) & (self.near < self.far);
        if self.meets & goes_in & (self.far >= ray.t_min) & (self.far < ray.t_max) {
            self.far
        } else {
            Hit::NONE_T
        }
    }
}

/// The part of a line between two parallel planes, in lanes.
#[derive(Clone, Copy)]
pub(super) struct Slab<L: Lane> {
    pub(super) near: L,
    pub(super) far: L,
}

/// What stands for an infinite parameter: no larger number is finite on all rungs.
pub(super) const FAR: f32 = 1e30;

impl<L: Lane> Slab<L> {
    /// Between −half and half of a coordinate, which is `p` at the parameter zero and grows by `d`.
    /// A line beside the planes that never comes between them is so from later on than it was.
    #[inline(always)]
    pub(super) fn of(p: L, d: L, half: L) -> Self {
        let (zero, one, far) = (p.splat(0.0), p.splat(1.0), p.splat(FAR));
        // Beyond that parameter it is as good as beside them forever.
        let moves = d.abs().simd_gt((p.abs() + half) * p.splat(1.0 / FAR));
        let slope = L::select(moves, d, one);
        let (low, high) = ((-half - p) / slope, (half - p) / slope);
        let is_upwards = slope.simd_gt(zero);
        let otherwise = L::select(p.abs().simd_le(half), far, -far);
        let near = L::select(is_upwards, low, high);
        let far = L::select(is_upwards, high, low);
        Self {
            near: L::select(moves, near, -otherwise),
            far: L::select(moves, far, otherwise),
        }
    }

    /// The part that is in both.
    #[inline(always)]
    pub(super) fn and(self, other: Self) -> Self {
        Self {
            near: L::select(self.near.simd_gt(other.near), self.near, other.near),
            far: L::select(self.far.simd_lt(other.far), self.far, other.far),
        }
    }
}

/// A vector in every lane; `like` says how many there are.
#[inline(always)]
pub(super) fn splat3<L: Lane>(like: L, vector: Vec3) -> Lane3<L> {
    Lane3 {
        x: like.splat(vector.x),
        y: like.splat(vector.y),
        z: like.splat(vector.z),
    }
}

/// Each coordinate's next float up, so that a sum that was rounded is a bound.
#[cfg(not(target_arch = "spirv"))]
#[inline]
pub(super) fn next_up(vector: Vec3) -> Vec3 {
    Vec3::from_array(vector.to_array().map(f32::next_up))
}

/// Each coordinate's next float down.
#[cfg(not(target_arch = "spirv"))]
#[inline]
pub(super) fn next_down(vector: Vec3) -> Vec3 {
    Vec3::from_array(vector.to_array().map(f32::next_down))
}
