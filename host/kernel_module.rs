//! The SPIR-V of the kernel that this build embeds: compiled by this build (feature
//! `compile-kernel`), or the committed modules of `spherule-kernel`.

use crate::device::Module;
use crate::error::Result;

#[cfg(kernel_compiled_here)]
static F32: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/spirv/f32.spv"));
#[cfg(not(kernel_compiled_here))]
static F32: &[u8] = spherule_kernel::spirv::F32;

#[cfg(kernel_compiled_here)]
static F64: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/spirv/f64.spv"));
#[cfg(not(kernel_compiled_here))]
static F64: &[u8] = spherule_kernel::spirv::F64;

/// The module for devices with 32-bit floats.
///
/// # Errors
///
/// [`KernelInvalid`](crate::Error::KernelInvalid) if this build embeds a broken module.
pub fn f32() -> Result<Module> {
    embedded("spherule-f32", F32)
}

/// The module for devices that also have 64-bit floats.
///
/// # Errors
///
/// As [`f32()`].
pub fn f64() -> Result<Module> {
    embedded("spherule-f64", F64)
}

fn embedded(name: &str, bytes: &[u8]) -> Result<Module> {
    let module = Module::from_bytes(name, bytes)?;
    // SAFETY: rust-gpu compiled it and ran spirv-val on it, and a test compares its bytes.
    Ok(unsafe { module.trusted() })
}
