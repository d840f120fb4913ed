//! [`Slabs`]: which boxes of a node a ray may meet. Runs on the GPU and on the CPU.
//!
//! # No hit is lost
//!
//! Boxes are rounded outwards. Let u = 2⁻²⁴, P a node's corner, v a side's distance from it, O the
//! ray's origin, i = 1/d and s the start of the ray's interval. The ray meets a side's plane at
//!
//! > v i + (P i + (−O i − s ∓ S)),
//!
//! - This is computed to within 6u((|P| + |O| + v)|i| + |s|), fused or not, with division off by
//!   two units in the last place.
//! - |P| is at most twice the size of the tree's [`Extent`], and v at most twice its sides. L and H
//!   are its corners.
//! - So one S serves all nodes: per axis 16u((max(|L|, |H|) + |O| + 2(H − L))|i| + |s|). Far planes
//!   are moved away by it, and near planes nearer.
//! - A component of the direction below 2⁻⁶⁴ of the largest is replaced by 2⁻⁶⁴ of it: the ray is
//!   then off by 2⁻⁶⁴ of the distance it goes.
//!
//! The rungs below [`Rung::Compensated`](crate::Rung::Compensated) may find hits where exact
//! arithmetic has none, and must find the same hits with a tree as without. So each box is widened
//! by what the rung may be off. With D the distance from O to the farthest corner of the extent:
//! * [`robust`](crate::precision::robust): 32u D. The foot of its perpendicular is off by 16u|o|.
//!   An error e = 5u o·o + u r² + u|c| in c puts its t off by at most 16u max(|o|, r) where |b| is
//!   at least |o|/2, or else r is at least 0.86|o|. In that case let s = |q|/|d|. Both roots are
//!   within s of the origin, so that |p·p − r²| ≤ 3s² + |c| at either; and c/q is off by e/s, which
//!   changes p·p by at most 4e where s² ≥ e. So a hit is within 8e/r of the sphere.
//! * [`textbook`](crate::precision::textbook): √(r² + 24u D²) − r, with r the smallest radius. Its
//!   hits are on a sphere whose r² is off by 24u D².
//!
//! Coordinates must be below 2⁶⁰.

use glam::{UVec3, UVec4, Vec3};
use spirv_std::arch::IndexUnchecked;

use super::node::{Extent, Node};
use crate::arithmetic::U;
use crate::cull::discriminant::power_of_two_under;
use crate::gpu::instructions::{larger, smaller};
use crate::lane::{Lane, Lane3};
use crate::ray::Ray;

/// A ray, prepared for testing it against one box after another.
#[derive(Clone, Copy, Debug)]
pub struct Slabs {
    /// One over the direction, after scaling its largest component to between 1 and 2.
    pub inverse: Vec3,
    /// What is added to the parameters of near planes: −O i − s − S.
    pub near: Vec3,
    /// What is added to the parameters of far planes: −O i − s + S.
    pub far: Vec3,
    /// For each axis, which of a node's rows of sides the ray meets first.
    pub near_rows: UVec3,
    /// A parameter t of the ray is t · `unit` − `start` in the planes' parameters.
    pub unit: f32,
    /// The start of the ray's interval, times `unit`. In the planes' parameters it is zero.
    pub start: f32,
    /// Bit 2 + k is set if the direction is not negative along axis k.
    pub octant: u32,
}

impl Slabs {
    /// Prepares a ray for a tree of this extent.
    #[inline(always)]
    #[must_use]
    pub fn of(rung: u32, ray: &Ray, world: &Extent) -> Self {
        Self::widened(ray, world, world.widening(rung, ray.origin))
    }

    /// Prepares a ray for a tree of this extent, whose boxes must be so much wider, in scene units.
    #[inline(always)]
    #[must_use]
    pub fn widened(ray: &Ray, world: &Extent, widening: f32) -> Self {
        let scale = power_of_two_under(ray.direction);
        // 1 / scale: the exponents add up to twice that of one.
        let unit = f32::from_bits(0x7f00_0000_u32.wrapping_sub(scale.to_bits()));
        let d = ray.direction * scale;
        let inverse = Vec3::new(reciprocal(d.x), reciprocal(d.y), reciprocal(d.z));
        let size = world.low.abs().max(world.high.abs())
            + ray.origin.abs()
            + (world.high - world.low) * 2.0;
        let off = size * (16.0 * U) + widening;
        let start = ray.t_min * unit;
        let first = -ray.origin * inverse - start;
        let slack = inverse.abs() * off + start.abs() * (16.0 * U);
        let backwards = |x: f32| if x < 0.0 { 1 } else { 0 };
        let backwards = UVec3::new(backwards(d.x), backwards(d.y), backwards(d.z));
        Self {
            inverse,
            near: first - slack,
            far: first + slack,
            near_rows: UVec3::new(0, 1, 2) + backwards * 3,
            unit,
            start,
            octant: 28 - (backwards.x << 2 | backwards.y << 3 | backwards.z << 4),
        }
    }

