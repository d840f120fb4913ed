//! Building the tree of boxes that the kernel's [`tree`](spherule_kernel::tree) walks, on every
//! thread.
//!
//! Top down, by the surface area heuristic over bins (I. Wald, On fast Construction of SAH-based
//! Bounding Volume Hierarchies, RT 2007). Two halves are split again until a node has its eight children;
//! a part that fits into a node less high is left alone, so that nodes are full at the bottom, where
//! most of them are. Within a node each axis is split along before one is split along again, unless the middles are much
//! farther apart along it: so that octants tell the children's order. The spheres of one node, up to 32, are shared out among its children by the same
//! heuristic, over every place where they could be split.

use std::array;
use std::ops::Deref;

use bytemuck::Zeroable;
use glam::{DVec3, UVec4, Vec3, Vec4};
use rayon::prelude::*;
use spherule_kernel::Sphere;
use spherule_kernel::tree::{self as kernel, Extent, Node};

use super::world::{GRAIN, World};

/// Bins along an axis, for many spheres and for few.
const BINS: usize = 16;
const FEW_BINS: usize = 8;
const FEW: usize = 256;
/// The most spheres of a node without nodes in it.
const FULL: usize = Node::WIDTH * Node::MAX_LEAF;
/// From this many spheres on, threads share the work on one node.
const SHARED: usize = 1 << 16;
/// Beyond this depth nodes are halved, whatever that costs a ray: 8¹² is more than there can be.
const HALVING_DEPTH: usize = Node::MAX_DEPTH - 12;
/// From how many spheres on a tree pays, for single rays on the CPU: 8 with AVX-512; camera rays by
/// squares and rays on a GPU have thresholds of their own.
pub const MIN_SPHERES: usize = 12;

/// What a sphere takes at most while a tree is grown and a world is sorted by it: two items, its shares of the nodes of a thread and of the
/// whole, and its copy.
pub const BYTES_A_SPHERE: u64 = 256;

/// Whether a tree is grown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Acceleration {
    /// Where there are enough spheres for one to pay.
    #[default]
    Auto,
    /// Always.
    Tree,
    /// Never: each ray is tested against every sphere.
    BruteForce,
}

impl Acceleration {
    /// The fewest spheres that get a tree, where one pays from `measured` on.
    #[must_use]
    pub fn min_spheres(self, measured: usize) -> usize {
        match self {
            Self::Auto => measured,
            Self::Tree => 1,
            Self::BruteForce => usize::MAX,
        }
    }
}

/// The nodes of a tree that was grown here, the first of them an [`Extent`]; or none.
#[derive(Clone, Debug, Default)]
pub struct Nodes(Vec<Node>);

impl Nodes {
    /// As walks take them.
    #[inline]
    #[must_use]
    pub fn tree(&self) -> kernel::Tree<'_> {
        // SAFETY: there are none, or `grow` made them.
        unsafe { kernel::Tree::of_unchecked(&self.0) }
    }
}

impl Deref for Nodes {
    type Target = [Node];

    fn deref(&self) -> &[Node] {
        &self.0
    }
}

/// A tree over spheres.
#[derive(Clone, Debug)]
pub struct Tree {
    /// The nodes.
    pub nodes: Nodes,
    /// The spheres in the order of the leaves, by their indices. The nodes name them by their places
    /// in here. Of many equal spheres in one place the first alone is among them: no ray finds
    /// another.
    pub order: Vec<u32>,
}

impl Tree {
    /// What belongs to each sphere, in the order of the leaves; zeros for spheres beyond the end of `values`.
    #[must_use]
    pub fn sort<T: Zeroable + Copy + Send + Sync>(&self, values: &[T]) -> Vec<T> {
        let of = |index: &u32| values.get(*index as usize).copied();
        self.order
            .par_iter()
            .with_min_len(GRAIN)
            .map(|index| of(index).unwrap_or(T::zeroed()))
            .collect()
    }

    /// The world with its spheres in the order of the leaves.
    #[must_use]
    pub fn sort_world(&self, world: &World) -> World {
        World {
            spheres: self.sort(&world.spheres),
            material_ids: self.sort(&world.material_ids),
            velocities: if world.velocities.is_empty() {
                Vec::new()
            } else {
                self.sort(&world.velocities)
            },
            materials: world.materials.clone(),
            material_names: world.material_names.clone(),
        }
    }
}

/// A box. What the fourth coordinates hold does not matter.
#[derive(Clone, Copy)]
struct Bounds {
    low: Vec4,
    high: Vec4,
}

impl Bounds {
    const EMPTY: Self = Self {
        low: Vec4::splat(f32::MAX),
        high: Vec4::splat(f32::MIN),
    };

    /// Of a sphere at rest, rounded outwards.
    fn of(sphere: &Sphere) -> Self {
        let (center, radius) = (sphere.center(), sphere.radius().abs());
        let low = (center - radius).to_array().map(f32::next_down);
        let high = (center + radius).to_array().map(f32::next_up);
        Self {
            low: Vec3::from_array(low).extend(0.0),
            high: Vec3::from_array(high).extend(0.0),
        }
    }

    /// Of a sphere, wherever it is while the shutter is open, rounded outwards.
    fn of_moving(sphere: &Sphere, velocity: Vec3, shutter: (f32, f32)) -> Self {
        let radius = DVec3::splat(f64::from(sphere.radius().abs()));
        let at = |time: f32| sphere.center().as_dvec3() + velocity.as_dvec3() * f64::from(time);
        let (first, last) = (at(shutter.0), at(shutter.1));
        // The kernel moves a sphere in 32 bits, which rounds its centre twice.
        let size = sphere.center().as_dvec3().abs() + first.abs().max(last.abs());
        let low = first.min(last) - radius - size * 4e-7;
        let high = first.max(last) + radius + size * 4e-7;
        Self {
            low: Vec3::from_array(low.to_array().map(|x| (x as f32).next_down())).extend(0.0),
            high: Vec3::from_array(high.to_array().map(|x| (x as f32).next_up())).extend(0.0),
        }
    }

