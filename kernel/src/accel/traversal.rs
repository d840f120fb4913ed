//! [`Traversal`]: how the rays of light paths find what they hit. Runs on the GPU and on the CPU.

use crate::accel::brute::{MovingSpheres, is_occluded, nearest_hit_in};
use crate::accel::node::Tree;
use crate::accel::walk::{is_occluded_in_tree, nearest_hit_in_tree};
use crate::hit::Hit;
use crate::ray::Ray;

/// Finds what rays hit. A host may have a faster traversal than the kernel's, with the same
/// answers. If a hit's index is beyond the spheres, the sphere is read as zeros.
pub trait Traversal {
    /// The nearest hit; of two equally near hits, the one with the lower index.
    fn nearest_hit(&self, ray: &Ray, spheres: &MovingSpheres<'_>) -> Hit;

    /// Whether the ray hits anything.
    fn is_occluded(&self, ray: &Ray, spheres: &MovingSpheres<'_>) -> bool;
}

/// Tests one box and one sphere after the other: the kernel's own traversal.
#[derive(Clone, Copy, Debug)]
pub struct OneByOne<'a> {
    /// The rung, a value of [`Rung::to_u32`](crate::Rung::to_u32).
    pub rung: u32,
    /// 1 if the tree holds the spheres; otherwise every sphere is tested.
    pub has_tree: u32,
    /// The tree.
    pub tree: Tree<'a>,
}

impl Traversal for OneByOne<'_> {
    #[inline]
    fn nearest_hit(&self, ray: &Ray, spheres: &MovingSpheres<'_>) -> Hit {
        if self.has_tree == 1 {
            nearest_hit_in_tree(self.rung, ray, self.tree, spheres)
        } else {
            nearest_hit_in(self.rung, ray, spheres, 0, u32::MAX)
        }
    }

    #[inline]
    fn is_occluded(&self, ray: &Ray, spheres: &MovingSpheres<'_>) -> bool {
        if self.has_tree == 1 {
            is_occluded_in_tree(self.rung, ray, self.tree, spheres)
        } else {
            is_occluded(self.rung, ray, spheres)
        }
    }
}
