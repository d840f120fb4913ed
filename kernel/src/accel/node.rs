//! [`Node`] and [`Tree`]: a tree of boxes around the spheres, as it is laid out in memory. Runs on
//! the GPU and on the CPU.
//!
//! A node holds up to eight children and takes 128 bytes. Their boxes are quantised: the sides of
//! boxes are stored as distances from a corner of the node, in sixteen bits each. The layout
//! follows H. Ylitie, T. Karras, S. Laine, Efficient Incoherent Ray Traversal on GPUs Through
//! Compressed Wide BVHs, HPG 2017. There a coordinate is a byte. Here it is the upper half of a
//! float: decoding takes a GPU an eighth of a node's instructions instead of two fifths, for a
//! tenth more memory.

#[cfg(not(target_arch = "spirv"))]
use alloc::vec;

use crate::precision::widening;
use bytemuck::{Pod, Zeroable};
use glam::{UVec4, Vec3};

/// Up to eight boxes and their contents: each box holds either a node or one to four spheres.
///
/// The first element of a tree's array is not a node: it is the [`Extent`]. The second is the root.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Node {
    /// The distances of the children's sides from the corner. The rows are the smallest x, y, z,
    /// then the largest x, y, z. Each of a row's four words holds two children:
    /// [`lower`](Node::lower) gives the first four children, [`upper`](Node::upper) the last four.
    pub sides: [UVec4; 6],
    /// x, y and z are the bits of the corner's coordinates. w says which children are nodes: bit
    /// 4c + 1 is set if child c is one.
    pub corner: UVec4,
    /// x is the index of the first child that is a node; the other nodes follow it. y is the index
    /// of the first sphere in any child; the others follow it, child by child. z has a bit for each
    /// sphere: bits 4c to 4c + n − 1 if child c has n spheres. w is unused.
    pub links: UVec4,
}

impl Node {
    /// The largest number of children.
    pub const WIDTH: usize = 8;
    /// The largest number of spheres in a child.
    pub const MAX_LEAF: usize = 4;
    /// The largest number of nodes on a path from the root to a leaf.
    pub const MAX_DEPTH: usize = 20;
    /// The largest number of spheres in a tree.
    pub const MAX_SPHERES: u32 = 1 << 30;
    /// The index of the root.
    pub const ROOT: u32 = 1;
    /// The number of the specialisation constant that is 1 if the pipeline is for worlds with a
    /// tree.
    pub const SPEC_ID: u32 = 4;
    /// Coordinates must be below this for the walk's numbers to be finite.
    pub const MAX_COORDINATE: f32 = (1_u64 << 60) as f32;

    /// Whether a child is a node. Here and below, only the lowest three bits of a child's number
    /// count.
    #[inline]
    #[must_use]
    pub fn is_node(&self, child: u32) -> bool {
        self.corner.w >> (4 * (child & 7) + 1) & 1 == 1
    }

    /// The index of a child that is a node.
    #[inline]
    #[must_use]
    pub fn child(&self, child: u32) -> u32 {
        let before = self.corner.w & ((1 << (4 * (child & 7))) - 1);
        self.links.x.wrapping_add(before.count_ones())
    }

    /// The index of a child's first sphere, and the number of its spheres.
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

    /// The index of the first sphere of all children, and the number of their spheres.
    #[inline]
    #[must_use]
    pub fn all_spheres(&self) -> (u32, u32) {
        (self.links.y, self.links.z.count_ones())
    }

    /// The side of the first of a word's two children: the word's lower half is the upper half of a
    /// float.
    #[inline]
    #[must_use]
    pub fn lower(word: u32) -> f32 {
        f32::from_bits(word << 16)
    }

    /// The side of the second of a word's two children: the whole word as a float. Its upper half
    /// was chosen for the lower half that it has.
    #[inline]
    #[must_use]
    pub fn upper(word: u32) -> f32 {
        f32::from_bits(word)
    }
}

/// What the first element of a tree's array holds: the box and the smallest radius of all spheres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// The corner with the smallest coordinates.
    pub low: Vec3,
    /// The corner with the largest coordinates.
    pub high: Vec3,
    /// The smallest radius of all spheres.
    pub smallest_radius: f32,
}

impl Extent {
    /// The extent as the first element of a tree's array.
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

    /// The extent that the first element of a tree's array holds.
    #[inline]
    #[must_use]
    pub fn of_node(node: &Node) -> Self {
        Self {
            low: point(node.corner),
            high: point(node.links),
            smallest_radius: f32::from_bits(node.corner.w),
        }
    }

    /// How much wider boxes must be for this rung, in scene units, for a ray from `origin`.
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

/// The nodes of a tree, checked to be one. The first is an [`Extent`] and the second the root. Each
/// other node is a child of exactly one node that stands before it. No path from the root has more
/// than [`Node::MAX_DEPTH`] nodes, counting the root.
#[derive(Clone, Copy, Debug)]
pub struct Tree<'a> {
    nodes: &'a [Node],
}

impl<'a> Tree<'a> {
    /// No tree: a walk through it finds nothing.
    pub const NONE: Self = Self { nodes: &[] };

    /// Checks each of these nodes; `None` if they are not a tree.
    ///
    /// ```
    /// use spherule_kernel::accel::node::{Node, Tree};
    ///
    /// assert!(Tree::of(&[]).is_some());
    /// assert!(Tree::of(&[Node::default(); 2]).is_some());
    /// // The third node is nobody's child.
    /// assert!(Tree::of(&[Node::default(); 3]).is_none());
    /// ```
    #[cfg(not(target_arch = "spirv"))]
    #[must_use]
    pub fn of(nodes: &'a [Node]) -> Option<Self> {
        let is_tree = nodes.is_empty() || is_tree(nodes);
        is_tree.then_some(Self { nodes })
    }

    /// Takes nodes that are a tree, without checking them.
    ///
    /// # Safety
    ///
    /// [`Tree::of`] accepts these nodes. On a GPU: it accepts the nodes in the buffer that is
    /// bound.
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

/// Whether nodes are a tree: each node but the first two is the child of exactly one node before
/// it, and none is too deep.
#[cfg(not(target_arch = "spirv"))]
fn is_tree(nodes: &[Node]) -> bool {
    if nodes.len() <= Node::ROOT as usize {
        return false;
    }
    // A parent stands before its children, so that a node's depth is known when the loop comes to
    // it. A node that is nobody's child still has the depth NOWHERE then, and a node with two
    // parents would get a depth twice.
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

/// Bit 4c + 1 of each child c: the bits in [`Node::corner`] that say which children are nodes.
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

    /// A node with `count` children that are nodes, from index `first` on.
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
                "the child of a node after it",
                vec![leaf, inner(2, 1), inner(1, 1)],
            ),
            (
                "the child of two nodes",
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
