//! What only a GPU has: entry points, and instructions that stand in for a function's plain text.

#[cfg(all(feature = "entry-points", target_arch = "spirv"))]
pub mod deferred;
#[cfg(all(feature = "entry-points", target_arch = "spirv"))]
pub mod entry;
pub mod instructions;
