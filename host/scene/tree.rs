//! Building the tree of boxes that the kernel's [`tree`](spherule_kernel::tree) walks: top down, by
//! the surface area heuristic over bins (I. Wald, On fast Construction of SAH-based Bounding Volume
//! Hierarchies, RT 2007), on every thread.

use glam::{DVec3, Vec3};
use spherule_kernel::Sphere;
use spherule_kernel::tree::Node;

use super::World;

/// Bins along the axis that is split.
const BINS: usize = 16;
/// What a box costs against a sphere.
const BOX_COST: f32 = 0.5;
/// The most spheres in a leaf.
const MAX_LEAF: usize = 4;
/// Below this many spheres a thread goes on alone.
const GRAIN: usize = 4096;
/// Below this many spheres testing each is cheaper than a tree: measured by `spherule accuracy
/// --scene` on worlds of growing size.
pub const MIN_SPHERES: usize = 12;

/// A world whose spheres stand in the order of a tree's leaves, and the tree.
#[derive(Clone, Debug, Default)]
pub struct Grown {
    /// The world, in the order of the leaves.
    pub world: World,
    /// The nodes, in the order in which a ray visits them; empty where there is no tree.
    pub nodes: Vec<Node>,
}

#[derive(Clone, Copy)]
struct Bounds {
    low: Vec3,
    high: Vec3,
}

impl Bounds {
    const EMPTY: Self = Self {
        low: Vec3::splat(f32::MAX),
        high: Vec3::splat(f32::MIN),
    };

    /// Of a sphere, wherever it is while the shutter is open, rounded outwards.
    fn of(sphere: &Sphere, velocity: Vec3, shutter: (f32, f32)) -> Self {
        let radius = DVec3::splat(f64::from(sphere.radius().abs()));
        let at = |time: f32| {
            let moved = velocity.as_dvec3() * f64::from(time);
            sphere.center().as_dvec3() + moved
        };
        let (first, last) = (at(shutter.0), at(shutter.1));
        let size = sphere.center().as_dvec3().abs() + first.abs().max(last.abs());
        // The kernel moves a sphere in 32 bits, which rounds its centre twice.
        let moves = velocity != Vec3::ZERO;
        let outwards = |x: DVec3, up: bool| {
            Vec3::from_array([0, 1, 2].map(|axis| {
                let x = x[axis];
                let slack = if moves { size[axis] * 4e-7 } else { 0.0 };
                if up {
                    ((x + slack) as f32).next_up()
                } else {
                    ((x - slack) as f32).next_down()
                }
            }))
        };
        Self {
            low: outwards(first.min(last) - radius, false),
            high: outwards(first.max(last) + radius, true),
        }
    }

