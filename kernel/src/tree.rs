//! [`Node`]: a tree of boxes around the spheres, so that a ray looks at few of them. Runs on the GPU
//! and on the CPU.
//!
//! A node holds up to eight children, whose boxes stand on a grid of 256 steps a side, a byte a
//! coordinate, and takes 80 bytes; so does the walk, front to back by the octant of the ray's direction
//! and with whole groups of children on the stack (H. Ylitie, T. Karras, S. Laine, Efficient Incoherent
//! Ray Traversal on GPUs Through Compressed Wide BVHs, HPG 2017).
//!
//! # No hit is lost
//!
//! Boxes are rounded outwards to their grid. With u = 2⁻²⁴, P the grid's corner, s its step and q
//! a byte, a plane is met at
//!
//! > (P − O)/d + q s/d,
//!
//! computed to within 5u(|P − O| + 255 s)/|d|, fused or not, division off by two units; the far
//! planes are moved away and the near ones nearer by 16u(|P − O| + 256 s)/|d|. A direction's
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

use core::mem::MaybeUninit;

use bytemuck::{Pod, Zeroable};
use glam::{UVec2, UVec4, Vec3};
use spirv_std::arch::IndexUnchecked;
// On the CPU, std has `f32::sqrt`.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use crate::candidates::power_of_two_under;
use crate::hit::Hit;
use crate::nearest::Spheres;
use crate::precision::{Rung, intersect};
use crate::ray::Ray;

/// Up to eight boxes on a grid, and what is in them: a node each, or one to four spheres.
///
/// The first of a tree's nodes is none: it is the [`Extent`]. The second is the root.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Node {
    /// The bits of the grid's corner x, y, z; then, a byte each from the lowest, the biased exponents
    /// of its steps along x, y, z, and which children are nodes.
    pub grid: UVec4,
    /// The index of the first child that is a node, the others follow; the index of the first sphere in
    /// any child, the others follow, child by child; how many each child has, four bits a child from the lowest;
    /// and nothing.
    pub links: UVec4,
    /// The eight children's smallest x, a byte each, then their smallest y.
    pub low_xy: UVec4,
    /// The eight children's smallest z, then their largest x.
    pub low_z_high_x: UVec4,
    /// The eight children's largest y, then their largest z.
    pub high_yz: UVec4,
}

impl Node {
    /// The most children.
    pub const WIDTH: usize = 8;
    /// The most spheres in a child.
    pub const MAX_LEAF: usize = 4;
    /// The most nodes on the way from the root to a leaf.
    pub const MAX_DEPTH: usize = 20;
    /// The most spheres that a tree has room to name.
    pub const MAX_SPHERES: u32 = 1 << 30;
    /// Where the root is.
    pub const ROOT: u32 = 1;
    /// The specialisation constant that is 1 where the pipeline is for worlds with a tree.
    pub const SPEC_ID: u32 = 4;
    /// What coordinates must stay below, for the walk's numbers to be finite.
    pub const MAX_COORDINATE: f32 = (1_u64 << 60) as f32;
}

/// What a tree's first node says instead: of all spheres, the box and the smallest radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// The corner of the smallest coordinates.
    pub low: Vec3,
    /// The corner of the largest coordinates.
    pub high: Vec3,
    /// The smallest radius.
    pub smallest_radius: f32,
}

impl Extent {
    /// As the tree's first node.
    #[must_use]
    pub fn to_node(self) -> Node {
        let (low, high) = (self.low, self.high);
        let bits =
            |v: Vec3, w: f32| UVec4::new(v.x.to_bits(), v.y.to_bits(), v.z.to_bits(), w.to_bits());
        Node {
            grid: bits(low, self.smallest_radius),
            links: bits(high, 0.0),
            ..Node::default()
        }
    }

    /// Out of the tree's first node.
    #[inline]
    #[must_use]
    pub fn of_node(node: &Node) -> Self {
        Self {
            low: corner(node.grid),
            high: corner(node.links),
            smallest_radius: f32::from_bits(node.grid.w),
        }
    }

