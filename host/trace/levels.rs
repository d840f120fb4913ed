//! [`Levels`]: a tree whose boxes hold sixteen boxes each, level upon level, so that one vector of
//! sixteen numbers covers all boxes in a box.
//!
//! The boxes at the bottom are those of the tree that it is made from, each around at most sixteen
//! spheres, in that tree's order. Sixteen consecutive boxes make a box of the level above. So no
//! links are stored: box i of a level holds the boxes 16 i to 16 i + 15 of the next.

use glam::Vec3;
use spherule_kernel::accel::node::{Node, Tree};

use super::avx512::Avx512;
use crate::cpu::InstructionSet;

/// Boxes in a box, and the most spheres in a box at the bottom.
pub(super) const WIDTH: usize = 16;
/// The most groups of boxes on the top level.
const MAX_TOP: usize = 4;
/// The most levels: enough for some 200 000 spheres. With more spheres, a ray would spend more time
/// on boxes behind its nearest hit.
const MAX_LEVELS: usize = 3;

/// The most boxes at the bottom.
const MAX_BOXES: usize = MAX_TOP * WIDTH.pow(MAX_LEVELS as u32);
const _: () = assert!(MAX_BOXES <= 1 << Levels::INDEX_BITS);

/// Boxes around the spheres of a tree.
#[derive(Clone, Debug)]
pub struct Levels {
    /// From the top down; at least one.
    pub(super) groups: Vec<Vec<Group>>,
    /// For each box at the bottom, its first sphere and how many it has.
    pub(super) spheres: Vec<(u32, u32)>,
    /// The number of spheres in all boxes.
    pub(super) sphere_count: usize,
}

/// The sides of sixteen boxes: the smallest x, y, z, then the largest. Unused boxes end before they
/// begin, so that no [plain](super::sixteen::is_plain) ray meets them.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Group(pub(super) [[f32; WIDTH]; 6]);

impl Levels {
    /// The bits of a box's index.
    pub(super) const INDEX_BITS: u32 = 16;

    /// The levels of a tree; `None` without nodes, if the tree is too large, or if this machine
    /// lacks AVX-512.
    #[must_use]
    pub fn of(tree: Tree<'_>) -> Option<Self> {
        let nodes = tree.nodes();
        if nodes.len() <= Node::ROOT as usize || !is_usable() {
            return None;
        }
        // Nodes branch, so at least half of them are at the bottom.
        if nodes.len() > 2 * MAX_BOXES {
            return None;
        }
        let mut boxes = Vec::with_capacity(4 * nodes.len());
        collect(nodes, Node::ROOT, &mut boxes);
        if boxes.len() > MAX_BOXES {
            return None;
        }
        let spheres: Vec<_> = boxes.iter().map(|of| of.spheres).collect();
        let end_of = |(first, count): &(u32, u32)| *first as usize + *count as usize;
        let sphere_count = spheres.iter().map(end_of).max()?;
        let mut levels = vec![groups(&boxes)];
        while boxes.len() > WIDTH * MAX_TOP {
            boxes = boxes.chunks(WIDTH).map(around).collect();
            levels.push(groups(&boxes));
        }
        levels.reverse();
        Some(Self {
            groups: levels,
            spheres,
            sphere_count,
        })
    }

    /// The memory that the levels take, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let groups = self.groups.iter().map(|groups| size_of_val(&groups[..]));
        groups.sum::<usize>() + size_of_val(&self.spheres[..])
    }
}

fn is_usable() -> bool {
    Avx512::of(InstructionSet::chosen()).is_some()
}

/// A box, and its spheres if it is at the bottom.
struct LevelBox {
    low: Vec3,
    high: Vec3,
    spheres: (u32, u32),
}

fn groups(boxes: &[LevelBox]) -> Vec<Group> {
    let group = |some: &[LevelBox]| {
        let beyond = Node::MAX_COORDINATE;
        let none = |side| [if side < 3 { beyond } else { -beyond }; WIDTH];
        let mut sides = [0, 1, 2, 3, 4, 5].map(none);
        for (lane, of) in some.iter().enumerate() {
            for axis in 0..3 {
                sides[axis][lane] = of.low[axis];
                sides[3 + axis][lane] = of.high[axis];
            }
        }
        Group(sides)
    };
    boxes.chunks(WIDTH).map(group).collect()
}

/// The box around boxes.
fn around(boxes: &[LevelBox]) -> LevelBox {
    let none = LevelBox {
        low: Vec3::MAX,
        high: Vec3::MIN,
        spheres: (0, 0),
    };
    boxes.iter().fold(none, |all, of| LevelBox {
        low: all.low.min(of.low),
        high: all.high.max(of.high),
        ..all
    })
}

/// Appends the boxes at the bottom that are below a node.
fn collect(nodes: &[Node], at: u32, boxes: &mut Vec<LevelBox>) {
    let node = &nodes[at as usize];
    let corner = [node.corner.x, node.corner.y, node.corner.z].map(f32::from_bits);
    let corner = Vec3::from_array(corner);
    let side = |row: usize, child: u32| {
        let word = node.sides[row][child as usize % 4];
        if child < 4 {
            Node::lower(word)
        } else {
            Node::upper(word)
        }
    };
    // Rounded outwards.
    let low = |child| corner + Vec3::new(side(0, child), side(1, child), side(2, child));
    let high = |child| corner + Vec3::new(side(3, child), side(4, child), side(5, child));
    let down = |v: Vec3| Vec3::from_array(v.to_array().map(f32::next_down));
    let up = |v: Vec3| Vec3::from_array(v.to_array().map(f32::next_up));
    let first_here = boxes.len();
    for child in 0..Node::WIDTH as u32 {
        let (first, count) = node.leaf(child);
        if count == 0 {
            continue;
        }
        let (low, high) = (down(low(child)), up(high(child)));
        // The spheres of neighbours are consecutive.
        match boxes[first_here..].last_mut() {
            Some(last) if !node.has_nodes() && last.spheres.1 + count <= WIDTH as u32 => {
                last.low = last.low.min(low);
                last.high = last.high.max(high);
                last.spheres.1 += count;
            }
            _ => boxes.push(LevelBox {
                low,
                high,
                spheres: (first, count),
            }),
        }
    }
    for child in 0..Node::WIDTH as u32 {
        if node.is_node(child) {
            collect(nodes, node.child(child), boxes);
        }
    }
}
