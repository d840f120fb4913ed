//! [`Node`]: a tree of boxes around the spheres, so that a ray looks at few of them. Runs on the GPU
//! and on the CPU.
//!
//! A node holds up to eight children, whose boxes are told from a corner of its own, 16 bits a coordinate, and
//! takes 128 bytes; so does the walk, front to back by the octant of the ray's direction
//! and with whole groups of children on the stack (H. Ylitie, T. Karras, S. Laine, Efficient Incoherent
//! Ray Traversal on GPUs Through Compressed Wide BVHs, HPG 2017). There a coordinate is a byte; here it is the upper half of
//! a float, which a GPU decodes in an eighth of a node's instructions instead of two fifths, for a tenth more memory.
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
//!
//! # No walk gets lost
//!
//! Walks take a [`Tree`], whose nodes are known to be one: each is the child of one other that stands before it, and none
//! is deeper than there is room for on a stack. What links say of spheres need not fit the spheres that a walk is given: on the CPU
//! an index beyond them is cut to the last, on a GPU the driver checks it (`robustBufferAccess`).

#[cfg(not(target_arch = "spirv"))]
use alloc::vec;
use core::mem::MaybeUninit;

use bytemuck::{Pod, Zeroable};
use glam::{UVec2, UVec3, UVec4, Vec3};
use spirv_std::arch::IndexUnchecked;
// On the CPU, std has `f32::sqrt`.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use crate::bounds::Line;
use crate::candidates::power_of_two_under;
use crate::hit::Hit;
use crate::instructions::{highest_bit, larger, lowest_bit, smaller};
use crate::nearest::Spheres;
use crate::precision::{Precision, Robust, Rung, Textbook, intersect};
use crate::ray::Ray;
use crate::sphere::Sphere;

