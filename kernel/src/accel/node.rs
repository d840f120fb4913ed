//! [`Node`] and [`Tree`]: a tree of boxes around the spheres, as memory holds it. Runs on the GPU and on the CPU.
//!
//! A node holds up to eight children and takes 128 bytes. Their boxes are quantised: sixteen bits a coordinate, counted from
//! the node's own corner. The layout follows H. Ylitie, T. Karras, S. Laine, Efficient Incoherent Ray Traversal on GPUs
//! Through Compressed Wide BVHs, HPG 2017. There a coordinate is a byte; here it is the upper half of a float, which a
//! GPU decodes in an eighth of a node's instructions instead of two fifths, for a tenth more memory.

#[cfg(not(target_arch = "spirv"))]
use alloc::vec;

use crate::precision::widening;
use bytemuck::{Pod, Zeroable};
use glam::{UVec4, Vec3};

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
        widening(rung, far, self.smallest_radius)
    }
}

#[inline]
pub(super) fn point(bits: UVec4) -> Vec3 {
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
    /// use spherule_kernel::accel::node::{Node, Tree};
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
