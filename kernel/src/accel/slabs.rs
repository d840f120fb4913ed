//! [`Slabs`]: which boxes of a node a ray may meet. Runs on the GPU and on the CPU.
//!
//! # No hit is lost
//!
//! Boxes are rounded outwards. With u = 2⁻²⁴, P a node's corner, v a side's distance from it, O the ray's origin
//! and i = 1/d, a plane is met at
//!
//! > v i + (P i + (−O i − s ∓ S)),
//!
//! s the start of the ray, computed to within 5u((|P| + |O| + v)|i| + |s|), fused or not, division off by two units. Neither |P| nor v
//! is beyond twice the size or the sides of the tree's [`Extent`], whose corners are L and H, so that one S serves all nodes: per
//! axis 16u((max(|L|, |H|) + |O| + 2(H − L))|i| + |s|), by which far planes are moved away and near ones nearer. A direction's
//! component below 2⁻⁶⁴ of its largest is taken for that: the ray is off by 2⁻⁶⁴ of its way then.
//!
//! The rungs below [`Rung::Compensated`] find hits where there are none, and a box must not keep them
//! from what they find without a tree. With D the distance from O to the farthest
//! corner of all, each box is wider by what the rung may be off:
//! * [`robust`](crate::precision::robust): 32u D. The foot of its perpendicular is off by 12u|o|, and
//!   its t by what an error of 4u(o·o + r²) in c makes of it: 16u max(|o|, r) at most, |b| being at
//!   least |o|/2 or else r at least 0.86|o|.
//! * [`textbook`](crate::precision::textbook): √(r² + 24u D²) − r, r the smallest radius. Its hits are on the sphere
//!   whose r² is off by that.
//!
//! Coordinates are to be below 2⁶⁰.

use glam::{UVec3, UVec4, Vec3};
use spirv_std::arch::IndexUnchecked;

use super::node::{Extent, Node};
use crate::arithmetic::U;
use crate::cull::discriminant::power_of_two_under;
use crate::gpu::instructions::{larger, smaller};
use crate::ray::Ray;

/// What stays the same of a ray as it meets box after box.
#[derive(Clone, Copy, Debug)]
pub struct Slabs {
    /// One over the direction, whose largest component was brought between 1 and 2.
    pub inverse: Vec3,
    /// What is added where a box begins, and where it ends.
    pub near: Vec3,
    /// As `near`.
    pub far: Vec3,
    /// Which of a node's rows of sides a ray meets first, an axis each.
    pub near_rows: UVec3,
    /// What a parameter of the ray is, times this, less `start`, as the planes count it.
    pub unit: f32,
    /// The start of the ray's interval, times `unit`: to the planes it is zero.
    pub start: f32,
    /// Bit 2 + k set where the direction is positive along axis k.
    pub octant: u32,
}

impl Slabs {
    /// Of a ray in a tree of this extent.
    #[inline(always)]
    #[must_use]
    pub fn of(rung: u32, ray: &Ray, world: &Extent) -> Self {
        let scale = power_of_two_under(ray.direction);
        // One over it: exponents that add up to those of one.
        let unit = f32::from_bits(0x7f00_0000_u32.wrapping_sub(scale.to_bits()));
        let d = ray.direction * scale;
        let inverse = Vec3::new(reciprocal(d.x), reciprocal(d.y), reciprocal(d.z));
        let size = world.low.abs().max(world.high.abs())
            + ray.origin.abs()
            + (world.high - world.low) * 2.0;
        let off = size * (16.0 * U) + world.widening(rung, ray.origin);
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

    /// The end of a ray, given as the planes count it, with what a box test may be off by.
    #[inline]
    #[must_use]
    pub fn widened_end(end: f32) -> f32 {
        end + end.abs() * (16.0 * U)
    }

    /// The children that the ray may meet before `end`: bit 4c set where it may meet child c.
    #[inline]
    pub(super) fn meets(&self, corner: Vec3, sides: &[UVec4; 6], end: f32) -> u32 {
        let boxes = Boxes {
            inverse: self.inverse,
            near: corner * self.inverse + self.near,
            far: corner * self.inverse + self.far,
            end: Self::widened_end(end),
        };
        let row = |row: u32| {
            // SAFETY: `near_rows` are 0 or 3, 1 or 4, 2 or 5.
            load(unsafe { sides.index_unchecked(row as usize) })
        };
        let rows = self.near_rows;
        let near = by_word(row(rows.x), row(rows.y), row(rows.z));
        let far = by_word(row(3 - rows.x), row(5 - rows.y), row(7 - rows.z));
        // Of each gap the sign and three bits that are dropped below: one instruction.
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

    /// The children's bits in the order of the visit, the first highest: child c at 4c with the
    /// bits of the octant flipped.
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

/// Planes of boxes, as parameters along a ray: v·inverse + near or far, v a side.
#[derive(Clone, Copy)]
struct Boxes {
    inverse: Vec3,
    near: Vec3,
    far: Vec3,
    end: f32,
}

impl Boxes {
    /// The bits of how far a ray goes in a box: negative, where it misses it.
    #[inline]
    fn gap(&self, near: Vec3, far: Vec3) -> u32 {
        let near = near * self.inverse + self.near;
        let far = far * self.inverse + self.far;
        // Of floats that are not negative the bits are in order, too, and a GPU takes three integers at once. A
        // negative one is never the largest of those with zero; and as the smallest, whichever it is, it makes the gap
        // negative.
        let bits = |x: f32| x.to_bits() as i32;
        let first = larger(larger(larger(bits(near.x), bits(near.y)), bits(near.z)), 0);
        let last = smaller(
            smaller(smaller(bits(far.x), bits(far.y)), bits(far.z)),
            bits(self.end),
        );
        (f32::from_bits(last as u32) - f32::from_bits(first as u32)).to_bits()
    }
}

/// The same word of three rows together.
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

/// All four words at once, which compilers for GPUs do not make of loads of their own.
#[inline]
pub(super) fn load(words: &UVec4) -> UVec4 {
    *words
}

/// 1/x; for an x below 2⁻⁶⁴, 2⁶⁴ with its sign.
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