    fn with(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    fn of_all(items: &[Item]) -> Self {
        items
            .iter()
            .fold(Self::EMPTY, |bounds, item| bounds.with(item.bounds()))
    }

    /// Of twice their middles.
    fn of_middles(items: &[Item]) -> Self {
        items
            .iter()
            .fold(Self::EMPTY, |bounds, item| bounds.with_point(item.middle()))
    }

    fn with_point(self, point: Vec4) -> Self {
        Self {
            low: self.low.min(point),
            high: self.high.max(point),
        }
    }

    /// Half of the surface, or nothing for an empty box.
    fn area(self) -> f32 {
        let side = (self.high - self.low).max(Vec4::ZERO);
        side.x * (side.y + side.z) + side.y * side.z
    }
}

/// A sphere's box, and its index in the bits of `low`'s fourth coordinate.
#[derive(Clone, Copy)]
struct Item {
    low: Vec4,
    high: Vec4,
}

impl Item {
    const NONE: Self = Self {
        low: Vec4::ZERO,
        high: Vec4::ZERO,
    };

    fn new(index: u32, bounds: Bounds) -> Self {
        Self {
            low: bounds.low.truncate().extend(f32::from_bits(index)),
            high: bounds.high,
        }
    }

    fn index(&self) -> u32 {
        self.low.w.to_bits()
    }

    fn bounds(&self) -> Bounds {
        Bounds {
            low: self.low,
            high: self.high,
        }
    }

    /// Twice the middle.
    fn middle(&self) -> Vec4 {
        self.low + self.high
    }
}

/// Grows a tree over spheres that move while the shutter is open; those beyond the end of `velocities` are
/// at rest. Without one where there are none or fewer than `min_spheres`, where a number is not finite or beyond
/// [`Node::MAX_COORDINATE`], or where there are more spheres than nodes can name.
#[must_use]
pub fn grow(
    spheres: &[Sphere],
    velocities: &[Vec3],
    shutter: (f32, f32),
    min_spheres: usize,
) -> Option<Tree> {
    let count = spheres.len();
    if !(min_spheres.max(1)..=Node::MAX_SPHERES as usize).contains(&count) {
        return None;
    }
    let still = Vec3::ZERO;
    let mut items: Vec<Item> = spheres
        .par_iter()
        .enumerate()
        .with_min_len(GRAIN)
        .map(|(index, sphere)| {
            let velocity = velocities.get(index).copied().unwrap_or(still);
            let bounds = if velocity == still {
                Bounds::of(sphere)
            } else {
                Bounds::of_moving(sphere, velocity, shutter)
            };
            Item::new(index as u32, bounds)
        })
        .collect();
    let limit = Vec3::splat(Node::MAX_COORDINATE);
    let is_within = |item: &Item| {
        let size = item.low.truncate().abs().max(item.high.truncate().abs());
        size.cmplt(limit).all()
    };
    if !items.par_iter().with_min_len(GRAIN).all(is_within) {
        return None;
    }
    let (bounds, middles) = items
        .par_chunks(GRAIN)
        .map(|items| (Bounds::of_all(items), Bounds::of_middles(items)))
        .reduce(
            || (Bounds::EMPTY, Bounds::EMPTY),
            |a, b| (a.0.with(b.0), a.1.with(b.1)),
        );
    let smallest_radius = spheres
        .par_iter()
        .with_min_len(GRAIN)
        .map(|sphere| sphere.radius().abs())
        .reduce(|| f32::MAX, f32::min);
    let extent = Extent {
        low: bounds.low.truncate(),
        high: bounds.high.truncate(),
        smallest_radius,
    };
    // What splits of many items are sorted into.
    let room = if count < SHARED { 0 } else { count };
    let scratch = (0..room).into_par_iter().with_min_len(GRAIN);
    let mut scratch: Vec<Item> = scratch.map(|_| Item::NONE).collect();
    let whole = Part {
        items: &mut items,
        scratch: &mut scratch,
        bounds,
        middles,
        weights: Vec3::ONE,
    };
    let given = Given {
        spheres,
        velocities: if shutter == (0.0, 0.0) {
            &[]
        } else {
            velocities
        },
    };
    let branch = Branch::grow(whole, 0, given);
    let above = Node::ROOT as usize + 1;
    let mut nodes = bytemuck::zeroed_vec::<Node>(above + branch.count_nodes());
    let mut order = bytemuck::zeroed_vec::<u32>(branch.count_spheres());
    let (top, below) = nodes.split_at_mut(above);
    top[0] = extent.to_node();
    branch.put(
        &mut top[Node::ROOT as usize],
        (above as u32, below),
        (0, &mut order),
    );
    debug_assert!(kernel::Tree::of(&nodes).is_some());
    let nodes = Nodes(nodes);
    Some(Tree { nodes, order })
}

/// [`grow`] over spheres at rest.
#[must_use]
pub fn grow_still(spheres: &[Sphere], min_spheres: usize) -> Option<Tree> {
    grow(spheres, &[], (0.0, 0.0), min_spheres)
}

/// A node and what is below it.
struct Branch {
    /// The node; its indices count from the starts of `nodes` and `order`.
    node: Node,
    /// What was grown below by one thread.
    nodes: Vec<Node>,
    order: Vec<u32>,
    /// What was grown below by others: the children that are nodes.
    branches: Vec<Branch>,
}

/// A child of a node: which items, and their box.
struct Part<'a> {
    items: &'a mut [Item],
    /// Room for as many items, where threads share the work on them.
    scratch: &'a mut [Item],
    bounds: Bounds,
    /// The box of twice their middles, of a part that may be split.
    middles: Bounds,
    /// What an axis counts for when the next split's is chosen: less, once the node was split along it.
    weights: Vec3,
}

