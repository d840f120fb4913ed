//! Open Image Denoise is called as it wants to be, and what it says reaches the user. It need not
//! be here: a stand-in for its library is compiled. Where `SPHERULE_OIDN` names the library itself,
//! it is tested, too.

use std::path::{Path, PathBuf};
use std::process;

use assert_cmd::Command;
use assert_cmd::cargo::cargo_bin;
use predicates::str::contains;

const SCENE: &str = "
[image]
width = 96
height = 64
samples = 4
transparent = true

[camera]
eye = [0, 1, 5]
target = [0, 0, 0]

[sky]
zenith = [3, 4, 5]
horizon = [1, 1, 1]

[[sphere]]
center = [0, 0, 0]
radius = 1
";

/// A folder with the scene, and the path of the stand-in.
fn folder() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("scene.toml"), SCENE).expect("a scene");
    let library = folder.path().join(if cfg!(windows) {
        "stand_in.dll"
    } else {
        "stand_in.so"
    });
    let compiler = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/denoise/library.rs");
    let compiled = process::Command::new(compiler)
        .args([
            "--edition",
            "2024",
            "--crate-type",
            "cdylib",
            "-A",
            "warnings",
            "-o",
        ])
        .arg(&library)
        .arg(source)
        .status();
    assert!(compiled.expect("rustc").success());
    (folder, library)
}

/// `spherule render scene.toml --device cpu -o OUTPUT` with more arguments.
fn render(folder: &Path, library: &Path, output: &str, more: &[&str]) -> Command {
    let mut command = Command::new(cargo_bin("spherule"));
    command
        .current_dir(folder)
        .env("SPHERULE_OIDN", library)
        .args(["render", "scene.toml", "--device", "cpu", "-o", output])
        .args(more);
    command
}

/// The channels of an EXR file, pixel by pixel.
fn channels(path: &Path) -> Vec<[f32; 4]> {
    let image = image::open(path).expect("an image").into_rgba32f();
    image.pixels().map(|pixel| pixel.0).collect()
}

#[test]
fn the_library_gets_the_image_and_gives_another() {
    let (folder, library) = folder();
    let path = folder.path();
    render(path, &library, "noisy.exr", &[]).assert().success();
    render(
        path,
        &library,
        "clean.exr",
        &["--denoise", "--stats", "stats.json"],
    )
    .assert()
    .success()
    .stderr(contains("denoised by Open Image Denoise 2.3.1 in"));
    let (noisy, clean) = (
        channels(&path.join("noisy.exr")),
        channels(&path.join("clean.exr")),
    );
    assert_eq!(noisy.len(), 96 * 64);
    for (noisy, clean) in noisy.iter().zip(&clean) {
        let [red, green, blue, opacity] = *noisy;
        assert_eq!(*clean, [0.5 * red, 0.5 * green, 0.5 * blue, opacity]);
    }
    assert!(noisy.iter().any(|pixel| pixel[0] > 0.0));
    let bytes = std::fs::read(path.join("clean.exr")).expect("a file");
    let remark = b"denoised by Open Image Denoise 2.3.1, which is biased";
    assert!(bytes.windows(remark.len()).any(|window| window == remark));
    let stats = std::fs::read_to_string(path.join("stats.json")).expect("statistics");
    assert!(stats.contains("\"denoise\": "), "{stats}");
}

#[test]
fn what_goes_wrong_is_said() {
    let (folder, library) = folder();
    let path = folder.path();
    for (how, said, is_written) in [
        ("version", "Open Image Denoise 1.4.3 is too old", false),
        ("device", "no device today", false),
        // What was rendered is kept.
        ("filter", "no filter today", true),
        ("execute", "no work today", true),
    ] {
        let _ = std::fs::remove_file(path.join("out.png"));
        render(path, &library, "out.png", &["--denoise"])
            .env("STAND_IN", how)
            .assert()
            .code(1)
            .stderr(contains(said))
            .stderr(contains("SPHERULE_OIDN"));
        assert_eq!(path.join("out.png").exists(), is_written, "{how}");
    }
    let missing = path.join("missing.so");
    render(path, &missing, "out.png", &["--denoise"])
        .assert()
        .code(1)
        .stderr(contains("missing.so"));
    render(
        path,
        &library,
        "out.png",
        &["--denoise", "--shade", "depth"],
    )
    .assert()
    .success()
    .stderr(contains("--denoise has no effect"));
    render(path, &library, "out.png", &["--denoise", "--check"])
        .assert()
        .code(2);
}

/// The library itself makes the image of few samples more like that of many.
#[test]
fn the_library_removes_noise() {
    let Some(library) = std::env::var_os("SPHERULE_OIDN").map(PathBuf::from) else {
        println!("skipped: SPHERULE_OIDN names no library");
        return;
    };
    let (folder, _) = folder();
    let path = folder.path();
    let error = |name: &str, more: &[&str]| {
        render(path, &library, name, more).assert().success();
        let right = channels(&path.join("many.exr"));
        let found = channels(&path.join(name));
        let squares = found.iter().zip(&right).map(|(a, b)| (a[1] - b[1]).powi(2));
        squares.sum::<f32>()
    };
    error("many.exr", &["--samples", "1024"]);
    let noisy = error("noisy.exr", &["--samples", "2"]);
    let clean = error("clean.exr", &["--samples", "2", "--denoise"]);
    assert!(clean < 0.5 * noisy, "{clean} {noisy}");
}
