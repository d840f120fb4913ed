//! Builds a tree of boxes over spheres, or over other shapes, on every thread.
//!
//! Top down, by the surface area heuristic over bins (I. Wald, On fast Construction of SAH-based
//! Bounding Volume Hierarchies, RT 2007). The parts of a node are split in two again until the node
//! has its eight children. A part that fits into a node one level lower is not split, so that nodes
//! are full at the bottom, where most of them are. Within a node, each axis is split once before
//! any is split again, unless the middles are much farther apart along one: this way the octant of
//! a ray gives the order of the children. The spheres of a node of up to 32 are distributed among
//! its children by the same heuristic, over every place where they could be split.

use glam::{UVec4, Vec3};
use rayon::prelude::*;
use spherule_kernel::Sphere;
use spherule_kernel::accel::node::{Extent, Node, Tree as NodeTree};
use spherule_kernel::shape::Shape;

use super::aabb::{Aabb, Item};
use super::quantise::{corner_of, put_sides, sides};
use super::split::{Part, SHARED, split, split_along, widest_axis};
use super::tree::{BuiltTree, Nodes};
use crate::scene::world::{GRAIN, bits_of};

/// The words that tell what a tree is built over apart.
const KEY: usize = 16;
/// The most spheres in a node that has no nodes as children.
const FULL: usize = Node::WIDTH * Node::MAX_LEAF;

/// Builds a tree over spheres that move while the shutter is open; those beyond the end of
/// `velocities` are at rest. Returns `None` if there are no spheres or fewer than `min_spheres`, if
/// a number is not finite or is beyond [`Node::MAX_COORDINATE`], or if there are more spheres than
/// nodes can index.
#[must_use]
pub fn build(
    spheres: &[Sphere],
    velocities: &[Vec3],
    shutter: (f32, f32),
    min_spheres: usize,
) -> Option<BuiltTree> {
    let count = spheres.len();
    if !(min_spheres.max(1)..=Node::MAX_SPHERES as usize).contains(&count) {
        return None;
    }
    let still = Vec3::ZERO;
    let items: Vec<Item> = spheres
        .par_iter()
        .enumerate()
        .with_min_len(GRAIN)
        .map(|(index, sphere)| {
            let velocity = velocities.get(index).copied().unwrap_or(still);
            let bounds = if velocity == still {
                Aabb::of(sphere)
            } else {
                Aabb::of_moving(sphere, velocity, shutter)
            };
            Item::new(index as u32, bounds)
        })
        .collect();
    let smallest_radius = spheres
        .par_iter()
        .with_min_len(GRAIN)
        .map(|sphere| sphere.radius().abs())
        .reduce(|| f32::MAX, f32::min);
    let velocities = if shutter == (0.0, 0.0) {
        &[]
    } else {
        velocities
    };
    let key = |index: u32| {
        let velocity = velocities.get(index as usize).copied();
        let bits = bits_of(&spheres[index as usize], velocity.unwrap_or_default());
        let mut key = [0; KEY];
        key[..bits.len()].copy_from_slice(&bits);
        key
    };
    grow(items, smallest_radius, Given { key: &key })
}

/// [`build`] over other shapes, of any number.
#[must_use]
pub fn build_shapes(
    shapes: &[Shape],
    velocities: &[Vec3],
    shutter: (f32, f32),
) -> Option<BuiltTree> {
    if !(1..=Node::MAX_SPHERES as usize).contains(&shapes.len()) {
        return None;
    }
    let velocity_of = |index: usize| velocities.get(index).copied().unwrap_or_default();
    let items: Vec<Item> = shapes
        .par_iter()
        .enumerate()
        .with_min_len(GRAIN)
        .map(|(index, shape)| {
            let bounds = Aabb::of_shape(shape, velocity_of(index), shutter);
            Item::new(index as u32, bounds)
        })
        .collect();
    let smallest_radius = shapes
        .par_iter()
        .with_min_len(GRAIN)
        .map(|shape| shape.thickness(shape.kinds()))
        .reduce(|| f32::MAX, f32::min);
    let key = |index: u32| {
        let velocity = velocity_of(index as usize).to_array().map(f32::to_bits);
        let mut key = [0; KEY];
        key[..12].copy_from_slice(bytemuck::cast_slice(&[shapes[index as usize]]));
        key[12..15].copy_from_slice(&velocity);
        key
    };
    grow(items, smallest_radius, Given { key: &key })
}