/// What a tree is grown over.
#[derive(Clone, Copy)]
struct Given<'a> {
    spheres: &'a [Sphere],
    /// Empty where nothing moves.
    velocities: &'a [Vec3],
}

impl Given<'_> {
    /// What equal spheres have in common, bit for bit.
    fn key(&self, index: u32) -> [u32; 7] {
        let sphere = &self.spheres[index as usize];
        let velocity = self.velocities.get(index as usize).copied();
        let [x, y, z] = sphere.center().to_array().map(f32::to_bits);
        let [u, v, w] = velocity.unwrap_or_default().to_array().map(f32::to_bits);
        [x, y, z, sphere.radius().to_bits(), u, v, w]
    }
}

impl<'a> Part<'a> {
    /// Whether all middles are the same, so that no plane tells the items apart.
    fn is_in_one_place(&self) -> bool {
        (self.middles.high - self.middles.low).truncate() == Vec3::ZERO
    }

    /// Of equal spheres the one with the lowest index, the rest left out: wherever a ray meets the
    /// others it meets that one, too. Boxes stay as they are. Done only where the middles are in one place, which costs ordinary
    /// worlds nothing; elsewhere a ray that meets equal spheres finds the one that comes first in the tree, which need not be
    /// the one with the lowest index.
    fn without_copies(self, given: Given<'_>) -> Self {
        if !self.is_in_one_place() {
            return self;
        }
        let by_key = |a: &Item, b: &Item| {
            let order = given.key(a.index()).cmp(&given.key(b.index()));
            order.then(a.index().cmp(&b.index()))
        };
        self.items.par_sort_unstable_by(by_key);
        let mut kept = 1;
        for at in 1..self.items.len() {
            if given.key(self.items[at].index()) != given.key(self.items[kept - 1].index()) {
                self.items[kept] = self.items[at];
                kept += 1;
            }
        }
        let room = self.scratch.len().min(kept);
        Self {
            items: &mut self.items[..kept],
            scratch: &mut self.scratch[..room],
            ..self
        }
    }
}

impl Branch {
    fn grow(part: Part<'_>, depth: usize, given: Given<'_>) -> Self {
        let mut branch = Self {
            node: Node::default(),
            nodes: Vec::new(),
            order: Vec::new(),
            branches: Vec::new(),
        };
        let count = part.items.len();
        if count < GRAIN {
            branch.nodes.reserve(count / 8);
            branch.order.reserve(count);
            branch.node = grow_alone(part, depth, given, &mut branch.nodes, &mut branch.order);
            return branch;
        }
        let part = part.without_copies(given);
        let (node, inner) = make_node(part, depth, 0, &mut branch.order);
        branch.node = node;
        branch.branches = inner
            .into_par_iter()
            .map(|part| Self::grow(part, depth + 1, given))
            .collect();
        branch
    }

    /// How many nodes there are below this one.
    fn count_nodes(&self) -> usize {
        let below = self.branches.iter().map(|branch| 1 + branch.count_nodes());
        self.nodes.len() + below.sum::<usize>()
    }

    fn count_spheres(&self) -> usize {
        let below = self.branches.iter().map(Self::count_spheres);
        self.order.len() + below.sum::<usize>()
    }

    /// Puts the node and what is below it where they belong in the tree: `nodes` has room for those below it, the first of which is number
    /// `first_node`, and `order` for its spheres.
    fn put(
        self,
        node: &mut Node,
        (first_node, nodes): (u32, &mut [Node]),
        (first_sphere, order): (u32, &mut [u32]),
    ) {
        let moved = |node: Node| {
            let mut node = node;
            node.links.x += first_node;
            node.links.y += first_sphere;
            node
        };
        *node = moved(self.node);
        let (own, mut order) = order.split_at_mut(self.order.len());
        own.copy_from_slice(&self.order);
        if self.branches.is_empty() {
            for (place, node) in nodes.iter_mut().zip(self.nodes) {
                *place = moved(node);
            }
            return;
        }
        let (children, mut nodes) = nodes.split_at_mut(self.branches.len());
        let mut first_node = first_node + children.len() as u32;
        let mut first_sphere = first_sphere + own.len() as u32;
        let mut work = Vec::with_capacity(children.len());
        for (child, branch) in children.iter_mut().zip(self.branches) {
            let (below, rest) = nodes.split_at_mut(branch.count_nodes());
            let (spheres, others) = order.split_at_mut(branch.count_spheres());
            (nodes, order) = (rest, others);
            let starts = (first_node, first_sphere);
            first_node += below.len() as u32;
            first_sphere += spheres.len() as u32;
            work.push((branch, child, (starts.0, below), (starts.1, spheres)));
        }
        work.into_par_iter()
            .for_each(|(branch, child, nodes, order)| branch.put(child, nodes, order));
    }
}

/// The node over these items; what is below it goes to the ends of `nodes` and `order`.
fn grow_alone(
    part: Part<'_>,
    depth: usize,
    given: Given<'_>,
    nodes: &mut Vec<Node>,
    order: &mut Vec<u32>,
) -> Node {
    let first = nodes.len();
    let part = part.without_copies(given);
    let (node, inner) = make_node(part, depth, first as u32, order);
    nodes.resize(first + inner.len(), Node::default());
    for (index, part) in inner.into_iter().enumerate() {
        let child = grow_alone(part, depth + 1, given, nodes, order);
        nodes[first + index] = child;
    }
    node
}

