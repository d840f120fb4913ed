//! [`Deferring`]: a kernel on a rung, as one launch or as two of which the second answers what the
//! first left open.

use spherule_kernel::Rung;

use super::buffer::{Access, Binding, Buffer};
use super::gpu::Gpu;
use super::kernel::{Kernel, LaunchTime};
use super::rung;
use super::spirv::Module;
use crate::error::Result;

/// Workgroups of the second launch: enough for a GPU to have something to do where much is
/// deferred, and soon over where nothing is.
const SECOND_WORKGROUPS: u32 = 256;

/// A kernel on a rung. On certified these are two, and the second does what the first deferred:
/// see [`DEFERRING`](spherule_kernel::precision::DEFERRING).
#[derive(Debug)]
pub(crate) struct Deferring {
    kernels: Vec<Kernel>,
}

impl Deferring {
    /// Compiles an entry point on a rung. Its last binding, which `access` does not name, is the
    /// list of what is deferred; `specialise` sets the other constants.
    ///
    /// # Errors
    ///
    /// The device's errors.
    pub(crate) fn compile(
        gpu: &Gpu,
        rung: Rung,
        entry_point: &str,
        access: &[Access],
        specialise: impl Fn(Module) -> Result<Module>,
    ) -> Result<Self> {
        let access = [access, &[Access::ReadWrite]].concat();
        let kernels = rung::modules(gpu, rung)?
            .into_iter()
            .map(|module| gpu.kernel(&specialise(module)?, entry_point, &access))
            .collect::<Result<_>>()?;
        Ok(Self { kernels })
    }

    /// How many workgroups of the first launch are needed for so many threads.
    pub(crate) fn workgroups_for(&self, threads: [u32; 3]) -> [u32; 3] {
        self.kernels[0].workgroups_for(threads)
    }

    /// A list with room for so many entries.
    ///
    /// # Errors
    ///
    /// The device's errors.
    pub(crate) fn list(gpu: &Gpu, entries: usize) -> Result<Buffer<u32>> {
        gpu.zeroed("deferred", entries + 1)
    }

    /// Runs the kernel, or both in turn, and waits. `workgroups` are those of the first launch.
    ///
    /// # Errors
    ///
    /// As [`Gpu::launch`].
    pub(crate) fn launch(
        &self,
        gpu: &Gpu,
        bindings: Vec<Binding<'_>>,
        list: &Buffer<u32>,
        workgroups: [u32; 3],
    ) -> Result<LaunchTime> {
        if self.kernels.len() > 1 {
            gpu.write_first(list, &[0])?;
        }
        let mut bindings = bindings;
        bindings.push(list.binding());
        let second = [SECOND_WORKGROUPS, 1, 1];
        let in_turn: Vec<_> = self.kernels.iter().zip([workgroups, second]).collect();
        gpu.launch_in_turn(&in_turn, &bindings)
    }
}
