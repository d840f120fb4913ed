//! The kernel's SPIR-V that this build embeds: compiled here (feature `compile-kernel`), or the
//! committed module of `spherule-kernel`.

use crate::device::Module;
use crate::error::Result;

/// The bytes of the module for devices with 32-bit floats.
#[cfg(kernel_compiled_here)]
pub static F32_BYTES: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/spirv/f32.spv"));
/// The bytes of the module for devices with 32-bit floats.
#[cfg(not(kernel_compiled_here))]
pub static F32_BYTES: &[u8] = spherule_kernel::spirv::F32;

/// The module for devices with 32-bit floats.
///
/// # Errors
///
/// [`KernelInvalid`](crate::Error::KernelInvalid) if this build embeds a broken module.
pub fn f32() -> Result<Module> {
    Module::from_bytes("spherule-f32", F32_BYTES)
}