/// A node over these items, whose first child that is a node is at `first_node`; its spheres go to
/// the end of `order`. Returns those children, too.
fn make_node<'a>(
    whole: Part<'a>,
    depth: usize,
    first_node: u32,
    order: &mut Vec<u32>,
) -> (Node, Vec<Part<'a>>) {
    let bounds = whole.bounds;
    let mut parts = Vec::with_capacity(Node::WIDTH);
    if whole.items.len() <= FULL {
        share_out(whole.items, Node::WIDTH, Vec3::ONE, &mut parts);
    } else {
        let limit = child_size(whole.items.len());
        let in_one_place = whole.is_in_one_place();
        parts.push(Part {
            weights: Vec3::ONE,
            ..whole
        });
        while parts.len() < Node::WIDTH {
            // The largest of those that are too large for a lower node, and at last none is.
            // One whose middles are in one place is left whole: it may be copies of one sphere.
            let widest = (0..parts.len())
                .filter(|part| parts[*part].items.len() > limit)
                .filter(|part| in_one_place || !parts[*part].is_in_one_place())
                .max_by(|a, b| parts[*a].bounds.area().total_cmp(&parts[*b].bounds.area()));
            let Some(widest) = widest else { break };
            let part = parts.swap_remove(widest);
            let (left, right) = split(part, depth);
            parts.extend([left, right]);
        }
    }
    let places = places(&parts, &bounds);
    let corner = corner_of(&bounds);
    let [x, y, z] = corner.to_array().map(f32::to_bits);
    let mut node = Node {
        corner: UVec4::new(x, y, z, 0),
        links: UVec4::new(first_node, order.len() as u32, 0, 0),
        ..Node::default()
    };
    let mut sorted: [Option<Part>; Node::WIDTH] = [const { None }; Node::WIDTH];
    for (part, place) in parts.into_iter().zip(places) {
        sorted[place] = Some(part);
    }
    let boxes = sorted.each_ref().map(|part| {
        part.as_ref().map_or((CLOSED_LOW, CLOSED_HIGH), |part| {
            sides(&part.bounds, corner)
        })
    });
    put_sides(&boxes, &mut node);
    let mut inner = Vec::new();
    for (place, part) in sorted.into_iter().enumerate() {
        let Some(part) = part else { continue };
        let count = part.items.len();
        if count <= Node::MAX_LEAF {
            order.extend(part.items.iter().map(Item::index));
            node.links.z |= ((1 << count) - 1) << (4 * place);
        } else {
            node.corner.w |= 1 << (4 * place + 1);
            inner.push(part);
        }
    }
    (node, inner)
}

/// The most items of a child of a node over this many: those that fit into nodes less high by one.
fn child_size(count: usize) -> usize {
    let mut size = FULL;
    while size * Node::WIDTH < count {
        size *= Node::WIDTH;
    }
    size
}

/// Shares at most [`FULL`] items out among at most `places` children, each with one to
/// [`Node::MAX_LEAF`].
fn share_out<'a>(items: &'a mut [Item], places: usize, weights: Vec3, parts: &mut Vec<Part<'a>>) {
    let count = items.len();
    if count == 1 || places == 1 {
        let bounds = Bounds::of_all(items);
        parts.push(Part {
            items,
            scratch: &mut [],
            bounds,
            middles: Bounds::EMPTY,
            weights,
        });
        return;
    }
    let axis = widest_axis(items, weights);
    sort_by_middle(items, axis);
    let weights = split_along(weights, axis);
    let mut right = [0.0; FULL];
    let mut bounds = Bounds::EMPTY;
    for at in (1..count).rev() {
        bounds = bounds.with(items[at].bounds());
        right[at] = bounds.area() * (count - at) as f32;
    }
    let mut best = (f32::INFINITY, 0, 0);
    let mut bounds = Bounds::EMPTY;
    for at in 1..count {
        bounds = bounds.with(items[at - 1].bounds());
        let cost = bounds.area() * at as f32 + right[at];
        // As many places as it has items, in proportion, and as both sides need.
        let rest = count - at;
        let least = at.div_ceil(Node::MAX_LEAF);
        let most = (places.saturating_sub(rest.div_ceil(Node::MAX_LEAF))).min(at);
        if least <= most && (cost < best.0 || best.1 == 0) {
            let even = (places * at + count / 2) / count;
            best = (cost, at, even.clamp(least, most));
        }
    }
    let (_, at, of_left) = best;
    let (left, right) = items.split_at_mut(at);
    share_out(left, of_left, weights, parts);
    share_out(right, places - of_left, weights, parts);
}

/// Sorts at most [`FULL`] items by their middles along an axis.
fn sort_by_middle(items: &mut [Item], axis: usize) {
    let count = items.len();
    let mut keys = [0_u64; FULL];
    let mut copy = [Item::NONE; FULL];
    copy[..count].copy_from_slice(items);
    for (at, (key, item)) in keys.iter_mut().zip(items.iter()).enumerate() {
        // In the order of the floats, negative ones too.
        let bits = (item.low[axis] + item.high[axis]).to_bits();
        let flip = (bits.cast_signed() >> 31).cast_unsigned() | 1 << 31;
        *key = u64::from(bits ^ flip) << 32 | at as u64;
    }
    keys[..count].sort_unstable();
    for (item, key) in items.iter_mut().zip(keys) {
        *item = copy[(key & 0xffff_ffff) as usize];
    }
}

fn widest_axis(items: &[Item], weights: Vec3) -> usize {
    let middles = Bounds::of_middles(items);
    ((middles.high - middles.low).truncate() * weights).max_position()
}