/// Up to eight boxes, and what is in them: a node each, or one to four spheres.
///
/// The first of a tree's nodes is none: it is the [`Extent`]. The second is the root.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Node {
    /// How far from the corner the children's sides are: the smallest x, y, z, then the largest. Of a
    /// row's words each holds two children, [`lower`](Node::lower) the first four and
    /// [`upper`](Node::upper) the last four.
    pub sides: [UVec4; 6],
    /// The bits of the corner x, y, z; and which children are nodes: bit 4c + 1 where child c is one.
    pub corner: UVec4,
    /// The index of the first child that is a node, the others follow; the index of the first sphere in
    /// any child, the others follow, child by child; the spheres, a bit each: bits 4c to 4c + n − 1 where child c has n;
    /// and nothing.
    pub links: UVec4,
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

    /// Whether a child is a node. Of a child's number, here and below, the lowest three bits count.
    #[inline]
    #[must_use]
    pub fn is_node(&self, child: u32) -> bool {
        self.corner.w >> (4 * (child & 7) + 1) & 1 == 1
    }

    /// Where a child is that is a node.
    #[inline]
    #[must_use]
    pub fn child(&self, child: u32) -> u32 {
        let before = self.corner.w & ((1 << (4 * (child & 7))) - 1);
        self.links.x.wrapping_add(before.count_ones())
    }

    /// Where a child's spheres begin, and how many it has.
    #[inline]
    #[must_use]
    pub fn leaf(&self, child: u32) -> (u32, u32) {
        let (bits, at) = (self.links.z, 4 * (child & 7));
        let before = (bits & ((1 << at) - 1)).count_ones();
        let count = (bits >> at & 15).count_ones();
        (self.links.y.wrapping_add(before), count)
    }

    /// Whether any child is a node.
    #[inline]
    #[must_use]
    pub fn has_nodes(&self) -> bool {
        self.corner.w != 0
    }

    /// Where the spheres of all children begin, and how many they are.
    #[inline]
    #[must_use]
    pub fn all_spheres(&self) -> (u32, u32) {
        (self.links.y, self.links.z.count_ones())
    }

    /// The side of the first of a word's two children: the lower half, as a float's upper half.
    #[inline]
    #[must_use]
    pub fn lower(word: u32) -> f32 {
        f32::from_bits(word << 16)
    }

    /// The side of the second of a word's two children: the whole word, whose upper half was chosen with
    /// the lower in mind.
    #[inline]
    #[must_use]
    pub fn upper(word: u32) -> f32 {
        f32::from_bits(word)
    }
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
            corner: bits(low, self.smallest_radius),
            links: bits(high, 0.0),
            ..Node::default()
        }
    }

    /// Out of the tree's first node.
    #[inline]
    #[must_use]
    pub fn of_node(node: &Node) -> Self {
        Self {
            low: point(node.corner),
            high: point(node.links),
            smallest_radius: f32::from_bits(node.corner.w),
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
fn point(bits: UVec4) -> Vec3 {
    Vec3::new(
        f32::from_bits(bits.x),
        f32::from_bits(bits.y),
        f32::from_bits(bits.z),
    )
}

/// The nodes of a tree, known to be one: the first is an [`Extent`], the second the root, each other is a child of exactly one
/// node that stands before it, and none is more than [`Node::MAX_DEPTH`] nodes down, the root counted.
#[derive(Clone, Copy, Debug)]
pub struct Tree<'a> {
    nodes: &'a [Node],
}

impl<'a> Tree<'a> {
    /// No tree: walks in it find nothing.
    pub const NONE: Self = Self { nodes: &[] };

    /// Of nodes that are a tree; `None` if they are not. Looks at each.
    ///
    /// ```
    /// use spherule_kernel::tree::{Node, Tree};
    ///
    /// assert!(Tree::of(&[]).is_some());
    /// assert!(Tree::of(&[Node::default(); 2]).is_some());
    /// // No node names the third.
    /// assert!(Tree::of(&[Node::default(); 3]).is_none());
    /// ```
    #[cfg(not(target_arch = "spirv"))]
    #[must_use]
    pub fn of(nodes: &'a [Node]) -> Option<Self> {
        let is_tree = nodes.is_empty() || is_tree(nodes);
        is_tree.then_some(Self { nodes })
    }

    /// Of nodes that are a tree, without a look at them.
    ///
    /// # Safety
    ///
    /// [`Tree::of`] would take them; on a GPU those that are bound.
    #[inline]
    #[must_use]
    pub const unsafe fn of_unchecked(nodes: &'a [Node]) -> Self {
        Self { nodes }
    }

    /// The nodes.
    #[inline]
    #[must_use]
    pub const fn nodes(self) -> &'a [Node] {
        self.nodes
    }

    /// Whether there is no tree.
    #[inline]
    #[must_use]
    pub const fn is_none(self) -> bool {
        self.nodes.len() <= Node::ROOT as usize
    }
}

/// Whether nodes, of which there are some, are a tree: level by level each node's children are the next that no other has named.
#[cfg(not(target_arch = "spirv"))]
fn is_tree(nodes: &[Node]) -> bool {
    if nodes.len() <= Node::ROOT as usize {
        return false;
    }
    // Each child is named once: as many are named as there are, and none twice. Nodes stand behind those that name them,
    // so that depths are known when they are asked for; what is not named is at no depth.
    const NOWHERE: u8 = u8::MAX;
    let mut depths = vec![NOWHERE; nodes.len()];
    depths[Node::ROOT as usize] = 1;
    for (at, node) in nodes.iter().enumerate().skip(Node::ROOT as usize) {
        let depth = depths[at];
        if depth == NOWHERE || usize::from(depth) > Node::MAX_DEPTH {
            return false;
        }
        let children = (node.corner.w & NODES).count_ones() as usize;
        if node.corner.w & !NODES != 0 {
            return false;
        }
        if children == 0 {
            continue;
        }
        let first = node.links.x as usize;
        let is_behind = first > at && first < nodes.len() && children <= nodes.len() - first;
        if !is_behind {
            return false;
        }
        for below in &mut depths[first..first + children] {
            if *below != NOWHERE {
                return false;
            }
            *below = depth + 1;
        }
    }
    true
}

/// Bit 4c + 1 of each child c: those of [`Node::corner`] that say which are nodes.
#[cfg(not(target_arch = "spirv"))]
const NODES: u32 = 0x2222_2222;

