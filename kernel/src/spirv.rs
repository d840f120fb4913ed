//! The kernel's SPIR-V as committed, for hosts that do not compile it themselves.
//!
//! The files are the bit-identical output of rust-gpu for the sources beside them; the manifest
//! says which sources, which compiler and which digest. They ship inside this package, so that
//! a dependant from a registry needs neither the repository nor rust-gpu.

/// The module for devices with 32-bit floats.
pub static F32: &[u8] = include_bytes!("../spirv/f32.spv");
/// The module for devices that have 64-bit floats too.
pub static F64: &[u8] = include_bytes!("../spirv/f64.spv");
/// What the modules were made of: sources, dependencies, compiler, digests.
pub static MANIFEST: &str = include_str!("../spirv/manifest.toml");