/// Splits a part in two, neither of them empty, where a ray pays least for it.
fn split(part: Part<'_>, depth: usize) -> (Part<'_>, Part<'_>) {
    let Part {
        items,
        scratch,
        middles,
        weights,
        ..
    } = part;
    if depth < HALVING_DEPTH {
        let best = if items.len() < FEW {
            best_split::<FEW_BINS>(items, middles, weights)
        } else {
            best_split::<BINS>(items, middles, weights)
        };
        if let Some(best) = best {
            let (items, scratch) = best.partition(items, scratch);
            let sides = [&best.left, &best.right].map(|bin| (bin.bounds, bin.middles));
            let weights = split_along(weights, best.places.axis);
            return halves(items, scratch, best.left.count, sides, weights);
        }
    }
    // All in one place, or as deep as may be.
    let middle = items.len() / 2;
    let axis = widest_axis(items, weights);
    items.select_nth_unstable_by(middle, |a, b| {
        let order = a.middle()[axis].total_cmp(&b.middle()[axis]);
        // Of spheres around one middle, the smaller together.
        let order = order.then(a.high[axis].total_cmp(&b.high[axis]));
        order.then(a.index().cmp(&b.index()))
    });
    let (left, right) = items.split_at(middle);
    let sides = [left, right].map(|side| (Bounds::of_all(side), Bounds::of_middles(side)));
    halves(items, scratch, middle, sides, weights)
}

/// The two parts of items that are sorted so, with their boxes and those of twice their middles.
fn halves<'a>(
    items: &'a mut [Item],
    scratch: &'a mut [Item],
    middle: usize,
    [of_left, of_right]: [(Bounds, Bounds); 2],
    weights: Vec3,
) -> (Part<'a>, Part<'a>) {
    let (left, right) = items.split_at_mut(middle);
    let (room_left, room_right) = scratch.split_at_mut(middle.min(scratch.len()));
    let half = |items, scratch, (bounds, middles)| Part {
        items,
        scratch,
        bounds,
        middles,
        weights,
    };
    (
        half(left, room_left, of_left),
        half(right, room_right, of_right),
    )
}

/// Octants tell the order of children that lie on one side or the other along each axis, not of four in a row. So an axis that
/// a node was split along is split again only where the middles are much farther apart along it.
fn split_along(mut weights: Vec3, axis: usize) -> Vec3 {
    weights[axis] *= 0.4;
    weights
}

/// Where the middles of items fall: the same arithmetic for all that ask.
#[derive(Clone, Copy)]
struct Places {
    axis: usize,
    low: f32,
    scale: f32,
}

impl Places {
    #[inline]
    fn bin(&self, item: &Item) -> f32 {
        (item.low[self.axis] + item.high[self.axis] - self.low) * self.scale
    }
}

/// A split, and what it makes.
struct Split {
    places: Places,
    bin: usize,
    left: Bin,
    right: Bin,
    /// How many go to the left of each [`GRAIN`] items, where threads share the work.
    of_chunks: Vec<usize>,
}

impl Split {
    /// Puts the items of the left side first, in `items` or, by many threads, in `scratch`. Returns where they are, and the other.
    fn partition<'a>(
        &self,
        items: &'a mut [Item],
        scratch: &'a mut [Item],
    ) -> (&'a mut [Item], &'a mut [Item]) {
        let end = self.bin as f32;
        let is_left = |item: &Item| self.places.bin(item) < end;
        if items.len() >= SHARED {
            partition_shared(items, scratch, &self.of_chunks, is_left);
            return (scratch, items);
        }
        partition(items, is_left);
        (items, scratch)
    }
}

/// Puts the items of the left side first. Without branches, which no processor could foretell.
fn partition(items: &mut [Item], is_left: impl Fn(&Item) -> bool) {
    let mut count = 0;
    for at in 0..items.len() {
        let is_left = is_left(&items[at]);
        items.swap(at, count);
        count += usize::from(is_left);
    }
}

/// Sorts `items` into `sorted`, those of the left side first, of which every [`GRAIN`] have so many; by many threads.
fn partition_shared(
    items: &[Item],
    sorted: &mut [Item],
    of_chunks: &[usize],
    is_left: impl Fn(&Item) -> bool + Sync,
) {
    let (mut left, mut right) = sorted.split_at_mut(of_chunks.iter().sum());
    let mut places = Vec::with_capacity(of_chunks.len());
    for (chunk, count) in items.chunks(GRAIN).zip(of_chunks) {
        let (of_left, rest) = left.split_at_mut(*count);
        left = rest;
        let (of_right, rest) = right.split_at_mut(chunk.len() - count);
        right = rest;
        places.push((chunk, of_left, of_right));
    }
    let copy = || vec![Item::NONE; GRAIN];
    places
        .into_par_iter()
        .for_each_init(copy, |copy, (chunk, left, right)| {
            let copy = &mut copy[..chunk.len()];
            copy.copy_from_slice(chunk);
            partition(copy, &is_left);
            left.copy_from_slice(&copy[..left.len()]);
            right.copy_from_slice(&copy[left.len()..]);
        });
}

/// What fell into a bin.
#[derive(Clone, Copy)]
struct Bin {
    bounds: Bounds,
    /// The box of twice the middles.
    middles: Bounds,
    count: usize,
}

impl Bin {
    const EMPTY: Self = Self {
        bounds: Bounds::EMPTY,
        middles: Bounds::EMPTY,
        count: 0,
    };

    fn with(self, other: Self) -> Self {
        Self {
            bounds: self.bounds.with(other.bounds),
            middles: self.middles.with(other.middles),
            count: self.count + other.count,
        }
    }

    fn cost(self) -> f32 {
        self.bounds.area() * self.count as f32
    }
}

fn bins_of<const N: usize>(items: &[Item], places: &Places) -> [Bin; N] {
    let mut bins = [Bin::EMPTY; N];
    for item in items {
        let bin = &mut bins[(places.bin(item) as usize).min(N - 1)];
        bin.bounds = bin.bounds.with(item.bounds());
        bin.middles = bin.middles.with_point(item.middle());
        bin.count += 1;
    }
    bins
}

