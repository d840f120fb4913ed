//! The module that runs a rung on a GPU.

use spherule_kernel::Rung;
use spherule_kernel::precision::{DEFERRING, Needs, SECOND_SPEC_ID};
use spherule_kernel::probe::throughput::{MULTIPLICATIONS, WIDE_MULTIPLICATIONS};

use super::buffer::Access;
use super::gpu::Gpu;
use super::spirv::Module;
use crate::error::Result;
use crate::kernel_module;

/// 64-bit floats pay if a device multiplies so many of them in the time of one of 32 bits: the
/// certified rung spares some 850 operations on pairs of floats by some 200 of them.
const PAYS: f64 = 0.2;

/// The module for this rung on this GPU, with the rung fixed: the driver compiles no other.
///
/// # Errors
///
/// The device's errors, and [`KernelInvalid`](crate::Error::KernelInvalid) if this build embeds a
/// broken module.
pub fn module(gpu: &Gpu, rung: Rung) -> Result<Module> {
    let module = if uses_f64(gpu, rung)? {
        kernel_module::f64()
    } else {
        kernel_module::f32()
    };
    module?.specialise(Rung::SPEC_ID, rung.to_u32())
}

/// The modules whose launches, one after the other, answer on this rung what is asked of the entry
/// points that render and trace: one, or for certified a first that defers what few rays ask for,
/// and a second that does nothing else.
///
/// # Errors
///
/// As [`module`].
pub fn modules(gpu: &Gpu, rung: Rung) -> Result<Vec<Module>> {
    let whole = module(gpu, rung)?;
    if rung != Rung::Certified {
        return Ok(vec![whole]);
    }
    Ok(vec![
        whole.clone().specialise(Rung::SPEC_ID, DEFERRING)?,
        whole.specialise(SECOND_SPEC_ID, 1)?,
    ])
}

/// Whether the rung uses 64-bit floats on this GPU.
///
/// # Errors
///
/// The device's errors.
pub fn uses_f64(gpu: &Gpu, rung: Rung) -> Result<bool> {
    match rung.needs() {
        Needs::Nothing | Needs::ErrorTerms => Ok(false),
        // Software has them at half the rate.
        Needs::ErrorTermsAtLeast => {
            Ok(gpu.has_f64()
                && (gpu.is_software() || f64_rate(gpu)?.is_some_and(|rate| rate >= PAYS)))
        }
        Needs::DoubleFloats => Ok(true),
    }
}

/// How many 64-bit floats the GPU multiplies in the time of one of 32 bits; `None` if it has none.
/// It is measured once.
///
/// # Errors
///
/// The device's errors.
pub fn f64_rate(gpu: &Gpu) -> Result<Option<f64>> {
    if gpu.has_f64() {
        gpu.remember_f64_rate(|| measure_f64_rate(gpu)).map(Some)
    } else {
        Ok(None)
    }
}

fn measure_f64_rate(gpu: &Gpu) -> Result<f64> {
    const THREADS: u32 = 1 << 18;
    const ROUNDS: u32 = 64;
    let access = [Access::Read, Access::ReadWrite];
    let parameters = gpu.upload("factor and rounds", &[0.999_999_9, ROUNDS as f32])?;
    let sums = gpu.zeroed::<f32>("sums", THREADS as usize)?;
    let bindings = [parameters.binding(), sums.binding()];
    let single = gpu.kernel(&kernel_module::f32()?, "measure_multiplications", &access)?;
    let wide = gpu.kernel(
        &kernel_module::f64()?,
        "measure_wide_multiplications",
        &access,
    )?;
    let groups = single.workgroups_for([THREADS, 1, 1]);
    let [mut of_single, mut of_wide] = [f64::INFINITY; 2];
    // In turns, because the clock rises.
    for _ in 0..5 {
        of_single = of_single.min(gpu.launch(&single, &bindings, groups)?.best().as_secs_f64());
        of_wide = of_wide.min(gpu.launch(&wide, &bindings, groups)?.best().as_secs_f64());
    }
    let ratio = f64::from(WIDE_MULTIPLICATIONS) / f64::from(MULTIPLICATIONS);
    Ok(ratio * of_single / of_wide.max(f64::MIN_POSITIVE))
}
