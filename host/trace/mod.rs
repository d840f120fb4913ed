//! Rays by the million: what they hit, and whether they hit anything, without an image.
//!
//! | module | holds |
//! | --- | --- |
//! | [`cpu`] | [`CpuTracer`]: on every thread of this machine |
//! | [`gpu`] | [`GpuTracer`]: on a GPU |

pub mod cpu;
pub mod gpu;

pub use cpu::CpuTracer;
pub use gpu::GpuTracer;
