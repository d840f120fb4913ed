//! Which spheres a ray is tested against: all of them, or those in the boxes that it meets. Runs on
//! the GPU and on the CPU.
//!
//! | module | holds |
//! | --- | --- |
//! | [`brute`] | every sphere, one after the other |
//! | `tiles` | every sphere, by workgroups that cull once for all of their pixels; on a GPU only |
//! | [`node`] | [`Node`](node::Node) and [`Tree`](node::Tree): boxes around the spheres |
//! | [`primitives`] | [`Primitives`](primitives::Primitives): what a walk asks about, by index |
//! | [`slabs`] | which boxes of a node a ray may meet |
//! | [`walk`] | a ray's way through a tree |
//! | [`traversal`] | [`Traversal`](traversal::Traversal): how the rays of light paths find what they hit |

pub mod brute;
pub mod node;
pub mod primitives;
pub mod slabs;
#[cfg(all(feature = "entry-points", target_arch = "spirv"))]
pub mod tiles;
pub mod traversal;
pub mod walk;