/// Grows a tree over boxes; `None` if one of them is not finite or beyond what nodes hold.
fn grow(mut items: Vec<Item>, smallest_radius: f32, given: Given<'_>) -> Option<BuiltTree> {
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
        .map(|items| (Aabb::of_all(items), Aabb::of_middles(items)))
        .reduce(
            || (Aabb::EMPTY, Aabb::EMPTY),
            |a, b| (a.0.with(b.0), a.1.with(b.1)),
        );
    let extent = Extent {
        low: bounds.low.truncate(),
        high: bounds.high.truncate(),
        smallest_radius,
    };
    // Splits of many items sort into it.
    let room = if items.len() < SHARED { 0 } else { items.len() };
    let scratch = (0..room).into_par_iter().with_min_len(GRAIN);
    let mut scratch: Vec<Item> = scratch.map(|_| Item::NONE).collect();
    let whole = Part {
        items: &mut items,
        scratch: &mut scratch,
        bounds,
        middles,
        weights: Vec3::ONE,
    };
    let branch = Branch::build(whole, 0, given);
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
    debug_assert!(NodeTree::of(&nodes).is_some());
    let nodes = Nodes(nodes);
    Some(BuiltTree { nodes, order })
}

/// [`build`] over spheres at rest.
#[must_use]
pub fn build_still(spheres: &[Sphere], min_spheres: usize) -> Option<BuiltTree> {
    build(spheres, &[], (0.0, 0.0), min_spheres)
}

/// A node and everything below it.
struct Branch {
    /// The node. Its indices are relative to the starts of `nodes` and `order`.
    node: Node,
    /// The nodes below that one thread built.
    nodes: Vec<Node>,
    order: Vec<u32>,
    /// The branches that other threads built: the children that are nodes.
    branches: Vec<Branch>,
}

/// What the tree is built over: bits that are the same exactly for those that are equal and move
/// alike, by index.
#[derive(Clone, Copy)]
struct Given<'a> {
    key: &'a (dyn Fn(u32) -> [u32; KEY] + Sync),
}

impl<'a> Part<'a> {
    /// Whether all middles are the same, so that no plane separates the items.
    fn is_in_one_place(&self) -> bool {
        (self.middles.high - self.middles.low).truncate() == Vec3::ZERO
    }

