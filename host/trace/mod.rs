//! Traces rays by the million without an image: what each ray hits, or whether it hits anything.
//!
//! | module | holds |
//! | --- | --- |
//! | [`cpu`] | [`CpuTracer`]: on every thread of this machine |
//! | [`gpu`] | [`GpuTracer`]: on a GPU |
//! | `single` | rays on the CPU: chooses among the ways below |
//! | `search` | one ray's search among spheres, four spheres at a time |
//! | `few` | rays among few spheres, sixteen rays side by side |
//! | `walk`, `wide` | rays through a tree, all eight boxes of a node at once |
//! | `boxes`, `sort` | the test of those boxes, and their order along the ray |
//! | `levels`, `stream`, `sixteen` | boxes of sixteen boxes, and sixteen rays that go through them together, with AVX-512 |
//! | `avx2`, `avx512` | the proofs that this machine has them; culling of sixteen spheres for one ray |

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "x86_64")]
mod boxes;
pub mod cpu;
mod few;
#[cfg(feature = "gpu")]
pub mod gpu;
#[cfg(target_arch = "x86_64")]
pub(crate) mod levels;
#[cfg(not(target_arch = "x86_64"))]
#[path = "no_levels.rs"]
pub(crate) mod levels;
#[cfg(test)]
mod sample_rays;
mod search;
pub(crate) mod single;
#[cfg(target_arch = "x86_64")]
mod sixteen;
#[cfg(target_arch = "x86_64")]
mod sort;
#[cfg(target_arch = "x86_64")]
mod stream;
#[cfg(target_arch = "x86_64")]
mod walk;
#[cfg(target_arch = "x86_64")]
mod wide;

pub use cpu::CpuTracer;
#[cfg(feature = "gpu")]
pub use gpu::GpuTracer;
