//! [`ShapeTree`]: the shapes of a world beside its spheres, in the order of the tree over them.

use glam::Vec3;
use spherule_kernel::shape::{Kinds, Shape, Shapes};

use super::build::build_shapes;
use super::tree::Nodes;
use crate::scene::World;

/// The shapes of a world beside its spheres, in the order of the tree over them, and the tree.
#[derive(Clone, Debug, Default)]
pub struct ShapeTree {
    /// The kinds that there are.
    pub kinds: Kinds,
    /// The shapes.
    pub shapes: Vec<Shape>,
    /// For each, the index of its material.
    pub material_ids: Vec<u32>,
    /// For each, its velocity; empty if none moves.
    pub velocities: Vec<Vec3>,
    /// The tree.
    pub nodes: Nodes,
}

impl ShapeTree {
    /// Grows a tree over the shapes of a world that move while the shutter is open. It is empty if
    /// there are none, or if a number is not finite.
    #[must_use]
    pub fn of(world: &World, shutter: (f32, f32)) -> Self {
        let Some(tree) = build_shapes(&world.shapes, &world.shape_velocities, shutter) else {
            return Self::default();
        };
        Self {
            kinds: world.kinds(),
            shapes: tree.sort(&world.shapes),
            material_ids: tree.sort(&world.shape_material_ids),
            velocities: tree.sort_any(&world.shape_velocities),
            nodes: tree.nodes,
        }
    }

    /// The shapes as the kernel takes them: their indices in hits begin at `first`.
    #[must_use]
    pub fn shapes(&self, first: u32) -> Shapes<'_> {
        Shapes {
            kinds: self.kinds,
            shapes: &self.shapes,
            tree: self.nodes.tree(),
            first,
        }
    }
}
