//! [`BuiltTree`]: a tree as the host keeps it, and whether one is built.

use std::ops::Deref;

use bytemuck::Zeroable;
use rayon::prelude::*;
use spherule_kernel::accel::node::{Node, Tree as NodeTree};

use crate::scene::world::{GRAIN, World};

/// From how many spheres on a tree pays, for single rays on the CPU: 8 with AVX-512; camera rays by
/// squares and rays on a GPU have thresholds of their own.
pub const MIN_SPHERES: usize = 12;

/// What a sphere takes at most while a tree is grown and a world is sorted by it: two items, its shares of the nodes of a thread and of the
/// whole, and its copy.
pub const BYTES_A_SPHERE: u64 = 256;

/// Whether a tree is built.
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
pub struct Nodes(pub(super) Vec<Node>);

impl Nodes {
    /// As walks take them.
    #[inline]
    #[must_use]
    pub fn tree(&self) -> NodeTree<'_> {
        // SAFETY: there are none, or `build` made them.
        unsafe { NodeTree::of_unchecked(&self.0) }
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
pub struct BuiltTree {
    /// The nodes.
    pub nodes: Nodes,
    /// The spheres in the order of the leaves, by their indices. The nodes name them by their places
    /// in here. Of many equal spheres in one place the first alone is among them: no ray finds
    /// another.
    pub order: Vec<u32>,
}

impl BuiltTree {
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
