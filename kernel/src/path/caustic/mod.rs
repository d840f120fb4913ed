//! Caustics: light that reaches a vertex by one sphere, found exactly. Runs on the GPU and on the
//! CPU.
//!
//! Light that a mirror or a ball of glass throws onto a surface is what path tracing finds by
//! chance: a direction must be guessed that meets a small lamp after the sphere, and a lamp without
//! extent is never met. Here, at each vertex outside of glass, a lamp, a sphere and a point of the
//! lamp are chosen, and all ways between the two points by that sphere are computed. For lamps with
//! an extent both ways of finding the light are weighed by the power heuristic, which bounds what
//! one sample adds where rays cross: there the spread of a path has no bound, but a direction that
//! is sampled finds it well.
//!
//! | module | holds |
//! | --- | --- |
//! | [`ball`] | the equation of a path by a sphere, its roots, and how its rays spread |
//! | [`ways`] | all paths between two points by one sphere |
//! | [`casters`] | the spheres that are looked at |
//! | `connect` | the light that a vertex gets by a sphere |
//! | `chain`, `weight` | what a path remembers that may meet the same light, and how it is weighed |

pub mod ball;
pub mod casters;
pub(super) mod chain;
pub(super) mod connect;
#[cfg(test)]
mod tests;
pub mod ways;
pub(super) mod weight;
