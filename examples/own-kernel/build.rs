//! Compiles the kernel with rust-gpu. The first build installs rust-gpu's nightly toolchain and
//! builds its compiler backend, which takes about ten minutes.

use std::path::Path;

use cargo_gpu_install::install::Install;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let kernel = Path::new(env!("CARGO_MANIFEST_DIR")).join("kernel");
    let backend = Install::from_shader_crate(kernel.clone())
        .within_build_script()
        .run()?;
    let mut builder = backend.to_spirv_builder(&kernel, "spirv-unknown-spv1.3");
    builder.build_script.defaults = true;
    let module = builder.build()?.module.unwrap_single().to_path_buf();
    println!("cargo::rustc-env=OWN_KERNEL_SPV={}", module.display());
    Ok(())
}
