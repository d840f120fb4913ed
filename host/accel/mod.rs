//! Building the tree of boxes that the kernel [walks](spherule_kernel::accel::walk).
//!
//! | module | holds |
//! | --- | --- |
//! | [`tree`] | [`BuiltTree`]: the nodes and the order of the spheres; [`Acceleration`]: whether there is one |
//! | [`mod@build`] | from spheres to a tree, on every thread |
//! | `split` | where a part of the spheres is split in two |
//! | `aabb`, `quantise` | boxes along the axes, and as a node holds them |

mod aabb;
pub mod build;
mod quantise;
mod split;
pub mod tree;

pub use build::{build, build_still};
pub use tree::{Acceleration, BYTES_A_SPHERE, BuiltTree, MIN_SPHERES, Nodes};