/// The cheapest split between bins along the axis on which the middles are farthest apart; `None` if all are in
/// one place.
fn best_split<const N: usize>(items: &[Item], middles: Bounds, weights: Vec3) -> Option<Split> {
    let width = (middles.high - middles.low).truncate();
    let axis = (width * weights).max_position();
    let scale = N as f32 * (1.0 - 1e-6) / width[axis];
    if !scale.is_finite() {
        return None;
    }
    let places = Places {
        axis,
        low: middles.low[axis],
        scale,
    };
    let chunks: Vec<[Bin; N]> = if items.len() >= SHARED {
        let bins = items.par_chunks(GRAIN).map(|chunk| bins_of(chunk, &places));
        bins.collect()
    } else {
        Vec::new()
    };
    let bins: [Bin; N] = if chunks.is_empty() {
        bins_of(items, &places)
    } else {
        array::from_fn(|at| {
            chunks
                .iter()
                .fold(Bin::EMPTY, |sum, bins| sum.with(bins[at]))
        })
    };

    let mut right = [Bin::EMPTY; N];
    let mut sum = Bin::EMPTY;
    for at in (1..N).rev() {
        sum = sum.with(bins[at]);
        right[at] = sum;
    }
    let mut best = None;
    let mut cheapest = f32::MAX;
    let mut left = Bin::EMPTY;
    for at in 1..N {
        left = left.with(bins[at - 1]);
        let cost = left.cost() + right[at].cost();
        if left.count > 0 && right[at].count > 0 && cost < cheapest {
            cheapest = cost;
            best = Some((at, left, right[at]));
        }
    }
    best.map(|(bin, left, right)| Split {
        places,
        bin,
        left,
        right,
        of_chunks: chunks
            .iter()
            .map(|bins| bins[..bin].iter().map(|bin| bin.count).sum())
            .collect(),
    })
}