    /// How much wider boxes must be for this rung, in scene units, around a ray from `origin`.
    #[inline]
    #[must_use]
    pub fn widening(&self, rung: u32, origin: Vec3) -> f32 {
        let far = (self.low - origin).abs().max((self.high - origin).abs());
        if rung == Rung::Robust.to_u32() {
            // At least the distance to the farthest corner.
            let distance = far.x + far.y + far.z;
            distance * (32.0 * U)
        } else if rung == Rung::Textbook.to_u32() {
            let r = self.smallest_radius;
            let squared = far.dot(far) * (24.0 * U);
            // √(r² + e) − r, without cancellation.
            squared / ((r * r + squared).sqrt() + r).max(f32::MIN_POSITIVE)
        } else {
            0.0
        }
    }
}

#[inline]
fn corner(bits: UVec4) -> Vec3 {
    Vec3::new(
        f32::from_bits(bits.x),
        f32::from_bits(bits.y),
        f32::from_bits(bits.z),
    )
}

/// 2⁻²⁴.
const U: f32 = 1.0 / (1 << 24) as f32;

/// What stays the same of a ray as it meets box after box.
#[derive(Clone, Copy, Debug)]
pub struct Slabs {
    /// The ray's.
    pub origin: Vec3,
    /// One over the direction, whose largest component was brought between 1 and 2.
    pub inverse: Vec3,
    /// How much sooner planes are met for the rung's sake, and how much later.
    pub widening: Vec3,
    /// What a parameter of the ray is, times this, as the planes count it.
    pub unit: f32,
    /// The start of the ray's interval.
    pub start: f32,
    /// Bit k set where the direction is positive along axis k.
    pub octant: u32,
}

impl Slabs {
    /// Of a ray in a tree, which has a first node.
    #[inline]
    #[must_use]
    pub fn of(rung: u32, ray: &Ray, nodes: &[Node]) -> Self {
        let scale = power_of_two_under(ray.direction);
        // One over it: exponents that add up to those of one.
        let unit = f32::from_bits(0x7f00_0000 - scale.to_bits());
        let d = ray.direction * scale;
        let inverse = Vec3::new(reciprocal(d.x), reciprocal(d.y), reciprocal(d.z));
        let mut widening = Vec3::ZERO;
        if rung < Rung::Compensated.to_u32() {
            // SAFETY: the callers' trees have a first node.
            let world = Extent::of_node(unsafe { nodes.index_unchecked(0) });
            widening = inverse.abs() * world.widening(rung, ray.origin);
        }
        let positive = |x: f32, bit: u32| if x < 0.0 { 0 } else { bit };
        let octant = positive(d.x, 1) | positive(d.y, 2) | positive(d.z, 4);
        Self {
            origin: ray.origin,
            inverse,
            widening,
            unit,
            start: ray.t_min * unit,
            octant,
        }
    }

    /// The end of a ray, given as the planes count it, with what a box test may be off by.
    #[inline]
    #[must_use]
    pub fn widened_end(end: f32) -> f32 {
        end + end.abs() * (16.0 * U)
    }

    /// The children that the ray may meet before `end`, a bit each.
    #[inline]
    fn meets(&self, node: &Node, end: f32) -> u32 {
        let exponents = node.grid.w;
        let step = Vec3::new(
            f32::from_bits((exponents & 0xff) << 23),
            f32::from_bits((exponents & 0xff00) << 15),
            f32::from_bits((exponents & 0x00ff_0000) << 7),
        ) * self.inverse;
        let offset = (corner(node.grid) - self.origin) * self.inverse;
        let slack = (offset.abs() + step.abs() * 256.0) * (16.0 * U) + self.widening;
        let boxes = Boxes {
            step,
            near: offset - slack,
            far: offset + slack,
            start: self.start,
            end: Self::widened_end(end),
        };
        let (low_xy, mixed, high_yz) = (node.low_xy, node.low_z_high_x, node.high_yz);
        let mut near_x = UVec2::new(low_xy.x, low_xy.y);
        let mut near_y = UVec2::new(low_xy.z, low_xy.w);
        let mut near_z = UVec2::new(mixed.x, mixed.y);
        let mut far_x = UVec2::new(mixed.z, mixed.w);
        let mut far_y = UVec2::new(high_yz.x, high_yz.y);
        let mut far_z = UVec2::new(high_yz.z, high_yz.w);
        if self.inverse.x < 0.0 {
            (near_x, far_x) = (far_x, near_x);
        }
        if self.inverse.y < 0.0 {
            (near_y, far_y) = (far_y, near_y);
        }
        if self.inverse.z < 0.0 {
            (near_z, far_z) = (far_z, near_z);
        }
        let first = [near_x.x, near_y.x, near_z.x, far_x.x, far_y.x, far_z.x];
        let last = [near_x.y, near_y.y, near_z.y, far_x.y, far_y.y, far_z.y];
        boxes.meets_four(first) | boxes.meets_four(last) << 4
    }

