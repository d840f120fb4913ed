//! Rays by the million: what they hit, and whether they hit anything, without an image.
//!
//! | module | holds |
//! | --- | --- |
//! | [`cpu`] | [`CpuTracer`]: on every thread of this machine |
//! | [`gpu`] | [`GpuTracer`]: on a GPU |
//! | `single` | rays one by one on the CPU: which of the ways below they take |
//! | `search` | a ray on its way among spheres, four of them side by side |
//! | `walk`, `wide` | rays through a tree, the eight boxes of a node side by side |
//! | `boxes_avx2`, `boxes_avx512` | those boxes with AVX2, and with AVX-512 |
//! | `levels`, `stream`, `sixteen` | boxes of sixteen boxes, and sixteen rays that go through them together, with AVX-512 |
//! | `avx512` | the proof that this machine has AVX-512, and sixteen spheres against one ray |

#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "x86_64")]
mod boxes_avx2;
#[cfg(target_arch = "x86_64")]
mod boxes_avx512;
pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
pub(crate) mod levels;
mod search;
pub(crate) mod single;
#[cfg(target_arch = "x86_64")]
mod sixteen;
#[cfg(target_arch = "x86_64")]
mod stream;
#[cfg(target_arch = "x86_64")]
mod walk;
#[cfg(target_arch = "x86_64")]
mod wide;

pub use cpu::CpuTracer;
#[cfg(feature = "gpu")]
pub use gpu::GpuTracer;