/// 2⁻²⁴.
const U: f32 = 1.0 / (1 << 24) as f32;

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
    fn meets(&self, corner: Vec3, sides: &[UVec4; 6], end: f32) -> u32 {
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
    fn in_order(&self, children: u32) -> u32 {
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
const FIRST_OF_FOUR: u32 = 0x1111_1111;

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
fn load(words: &UVec4) -> UVec4 {
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

/// The nearest hit of `ray` on this rung among the spheres of a tree; of two equally near, the one
/// of lower index.
#[inline]
#[must_use]
pub fn nearest_hit_in_tree<S: Spheres + ?Sized>(
    rung: u32,
    ray: &Ray,
    tree: Tree<'_>,
    spheres: &S,
) -> Hit {
    walk::<false, S>(rung, ray, tree, spheres, &mut Work::default())
}

/// Whether `ray` hits any sphere of a tree.
#[inline]
#[must_use]
pub fn is_occluded_in_tree<S: Spheres + ?Sized>(
    rung: u32,
    ray: &Ray,
    tree: Tree<'_>,
    spheres: &S,
) -> bool {
    walk::<true, S>(rung, ray, tree, spheres, &mut Work::default()).is_some()
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
    tree: Tree<'_>,
    spheres: &S,
) -> Work {
    let mut work = Work::default();
    if any {
        let _ = walk::<true, S>(rung, ray, tree, spheres, &mut work);
    } else {
        let _ = walk::<false, S>(rung, ray, tree, spheres, &mut work);
    }
    work
}

/// The index of the sphere that has this bit in a node's links.
#[inline]
fn sphere_at(links: UVec4, bit: u32, count: u32) -> u32 {
    let before = (links.z & ((1 << bit) - 1)).count_ones();
    within(links.y.wrapping_add(before), count)
}

/// [`intersect`] of the rungs that are not lazy.
#[inline]
fn intersect_at_once(rung: u32, sphere: Sphere, ray: &Ray) -> f32 {
    if rung == Rung::Robust.to_u32() {
        Robust::intersect(sphere, ray)
    } else {
        Textbook::intersect(sphere, ray)
    }
}

/// The two lowest bits of some that are set, the same twice if there is one; and the others.
#[inline]
fn take_two(bits: u32) -> (u32, u32, u32) {
    let one = lowest_bit(bits);
    let mut rest = bits & (bits - 1);
    let mut two = one;
    if rest != 0 {
        two = lowest_bit(rest);
        rest &= rest - 1;
    }
    (one, two, rest)
}

/// An index below a length that is not zero. The spheres need not be those of the tree, and a GPU's buffers are checked by
/// their driver (`robustBufferAccess`).
#[inline]
fn within(index: u32, length: u32) -> u32 {
    if cfg!(target_arch = "spirv") {
        index
    } else {
        index.min(length - 1)
    }
}

/// The nearest hit, or any.
#[inline]
fn walk<const ANY: bool, S: Spheres + ?Sized>(
    rung: u32,
    ray: &Ray,
    tree: Tree<'_>,
    spheres: &S,
    work: &mut Work,
) -> Hit {
    let (nodes, count) = (tree.nodes, spheres.count());
    if (nodes.len() <= Node::ROOT as usize) | (count == 0) {
        return Hit::NONE;
    }
    // SAFETY: there are more than one.
    let world = Extent::of_node(unsafe { nodes.index_unchecked(0) });
    let slabs = Slabs::of(rung, ray, &world);
    let line = Line::of(ray);
    // Rungs that take long are asked about the nearest sphere only, when it is found.
    let is_lazy = rung >= Rung::Compensated.to_u32();
    let ray = &Ray {
        t_max: ray.end(),
        ..*ray
    };
    // What changes on the way is kept apart from what does not, and is little: compilers for GPUs carry a
    // whole struct from round to round if any of it changes, and copy what they carry. Inner loops end where
    // they may go on, for the same reason.
    //
    // The nearest answer so far, and its sphere.
    let mut t = ray.t_max;
    let mut hit_sphere = 0;
    // The end of the ray, as the line counts it; and if it is lazy where the nearest sphere may begin, which is before
    // the end if the rung was not asked.
    let mut end = t * line.unit;
    let mut low = end;

    // Below the last group is an empty one.
    let mut stack = [MaybeUninit::<UVec2>::uninit(); Node::MAX_DEPTH + 1];
    stack[0] = MaybeUninit::new(UVec2::ZERO);
    let mut height = 1;
    // A group of nodes: where the first is, and which are to be visited (bits 4c, c in the order of the visit),
    // which are there (bits 4c + 1). The root is one alone.
    let mut first = Node::ROOT;
    let mut group = 0x1000_0000_u32;
    loop {
        // The next to be visited.
        let bit = highest_bit(group & FIRST_OF_FOUR);
        group ^= 1 << bit;
        if (group & FIRST_OF_FOUR != 0) & (height <= Node::MAX_DEPTH) {
            let kept = MaybeUninit::new(UVec2::new(first, group));
            // SAFETY: `height` is below the array's length.
            unsafe { *stack.index_unchecked_mut(height) = kept };
            height += 1;
        }
        let before = group & !FIRST_OF_FOUR & ((1 << (bit ^ slabs.octant)) - 1);
        let at = within(first + before.count_ones(), nodes.len() as u32);
        // SAFETY: `at` is below the slice's length, which is not zero.
        let node = unsafe { nodes.index_unchecked(at as usize) };
        let (corner, links) = (load(&node.corner), load(&node.links));
        let inner = corner.w;
        let met = slabs.meets(point(corner), &node.sides, end - slabs.start);
        work.nodes += 1;

        let mut candidates = (met * 15) & links.z;
        let mut met = met & (inner >> 1);
        work.spheres += candidates.count_ones();
        if (is_lazy | ANY) & (candidates != 0) {
            // Threads of a GPU wait for each other: few operations on all spheres, and many on the few that are left.
            // Two at a time, so that what one waits for does not hold up the other.
            let mut leaves = candidates;
            candidates = 0;
            loop {
                let (one, two, rest) = take_two(leaves);
                leaves = rest;
                let indices = [sphere_at(links, one, count), sphere_at(links, two, count)];
                // SAFETY: both are below the number of spheres.
                let pair = unsafe { [spheres.sphere(indices[0]), spheres.sphere(indices[1])] };
                if is_lazy {
                    let [first, second] = [line.bounds(pair[0]), line.bounds(pair[1])];
                    if first.hits & (first.high < low) {
                        (hit_sphere, low, end) = (indices[0], first.low, first.high);
                    } else {
                        candidates |= u32::from(first.is_open(end)) << one;
                    }
                    if second.hits & (second.high < low) {
                        (hit_sphere, low, end) = (indices[1], second.low, second.high);
                    } else {
                        candidates |= u32::from(second.is_open(end) & (one != two)) << two;
                    }
                } else {
                    candidates |= u32::from(line.may_hit(pair[0])) << one;
                    candidates |= u32::from(line.may_hit(pair[1])) << two;
                }
                if (leaves == 0) | (is_lazy & ANY & (low < end)) {
                    break;
                }
            }
            if is_lazy & ANY & (low < end) {
                candidates = 0;
            }
        }
        if (is_lazy | ANY) & (candidates != 0) {
            loop {
                // The nearest sphere comes first, if its rung was not asked.
                let index = if is_lazy & (low < end) {
                    hit_sphere
                } else {
                    let bit = lowest_bit(candidates);
                    candidates &= candidates - 1;
                    sphere_at(links, bit, count)
                };
                // SAFETY: `index` is below the number of spheres.
                let sphere = unsafe { spheres.sphere(index) };
                let answer = intersect(rung, sphere, ray);
                if (answer < t) | ((answer == t) & (index < hit_sphere)) {
                    (t, hit_sphere) = (answer, index);
                }
                end = t * line.unit;
                low = end;
                // Not by making `candidates` zero above: compilers leave the loop from there then, which Mesa 22's
                // llvmpipe was seen to get wrong.
                if (candidates == 0) | (ANY & (t < ray.t_max)) {
                    break;
                }
            }
        }
        if !(is_lazy | ANY) & (candidates != 0) {
            // Most are hits, and a hit is cheap: there is nothing to sift.
            loop {
                let (one, two, rest) = take_two(candidates);
                candidates = rest;
                let indices = [sphere_at(links, one, count), sphere_at(links, two, count)];
                // SAFETY: both are below the number of spheres.
                let pair = unsafe { [spheres.sphere(indices[0]), spheres.sphere(indices[1])] };
                let answers = [
                    intersect_at_once(rung, pair[0], ray),
                    intersect_at_once(rung, pair[1], ray),
                ];
                if (answers[0] < t) | ((answers[0] == t) & (indices[0] < hit_sphere)) {
                    (t, hit_sphere) = (answers[0], indices[0]);
                }
                if (answers[1] < t) | ((answers[1] == t) & (indices[1] < hit_sphere)) {
                    (t, hit_sphere) = (answers[1], indices[1]);
                }
                if candidates == 0 {
                    break;
                }
            }
            end = t * line.unit;
        }
        if ANY & ((t < ray.t_max) | (is_lazy & (low < end))) {
            // Nothing is left to be visited. A `return` out of both loops was seen to be compiled wrongly, by
            // Mesa 22's llvmpipe.
            (met, height) = (0, 1);
        }

        first = links.x;
        group = slabs.in_order(met) | inner;
        if met == 0 {
            height -= 1;
            // SAFETY: `height` is below the array's length, and what is there was put there.
            let next = unsafe { (*stack.index_unchecked(height)).assume_init() };
            first = next.x;
            group = next.y;
        }
        if group & FIRST_OF_FOUR == 0 {
            break;
        }
    }

    let is_unasked = is_lazy & (low < end);
    if is_unasked & !ANY {
        // SAFETY: `hit_sphere` is below the number of spheres.
        let sphere = unsafe { spheres.sphere(hit_sphere) };
        // No hit after all only where numbers are beyond what bounds are made for.
        t = intersect(rung, sphere, ray);
    }
    if (t < ray.t_max) | (is_unasked & ANY) {
        Hit {
            t,
            sphere: hit_sphere,
        }
    } else {
        Hit::NONE
    }
}

const _: () = {
    assert!(size_of::<Node>() == 128);
    assert!(core::mem::offset_of!(Node, corner) == 96);
    assert!(core::mem::offset_of!(Node, links) == 112);
};

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use super::*;

    /// A node whose children from `first` on are nodes, so many.
    fn inner(first: u32, count: u32) -> Node {
        let bits = (0..count).fold(0, |bits, child| bits | 2 << (4 * child));
        Node {
            corner: UVec4::new(0, 0, 0, bits),
            links: UVec4::new(first, 0, 0, 0),
            ..Node::default()
        }
    }

    #[test]
    fn only_trees_are_trees() {
        let leaf = Node::default();
        assert!(Tree::of(&[leaf, inner(2, 2), inner(4, 1), leaf, leaf]).is_some());
        for (what, nodes) in [
            ("no root", vec![leaf]),
            ("its own child", vec![leaf, inner(1, 1)]),
            (
                "the child of one behind it",
                vec![leaf, inner(2, 1), inner(1, 1)],
            ),
            (
                "the child of two",
                vec![leaf, inner(2, 2), inner(4, 1), inner(4, 1), leaf],
            ),
            ("beyond the last", vec![leaf, inner(2, 2), leaf]),
            ("nobody's child", vec![leaf, inner(2, 1), leaf, leaf]),
            ("far away", vec![leaf, inner(u32::MAX, 8), leaf]),
            ("the extent", vec![leaf, inner(0, 1)]),
        ] {
            assert!(Tree::of(&nodes).is_none(), "{what}");
        }
        let chain = |length: usize| -> Vec<Node> {
            let inner = (2..=length as u32).map(|next| inner(next, 1));
            [leaf].into_iter().chain(inner).chain([leaf]).collect()
        };
        assert!(Tree::of(&chain(Node::MAX_DEPTH)).is_some());
        assert!(Tree::of(&chain(Node::MAX_DEPTH + 1)).is_none());
    }
}
