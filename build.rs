//! Chooses the SPIR-V that the library embeds: the committed modules, or modules that rust-gpu
//! compiles during the build (feature `compile-kernel`).
//!
//! The committed modules are used only if they were compiled from the kernel's current sources.
//! This script writes the manifest of the sources on disk and compares it with the committed
//! manifest; if the kernel was edited and not compiled, the build stops.

use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// The kernel's modules, one for each set of capabilities that a device may have.
const MODULES: &[Module] = &[
    Module {
        name: "f32",
        features: &["entry-points"],
        needs_f64: false,
    },
    Module {
        name: "f64",
        features: &["entry-points", "f64"],
        needs_f64: true,
    },
];

/// The toolchain that rust-gpu 0.11 is built with. rust-gpu knows it, too, and installs it.
const NIGHTLY: &str = "nightly-2026-08-15";

/// The target that the modules are compiled for.
const TARGET: &str = "spirv-unknown-spv1.3";

struct Module {
    name: &'static str,
    features: &'static [&'static str],
    needs_f64: bool,
}

impl Module {
    fn file(&self) -> String {
        format!("{}.spv", self.name)
    }
}

type Result<T> = std::result::Result<T, Box<dyn Error>>;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // This variable leaves effects out of the kernel; see its `effects.rs`.
    println!("cargo::rerun-if-env-changed=SPHERULE_EFFECTS");
    if let Err(error) = run() {
        println!("cargo::error={error}");
        std::process::exit(1);
    }
}

fn run() -> Result<()> {
    println!("cargo::rustc-check-cfg=cfg(kernel_compiled_here)");
    // In the repository the kernel is beside this script. Elsewhere its package says where it is;
    // cargo caches that path, which would be wrong if the repository was moved.
    let beside = PathBuf::from(env_var("CARGO_MANIFEST_DIR")?).join("kernel");
    let kernel = if beside.join("Cargo.toml").is_file() {
        beside
    } else {
        PathBuf::from(env_var("DEP_SPHERULE_KERNEL_ROOT")?)
    };
    println!("cargo::rerun-if-changed={}", kernel.join("src").display());
    println!("cargo::rerun-if-changed={}", kernel.join("spirv").display());

    #[cfg(feature = "compile-kernel")]
    {
        let out = PathBuf::from(env_var("OUT_DIR")?).join("spirv");
        compile::compile(&kernel, &out)?;
        fs::write(out.join("manifest.toml"), manifest(&kernel, &out)?)?;
        println!("cargo::rustc-cfg=kernel_compiled_here");
        Ok(())
    }
    #[cfg(not(feature = "compile-kernel"))]
    check_committed(&kernel)
}

#[cfg(not(feature = "compile-kernel"))]
fn check_committed(kernel: &Path) -> Result<()> {
    let committed = fs::read_to_string(kernel.join("spirv/manifest.toml")).unwrap_or_default();
    if without_dependencies(&committed, kernel)
        == without_dependencies(&manifest(kernel, &kernel.join("spirv"))?, kernel)
    {
        return Ok(());
    }
    Err("the kernel's sources and its committed SPIR-V differ: build with `--features compile-kernel` to use \
         your change, and run `SPHERULE_RENEW_KERNEL=1 cargo test --release --features compile-kernel --test kernel_spirv committed` \
         to renew the committed modules"
        .into())
}

/// The manifest without the lines that are not compared. Outside this workspace (in a package from
/// a registry) the lock file is the dependant's, the committed modules were not compiled with its
/// versions, and cargo has rewritten the kernel's Cargo.toml.
#[cfg(not(feature = "compile-kernel"))]
fn without_dependencies(manifest: &str, kernel: &Path) -> String {
    let keep_all = workspace_lock(kernel).is_some();
    manifest
        .lines()
        .filter(|line| keep_all || !line.starts_with("dependencies"))
        .map(|line| format!("{line}\n"))
        .collect()
}

/// The manifest in TOML: what the modules in the folder `modules` were compiled from.
fn manifest(kernel: &Path, modules: &Path) -> Result<String> {
    let mut text = String::from(
        "# Written by the test `kernel_spirv`; read by build.rs. What the modules beside this file are made of.\n",
    );
    writeln!(text, "nightly = \"{NIGHTLY}\"")?;
    writeln!(
        text,
        "sources = \"{}\"",
        digest_sources(&kernel.join("src"))?
    )?;
    let locked = workspace_lock(kernel)
        .map(|lock| locked_dependencies(&lock))
        .unwrap_or_default();
    writeln!(text, "dependencies = [{}]", locked.join(", "))?;
    let package = fs::read(kernel.join("Cargo.toml"))?;
    writeln!(
        text,
        "dependencies_package = \"{}\"",
        hex(&hmac_sha256::Hash::hash(&package))
    )?;
    for module in MODULES {
        let bytes = fs::read(modules.join(module.file())).unwrap_or_default();
        writeln!(text, "\n[{}]", module.name)?;
        writeln!(text, "file = \"{}\"", module.file())?;
        writeln!(text, "target = \"{TARGET}\"")?;
        writeln!(text, "features = {:?}", module.features)?;
        writeln!(text, "needs_f64 = {}", module.needs_f64)?;
        writeln!(text, "bytes = {}", bytes.len())?;
        writeln!(
            text,
            "sha256 = \"{}\"",
            hex(&hmac_sha256::Hash::hash(&bytes))
        )?;
    }
    Ok(text)
}

