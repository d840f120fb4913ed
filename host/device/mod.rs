//! Devices: which there are, and running kernels on them.
//!
//! | module | holds |
//! | --- | --- |
//! | [`adapter`] | the list of adapters, and the choice between them |
//! | [`gpu`] | [`Gpu`]: buffers, kernels and launches on one adapter |
//! | [`kernel`] | [`Kernel`]: an entry point that the driver compiled |
//! | `mapping`, `timer` | memory that is mapped for the host to read, and how long a launch took |
//! | [`spirv`] | [`Module`]: SPIR-V, checked and specialised |
//! | [`buffer`] | [`Buffer`]: device memory |
//! | [`canary`] | what a device does to the arithmetic that the upper rungs need |
//!
//! Nothing in here knows of scenes or images. A program with kernels of its own uses it as it
//! is: see `examples/own-kernel`.

pub mod adapter;
pub mod buffer;
pub mod canary;
mod errors;
pub mod gpu;
pub mod kernel;
mod mapping;
pub mod spirv;
mod timer;

use std::time::Instant;

use crate::error::Result;
use crate::plural::count_of;
pub use adapter::{AdapterReport, DeviceChoice, list_adapters};
pub use buffer::{Access, Binding, Buffer};
pub use errors::is_catching;
pub(crate) use gpu::Staging;
pub use gpu::{Gpu, GpuOptions};
pub use kernel::{Kernel, LaunchTime};
pub use spirv::Module;

/// What renders: the CPU, or a GPU.
#[derive(Debug)]
pub enum Device {
    /// The CPU, on every thread of rayon's pool.
    Cpu,
    /// A GPU, or a software adapter.
    Gpu(Box<Gpu>),
}

impl Device {
    /// Opens what `choice` means; also says why it was chosen, in a few words.
    ///
    /// # Errors
    ///
    /// The errors of [`Gpu::open`], where a GPU was asked for. [`DeviceChoice::Auto`] never
    /// fails: a GPU that does not open leaves the CPU.
    pub fn open(choice: &DeviceChoice) -> Result<(Self, String)> {
        let started = Instant::now();
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

    /// The device's name for a person.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Self::Cpu => format!("CPU, {}", count_of(rayon::current_num_threads(), "thread")),
            Self::Gpu(gpu) => gpu.name().into(),
        }
    }

    /// Whether kernels may use 64-bit floats.
    #[must_use]
    pub fn has_f64(&self) -> bool {
        match self {
            Self::Cpu => true,
            Self::Gpu(gpu) => gpu.has_f64(),
        }
    }

    /// `cpu` or `gpu`.
    #[must_use]
    pub fn backend(&self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            Self::Gpu(_) => "gpu",
        }
    }
}