    /// The end of a ray in the planes' parameters, plus what a box test may be off by.
    #[inline]
    #[must_use]
    pub fn widened_end(end: f32) -> f32 {
        end + end.abs() * (16.0 * U)
    }

    /// The children that the ray may meet before `end`: bit 4c is set if it may meet child c.
    #[inline]
    pub(super) fn meets(&self, corner: Vec3, sides: &[UVec4; 6], end: f32) -> u32 {
        let boxes = Boxes {
            inverse: self.inverse,
            near: corner.times_plus(self.inverse, self.near),
            far: corner.times_plus(self.inverse, self.far),
            end: Self::widened_end(end),
        };
        let row = |row: u32| {
            // SAFETY: `near_rows` are 0 or 3, 1 or 4, and 2 or 5: all are below 6.
            load(unsafe { sides.index_unchecked(row as usize) })
        };
        let rows = self.near_rows;
        let near = by_word(row(rows.x), row(rows.y), row(rows.z));
        let far = by_word(row(3 - rows.x), row(5 - rows.y), row(7 - rows.z));
        // Shifts in the sign and three more bits of each gap with one instruction. The three bits
        // are dropped below.
        let mut gaps = boxes.gap(upper(near[3]), upper(far[3])) >> 28;
        gaps = gaps << 4 | boxes.gap(upper(near[2]), upper(far[2])) >> 28;
        gaps = gaps << 4 | boxes.gap(upper(near[1]), upper(far[1])) >> 28;
        gaps = gaps << 4 | boxes.gap(upper(near[0]), upper(far[0])) >> 28;
        gaps = gaps << 4 | boxes.gap(lower(near[3]), lower(far[3])) >> 28;
        gaps = gaps << 4 | boxes.gap(lower(near[2]), lower(far[2])) >> 28;
        gaps = gaps << 4 | boxes.gap(lower(near[1]), lower(far[1])) >> 28;
        gaps = gaps << 4 | boxes.gap(lower(near[0]), lower(far[0])) >> 28;
        !gaps >> 3 & FIRST_OF_FOUR
    }

    /// The children's bits in the order in which they are visited, the first being the highest: the
    /// bit 4c of child c moves to 4c XOR `octant`.
    #[inline]
    pub(super) fn in_order(&self, children: u32) -> u32 {
        let mut bits = children;
        if self.octant & 4 != 0 {
            bits = ((bits & 0x0101_0101) << 4) | ((bits >> 4) & 0x0101_0101);
        }
        if self.octant & 8 != 0 {
            bits = ((bits & 0x0011_0011) << 8) | ((bits >> 8) & 0x0011_0011);
        }
        if self.octant & 16 != 0 {
            bits = bits.rotate_left(16);
        }
        bits
    }
}

/// Bit 4c of each child c.
pub(super) const FIRST_OF_FOUR: u32 = 0x1111_1111;

/// A number along each axis, in which boxes are tested: of one box, or of several side by side.
pub trait Sides: Copy {
    /// A number of each box.
    type Number;

    /// `self` · `factor` + `term` along each axis, rounded once or twice.
    fn times_plus(self, factor: Self, term: Self) -> Self;

    /// The largest of the three and zero. None may be NaN.
    fn largest_or_zero(self) -> Self::Number;

    /// The smallest of the three and `end`; if some are below zero, any of those. None may be NaN.
    fn smallest(self, end: Self::Number) -> Self::Number;
}

/// Several numbers side by side in which boxes are tested.
pub trait BoxLane: Lane {
    /// The larger of two numbers. None may be NaN.
    fn larger(self, other: Self) -> Self;

    /// The smaller of two numbers. None may be NaN.
    fn smaller(self, other: Self) -> Self;
}

