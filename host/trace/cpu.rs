//! [`CpuTracer`]: rays on every thread of this machine.

use rayon::prelude::*;
use spherule_kernel::accel::node::Tree;
use spherule_kernel::accel::walk::work_in_tree;
use spherule_kernel::{Hit, Ray, Rung, Sphere};

use super::levels::Levels;
use super::single::Single;
use crate::accel::{self, Acceleration, MIN_SPHERES, Nodes};

/// Rays that a thread takes at once.
const GRAIN: usize = 1 << 10;

/// Spheres, and the tree over them if one pays.
#[derive(Clone, Debug)]
pub struct CpuTracer {
    spheres: Vec<Sphere>,
    nodes: Nodes,
    levels: Option<Levels>,
    /// For each sphere in the order of the leaves, its index in the input; empty without a tree.
    order: Vec<u32>,
}

impl CpuTracer {
    /// Builds the tree.
    #[must_use]
    pub fn new(spheres: &[Sphere], acceleration: Acceleration) -> Self {
        match accel::build_still(spheres, acceleration.min_spheres(MIN_SPHERES)) {
            Some(tree) => Self {
                spheres: tree.sort(spheres),
                levels: Levels::of(tree.nodes.tree()),
                nodes: tree.nodes,
                order: tree.order,
            },
            None => Self {
                spheres: spheres.to_vec(),
                nodes: Nodes::default(),
                levels: None,
                order: Vec::new(),
            },
        }
    }

    /// The memory that spheres, nodes and levels take, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let levels = self.levels.as_ref().map_or(0, Levels::bytes);
        size_of_val(&self.spheres[..]) + size_of_val(&self.nodes[..]) + levels
    }

    /// Traces rays on this rung.
    #[must_use]
    fn single(&self, rung: Rung) -> Single<'_> {
        Single::new(rung, self.nodes.tree(), self.levels.as_ref())
    }

    /// The tree; without nodes if none was built.
    #[must_use]
    pub fn tree(&self) -> Tree<'_> {
        self.nodes.tree()
    }

    /// For each sphere in the order of the tree's leaves, its index in the input; empty without a
    /// tree.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Finds the nearest hit of each ray, with the sphere's index in the input. `hits` is resized
    /// to the length of `rays`.
    pub fn nearest(&self, rung: Rung, rays: &[Ray], hits: &mut Vec<Hit>) {
        hits.resize(rays.len(), Hit::NONE);
        let single = self.single(rung);
        let spheres = &self.spheres[..];
        hits.par_chunks_mut(GRAIN)
            .zip(rays.par_chunks(GRAIN))
            .for_each(|(hits, rays)| {
                single.trace::<false>(rays, &[], spheres, |index, mut hit| {
                    if let Some(given) = self.order.get(hit.sphere as usize) {
                        hit.sphere = *given;
                    }
                    hits[index] = hit;
                });
            });
    }

    /// Finds whether each ray hits anything: 1 or 0. `occluded` is resized to the length of `rays`.
    pub fn occluded(&self, rung: Rung, rays: &[Ray], occluded: &mut Vec<u32>) {
        occluded.resize(rays.len(), 0);
        let single = self.single(rung);
        let spheres = &self.spheres[..];
        occluded
            .par_chunks_mut(GRAIN)
            .zip(rays.par_chunks(GRAIN))
            .for_each(|(occluded, rays)| {
                single.trace::<true>(rays, &[], spheres, |index, hit| {
                    occluded[index] = u32::from(hit.is_some());
                });
            });
    }

    /// How many nodes and how many spheres all rays together test in the tree; `None` without a
    /// tree. With `any`, each ray stops at its first hit.
    #[must_use]
    pub fn work(&self, rung: Rung, any: bool, rays: &[Ray]) -> Option<(u64, u64)> {
        if self.nodes.is_empty() {
            return None;
        }
        let spheres = &self.spheres[..];
        let of = |ray: &Ray| {
            let work = work_in_tree(rung.to_u32(), any, ray, self.tree(), spheres);
            (u64::from(work.nodes), u64::from(work.spheres))
        };
        Some(
            rays.par_iter()
                .map(of)
                .reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1)),
        )
    }
}
