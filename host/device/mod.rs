//! Devices: lists them and runs kernels on them.
//!
//! | module | holds |
//! | --- | --- |
//! | [`adapter`] | the list of adapters, and the choice between them |
//! | [`gpu`] | [`Gpu`]: buffers, kernels and launches on one adapter |
//! | [`kernel`] | [`Kernel`]: an entry point, compiled by the driver |
//! | `mapping`, `timer` | mapping device memory for the host; the time of a launch |
//! | [`spirv`] | [`Module`]: SPIR-V, checked and specialised |
//! | [`buffer`] | [`Buffer`]: device memory |
//! | `deferring` | one launch on a rung, or two of which the second answers what the first left open |
//! | [`busy`] | keeps a GPU's clock up before something is timed |
//! | [`canary`] | measures the arithmetic that the upper rungs need |
//! | [`rung`] | the module that runs a rung on a GPU, with 64-bit floats where they pay |
//!
//! This module knows nothing of scenes and images. A program with kernels of its own can use it:
//! see `examples/own-kernel`.

#[cfg(feature = "gpu")]
pub mod adapter;
#[cfg(feature = "gpu")]
pub mod buffer;
#[cfg(feature = "gpu")]
pub mod busy;
#[cfg(feature = "gpu")]
pub mod canary;
mod choice;
#[cfg(feature = "gpu")]
mod deferring;
#[cfg(feature = "gpu")]
mod errors;
#[cfg(feature = "gpu")]
pub mod gpu;
#[cfg(feature = "gpu")]
pub mod kernel;
#[cfg(feature = "gpu")]
mod mapping;
#[cfg(feature = "gpu")]
pub mod rung;
#[cfg(feature = "gpu")]
pub mod spirv;
#[cfg(feature = "gpu")]
mod timer;

use crate::error::Result;
use crate::plural::count_of;
#[cfg(feature = "gpu")]
pub use adapter::{AdapterReport, list_adapters};
#[cfg(feature = "gpu")]
pub use buffer::{Access, Binding, Buffer};
pub use choice::DeviceChoice;
#[cfg(feature = "gpu")]
pub(crate) use deferring::Deferring;
#[cfg(feature = "gpu")]
pub use errors::is_catching;
#[cfg(feature = "gpu")]
pub(crate) use gpu::Staging;
#[cfg(feature = "gpu")]
pub use gpu::{Gpu, GpuOptions};
#[cfg(feature = "gpu")]
pub use kernel::{Kernel, LaunchTime};
#[cfg(feature = "gpu")]
pub use spirv::Module;

/// A device that renders: the CPU or a GPU.
#[derive(Debug)]
pub enum Device {
    /// The CPU, on every thread of rayon's pool.
    Cpu,
    /// A GPU, or a software adapter.
    #[cfg(feature = "gpu")]
    Gpu(Box<Gpu>),
}

impl Device {
    /// Opens the device that `choice` selects. Also returns the reason for the choice, in a few
    /// words.
    ///
    /// # Errors
    ///
    /// The errors of [`Gpu::open`], if a GPU was requested. [`DeviceChoice::Auto`] never fails: if
    /// a GPU does not open, the CPU is used.
    #[cfg(feature = "gpu")]
    pub fn open(choice: &DeviceChoice) -> Result<(Self, String)> {
        let started = std::time::Instant::now();
        let (adapter, reason) = adapter::choose(choice)?;
        let Some(adapter) = adapter else {
            tracing::debug!(
                "the device is the CPU ({reason}): {:.1?}",
                started.elapsed()
            );
            return Ok((Self::Cpu, reason));
        };
        let opened = Gpu::from_adapter(&adapter, GpuOptions::default());
        tracing::debug!(
            "opened {}: {:.1?}",
            adapter.get_info().name,
            started.elapsed()
        );
        match opened {
            Ok(gpu) => Ok((Self::Gpu(Box::new(gpu)), reason)),
            Err(error) if *choice == DeviceChoice::Auto => Ok((Self::Cpu, error.to_string())),
            Err(error) => Err(error),
        }
    }

    /// Opens the CPU. Also returns the reason for the choice, in a few words.
    ///
    /// # Errors
    ///
    /// [`Error::NoAdapter`](crate::Error::NoAdapter) if a GPU was requested: this build has none.
    #[cfg(not(feature = "gpu"))]
    pub fn open(choice: &DeviceChoice) -> Result<(Self, String)> {
        match choice {
            DeviceChoice::Auto => Ok((Self::Cpu, "built without the feature `gpu`".into())),
            DeviceChoice::Cpu => Ok((Self::Cpu, "requested".into())),
            DeviceChoice::Gpu | DeviceChoice::Named(_) => Err(crate::Error::NoAdapter {
                wanted: format!("can be used for `{choice}`"),
                found: "this build has the feature `gpu` off".into(),
            }),
        }
    }

    /// The device's name for people.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Self::Cpu => format!("CPU, {}", count_of(rayon::current_num_threads(), "thread")),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => gpu.name().into(),
        }
    }

    /// Whether kernels may use 64-bit floats.
    #[must_use]
    pub fn has_f64(&self) -> bool {
        match self {
            Self::Cpu => true,
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => gpu.has_f64(),
        }
    }

    /// `cpu` or `gpu`.
    #[must_use]
    pub fn backend(&self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            #[cfg(feature = "gpu")]
            Self::Gpu(_) => "gpu",
        }
    }
}