impl<L: BoxLane> Sides for Lane3<L> {
    type Number = L;

    #[inline(always)]
    fn times_plus(self, factor: Self, term: Self) -> Self {
        Self {
            x: self.x.mul_add_rough(factor.x, term.x),
            y: self.y.mul_add_rough(factor.y, term.y),
            z: self.z.mul_add_rough(factor.z, term.z),
        }
    }

    #[inline(always)]
    fn largest_or_zero(self) -> L {
        let zero = self.x.splat(0.0);
        self.x.larger(self.y).larger(self.z.larger(zero))
    }

    #[inline(always)]
    fn smallest(self, end: L) -> L {
        self.x.smaller(self.y).smaller(self.z.smaller(end))
    }
}

/// The bits of floats that are not negative are ordered as the floats are, and a GPU compares three
/// integers at once. Negative floats are negative integers: they never win against zero where the
/// largest is taken, and where the smallest is taken any of them will do.
impl Sides for Vec3 {
    type Number = f32;

    #[inline]
    fn times_plus(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }

    #[inline]
    fn largest_or_zero(self) -> f32 {
        let bits = |x: f32| x.to_bits() as i32;
        let largest = larger(larger(larger(bits(self.x), bits(self.y)), bits(self.z)), 0);
        f32::from_bits(largest as u32)
    }

    #[inline]
    fn smallest(self, end: f32) -> f32 {
        let bits = |x: f32| x.to_bits() as i32;
        let smallest = smaller(smaller(bits(self.x), bits(self.y)), bits(self.z));
        f32::from_bits(smaller(smallest, bits(end)) as u32)
    }
}

/// A ray in the coordinates of boxes: a side at v has the parameter v · `inverse` + `near` or
/// `far`.
#[derive(Clone, Copy, Debug)]
pub struct Boxes<S: Sides> {
    /// One over the direction.
    pub inverse: S,
    /// What is added for near planes.
    pub near: S,
    /// What is added for far planes.
    pub far: S,
    /// The ray's end, as [`Slabs::widened_end`] returns it.
    pub end: S::Number,
}

impl<S: Sides<Number: Copy>> Boxes<S> {
    /// Where the ray enters boxes and where it leaves them, from their near and far sides. It
    /// misses those that it leaves before it enters.
    #[inline(always)]
    #[must_use]
    pub fn enter_and_leave(&self, near: S, far: S) -> (S::Number, S::Number) {
        let near = near.times_plus(self.inverse, self.near);
        let far = far.times_plus(self.inverse, self.far);
        (near.largest_or_zero(), far.smallest(self.end))
    }
}

impl Boxes<Vec3> {
    /// The length of the ray's interval in a box, as the bits of a float; negative if the ray
    /// misses the box.
    #[inline]
    fn gap(&self, near: Vec3, far: Vec3) -> u32 {
        let (enter, leave) = self.enter_and_leave(near, far);
        (leave - enter).to_bits()
    }
}

/// Groups the words of three rows: element k holds word k of each row.
#[inline]
fn by_word(x: UVec4, y: UVec4, z: UVec4) -> [[u32; 3]; 4] {
    [
        [x.x, y.x, z.x],
        [x.y, y.y, z.y],
        [x.z, y.z, z.z],
        [x.w, y.w, z.w],
    ]
}

#[inline]
fn lower([x, y, z]: [u32; 3]) -> Vec3 {
    Vec3::new(Node::lower(x), Node::lower(y), Node::lower(z))
}

#[inline]
fn upper([x, y, z]: [u32; 3]) -> Vec3 {
    Vec3::new(Node::upper(x), Node::upper(y), Node::upper(z))
}

/// Loads all four words at once; compilers for GPUs do not merge four loads.
#[inline]
pub(super) fn load(words: &UVec4) -> UVec4 {
    *words
}

/// 1/x; for |x| up to 2⁻⁶⁴, 2⁶⁴ with the sign of x.
#[inline]
fn reciprocal(x: f32) -> f32 {
    const SMALLEST: f32 = 1.0 / (1_u128 << 64) as f32;
    const LARGEST: f32 = (1_u128 << 64) as f32;
    if x.abs() > SMALLEST {
        1.0 / x
    } else if x < 0.0 {
        -LARGEST
    } else {
        LARGEST
    }
}