    /// The children's bits in the order of the visit, the first highest: child c at c with the
    /// bits of the octant flipped.
    #[inline]
    fn in_order(&self, children: u32) -> u32 {
        let mut bits = children;
        if self.octant & 1 != 0 {
            bits = ((bits & 0x55) << 1) | ((bits >> 1) & 0x55);
        }
        if self.octant & 2 != 0 {
            bits = ((bits & 0x33) << 2) | ((bits >> 2) & 0x33);
        }
        if self.octant & 4 != 0 {
            bits = ((bits & 0x0f) << 4) | (bits >> 4);
        }
        bits
    }
}

/// Planes of boxes, as parameters along a ray: q·step + near or far, q a byte.
#[derive(Clone, Copy)]
struct Boxes {
    step: Vec3,
    near: Vec3,
    far: Vec3,
    start: f32,
    end: f32,
}

impl Boxes {
    /// Which of four are met, a bit each; `planes` are near x, y, z and far x, y, z, a byte each.
    #[inline]
    fn meets_four(&self, planes: [u32; 6]) -> u32 {
        let bit = |index: u32| u32::from(self.meets_one(planes, 8 * index)) << index;
        bit(0) | bit(1) | bit(2) | bit(3)
    }

    #[inline]
    fn meets_one(&self, planes: [u32; 6], shift: u32) -> bool {
        let byte = |word: u32| ((word >> shift) & 0xff) as f32;
        let (step, near, far) = (self.step, self.near, self.far);
        let near_x = byte(planes[0]) * step.x + near.x;
        let near_y = byte(planes[1]) * step.y + near.y;
        let near_z = byte(planes[2]) * step.z + near.z;
        let far_x = byte(planes[3]) * step.x + far.x;
        let far_y = byte(planes[4]) * step.y + far.y;
        let far_z = byte(planes[5]) * step.z + far.z;
        let near = near_x.max(near_y).max(near_z.max(self.start));
        let far = far_x.min(far_y).min(far_z.min(self.end));
        near <= far
    }
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

/// The nearest hit of `ray` on this rung among the spheres of a tree; of two equally near, the one
/// of lower index.
#[inline]
#[must_use]
pub fn nearest_hit_in_tree<S: Spheres + ?Sized>(
    rung: u32,
    ray: &Ray,
    nodes: &[Node],
    spheres: &S,
) -> Hit {
    walk::<false, S>(rung, ray, nodes, spheres, &mut Work::default())
}

/// Whether `ray` hits any sphere of a tree.
#[inline]
#[must_use]
pub fn is_occluded_in_tree<S: Spheres + ?Sized>(
    rung: u32,
    ray: &Ray,
    nodes: &[Node],
    spheres: &S,
) -> bool {
    walk::<true, S>(rung, ray, nodes, spheres, &mut Work::default()).is_some()
}

/// What a ray took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// The nodes whose boxes it was tested against.
    pub nodes: u32,
    /// The spheres that it was tested against.
    pub spheres: u32,
}

/// What `ray` takes in a tree; with `any`, up to the first hit that is found.
#[must_use]
pub fn work_in_tree<S: Spheres + ?Sized>(
    rung: u32,
    any: bool,
    ray: &Ray,
    nodes: &[Node],
    spheres: &S,
) -> Work {
    let mut work = Work::default();
    if any {
        let _ = walk::<true, S>(rung, ray, nodes, spheres, &mut work);
    } else {
        let _ = walk::<false, S>(rung, ray, nodes, spheres, &mut work);
    }
    work
}

