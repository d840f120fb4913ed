//! A ray tracer for spheres whose kernel is Rust.
//!
//! rust-gpu compiles the kernel to SPIR-V, wgpu dispatches it, and the very same functions run
//! on the CPU. This crate is the host: it reads scenes, opens devices, renders and validates.
//!
//! # Map, in reading order
//!
//! | module | holds |
//! | --- | --- |
//! | [`kernel`] | the device code and the types shared with it: `Sphere`, `Ray`, `Hit`, `Camera` |
//! | [`scene`] | what is rendered: TOML scenes, molecules from PDB and XYZ files |
//! | [`device`] | adapters, buffers, kernels, launches, and their errors |
//! | [`mod@render`] | a scene on a device, GPU or CPU |
//! | [`trace`] | rays by the million, without an image |
//! | [`accuracy`] | how right the rungs of the ladder are, decided by an exact oracle |
//! | [`mod@bench`] | how fast rays of every kind are |
//! | [`film`] | images: encoding, comparison |
//! | `write` | outputs: checked before the work, written whole or not at all |
//! | [`error`] | [`Error`]: what can go wrong, and how to mend it |
//! | [`threads`] | the pool of threads that work on the CPU is done by |
//! | `memory` | memory of the host that may not be there |
//! | [`kernel_module`] | the kernel's SPIR-V that this build embeds |
//! | [`cpu`] | which vector instructions rays are traced with on the CPU |
//! | `lanes` | vectors as the kernel's numbers |
//! | `plural` | counts with their nouns |
//! | `shown` | texts of unknown origin, as a terminal may show them |
//! | [`cli`] | the command `spherule` |

#![deny(missing_docs)]

pub mod accuracy;
pub mod bench;
#[cfg(feature = "cli")]
pub mod cli;
pub mod cpu;
pub mod device;
pub mod error;
pub mod film;
pub mod kernel_module;
mod lanes;
mod memory;
mod plural;
pub mod render;
pub mod scene;
mod shown;
pub mod threads;
pub mod trace;
pub(crate) mod write;

pub use device::{Device, DeviceChoice, Gpu};
pub use error::{Error, Result};
pub use film::Image;
pub use scene::Scene;
pub use spherule_kernel as kernel;
pub use wgpu;

/// Compiles the programs of the README and of the book, so that they stay true.
#[cfg(doctest)]
mod book {
    #[doc = include_str!("../README.md")]
    struct Readme;
    #[doc = include_str!("../docs/gpu-errors.md")]
    struct GpuErrors;
}
