//! Tells packages that depend on this one where its sources and its committed SPIR-V are, in
//! `DEP_SPHERULE_KERNEL_ROOT`. It compiles nothing.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::metadata=root={}", env!("CARGO_MANIFEST_DIR"));
}
