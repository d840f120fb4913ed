//! [`Levels`]: a tree whose boxes hold sixteen boxes each, level upon level, so that a vector of sixteen numbers is all boxes
//! of one.
//!
//! The boxes at the bottom are those of the tree it is made from, each around sixteen spheres at most, in that tree's order;
//! sixteen that follow each other make a box of the level above. That way no box need say where its own are: box i of a
//! level holds the boxes 16 i to 16 i + 15 of the next.

use glam::Vec3;
use spherule_kernel::accel::node::{Node, Tree};

/// Boxes in a box, and spheres in one at the bottom.
pub(super) const WIDTH: usize = 16;
/// The most groups of boxes on top.
const MAX_TOP: usize = 4;
/// The most levels: of some 200 000 spheres. Of more, a ray spends more time on what is behind its nearest hit.
const MAX_LEVELS: usize = 3;

/// The most boxes at the bottom.
const MAX_BOXES: usize = MAX_TOP * WIDTH.pow(MAX_LEVELS as u32);
const _: () = assert!(MAX_BOXES <= 1 << Levels::INDEX_BITS);

/// Boxes around the spheres of a tree.
#[derive(Clone, Debug)]
pub struct Levels {
    /// From the top down; there is one at least.
    pub(super) groups: Vec<Vec<Group>>,
    /// Of each box at the bottom the first sphere, and how many there are.
    pub(super) spheres: Vec<(u32, u32)>,
    /// How many spheres there are in all boxes.
    pub(super) sphere_count: usize,
}

/// The sides of sixteen boxes: the smallest x, y, z, then the largest. A box that is none ends before it begins, so that no ray
/// whose numbers are not beyond [`is_plain`](super::sixteen::is_plain) meets it.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Group(pub(super) [[f32; WIDTH]; 6]);

impl Levels {
    /// A box's number has as many bits.
    pub(super) const INDEX_BITS: u32 = 16;

    /// Of a tree; `None` without one, or of one that is too large, or if this machine has no instructions to use them.
    #[must_use]
    pub fn of(tree: Tree<'_>) -> Option<Self> {
        let nodes = tree.nodes();
        if nodes.len() <= Node::ROOT as usize || !is_usable() {
            return None;
        }
        // Nodes branch: half of them at least are at the bottom.
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

    /// The memory that they take, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let groups = self.groups.iter().map(|groups| size_of_val(&groups[..]));
        groups.sum::<usize>() + size_of_val(&self.spheres[..])
    }
}

fn is_usable() -> bool {
    #[cfg(target_arch = "x86_64")]
    return super::avx512::Avx512::of(crate::cpu::InstructionSet::chosen()).is_some();
    #[cfg(not(target_arch = "x86_64"))]
    return false;
}

/// A box, and the spheres in it if it is at the bottom.
struct Bottom {
    low: Vec3,
    high: Vec3,
    spheres: (u32, u32),
}

fn groups(boxes: &[Bottom]) -> Vec<Group> {
    let group = |some: &[Bottom]| {
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

/// What is around boxes.
fn around(boxes: &[Bottom]) -> Bottom {
    let none = Bottom {
        low: Vec3::MAX,
        high: Vec3::MIN,
        spheres: (0, 0),
    };
    boxes.iter().fold(none, |all, of| Bottom {
        low: all.low.min(of.low),
        high: all.high.max(of.high),
        ..all
    })
}

/// Adds what is at the bottom below a node.
fn collect(nodes: &[Node], at: u32, boxes: &mut Vec<Bottom>) {
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
        // Spheres of neighbours follow each other.
        match boxes[first_here..].last_mut() {
            Some(last) if !node.has_nodes() && last.spheres.1 + count <= WIDTH as u32 => {
                last.low = last.low.min(low);
                last.high = last.high.max(high);
                last.spheres.1 += count;
            }
            _ => boxes.push(Bottom {
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
