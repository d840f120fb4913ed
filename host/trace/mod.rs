//! Rays by the million: what they hit, and whether they hit anything, without an image.
//!
//! | module | holds |
//! | --- | --- |
//! | [`cpu`] | [`CpuTracer`]: on every thread of this machine |
//! | `single` | rays one by one on the CPU, several boxes and spheres side by side |
//! | `levels` | boxes of sixteen boxes, for worlds that are not too large |
//! | [`gpu`] | [`GpuTracer`]: on a GPU |

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
pub mod cpu;
pub mod gpu;
pub(crate) mod levels;
pub(crate) mod single;
#[cfg(target_arch = "x86_64")]
mod sixteen;
#[cfg(target_arch = "x86_64")]
mod stream;
#[cfg(target_arch = "x86_64")]
mod walk;

pub use cpu::CpuTracer;
pub use gpu::GpuTracer;