/// The SHA-256 of the Rust files below `dir`: of their paths and contents, sorted by path, with
/// `\n` as line ends.
fn digest_sources(dir: &Path) -> Result<String> {
    let mut files = Vec::new();
    collect_files(dir, &mut files)?;
    files.sort();
    let mut hash = hmac_sha256::Hash::new();
    for file in files {
        let name = file.strip_prefix(dir)?.to_string_lossy().replace('\\', "/");
        let text = fs::read_to_string(&file)
            .map_err(|error| format!("cannot read {}: {error}", file.display()))?
            .replace("\r\n", "\n");
        hash.update(name.as_bytes());
        hash.update([0]);
        hash.update(text.as_bytes());
        hash.update([0]);
    }
    Ok(hex(&hash.finalize()))
}

fn collect_files(dir: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    let entries =
        fs::read_dir(dir).map_err(|error| format!("cannot list {}: {error}", dir.display()))?;
    for entry in entries {
        let path = entry?.path();
        if path.is_dir() {
            collect_files(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    Ok(())
}

/// The content of the lock file; `None` unless the kernel is the one beside this script.
fn workspace_lock(kernel: &Path) -> Option<String> {
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR")?);
    let is_ours = kernel.canonicalize().ok()? == root.join("kernel").canonicalize().ok()?;
    is_ours
        .then(|| {
            println!(
                "cargo::rerun-if-changed={}",
                root.join("Cargo.lock").display()
            );
            fs::read_to_string(root.join("Cargo.lock")).ok()
        })
        .flatten()
}

/// The locked versions of the crates in the kernel's code, as TOML strings.
fn locked_dependencies(lock: &str) -> Vec<String> {
    // spirv-std can use several versions of glam, and the lock file has all of them.
    const IN_THE_KERNEL: &[(&str, &str)] = &[
        ("bytemuck", ""),
        ("cargo-gpu-install", ""),
        ("glam", "0.34."),
        ("libm", ""),
        ("num-traits", ""),
        ("spirv-std", ""),
    ];
    let mut name = None;
    let mut found = Vec::new();
    for line in lock.lines() {
        let value = |key: &str| {
            line.strip_prefix(key)
                .and_then(|rest| rest.strip_prefix(" = \""))
                .and_then(|rest| rest.strip_suffix('"'))
        };
        if let Some(value) = value("name") {
            name = IN_THE_KERNEL.iter().find(|(known, _)| *known == value);
        } else if let (Some((name, series)), Some(version)) = (name, value("version"))
            && version.starts_with(series)
        {
            found.push(format!("\"{name} {version}\""));
        }
    }
    found
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        // Writing to a String cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

fn env_var(name: &str) -> Result<String> {
    env::var(name).map_err(|error| format!("{name}: {error}").into())
}

#[cfg(feature = "compile-kernel")]
mod compile {
    use super::{MODULES, Path, Result, TARGET, fs};
    use cargo_gpu_install::install::Install;
    use cargo_gpu_install::spirv_builder::Capability;

    /// Compiles every module of `kernel` into the folder `out`.
    pub(super) fn compile(kernel: &Path, out: &Path) -> Result<()> {
        fs::create_dir_all(out)?;
        let backend = Install::from_shader_crate(kernel.to_path_buf())
            .within_build_script()
            .run()
            .map_err(|error| {
                format!(
                    "rust-gpu could not be installed ({error:#}): it needs rustup and the network once; \
                     without the feature `compile-kernel` the committed modules are used"
                )
            })?;
        for module in MODULES {
            let mut builder = backend.to_spirv_builder(kernel, TARGET);
            builder.build_script.defaults = true;
            builder.shader_crate_features.features =
                module.features.iter().map(ToString::to_string).collect();
            if module.needs_f64 {
                builder.capabilities.push(Capability::Float64);
            }
            let built = builder
                .build()
                .map_err(|error| format!("the kernel does not compile for the GPU: {error}"))?;
            fs::copy(built.module.unwrap_single(), out.join(module.file()))?;
        }
        Ok(())
    }
}