    fn with(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    fn area(&self) -> f32 {
        let side = (self.high - self.low).max(Vec3::ZERO);
        side.x * side.y + side.y * side.z + side.z * side.x
    }
}

#[derive(Clone, Copy)]
struct Item {
    index: u32,
    bounds: Bounds,
    middle: Vec3,
}

/// Grows a tree over `world`, whose spheres move while the shutter is open. Without one where it
/// would not pay, where a number is not finite, or where there are more spheres than nodes can name.
#[must_use]
pub fn grow(world: &World, shutter: (f32, f32)) -> Option<Grown> {
    let count = world.spheres.len();
    if !(MIN_SPHERES..=Node::MAX_SPHERES as usize).contains(&count) {
        return None;
    }
    let mut items: Vec<Item> = world
        .spheres
        .iter()
        .enumerate()
        .map(|(index, sphere)| {
            let velocity = world.velocities.get(index).copied().unwrap_or(Vec3::ZERO);
            let bounds = Bounds::of(sphere, velocity, shutter);
            Item {
                index: index as u32,
                bounds,
                middle: 0.5 * bounds.low + 0.5 * bounds.high,
            }
        })
        .collect();
    let is_finite = |item: &Item| item.bounds.low.is_finite() && item.bounds.high.is_finite();
    if !items.iter().all(is_finite) {
        return None;
    }
    let nodes = split(&mut items, 0);
    let pick = |index: usize| items[index].index as usize;
    let order = 0..count;
    let mut ordered = World {
        materials: world.materials.clone(),
        material_names: world.material_names.clone(),
        ..World::default()
    };
    ordered.spheres = order.clone().map(|i| world.spheres[pick(i)]).collect();
    ordered.material_ids = order.clone().map(|i| world.material_ids[pick(i)]).collect();
    if world.velocities.len() == count {
        ordered.velocities = order.map(|i| world.velocities[pick(i)]).collect();
    }
    Some(Grown {
        world: ordered,
        nodes,
    })
}

/// The nodes of these items, which are put into the order of the leaves; the first of them is
/// sphere `first`. Indices of nodes count from the first of these.
fn split(items: &mut [Item], first: u32) -> Vec<Node> {
    let bounds = items
        .iter()
        .fold(Bounds::EMPTY, |bounds, item| bounds.with(item.bounds));
    let node = |after: u32, spheres: u32| Node {
        low: bounds.low,
        after,
        high: bounds.high,
        spheres,
    };
    let leaf = |items: &[Item]| vec![node(1, first << 4 | items.len() as u32)];
    if items.len() == 1 {
        return leaf(items);
    }
    let middle = match best_split(items, &bounds) {
        Some((axis, at)) => partition(items, |item| item.middle[axis] < at),
        None if items.len() <= MAX_LEAF => return leaf(items),
        // All in one place, or boxes that gain nothing: by halves.
        None => items.len() / 2,
    };
    let (left, right) = items.split_at_mut(middle);
    let second = first + left.len() as u32;
    let (left, right) = if left.len() + right.len() > GRAIN {
        rayon::join(|| split(left, first), || split(right, second))
    } else {
        (split(left, first), split(right, second))
    };
    let mut nodes = Vec::with_capacity(1 + left.len() + right.len());
    nodes.push(node((1 + left.len() + right.len()) as u32, 0));
    let shifted = |part: &[Node], by: u32| -> Vec<Node> {
        part.iter()
            .map(|node| Node {
                after: node.after + by,
                ..*node
            })
            .collect()
    };
    nodes.extend(shifted(&left, 1));
    nodes.extend(shifted(&right, 1 + left.len() as u32));
    nodes
}

/// The axis and the place of the cheapest split; `None` if a leaf is cheaper, or nothing can be
/// split.
fn best_split(items: &[Item], bounds: &Bounds) -> Option<(usize, f32)> {
    let (low, high) = items.iter().fold(
        (Vec3::splat(f32::MAX), Vec3::splat(f32::MIN)),
        |(low, high), item| (low.min(item.middle), high.max(item.middle)),
    );
    let mut best = None;
    let mut cheapest = if items.len() <= MAX_LEAF {
        items.len() as f32
    } else {
        f32::MAX
    };
    for axis in 0..3 {
        let width = high[axis] - low[axis];
        if !(width > 0.0 && width.is_finite()) {
            continue;
        }
        let place = |bin: usize| low[axis] + width * (bin as f32 / BINS as f32);
        let mut bins = [(Bounds::EMPTY, 0_usize); BINS];
        for item in items {
            let bin = ((item.middle[axis] - low[axis]) / width * BINS as f32) as usize;
            // Where rounding puts an item into the wrong bin, the partition decides by place.
            let bin = bin.min(BINS - 1);
            bins[bin] = (bins[bin].0.with(item.bounds), bins[bin].1 + 1);
        }
        let mut right = [(0.0, 0); BINS];
        let mut so_far = (Bounds::EMPTY, 0);
        for bin in (1..BINS).rev() {
            so_far = (so_far.0.with(bins[bin].0), so_far.1 + bins[bin].1);
            right[bin] = (so_far.0.area(), so_far.1);
        }
        let mut left = (Bounds::EMPTY, 0);
        for bin in 1..BINS {
            left = (left.0.with(bins[bin - 1].0), left.1 + bins[bin - 1].1);
            let (right_area, right_count) = right[bin];
            if left.1 == 0 || right_count == 0 {
                continue;
            }
            let cost = 2.0 * BOX_COST
                + (left.0.area() * left.1 as f32 + right_area * right_count as f32)
                    / bounds.area().max(f32::MIN_POSITIVE);
            if cost < cheapest {
                cheapest = cost;
                best = Some((axis, place(bin)));
            }
        }
    }
    // A place that rounding leaves at one end splits nothing.
    best.filter(|(axis, at)| {
        let before = items.iter().filter(|item| item.middle[*axis] < *at).count();
        before > 0 && before < items.len()
    })
}

/// Puts those that `belongs` before the others, keeping the order of both; says how many.
fn partition(items: &mut [Item], belongs: impl Fn(&Item) -> bool) -> usize {
    let (mut left, right): (Vec<Item>, Vec<Item>) = items.iter().partition(|item| belongs(item));
    let count = left.len();
    left.extend(right);
    items.copy_from_slice(&left);
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::families::Family;
    use crate::accuracy::random::Random;
    use spherule_kernel::nearest::{is_occluded, nearest_hit_in};
    use spherule_kernel::tree::{is_occluded_in_tree, nearest_hit_in_tree};
    use spherule_kernel::{Effects, Ray, Rung};

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
            let grown = grow(&world, (0.0, 0.0)).expect("a tree");
            let mut random = Random::new(5);
            let mut rays: Vec<Ray> = (0..2000)
                .map(|i| {
                    let origin = center + random.vec3(-8.0, 8.0);
                    let aim = world.spheres[i % world.spheres.len()];
                    let at = aim.center() + random.unit_vec3() * aim.radius();
                    Ray::new(origin, at - origin)
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
            // The lower rungs find hits where there are none, and a box keeps them from some.
            for rung in [Rung::Compensated, Rung::Double, Rung::Certified] {
                let rung = rung.to_u32();
                for ray in &rays {
                    let brute = nearest_hit_in(rung, ray, &world.spheres, 0, u32::MAX);
                    let none = Effects::NONE;
                    let found = nearest_hit_in_tree(
                        none,
                        rung,
                        ray,
                        &grown.nodes,
                        &grown.world.spheres,
                        &[],
                        0.0,
                    );
                    assert_eq!(found.t, brute.t, "{name} {ray:?}");
                    hits += usize::from(found.is_some());
                    let shadow = is_occluded_in_tree(
                        none,
                        rung,
                        ray,
                        &grown.nodes,
                        &grown.world.spheres,
                        &[],
                        0.0,
                    );
                    assert_eq!(shadow, is_occluded(rung, ray, &world.spheres));
                }
            }
            assert!(hits > 3000, "{name}: {hits} hits tell little");
        }
    }

    #[test]
    fn every_sphere_is_in_one_leaf_and_inside_of_its_boxes() {
        for (name, world) in worlds() {
            let grown = grow(&world, (0.0, 0.0)).expect("a tree");
            let mut next = 0;
            for (at, node) in grown.nodes.iter().enumerate() {
                assert!(node.after as usize > at && node.after as usize <= grown.nodes.len());
                if node.spheres > 0 {
                    assert_eq!(node.spheres >> 4, next, "{name}");
                    next += node.spheres & 15;
                }
                let inside = at + 1..node.after as usize;
                for child in &grown.nodes[inside] {
                    assert!(child.low.cmpge(node.low).all() && child.high.cmple(node.high).all());
                }
            }
            assert_eq!(next as usize, world.spheres.len());
        }
    }

    #[test]
    fn a_world_that_is_not_finite_gets_no_tree() {
        let (_, mut world) = worlds().remove(0);
        world.add(Sphere::new(Vec3::NAN, 1.0), 0);
        assert!(grow(&world, (0.0, 0.0)).is_none());
    }
}