/// A place for each child, so that a ray of any octant meets the nearer before the farther: bit k of
/// a place says that it is on the high side along axis k. The best pair of child and place first.
fn places(parts: &[Part<'_>], bounds: &Bounds) -> [usize; Node::WIDTH] {
    let middle = bounds.low + bounds.high;
    let offsets = parts
        .iter()
        .map(|part| (part.bounds.low + part.bounds.high) - middle);
    let mut gains = [[0.0; Node::WIDTH]; Node::WIDTH];
    for (gains, offset) in gains.iter_mut().zip(offsets) {
        for (place, gain) in gains.iter_mut().enumerate() {
            let signed = |axis: usize| {
                if place >> axis & 1 == 1 {
                    offset[axis]
                } else {
                    -offset[axis]
                }
            };
            *gain = signed(0) + signed(1) + signed(2);
        }
    }
    let mut places = [0; Node::WIDTH];
    for _ in 0..parts.len() {
        let best = gains[..parts.len()]
            .iter()
            .map(|gains| gains.iter().copied().fold(f32::NEG_INFINITY, f32::max))
            .enumerate()
            .fold((0, f32::NEG_INFINITY), |best, (child, gain)| {
                if gain > best.1 { (child, gain) } else { best }
            });
        let child = best.0;
        let place = gains[child].iter().position(|gain| *gain == best.1);
        let place = place.unwrap_or_default();
        places[child] = place;
        gains[child] = [f32::NEG_INFINITY; Node::WIDTH];
        for gains in &mut gains {
            gains[place] = f32::NEG_INFINITY;
        }
    }
    places
}

/// Sides of a box that ends before it begins, which no ray meets.
const CLOSED_LOW: Vec3 = Vec3::splat(1e38);
const CLOSED_HIGH: Vec3 = Vec3::splat(1e-30);

/// What a node's sides are told from: a little below the corner of smallest coordinates, so that no
/// distance is zero or so small that it is no normal number.
fn corner_of(bounds: &Bounds) -> Vec3 {
    let (low, high) = (bounds.low.truncate(), bounds.high.truncate());
    let below = low - (high - low) * (1.0 / 512.0) - 1e-27;
    Vec3::from_array(below.to_array().map(f32::next_down))
}

/// How far a box's sides are from the corner, rounded outwards to floats.
fn sides(bounds: &Bounds, corner: Vec3) -> (Vec3, Vec3) {
    let corner = corner.as_dvec3();
    let low = (bounds.low.truncate().as_dvec3() - corner).as_vec3();
    let high = (bounds.high.truncate().as_dvec3() - corner).as_vec3();
    (
        Vec3::from_array(low.to_array().map(f32::next_down)),
        Vec3::from_array(high.to_array().map(f32::next_up)),
    )
}

/// Puts the sides of the eight boxes, rounded outwards to what a node has room for.
fn put_sides(boxes: &[(Vec3, Vec3); Node::WIDTH], node: &mut Node) {
    const LAST: usize = Node::WIDTH / 2;
    for axis in 0..3 {
        for word in 0..LAST {
            let (first, last) = (&boxes[word], &boxes[LAST + word]);
            // Positive floats are in the order of their bits.
            let low = first.0[axis].to_bits() >> 16;
            let high = first.1[axis].to_bits().div_ceil(1 << 16);
            // The word as a whole is the other's: at most its low side, at least its high side.
            let low = (last.0[axis].to_bits().saturating_sub(low) >> 16) << 16 | low;
            let high = (last.1[axis].to_bits().saturating_sub(high)).div_ceil(1 << 16) << 16 | high;
            node.sides[axis][word] = low;
            node.sides[3 + axis][word] = high;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::families::Family;
    use crate::accuracy::random::Random;
    use crate::trace::levels::Levels;
    use crate::trace::single::Single;
    use spherule_kernel::nearest::nearest_hit_in;
    use spherule_kernel::tree::{is_occluded_in_tree, nearest_hit_in_tree, work_in_tree};
    use spherule_kernel::{Hit, Ray, Rung};
    use std::collections::HashSet;

    struct Grown {
        world: World,
        nodes: Nodes,
        order: Vec<u32>,
    }

    impl Grown {
        fn over(world: &World) -> Self {
            let tree = grow_still(&world.spheres, 1).expect("a tree");
            Self {
                world: tree.sort_world(world),
                nodes: tree.nodes,
                order: tree.order,
            }
        }
    }

    fn worlds() -> Vec<(&'static str, World)> {
        let mut random = Random::new(71);
        let mut make = |f: &mut dyn FnMut(&mut Random) -> Sphere| {
            let mut world = World::default();
            let grey = world.add_material(spherule_kernel::Material::default());
            for _ in 0..700 {
                world.add(f(&mut random), grey);
            }
            world
        };
        vec![
            ("even", make(&mut |r| Sphere::new(r.vec3(-4.0, 4.0), 0.2))),
            (
                "huge beside tiny",
                make(&mut |r| {
                    let radius = r.log_within(1e-3, 1e4);
                    Sphere::new(r.unit_vec3() * (radius + r.within(0.0, 5.0)), radius)
                }),
            ),
            (
                "coincident",
                make(&mut |r| Sphere::new((r.vec3(-2.0, 2.0)).round(), 0.5)),
            ),
            (
                "many in one place",
                make(&mut |r| {
                    if r.within(0.0, 1.0) < 0.8 {
                        Sphere::new(Vec3::X, 0.5)
                    } else {
                        Sphere::new(r.vec3(-2.0, 2.0), 0.2)
                    }
                }),
            ),
            (
                "concentric",
                make(&mut |r| Sphere::new(Vec3::ONE, r.log_within(0.1, 9.0))),
            ),
            (
                "far away",
                make(&mut |r| Sphere::new(Vec3::new(1e6, -2e6, 5e5) + r.vec3(-9.0, 9.0), 0.5)),
            ),
        ]
    }

    /// No hit is lost: tree and brute force name the same distance on every rung whose hits are hits,
    /// among them the oracle's hard families inside of a world.
    #[test]
    fn a_tree_finds_what_testing_every_sphere_finds() {
        for (name, mut world) in worlds() {
            let center = world.spheres[0].center();
            for (_, sphere) in Family::ALL.iter().flat_map(|f| f.sample(3, 40)) {
                world.add(sphere, 0);
            }
            let grown = Grown::over(&world);
            let levels = Levels::of(grown.nodes.tree());
            let mut random = Random::new(5);
            let mut rays: Vec<Ray> = (0..2000)
                .map(|i| {
                    let origin = center + random.vec3(-8.0, 8.0);
                    let aim = world.spheres[i % world.spheres.len()];
                    let at = aim.center() + random.unit_vec3() * aim.radius();
                    match i % 8 {
                        0 => Ray::within(origin, at - origin, -3.0, 0.7),
                        1 => Ray::within(at, at - origin, -0.2, 0.0),
                        2 => Ray::within(origin, (at - origin) * 1e-25, 1e24, f32::INFINITY),
                        _ => Ray::new(origin, at - origin),
                    }
                })
                .collect();
            rays.extend(
                Family::ALL
                    .iter()
                    .flat_map(|f| f.sample(3, 40))
                    .map(|(ray, _)| ray),
            );
            for axis in [Vec3::X, Vec3::Y, Vec3::NEG_Z, Vec3::new(0.0, -0.0, 1.0)] {
                rays.push(Ray::new(center - axis * 20.0, axis));
            }
            let mut hits = 0;
            let spheres = &grown.world.spheres[..];
            for rung in Rung::ALL {
                let mut by_several = [
                    vec![Hit::NONE; rays.len()],
                    vec![Hit::NONE; rays.len()],
                    vec![Hit::NONE; rays.len()],
                ];
                let [nearest, any, all] = &mut by_several;
                let in_tree = Single::new(rung, grown.nodes.tree(), levels.as_ref());
                in_tree.trace::<false, _>(&rays, spheres, |index, hit| nearest[index] = hit);
                in_tree.trace::<true, _>(&rays, spheres, |index, hit| any[index] = hit);
                let in_none = Single::new(rung, kernel::Tree::NONE, None);
                in_none.trace::<false, _>(&rays, spheres, |index, hit| all[index] = hit);
                let rung = rung.to_u32();
                for (index, ray) in rays.iter().enumerate() {
                    let brute = nearest_hit_in(rung, ray, spheres, 0, u32::MAX);
                    assert_eq!(by_several[0][index], brute, "{name} {ray:?}");
                    assert_eq!(
                        by_several[1][index].is_some(),
                        brute.is_some(),
                        "{name} {ray:?}"
                    );
                    assert_eq!(by_several[2][index], brute, "{name} {ray:?}");
                    let found = nearest_hit_in_tree(rung, ray, grown.nodes.tree(), spheres);
                    assert_eq!(found, brute, "{name} {ray:?}");
                    hits += usize::from(found.is_some());
                    let shadow = is_occluded_in_tree(rung, ray, grown.nodes.tree(), spheres);
                    assert_eq!(shadow, brute.is_some(), "{name} {rung} {ray:?}");
                }
            }
            assert!(hits > 3000, "{name}: {hits} hits tell little");
        }
    }

    /// The boxes of a node's children, as the kernel reads them, and their links.
    fn children(node: &Node) -> Vec<(DVec3, DVec3, u32)> {
        let corner = [node.corner.x, node.corner.y, node.corner.z].map(f32::from_bits);
        (0..Node::WIDTH)
            .map(|place| {
                let at = |first: usize| {
                    DVec3::from_array([0, 1, 2].map(|axis| {
                        let word = node.sides[first + axis][place % 4];
                        let side = if place < 4 {
                            Node::lower(word)
                        } else {
                            Node::upper(word)
                        };
                        f64::from(corner[axis]) + f64::from(side)
                    }))
                };
                (at(0), at(3), node.leaf(place as u32).1)
            })
            .collect()
    }

    /// Walks everything below a node: each sphere once, inside of the box that its child has, and each
    /// node's own boxes, which its parent must enclose as far as the parent's spheres go.
    fn visit(
        grown: &Grown,
        at: usize,
        depth: usize,
        seen: &mut [bool],
        nodes: &mut usize,
    ) -> Bounds {
        assert!(depth < Node::MAX_DEPTH);
        *nodes += 1;
        let node = grown.nodes[at];
        let mut all = Bounds::EMPTY;
        let mut inner = 0;
        let mut next = node.links.y;
        for (place, (low, high, count)) in children(&node).into_iter().enumerate() {
            let is_node = node.is_node(place as u32);
            let inside = if is_node {
                assert_eq!(count, 0);
                let child = node.links.x as usize + inner;
                inner += 1;
                visit(grown, child, depth + 1, seen, nodes)
            } else {
                let mut bounds = Bounds::EMPTY;
                for index in next..next + count {
                    let index = index as usize;
                    assert!(!seen[index]);
                    seen[index] = true;
                    bounds = bounds.with(Bounds::of(&grown.world.spheres[index]));
                }
                next += count;
                bounds
            };
            if is_node || count > 0 {
                let inner_low = inside.low.truncate().as_dvec3();
                let inner_high = inside.high.truncate().as_dvec3();
                assert!(low.cmple(inner_low).all() && high.cmpge(inner_high).all());
            }
            all = all.with(inside);
        }
        all
    }

    #[test]
    fn every_sphere_is_in_one_leaf_and_inside_of_its_boxes() {
        for (name, world) in worlds() {
            let grown = Grown::over(&world);
            let mut seen = vec![false; grown.order.len()];
            let mut nodes = 1;
            let root = Node::ROOT as usize;
            let _ = visit(&grown, root, 0, &mut seen, &mut nodes);
            assert!(seen.iter().all(|seen| *seen), "{name}");
            assert_eq!(nodes, grown.nodes.len(), "{name}");
            // What is left out is a copy of one that is not, with a higher index.
            let kept: HashSet<u32> = grown.order.iter().copied().collect();
            for (index, sphere) in world.spheres.iter().enumerate() {
                let first = world.spheres.iter().position(|other| other == sphere);
                assert!(
                    kept.contains(&(index as u32)) || first < Some(index),
                    "{name}"
                );
            }
            for (sphere, of) in grown.world.spheres.iter().zip(&grown.order) {
                assert_eq!(*sphere, world.spheres[*of as usize]);
            }
        }
    }

    /// What rays from outside take in a tree over this many spheres, nodes and spheres together.
    fn work_of(count: usize) -> f64 {
        const RAYS: u32 = 4000;
        let mut random = Random::new(5);
        let radius = 0.5 / (count as f32).cbrt();
        let spheres: Vec<Sphere> = (0..count)
            .map(|_| Sphere::new(random.vec3(-1.0, 1.0), radius))
            .collect();
        let tree = grow_still(&spheres, 1).expect("a tree");
        let sorted = tree.sort(&spheres);
        let all: u32 = (0..RAYS)
            .map(|_| {
                let eye = Vec3::new(0.0, 0.0, -3.5);
                let ray = Ray::new(eye, random.vec3(-1.0, 1.0) - eye);
                let rung = Rung::Robust.to_u32();
                let work = work_in_tree(rung, false, &ray, tree.nodes.tree(), &sorted[..]);
                work.nodes + work.spheres
            })
            .sum();
        f64::from(all) / f64::from(RAYS)
    }

    /// A tree whose root has two children, because it is a little too large for one less high, is entered in order, too.
    #[test]
    fn a_level_more_costs_little() {
        let (full, loose) = (work_of(120_000), work_of(200_000));
        assert!(loose < 1.08 * full, "{full} and {loose}");
    }

    /// Many equal spheres cost a ray no more than one does, wherever else there are some; moving ones
    /// are equal only if they move alike.
    #[test]
    fn of_equal_spheres_the_first_is_kept() {
        let mut random = Random::new(8);
        let copy = Sphere::new(Vec3::new(0.5, 0.25, -3.0), 0.125);
        let mut spheres = vec![copy; 1000];
        assert_eq!(grow_still(&spheres, 1).expect("a tree").order, [0]);
        spheres.splice(
            300..300,
            (0..500).map(|_| Sphere::new(random.vec3(-4.0, 4.0), 0.2)),
        );
        let shells = (0..500).map(|shell| Sphere::new(copy.center(), 0.2 + 1e-3 * shell as f32));
        spheres.extend(shells);
        let tree = grow_still(&spheres, 1).expect("a tree");
        let copies = tree
            .order
            .iter()
            .filter(|index| spheres[**index as usize] == copy);
        assert_eq!(copies.copied().collect::<Vec<u32>>(), [0]);
        assert_eq!(tree.order.len(), 1001);

        let mut velocities = vec![Vec3::ZERO; 1000];
        velocities[300..600].fill(Vec3::X);
        velocities[600..].fill(Vec3::Y);
        let moving = grow(&[copy; 1000], &velocities, (-1.0, 1.0), 1);
        let mut order = moving.expect("a tree").order;
        order.sort_unstable();
        assert_eq!(order, [0, 300, 600]);
    }

    #[test]
    fn no_spheres_get_no_tree() {
        assert!(grow_still(&[], 0).is_none());
    }

    #[test]
    fn a_world_that_is_not_finite_gets_no_tree() {
        let (_, mut world) = worlds().remove(0);
        world.add(Sphere::new(Vec3::NAN, 1.0), 0);
        assert!(grow_still(&world.spheres, 1).is_none());
    }
}
