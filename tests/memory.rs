//! Little memory and few threads: a command that cannot do its work says why and loses nothing.

#![cfg(unix)]

mod common;

use std::fmt::Write as _;
use std::process::{Command, Output};

/// Runs `spherule` in a shell that sets limits first; returns the exit code and standard error.
fn spherule(limits: &str, environment: &[(&str, &str)], arguments: &str) -> (Option<i32>, String) {
    let command = env!("CARGO_BIN_EXE_spherule");
    let Output { status, stderr, .. } = Command::new("bash")
        .args(["-c", &format!("{limits}; exec {command} {arguments}")])
        .envs(environment.iter().copied())
        .env_remove("RUST_BACKTRACE")
        .output()
        .expect("bash runs");
    let stderr = String::from_utf8_lossy(&stderr).into_owned();
    (status.code(), stderr)
}

fn two_spheres(folder: &tempfile::TempDir) -> String {
    let output = folder.path().join("out.png");
    format!(
        "render scenes/two-spheres.toml --device cpu -o {}",
        output.display()
    )
}

#[test]
fn missing_memory_is_reported_before_the_work() {
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = two_spheres(&folder) + " --size 65536x65536";
    let (code, stderr) = spherule("ulimit -v 4000000", &[], &arguments);
    assert_eq!(code, Some(1), "{stderr}");
    assert!(
        stderr.contains("out of memory: an image of 65536 × 65536 pixels"),
        "{stderr}"
    );
    // 16 bytes a pixel, and a little more.
    assert!(stderr.contains("64.0 GiB (687"), "{stderr}");
    assert!(
        stderr.contains("ulimit -v") && !stderr.contains("--device cpu`"),
        "{stderr}"
    );
}

#[test]
fn running_out_of_memory_while_reading_is_an_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = folder.path().join("many.toml");
    let mut text = String::new();
    for index in 0..100_000 {
        writeln!(text, "[[sphere]]\ncenter = [{index}, 0, 0]\nradius = 0.4").expect("text");
    }
    std::fs::write(&scene, text).expect("a file");
    let output = folder.path().join("out.png");
    std::fs::write(&output, "before").expect("a file");
    let arguments = format!(
        "render {} --device cpu --size 16x9 -o {}",
        scene.display(),
        output.display()
    );
    let (code, stderr) = spherule("ulimit -v 60000", &[], &arguments);
    if code == Some(0) {
        // A reader that needs less memory may succeed.
        return;
    }
    assert_eq!(code, Some(1), "{stderr}");
    assert!(
        stderr.contains("out of memory") && stderr.contains("help: "),
        "{stderr}"
    );
    assert_eq!(std::fs::read(&output).expect("a file"), b"before");
}

#[test]
fn a_bad_number_of_threads_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    for bad in ["abc", "-3", "1.5", "99999999999999999999999"] {
        let threads = [("RAYON_NUM_THREADS", bad)];
        let (code, stderr) = spherule("true", &threads, &two_spheres(&folder));
        assert_eq!(code, Some(2), "{stderr}");
        assert!(
            stderr.contains(bad) && stderr.contains("help: "),
            "{stderr}"
        );
    }
}

#[test]
fn many_threads_are_capped_and_few_are_enough() {
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = two_spheres(&folder);
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let most = (4 * processors).max(64);

    let many = [("RAYON_NUM_THREADS", "5000")];
    let (code, stderr) = spherule("true", &many, &arguments);
    assert_eq!(code, Some(0), "{stderr}");
    assert!(
        stderr.contains(&format!("{most} threads instead of 5000")),
        "{stderr}"
    );

    let some = [("RAYON_NUM_THREADS", "60")];
    let (code, stderr) = spherule("ulimit -v 100000", &some, &arguments);
    assert_eq!(code, Some(0), "{stderr}");
    assert!(
        stderr.contains(" instead of 60") && stderr.contains("ulimit -v"),
        "{stderr}"
    );

    let one = [("RAYON_NUM_THREADS", "1")];
    let (code, stderr) = spherule("true", &one, &arguments);
    assert_eq!(code, Some(0), "{stderr}");
    assert!(stderr.contains("CPU, 1 thread "), "{stderr}");
}

/// The memory for reading the image back is allocated before the first ray, on a software GPU, too:
/// whatever the limit, no image is traced and then lost.
#[test]
fn what_is_traced_on_a_gpu_can_be_read_back() {
    if common::skips("what_is_traced_on_a_gpu_can_be_read_back") {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let scene = folder.path().join("light.toml");
    let text = "[image]\nsamples = 1\n[sky]\nhorizon = [1, 1, 1]\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n";
    std::fs::write(&scene, text).expect("a file");
    let arguments = format!(
        "render {} --device gpu --size 1500x1500 -o {}",
        scene.display(),
        folder.path().join("out.exr").display()
    );
    if common::gpus().iter().any(|gpu| !gpu.is_software()) {
        println!(
            "SKIPPED: what_is_traced_on_a_gpu_can_be_read_back: drivers of real GPUs use an unknown amount of addresses"
        );
        return;
    }
    // Tries limits up to the first that is large enough, which depends on the number of the
    // driver's threads.
    let is_done = (540_000..16_000_000).step_by(20_000).any(|kibibytes| {
        let limit = format!("ulimit -v {kibibytes}");
        let (code, stderr) = spherule(&limit, &[], &arguments);
        assert!(code == Some(0) || code == Some(1), "{limit}: {stderr}");
        assert!(!stderr.contains("while reading"), "{limit}: {stderr}");
        code == Some(0)
    });
    assert!(is_done);
}

/// Limits on data (`ulimit -d`) count like those on addresses: a driver is not started if it would
/// crash.
#[test]
fn a_limit_on_data_causes_no_crash() {
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = two_spheres(&folder);
    for device in ["cpu", "gpu"] {
        for kibibytes in [60_000, 100_000, 141_000, 164_000, 180_000, 260_000] {
            let limit = format!("ulimit -d {kibibytes}");
            let arguments = arguments.replace("--device cpu", &format!("--device {device}"));
            let (code, stderr) = spherule(&limit, &[], &arguments);
            assert!(code == Some(0) || code == Some(1), "{limit}: {stderr}");
            assert!(!stderr.contains("internal error"), "{limit}: {stderr}");
        }
    }
}

/// Runs `tests/memory_sweep` with 3 steps; its default is forty.
#[test]
fn a_sweep_of_limits_ends_in_images_or_messages() {
    let test = "a_sweep_of_limits_ends_in_images_or_messages";
    common::skips(test);
    let sweep = Command::new("tests/memory_sweep")
        .arg("3")
        .env("SPHERULE", env!("CARGO_BIN_EXE_spherule"))
        .output()
        .expect("bash runs");
    let said = String::from_utf8_lossy(&sweep.stdout);
    assert!(sweep.status.success(), "{said}");
}
