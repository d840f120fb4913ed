//! [`BuiltTree`]: a tree as the host keeps it; [`Acceleration`]: whether one is built.

use std::ops::Deref;

use bytemuck::Zeroable;
use rayon::prelude::*;
use spherule_kernel::accel::node::{Node, Tree as NodeTree};

use crate::scene::world::{GRAIN, World};

/// The fewest spheres for which a tree pays, for single rays on the CPU; with AVX-512 it is 8.
/// Squares of camera rays and rays on a GPU have thresholds of their own.
pub const MIN_SPHERES: usize = 12;

/// The most bytes that a sphere takes while a tree is built and a world is sorted by it: two items,
/// its shares of one thread's nodes and of all nodes, and its copy.
pub const BYTES_A_SPHERE: u64 = 256;

/// Whether a tree is built.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Acceleration {
    /// If there are enough spheres for a tree to pay.
    #[default]
    Auto,
    /// Always.
    Tree,
    /// Never: each ray is tested against every sphere.
    BruteForce,
}

impl Acceleration {
    /// The fewest spheres that get a tree; `measured` is the number from which one pays.
    #[must_use]
    pub fn min_spheres(self, measured: usize) -> usize {
        match self {
            Self::Auto => measured,
            Self::Tree => 1,
            Self::BruteForce => usize::MAX,
        }
    }
}

/// The nodes of a tree that this module built, the first of them an
/// [`Extent`](spherule_kernel::accel::node::Extent); or no nodes.
#[derive(Clone, Debug, Default)]
pub struct Nodes(pub(super) Vec<Node>);

impl Nodes {
    /// The nodes as walks use them.
    #[inline]
    #[must_use]
    pub fn tree(&self) -> NodeTree<'_> {
        // SAFETY: there are no nodes, or `build` made them.
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
    /// The indices of the spheres in the order of the leaves; nodes refer to spheres by their
    /// positions in it. Of many equal spheres in one place only the first is included: no ray finds
    /// another.
    pub order: Vec<u32>,
}

impl BuiltTree {
    /// The value of each sphere, in the order of the leaves; zeros for spheres beyond the end of
    /// `values`.
    #[must_use]
    pub fn sort<T: Zeroable + Copy + Send + Sync>(&self, values: &[T]) -> Vec<T> {
        let of = |index: &u32| values.get(*index as usize).copied();
        self.order
            .par_iter()
            .with_min_len(GRAIN)
            .map(|index| of(index).unwrap_or(T::zeroed()))
            .collect()
    }

    /// [`BuiltTree::sort`] of values that there may be none of.
    pub(super) fn sort_any<T: Zeroable + Copy + Send + Sync>(&self, values: &[T]) -> Vec<T> {
        if values.is_empty() {
            Vec::new()
        } else {
            self.sort(values)
        }
    }

    /// The world with its spheres in the order of the leaves.
    #[must_use]
    pub fn sort_world(&self, world: &World) -> World {
        World {
            spheres: self.sort(&world.spheres),
            material_ids: self.sort(&world.material_ids),
            velocities: self.sort_any(&world.velocities),
            materials: world.materials.clone(),
            material_names: world.material_names.clone(),
            shapes: world.shapes.clone(),
            shape_material_ids: world.shape_material_ids.clone(),
            shape_velocities: world.shape_velocities.clone(),
        }
    }
}