    /// Keeps the one with the lowest index of equal spheres and drops the rest: a ray that hits a
    /// dropped one hits the kept one at the same distance. Boxes stay as they are. This is done
    /// only if all middles are in one place, so that it costs ordinary worlds nothing. Elsewhere, a
    /// ray that hits equal spheres finds the first of them in the tree, which may not have the
    /// lowest index.
    fn without_copies(self, given: Given<'_>) -> Self {
        if !self.is_in_one_place() {
            return self;
        }
        let by_key = |a: &Item, b: &Item| {
            let order = (given.key)(a.index()).cmp(&(given.key)(b.index()));
            order.then(a.index().cmp(&b.index()))
        };
        self.items.par_sort_unstable_by(by_key);
        let mut kept = 1;
        for at in 1..self.items.len() {
            if (given.key)(self.items[at].index()) != (given.key)(self.items[kept - 1].index()) {
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
    fn build(part: Part<'_>, depth: usize, given: Given<'_>) -> Self {
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
            branch.node = build_alone(part, depth, given, &mut branch.nodes, &mut branch.order);
            return branch;
        }
        let part = part.without_copies(given);
        let (node, inner) = make_node(part, depth, 0, &mut branch.order);
        branch.node = node;
        branch.branches = inner
            .into_par_iter()
            .map(|part| Self::build(part, depth + 1, given))
            .collect();
        branch
    }

    /// The number of nodes below this one.
    fn count_nodes(&self) -> usize {
        let below = self.branches.iter().map(|branch| 1 + branch.count_nodes());
        self.nodes.len() + below.sum::<usize>()
    }

    fn count_spheres(&self) -> usize {
        let below = self.branches.iter().map(Self::count_spheres);
        self.order.len() + below.sum::<usize>()
    }

    /// Moves the node and everything below it to their places in the tree. `nodes` has room for the
    /// nodes below, the first of which has the index `first_node`; `order` has room for the
    /// spheres.
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

/// The node over these items. What is below it is appended to `nodes` and `order`.
fn build_alone(
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
        let child = build_alone(part, depth + 1, given, nodes, order);
        nodes[first + index] = child;
    }
    node
}

/// Makes the node over these items, and returns it with its children that are nodes. `first_node`
/// is the index of the first of them. The node's own spheres are appended to `order`.
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
            // The part with the largest surface among those too large for a lower node, until there
            // is none. A part whose middles are in one place is not split: it may be copies of one
            // sphere.
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

/// The most items in a child of a node over `count` items: as many as fit into a node one level
/// lower.
fn child_size(count: usize) -> usize {
    let mut size = FULL;
    while size * Node::WIDTH < count {
        size *= Node::WIDTH;
    }
    size
}

/// Distributes at most [`FULL`] items among at most `places` children, each with one to
/// [`Node::MAX_LEAF`].
fn share_out<'a>(items: &'a mut [Item], places: usize, weights: Vec3, parts: &mut Vec<Part<'a>>) {
    let count = items.len();
    if count == 1 || places == 1 {
        let bounds = Aabb::of_all(items);
        parts.push(Part {
            items,
            scratch: &mut [],
            bounds,
            middles: Aabb::EMPTY,
            weights,
        });
        return;
    }
    let axis = widest_axis(items, weights);
    sort_by_middle(items, axis);
    let weights = split_along(weights, axis);
    let mut right = [0.0; FULL];
    let mut bounds = Aabb::EMPTY;
    for at in (1..count).rev() {
        bounds = bounds.with(items[at].bounds());
        right[at] = bounds.area() * (count - at) as f32;
    }
    let mut best = (f32::INFINITY, 0, 0);
    let mut bounds = Aabb::EMPTY;
    for at in 1..count {
        bounds = bounds.with(items[at - 1].bounds());
        let cost = bounds.area() * at as f32 + right[at];
        // Places in proportion to the items, within what both sides need.
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
        // Integers in the order of the floats, negative ones included.
        let bits = (item.low[axis] + item.high[axis]).to_bits();
        let flip = (bits.cast_signed() >> 31).cast_unsigned() | 1 << 31;
        *key = u64::from(bits ^ flip) << 32 | at as u64;
    }
    keys[..count].sort_unstable();
    for (item, key) in items.iter_mut().zip(keys) {
        *item = copy[(key & 0xffff_ffff) as usize];
    }
}

/// A place for each child, such that a ray of any octant meets nearer children before farther ones:
/// bit k of a place says that it is on the high side along axis k. The best pair of child and place
/// is assigned first.
fn places(parts: &[Part<'_>], bounds: &Aabb) -> [usize; Node::WIDTH] {
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

/// The sides of a box whose high side is below its low side: no ray meets it.
const CLOSED_LOW: Vec3 = Vec3::splat(1e38);
const CLOSED_HIGH: Vec3 = Vec3::splat(1e-30);

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::accuracy::families::Family;
    use crate::random::Random;
    use crate::scene::World;
    use crate::trace::levels::Levels;
    use crate::trace::single::Single;
    use spherule_kernel::accel::brute::nearest_hit_in;
    use spherule_kernel::accel::walk::{is_occluded_in_tree, nearest_hit_in_tree, work_in_tree};
    use spherule_kernel::{Hit, Ray, Rung};
    use std::collections::HashSet;

    struct Built {
        world: World,
        nodes: Nodes,
        order: Vec<u32>,
    }

    impl Built {
        fn over(world: &World) -> Self {
            let tree = build_still(&world.spheres, 1).expect("a tree");
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

    /// The tree loses no hit: tree and brute force return the same distance on every rung, also for
    /// the oracle's hard families inside a world.
    #[test]
    fn a_tree_finds_what_testing_every_sphere_finds() {
        for (name, mut world) in worlds() {
            let center = world.spheres[0].center();
            for (_, sphere) in Family::ALL.iter().flat_map(|f| f.sample(3, 40)) {
                world.add(sphere, 0);
            }
            let built = Built::over(&world);
            let levels = Levels::of(built.nodes.tree());
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
            let spheres = &built.world.spheres[..];
            for rung in Rung::ALL {
                let mut by_several = [
                    vec![Hit::NONE; rays.len()],
                    vec![Hit::NONE; rays.len()],
                    vec![Hit::NONE; rays.len()],
                ];
                let [nearest, any, all] = &mut by_several;
                let in_tree = Single::new(rung, built.nodes.tree(), levels.as_ref());
                in_tree.trace::<false>(&rays, &[], spheres, |index, hit| nearest[index] = hit);
                in_tree.trace::<true>(&rays, &[], spheres, |index, hit| any[index] = hit);
                let in_none = Single::new(rung, NodeTree::NONE, None);
                in_none.trace::<false>(&rays, &[], spheres, |index, hit| all[index] = hit);
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
                    let found = nearest_hit_in_tree(rung, ray, built.nodes.tree(), spheres);
                    assert_eq!(found, brute, "{name} {ray:?}");
                    hits += usize::from(found.is_some());
                    let shadow = is_occluded_in_tree(rung, ray, built.nodes.tree(), spheres);
                    assert_eq!(shadow, brute.is_some(), "{name} {rung} {ray:?}");
                }
            }
            assert!(hits > 3000, "{name}: {hits} hits tell little");
        }
    }

    /// The boxes of a node's children as the kernel reads them, and their links.
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

    /// Walks everything below a node and checks that each sphere appears once, inside the box of
    /// its child, and that a parent's boxes enclose the spheres of its children.
    fn visit(built: &Built, at: usize, depth: usize, seen: &mut [bool], nodes: &mut usize) -> Aabb {
        assert!(depth < Node::MAX_DEPTH);
        *nodes += 1;
        let node = built.nodes[at];
        let mut all = Aabb::EMPTY;
        let mut inner = 0;
        let mut next = node.links.y;
        for (place, (low, high, count)) in children(&node).into_iter().enumerate() {
            let is_node = node.is_node(place as u32);
            let inside = if is_node {
                assert_eq!(count, 0);
                let child = node.links.x as usize + inner;
                inner += 1;
                visit(built, child, depth + 1, seen, nodes)
            } else {
                let mut bounds = Aabb::EMPTY;
                for index in next..next + count {
                    let index = index as usize;
                    assert!(!seen[index]);
                    seen[index] = true;
                    bounds = bounds.with(Aabb::of(&built.world.spheres[index]));
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
            let built = Built::over(&world);
            let mut seen = vec![false; built.order.len()];
            let mut nodes = 1;
            let root = Node::ROOT as usize;
            let _ = visit(&built, root, 0, &mut seen, &mut nodes);
            assert!(seen.iter().all(|seen| *seen), "{name}");
            assert_eq!(nodes, built.nodes.len(), "{name}");
            // Every sphere that was left out is a copy of a kept one with a lower index.
            let kept: HashSet<u32> = built.order.iter().copied().collect();
            for (index, sphere) in world.spheres.iter().enumerate() {
                let first = world.spheres.iter().position(|other| other == sphere);
                assert!(
                    kept.contains(&(index as u32)) || first < Some(index),
                    "{name}"
                );
            }
            for (sphere, of) in built.world.spheres.iter().zip(&built.order) {
                assert_eq!(*sphere, world.spheres[*of as usize]);
            }
        }
    }

    /// The mean work of rays from outside in a tree over `count` spheres: nodes plus spheres.
    fn work_of(count: usize) -> f64 {
        const RAYS: u32 = 4000;
        let mut random = Random::new(5);
        let radius = 0.5 / (count as f32).cbrt();
        let spheres: Vec<Sphere> = (0..count)
            .map(|_| Sphere::new(random.vec3(-1.0, 1.0), radius))
            .collect();
        let tree = build_still(&spheres, 1).expect("a tree");
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

    /// A tree whose root has only two children, because it is slightly too large for one level
    /// less, is also walked in order.
    #[test]
    fn a_level_more_costs_little() {
        let (full, loose) = (work_of(120_000), work_of(200_000));
        assert!(loose < 1.08 * full, "{full} and {loose}");
    }

    /// Many equal spheres cost a ray no more than one does, also with other spheres around. Moving
    /// spheres are equal only if they move alike.
    #[test]
    fn of_equal_spheres_the_first_is_kept() {
        let mut random = Random::new(8);
        let copy = Sphere::new(Vec3::new(0.5, 0.25, -3.0), 0.125);
        let mut spheres = vec![copy; 1000];
        assert_eq!(build_still(&spheres, 1).expect("a tree").order, [0]);
        spheres.splice(
            300..300,
            (0..500).map(|_| Sphere::new(random.vec3(-4.0, 4.0), 0.2)),
        );
        let shells = (0..500).map(|shell| Sphere::new(copy.center(), 0.2 + 1e-3 * shell as f32));
        spheres.extend(shells);
        let tree = build_still(&spheres, 1).expect("a tree");
        let copies = tree
            .order
            .iter()
            .filter(|index| spheres[**index as usize] == copy);
        assert_eq!(copies.copied().collect::<Vec<u32>>(), [0]);
        assert_eq!(tree.order.len(), 1001);

        let mut velocities = vec![Vec3::ZERO; 1000];
        velocities[300..600].fill(Vec3::X);
        velocities[600..].fill(Vec3::Y);
        let moving = build(&[copy; 1000], &velocities, (-1.0, 1.0), 1);
        let mut order = moving.expect("a tree").order;
        order.sort_unstable();
        assert_eq!(order, [0, 300, 600]);
    }

    #[test]
    fn no_spheres_get_no_tree() {
        assert!(build_still(&[], 0).is_none());
    }

    #[test]
    fn a_world_that_is_not_finite_gets_no_tree() {
        let (_, mut world) = worlds().remove(0);
        world.add(Sphere::new(Vec3::NAN, 1.0), 0);
        assert!(build_still(&world.spheres, 1).is_none());
    }
}