/// The nearest hit, or any.
#[inline]
fn walk<const ANY: bool, S: Spheres + ?Sized>(
    rung: u32,
    ray: &Ray,
    nodes: &[Node],
    spheres: &S,
    work: &mut Work,
) -> Hit {
    if nodes.len() <= Node::ROOT as usize {
        return Hit::NONE;
    }
    let slabs = Slabs::of(rung, ray, nodes);
    // What changes on the way is kept apart from what does not: compilers for GPUs carry a whole struct from
    // round to round if any of it changes.
    let mut t_max = ray.end();
    let mut end = t_max * slabs.unit;
    let mut hit_t = Hit::NONE_T;
    let mut hit_sphere = Hit::NONE_SPHERE;

    let mut stack = [MaybeUninit::<UVec2>::uninit(); Node::MAX_DEPTH];
    let mut height = 0;
    // A group of nodes: where the first is, and which are to be visited (bits 24 to 31), which are
    // there (bits 0 to 7). The root is one alone.
    let mut first = Node::ROOT;
    let mut group = 0x8000_0000_u32;
    loop {
        // The next to be visited.
        let bit = 31 - group.leading_zeros();
        group ^= 1 << bit;
        if group > 0x00ff_ffff && height < Node::MAX_DEPTH {
            let kept = MaybeUninit::new(UVec2::new(first, group));
            // SAFETY: `height` is below the array's length.
            unsafe { *stack.index_unchecked_mut(height) = kept };
            height += 1;
        }
        let place = (bit - 24) ^ slabs.octant;
        let before = (group & 0xff & ((1 << place) - 1)).count_ones();
        // A tree's links are within it; that this one is one is not known, so that it is cut.
        let at = (first + before).min(nodes.len() as u32 - 1);
        // SAFETY: `at` is below the slice's length, which is not zero.
        let node = unsafe { *nodes.index_unchecked(at as usize) };
        let met = slabs.meets(&node, end);
        work.nodes += 1;

        let inner = node.grid.w >> 24;
        let counts = node.links.z;
        let mut leaves = met & !inner;
        let mut index = 0;
        let mut end_index = 0;
        while (leaves != 0) | (index < end_index) {
            if index == end_index {
                let child = leaves.trailing_zeros();
                leaves &= leaves - 1;
                index = node.links.y + sum_of_nibbles(counts & ((1 << (4 * child)) - 1));
                end_index = index + ((counts >> (4 * child)) & 15);
                end_index = end_index.min(spheres.count());
            }
            if index < end_index {
                // SAFETY: `end_index` is at most the number of spheres.
                let sphere = unsafe { spheres.sphere(index) };
                let t = intersect(rung, sphere, &Ray { t_max, ..*ray });
                work.spheres += 1;
                if t < t_max {
                    if ANY {
                        return Hit { t, sphere: index };
                    }
                    if (t < hit_t) | (index < hit_sphere) {
                        (hit_t, hit_sphere) = (t, index);
                    }
                    // One as near is still of interest, if its index is lower.
                    t_max = next_up(t);
                    end = t_max * slabs.unit;
                }
                index += 1;
            }
        }

        first = node.links.x;
        group = slabs.in_order(met & inner) << 24 | inner;
        if met & inner == 0 {
            if height == 0 {
                return Hit {
                    t: hit_t,
                    sphere: hit_sphere,
                };
            }
            height -= 1;
            // SAFETY: `height` is below the array's length.
            let next = unsafe { (*stack.index_unchecked(height)).assume_init() };
            first = next.x;
            group = next.y;
        }
    }
}

/// The sum of eight numbers of four bits.
#[inline]
#[must_use]
pub fn sum_of_nibbles(nibbles: u32) -> u32 {
    let bytes = (nibbles & 0x0f0f_0f0f) + ((nibbles >> 4) & 0x0f0f_0f0f);
    bytes.wrapping_mul(0x0101_0101) >> 24
}

/// The next larger float.
#[inline]
#[must_use]
pub fn next_up(x: f32) -> f32 {
    let bits = x.to_bits();
    f32::from_bits(if x > 0.0 {
        bits + 1
    } else if x < 0.0 {
        bits - 1
    } else {
        1
    })
}

const _: () = {
    assert!(size_of::<Node>() == 80);
    assert!(core::mem::offset_of!(Node, links) == 16);
    assert!(core::mem::offset_of!(Node, low_xy) == 32);
    assert!(core::mem::offset_of!(Node, low_z_high_x) == 48);
    assert!(core::mem::offset_of!(Node, high_yz) == 64);
};
