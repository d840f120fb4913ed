//! Builds the tree of boxes that the kernel [walks](spherule_kernel::accel::walk).
//!
//! | module | holds |
//! | --- | --- |
//! | [`tree`] | [`BuiltTree`]: the nodes and the order of the spheres; [`Acceleration`]: whether one is built |
//! | [`mod@build`] | builds a tree over spheres, on every thread |
//! | [`shapes`] | [`ShapeTree`]: the shapes beside the spheres, and the tree over them |
//! | `split` | where a part of the spheres is split in two |
//! | `aabb`, `quantise` | axis-aligned boxes, and how a node stores them |

mod aabb;
pub mod build;
mod quantise;
pub mod shapes;
mod split;
pub mod tree;

pub use build::{build, build_shapes, build_still};
pub use shapes::ShapeTree;
pub use tree::{Acceleration, BYTES_A_SPHERE, BuiltTree, MIN_SPHERES, Nodes};
