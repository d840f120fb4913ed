//! Keeps a GPU busy before something is timed on it: the clock of one that was idle is low.

use std::time::{Duration, Instant};

use super::buffer::Access;
use super::gpu::Gpu;
use crate::error::Result;
use crate::kernel_module;

/// After so long a GPU's clock is up.
pub const WARM_UP: Duration = Duration::from_secs(2);
/// So long it is kept busy again before each measurement, because whatever lies between two of them
/// leaves it idle.
pub const BETWEEN: Duration = Duration::from_millis(30);

/// Multiplies for at least so long. A driver that computes on the CPU has no clock to raise, and
/// is left alone.
///
/// # Errors
///
/// The device's errors.
pub fn keep_busy(gpu: &Gpu, duration: Duration) -> Result<()> {
    const THREADS: u32 = 1 << 18;
    const ROUNDS: f32 = 256.0;
    if gpu.is_software() {
        return Ok(());
    }
    let access = [Access::Read, Access::ReadWrite];
    let kernel = gpu.kernel(&kernel_module::f32()?, "measure_multiplications", &access)?;
    let parameters = gpu.upload("factor and rounds", &[0.999_999_9, ROUNDS])?;
    let sums = gpu.zeroed::<f32>("sums", THREADS as usize)?;
    let bindings = [parameters.binding(), sums.binding()];
    let groups = kernel.workgroups_for([THREADS, 1, 1]);
    let started = Instant::now();
    while started.elapsed() < duration {
        gpu.launch(&kernel, &bindings, groups)?;
    }
    Ok(())
}
