//! [`Node`]: a tree of boxes around the spheres, so that a ray looks at few of them. Runs on the GPU
//! and on the CPU.
//!
//! The nodes stand in the order in which a ray visits them, each with the index of the node that
//! comes after its whole subtree: a ray that misses a box goes there, and nothing needs a stack.
//! Spheres stand in the order of the leaves, so that of two equally near the one of lower index is
//! found first, as without a tree.
//!
//! No box is missed that holds a hit. Boxes are rounded outwards; the differences low − O and high − O
//! keep their signs and are off by u = 2⁻²⁴ at most, the reciprocals and the products by a few u more.
//! A box is passed by only where its far side, taken farther by 2⁻¹⁸ of its distance, is before its near
//! side or before the ray's interval, or its near side behind that (after T. Ize, Robust BVH Ray Traversal, J. Comput.
//! Graph. Tech. 2 (2013)).

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};
use spirv_std::arch::IndexUnchecked;

use crate::effects::Effects;
use crate::hit::Hit;
use crate::nearest::sphere_at;
use crate::precision::intersect;
use crate::ray::Ray;
use crate::sphere::Sphere;

/// A box, and what is in it: other nodes, or spheres. Lengths are in scene units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Node {
    /// The corner of the smallest coordinates.
    pub low: Vec3,
    /// The index of the node after the last one inside of this one.
    pub after: u32,
    /// The corner of the largest coordinates.
    pub high: Vec3,
    /// For a leaf, the index of its first sphere times 16, plus how many it has, from 1 to 15; zero
    /// for a node that holds nodes.
    pub spheres: u32,
}

impl Node {
    /// The most spheres that a tree has room to name.
    pub const MAX_SPHERES: u32 = 1 << 28;
    /// The specialisation constant that is 1 where the pipeline is for worlds with a tree.
    pub const SPEC_ID: u32 = 4;
}

/// 2⁻¹⁸: how much farther, for its size, each far end is taken to be.
const SLACK: f32 = 1.0 / (1 << 18) as f32;

/// What stays the same of a ray as it meets box after box.
#[derive(Clone, Copy)]
struct Slabs {
    origin: Vec3,
    inverse: Vec3,
}

impl Slabs {
    #[inline]
    fn of(ray: &Ray) -> Self {
        let d = ray.direction;
        Self {
            origin: ray.origin,
            inverse: Vec3::new(reciprocal(d.x), reciprocal(d.y), reciprocal(d.z)),
        }
    }

    /// Whether the ray may meet the box between `t_min` and `t_max`.
    #[inline]
    fn may_meet(&self, node: &Node, t_min: f32, t_max: f32) -> bool {
        let low = (node.low - self.origin) * self.inverse;
        let high = (node.high - self.origin) * self.inverse;
        let near = low.min(high);
        let far = low.max(high);
        let far = far + far.abs() * SLACK;
        let near = near.x.max(near.y).max(near.z);
        let far = far.x.min(far.y).min(far.z);
        (near <= far) & (far >= t_min) & (near <= t_max + t_max.abs() * SLACK)
    }
}

/// 1/x; for an x whose reciprocal floats have not, the largest number, so that no product
/// of zero is undefined.
#[inline]
fn reciprocal(x: f32) -> f32 {
    if x.abs() > 2.0 * f32::MIN_POSITIVE {
        1.0 / x
    } else {
        f32::MAX
    }
}

/// The nearest hit of `ray` on this rung among the spheres of a tree, where each is at `time`.
#[inline]
#[must_use]
pub fn nearest_hit_in_tree(
    effects: Effects,
    rung: u32,
    ray: &Ray,
    nodes: &[Node],
    spheres: &[Sphere],
    velocities: &[Vec4],
    time: f32,
) -> Hit {
    let slabs = Slabs::of(ray);
    let mut ray = *ray;
    let mut hit = Hit::NONE;
    let mut at = 0;
    while at < nodes.len() {
        // SAFETY: `at` is below the length of the slice.
        let node = unsafe { *nodes.index_unchecked(at) };
        let mut next = node.after;
        if slabs.may_meet(&node, ray.t_min, ray.t_max) {
            if node.spheres == 0 {
                next = at as u32 + 1;
            }
            let mut index = node.spheres >> 4;
            let end = (index + (node.spheres & 15)).min(spheres.len() as u32);
            while index < end {
                let sphere = sphere_at(effects, spheres, velocities, index as usize, time);
                let t = intersect(rung, sphere, &ray);
                if t < ray.t_max {
                    ray.t_max = t;
                    hit = Hit { t, sphere: index };
                }
                index += 1;
            }
        }
        // Forward, whatever the node says.
        at = (next as usize).max(at + 1);
    }
    hit
}

/// Whether `ray` hits any sphere of a tree, where each is at `time`.
#[inline]
#[must_use]
pub fn is_occluded_in_tree(
    effects: Effects,
    rung: u32,
    ray: &Ray,
    nodes: &[Node],
    spheres: &[Sphere],
    velocities: &[Vec4],
    time: f32,
) -> bool {
    let slabs = Slabs::of(ray);
    let mut found = false;
    let mut at = 0;
    while (at < nodes.len()) & !found {
        // SAFETY: `at` is below the length of the slice.
        let node = unsafe { *nodes.index_unchecked(at) };
        let mut next = node.after;
        if slabs.may_meet(&node, ray.t_min, ray.t_max) {
            if node.spheres == 0 {
                next = at as u32 + 1;
            }
            let mut index = node.spheres >> 4;
            let end = (index + (node.spheres & 15)).min(spheres.len() as u32);
            while (index < end) & !found {
                let sphere = sphere_at(effects, spheres, velocities, index as usize, time);
                found = intersect(rung, sphere, ray) < ray.t_max;
                index += 1;
            }
        }
        // Forward, whatever the node says.
        at = (next as usize).max(at + 1);
    }
    found
}

const _: () = {
    assert!(size_of::<Node>() == 32);
    assert!(core::mem::offset_of!(Node, after) == 12);
    assert!(core::mem::offset_of!(Node, high) == 16);
    assert!(core::mem::offset_of!(Node, spheres) == 28);
};
