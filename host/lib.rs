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
//! | [`scene`] | what is rendered; it knows no file |
//! | [`read`] | files: scenes in TOML, particles, images of the surroundings |
//! | [`look`] | from particles to a world |
//! | [`device`] | adapters, buffers, kernels, launches, and their errors |
//! | [`accel`] | building the tree of boxes around the spheres |
//! | [`trace`] | rays by the million, without an image |
//! | [`mod@render`] | a scene on a device, GPU or CPU |
//! | [`film`] | images: encoding, comparison |
//! | `write` | outputs: checked before the work, written whole or not at all |
//! | [`mod@choose`] | which rung a scene calls for |
//! | [`accuracy`] | how right the rungs of the ladder are, decided by an exact oracle |
//! | [`mod@bench`] | how fast rays of every kind are |
//! | [`error`] | [`Error`]: what can go wrong, and how to mend it |
//! | [`cpu`], `lanes` | which vector instructions the CPU has, and vectors as the kernel's numbers |
//! | [`threads`], `memory` | the pool of threads, and memory that may not be there |
//! | [`kernel_module`] | the kernel's SPIR-V that this build embeds |
//! | [`random`], [`ulp`] | repeatable random numbers, distances between floats |
//! | `plural`, `shown` | counts with their nouns, texts of unknown origin as a terminal may show them |
//! | [`cli`] | the command `spherule` |

#![deny(missing_docs)]

pub mod accel;
#[cfg(feature = "lab")]
pub mod accuracy;
#[cfg(feature = "lab")]
pub mod bench;
pub mod choose;
#[cfg(feature = "cli")]
pub mod cli;
pub mod cpu;
pub mod device;
pub mod error;
pub mod film;
#[cfg(feature = "gpu")]
pub mod kernel_module;
mod lanes;
pub mod look;
mod memory;
mod plural;
pub mod random;
pub mod read;
pub mod render;
pub mod scene;
mod shown;
pub mod threads;
pub mod trace;
pub mod ulp;
pub(crate) mod write;

#[cfg(feature = "gpu")]
pub use device::Gpu;
pub use device::{Device, DeviceChoice};
pub use error::{Error, Result};
pub use film::Image;
pub use scene::Scene;
pub use spherule_kernel as kernel;
#[cfg(feature = "gpu")]
pub use wgpu;

/// Compiles the programs of the README and of the book, so that they stay true.
#[cfg(all(doctest, feature = "gpu", feature = "lab"))]
mod book {
    #[doc = include_str!("../README.md")]
    struct Readme;
    #[doc = include_str!("../docs/gpu-errors.md")]
    struct GpuErrors;
    #[doc = include_str!("../docs/library.md")]
    struct Library;
    #[doc = include_str!("../docs/practical.md")]
    struct Practical;
    #[doc = include_str!("../docs/own-kernel.md")]
    struct OwnKernel;
}
