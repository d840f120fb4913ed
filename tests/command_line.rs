//! The command line as a user sees it: outputs, messages and exit codes.

mod common;

use std::path::Path;
use std::time::{Duration, Instant};

use assert_cmd::Command;
use assert_cmd::assert::Assert;
use common::skips;
use predicates::prelude::*;
use predicates::str::contains;
use spherule::cpu::InstructionSet;
use spherule::kernel::Effects;

fn spherule() -> Command {
    let mut command = Command::cargo_bin("spherule").expect("the binary is built");
    command.env_remove("SPHERULE_LOG");
    command
}

/// `spherule render SCENE --device cpu --size SIZE -o OUTPUT`.
fn render(scene: &str, size: &str, output: &Path) -> Command {
    let mut command = spherule();
    command
        .args(["render", scene, "--device", "cpu", "--size", size, "-o"])
        .arg(output);
    command
}

/// What a command printed, as JSON.
fn printed_json(assert: &Assert) -> serde_json::Value {
    serde_json::from_slice(&assert.get_output().stdout).expect("JSON")
}

fn read_json(path: &Path) -> serde_json::Value {
    let text = std::fs::read_to_string(path).expect("a file");
    serde_json::from_str(&text).expect("JSON")
}

fn temporary() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary directory")
}

#[test]
fn a_scene_renders_to_png_on_the_cpu() {
    let dir = temporary();
    let out = dir.path().join("out.png");
    render("scenes/two-spheres.toml", "64x36", &out)
        .assert()
        .success()
        .stdout("")
        .stderr(contains("rendering on CPU").and(contains("64 × 36 pixels, 2 spheres")));
    let image = image::open(&out).expect("a PNG").to_rgb8();
    assert_eq!(image.dimensions(), (64, 36));
    // Only the image is in the folder.
    assert_eq!(
        std::fs::read_dir(dir.path())
            .expect("the directory")
            .count(),
        1
    );
}

#[test]
fn molecules_render_to_exr_with_linear_floats() {
    let dir = temporary();
    for input in ["scenes/1crn.pdb", "scenes/c60.xyz"] {
        let out = dir.path().join("out.exr");
        spherule()
            .args([
                "render", input, "--device", "cpu", "--size", "40x30", "--shade", "depth", "-q",
                "-o",
            ])
            .arg(&out)
            .assert()
            .success()
            .stdout("")
            .stderr("");
        let file = exr::prelude::read_first_flat_layer_from_file(&out).expect("an EXR");
        assert_eq!(file.layer_data.size, exr::math::Vec2(40, 30));
        let depth = &file.layer_data.channel_data.list[1];
        assert!(depth.name.eq("Z"), "{:?}", depth.name);
        let farthest = depth
            .sample_data
            .values_as_f32()
            .filter(|depth| depth.is_finite())
            .fold(0.0, f32::max);
        assert!(
            farthest > 10.0,
            "{input}: the largest depth is {farthest}, in ångström"
        );
    }
}

#[test]
fn without_an_output_the_image_is_named_after_the_input() {
    let dir = temporary();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/c60.xyz");
    spherule()
        .current_dir(dir.path())
        .args(["render", "--device", "cpu", "--size", "8x8"])
        .arg(scene)
        .assert()
        .success();
    assert!(dir.path().join("c60.png").is_file());
}

#[test]
fn stats_have_every_field() {
    let dir = temporary();
    let stats = dir.path().join("stats.json");
    render(
        "scenes/two-spheres.toml",
        "20x10",
        &dir.path().join("out.png"),
    )
    .arg("--stats")
    .arg(&stats)
    .assert()
    .success();
    let stats = read_json(&stats);
    assert_eq!(stats["backend"], "cpu");
    assert_eq!(
        [
            &stats["spheres"],
            &stats["width"],
            &stats["height"],
            &stats["rays"]
        ],
        [2, 20, 10, 200]
    );
    assert!(
        stats["device"]
            .as_str()
            .is_some_and(|name| name.starts_with("CPU"))
    );
    assert!(stats["mrays_per_s"].as_f64().is_some_and(|rate| rate > 0.0));
    let seconds = &stats["seconds"];
    let time = |name: &str| seconds[name].as_f64().expect(name);
    let parts = ["load", "setup", "trace", "readback", "encode"].map(time);
    assert!(parts.iter().all(|part| *part >= 0.0));
    assert!(parts.iter().sum::<f64>() <= time("total"));
}

#[test]
fn check_compares_the_two_paths() {
    if skips("check_compares_the_two_paths") {
        return;
    }
    let dir = temporary();
    for device in ["cpu", "gpu"] {
        let stats = dir.path().join("stats.json");
        spherule()
            .args([
                "render",
                "scenes/1crn.pdb",
                "--size",
                "80x60",
                "--check",
                "--device",
                device,
                "-o",
            ])
            .arg(dir.path().join("out.png"))
            .arg("--stats")
            .arg(&stats)
            .assert()
            .success()
            .stdout("")
            .stderr(contains("check passed").and(contains("largest difference")));
        let stats = read_json(&stats);
        assert_eq!(stats["backend"], device);
        assert_eq!(stats["check"]["passed"], true);
        assert_eq!(stats["check"]["pixels"], 4800);
    }
}

#[test]
fn devices_are_listed() {
    spherule()
        .arg("devices")
        .assert()
        .success()
        .stdout(contains("CPU, ").and(contains("* --device auto takes this one")));
    let output = spherule()
        .args(["devices", "--json"])
        .output()
        .expect("it runs");
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert!(
        value["cpu"]["threads"]
            .as_u64()
            .is_some_and(|threads| threads > 0)
    );
    for adapter in value["adapters"].as_array().expect("a list") {
        assert!(
            adapter["name"].is_string() && adapter["max_binding"].is_u64(),
            "{adapter}"
        );
    }
}

/// A wrong input ends with exit code 2. The message says the file, the place and how to fix it.
#[test]
fn wrong_inputs_are_refused_with_their_place() {
    let dir = temporary();
    let write = |name: &str, content: &[u8]| {
        let path = dir.path().join(name);
        std::fs::write(&path, content).expect("the file can be written");
        path
    };
    let truncated = std::fs::read("scenes/1crn.pdb").expect("crambin");
    let cases = [
        (
            write("key.toml", b"[image]\nwdith = 3\n"),
            "key.toml:2:1",
            "unknown field",
        ),
        (
            write(
                "radius.toml",
                b"[[sphere]]\ncenter = [0, 0, 0]\nradius = -1\n",
            ),
            "radius.toml:3:10",
            "radius = -1",
        ),
        (write("empty.toml", b""), "empty.toml", "no spheres"),
        (write("not-utf8.toml", b"[image]\n\xff"), "byte 8", "UTF-8"),
        (
            write("part.toml", b"[particles]\nfile = \"gone.pdb\"\n"),
            "part.toml:2:8",
            "no such file",
        ),
        (
            write("cut.pdb", &truncated[..truncated.len() / 2]),
            "cut.pdb:213:1",
            "before its END record",
        ),
        (
            write("short.pdb", &truncated[..17_212]),
            "short.pdb:213:1",
            "before its coordinates",
        ),
        (
            write("cut.xyz", b"3\n\nC 0 0 0\n"),
            "cut.xyz:3:1",
            "promises 3 atoms",
        ),
        (
            write("picture.bmp", b""),
            "picture.bmp",
            "not a file format",
        ),
        (
            dir.path().join("nowhere.toml"),
            "nowhere.toml",
            "no such file",
        ),
        (dir.path().to_path_buf(), "", "not a file format"),
    ];
    for (input, place, message) in cases {
        let out = dir.path().join("out.png");
        spherule()
            .args(["render", "--device", "cpu", "-o"])
            .args([&out, &input])
            .assert()
            .code(2)
            .stderr(
                contains(place)
                    .and(contains(message))
                    .and(contains("help: ")),
            );
        assert!(!out.exists());
    }
}

/// Wrong arguments end with exit code 2 and a hint.
#[test]
fn wrong_arguments_are_refused() {
    for (arguments, message) in [
        (&["render"][..], "INPUT"),
        (&["render", "x.toml", "-o", "out.jpg"], ".png or .exr"),
        (&["render", "x.toml", "--size", "0x10"], "1280x720"),
        (&["render", "x.toml", "--shade", "pretty"], "normals"),
        (&["paint"], "unrecognized"),
    ] {
        spherule()
            .args(arguments)
            .assert()
            .code(2)
            .stderr(contains(message));
    }
}

/// Messages quote arguments, and their control characters do not reach the terminal.
#[test]
fn no_argument_controls_the_terminal() {
    let odd = "\u{1b}[2J\u{1b}]0;pwn\u{7}\u{202e}";
    for arguments in [
        &["render", "s.toml", "--{}foo"][..],
        &["render", "s.toml", "{}", "{}"],
        &["{}"],
        &["render", "s.toml", "--device", "cpu", "--size", "{}"],
        &["render", "s.toml", "--shade={}"],
        &["render", "s.toml", "--effects", "fog{}"],
        &["render", "s.toml", "-o", "{}"],
        &["render", "s{}.toml"],
        &["render", "s.toml", "--device", "{}"],
        &["accuracy", "--scene", "{}"],
        &["bench", "--scene", "{}"],
    ] {
        let arguments: Vec<String> = arguments.iter().map(|a| a.replace("{}", odd)).collect();
        let output = spherule()
            .args(&arguments)
            // Colours stay in the output, as on a terminal.
            .env("CLICOLOR_FORCE", "1")
            .output()
            .expect("it runs");
        let said = String::from_utf8(output.stderr).expect("text");
        assert_ne!(output.status.code(), Some(0), "{arguments:?}");
        for control in ["\u{1b}[2J", "\u{1b}]", "\u{7}", "\u{202e}"] {
            assert!(!said.contains(control), "{arguments:?}: {said:?}");
        }
    }
    let long = "x".repeat(100_000);
    for name in ["SPHERULE_LOG", "RAYON_NUM_THREADS"] {
        let output = spherule()
            .args(["render", "no.toml", "--device", "cpu"])
            .env(name, &long)
            .output()
            .expect("it runs");
        let said = String::from_utf8(output.stderr).expect("text");
        assert!(said.contains(name) && said.len() < 2000, "{}", said.len());
    }
}

/// No number and no name as an argument makes a command panic or hang.
#[test]
#[expect(clippy::too_many_lines, reason = "one table, an entry an argument")]
fn odd_arguments_are_refused_in_every_command() {
    let numbers = [
        "-1",
        "-0.5",
        "nan",
        "-nan",
        "inf",
        "-inf",
        "1e308",
        "1e400",
        "",
        " ",
        "0x10",
        "1,5",
        "one",
        "99999999999999999999",
    ];
    let sizes = [
        "0x0",
        "0x1",
        "65537x1",
        "1x65537",
        "-1x-1",
        "4294967297x1",
        "x",
        "1x",
        "",
        "1x1x1",
    ];
    let names = ["", "nope", "auto,cpu", "\u{1b}[31m"];
    for (arguments, odd) in [
        (
            &["render", "scenes/box.toml", "--tolerance"][..],
            &numbers[..],
        ),
        (&["render", "scenes/box.toml", "--samples"], &numbers),
        (&["render", "scenes/box.toml", "--samples"], &["0", "65537"]),
        (&["render", "scenes/box.toml", "--max-bounces"], &numbers),
        (&["render", "scenes/box.toml", "--seed"], &numbers),
        (&["render", "scenes/box.toml", "--time-limit"], &numbers),
        (&["render", "scenes/box.toml", "--noise"], &numbers),
        (&["render", "scenes/box.toml", "--noise"], &["0"]),
        (&["render", "scenes/box.toml", "--size"], &sizes),
        (&["render", "scenes/box.toml", "--effects"], &names),
        (&["render", "scenes/box.toml", "--precision"], &names),
        (&["render", "scenes/box.toml", "--shade"], &names),
        (&["accuracy", "--rays"], &numbers),
        (&["accuracy", "--rays"], &["0", "999", "100000001"]),
        (&["accuracy", "--scene"], &names),
        (
            &["accuracy", "--samples", "scenes/box.toml", "--time-limit"],
            &numbers,
        ),
        (
            &["accuracy", "--samples", "scenes/box.toml", "--size"],
            &sizes,
        ),
        (&["accuracy", "--samples"], &names),
        (&["explain", "scenes/box.toml", "--time-limit"], &numbers),
        (&["explain", "scenes/box.toml", "--time-limit"], &["0"]),
        (&["explain", "scenes/box.toml", "--samples"], &numbers),
        (&["explain", "scenes/box.toml", "--size"], &sizes),
        (&["explain", "scenes/box.toml", "--precision"], &names),
        (&["explain"], &names),
        (&["bench", "--size"], &sizes),
        (&["bench", "--rounds"], &numbers),
        (&["bench", "--rounds"], &["0", "1001"]),
        (&["bench", "--scene"], &names),
        (&["bench", "--precision"], &names),
        (&["bench", "--acceleration"], &names),
        (&["check", "--device"], &["", " "]),
        (&["devices"], &names),
    ] {
        for odd in odd {
            spherule()
                .args(arguments)
                .arg(odd)
                .timeout(Duration::from_secs(60))
                .assert()
                .code(2)
                .stderr(
                    contains("internal error")
                        .not()
                        .and(contains("\u{1b}[31m").not()),
                );
        }
    }
}

/// What the machine cannot do ends with exit code 1. A name that no device has is a wrong input,
/// unless there is no adapter at all.
#[test]
fn what_the_machine_cannot_do_is_exit_code_one() {
    let dir = temporary();
    let unknown = if common::all_adapters().is_empty() {
        1
    } else {
        2
    };
    for command in [
        &["render", "scenes/two-spheres.toml"][..],
        &["explain", "scenes/two-spheres.toml"],
        &["check"],
        &["accuracy"],
        &["bench"],
    ] {
        spherule()
            .args(command)
            .args(["--device", "no such adapter"])
            .assert()
            .code(unknown)
            .stderr(contains("no such adapter").and(contains("spherule devices")));
    }
    // Without a driver, no name can be right.
    for device in ["gpu", "llvmpipe"] {
        spherule()
            .env("VK_DRIVER_FILES", "/nonexistent")
            .env("VK_ICD_FILENAMES", "/nonexistent")
            .args(["check", "--device", device])
            .assert()
            .code(1)
            .stderr(contains("no graphics driver"));
    }
    render(
        "scenes/two-spheres.toml",
        "4x4",
        &dir.path().join("no/such/directory/out.png"),
    )
    .assert()
    .code(1)
    .stderr(contains("cannot be written").and(contains("help: ")));
}

/// An existing output is replaced as a whole, and is kept if the render fails.
#[test]
fn an_old_image_survives_a_failed_render() {
    let dir = temporary();
    let out = dir.path().join("out.png");
    std::fs::write(&out, "old").expect("the file can be written");
    spherule()
        .args([
            "render",
            "scenes/two-spheres.toml",
            "--device",
            "no such adapter",
            "-o",
        ])
        .arg(&out)
        .assert()
        .failure();
    assert_eq!(std::fs::read(&out).expect("the old file"), b"old");
    render("scenes/two-spheres.toml", "4x4", &out)
        .assert()
        .success();
    assert!(image::open(&out).is_ok());
}

/// The CPU path uses no graphics driver and needs none.
#[test]
fn the_cpu_path_works_without_any_driver() {
    let dir = temporary();
    spherule()
        .env("VK_DRIVER_FILES", "/nonexistent")
        .env("VK_ICD_FILENAMES", "/nonexistent")
        .args([
            "render",
            "scenes/soft-light.toml",
            "--size",
            "320x180",
            "-o",
        ])
        .arg(dir.path().join("out.png"))
        .assert()
        .success()
        .stderr(contains("there is no real GPU"));
}

/// The CPU renders an image that it finishes before a GPU would be open.
#[test]
fn auto_opens_no_gpu_for_a_small_image() {
    let dir = temporary();
    spherule()
        .args(["render", "scenes/two-spheres.toml", "--size", "16x9", "-o"])
        .arg(dir.path().join("out.png"))
        .assert()
        .success()
        .stderr(contains("done before a GPU would be open"));
}

#[test]
fn help_names_every_command_and_default() {
    spherule()
        .arg("--help")
        .assert()
        .success()
        .stdout(contains("render").and(contains("devices")));
    spherule()
        .args(["render", "--help"])
        .assert()
        .success()
        .stdout(
            contains("--check")
                .and(contains("Exit codes"))
                .and(contains("[default: auto]")),
        );
}

/// The table, the JSON and the exit code of `check` agree.
#[test]
fn check_reports_every_case_on_every_rung() {
    spherule()
        .args(["check", "--device", "cpu"])
        .assert()
        .success()
        .stdout(
            contains("Earth, camera at 0.1")
                .and(contains("certified"))
                .and(contains("Every promise holds on this device.")),
        );
    let output = spherule()
        .args(["check", "--device", "cpu", "--json"])
        .output()
        .expect("it runs");
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(report["promises_kept"], true);
    let cases = report["cases"].as_array().expect("a list");
    assert!(cases.len() > 30);
    for case in cases {
        assert_eq!(case["rungs"].as_array().map(Vec::len), Some(5), "{case}");
    }
}

#[test]
fn accuracy_writes_a_table_a_page_and_numbers() {
    let dir = temporary();
    let (page, numbers) = (
        dir.path().join("report.html"),
        dir.path().join("numbers.json"),
    );
    spherule()
        .args([
            "accuracy", "--device", "cpu", "--rays", "2000", "--scene", "far", "-o",
        ])
        .arg(&page)
        .arg("--json")
        .arg(&numbers)
        .assert()
        .success()
        .stdout(
            contains("far")
                .and(contains("textbook"))
                .and(contains("ns a test")),
        );
    let page = std::fs::read_to_string(page).expect("the page");
    assert!(
        page.starts_with("<!doctype html>") && page.contains("<svg") && page.ends_with("</html>\n")
    );
    assert!(
        !page.contains("NaN") && !page.contains("http"),
        "the page needs no other file"
    );
    let numbers = read_json(&numbers);
    let rungs = numbers["families"][0]["rungs"].as_array().expect("a list");
    assert_eq!(rungs.len(), 5);
    assert!(
        rungs[0]["measured"]["false_misses"].as_u64()
            > rungs[1]["measured"]["false_misses"].as_u64()
    );
    assert_eq!(rungs[4]["measured"]["false_misses"], 0);
}

#[test]
fn auto_precision_says_what_it_chose_and_why() {
    let dir = temporary();
    for (scene, size, tolerance, rung) in [
        ("scenes/1crn.pdb", "32x18", "0.1", "robust"),
        ("scenes/glass-marble.toml", "960x540", "0.1", "double"),
        // A pixel of a small image tolerates a larger error.
        ("scenes/glass-marble.toml", "96x54", "0.1", "robust"),
        ("scenes/marble-on-earth.toml", "960x540", "0.1", "double"),
        (
            "scenes/marble-on-earth.toml",
            "960x540",
            "1.0e-4",
            "certified",
        ),
    ] {
        render(scene, size, &dir.path().join("out.png"))
            .args(["--samples", "1", "--tolerance", tolerance])
            .assert()
            .success()
            .stderr(
                contains(format!("precision {rung} (within "))
                    .and(contains(format!("{tolerance} are allowed"))),
            );
    }
}

/// If no rung is within the tolerance, the image is rendered and a warning says so.
#[test]
fn a_warning_says_that_no_precision_meets_the_tolerance() {
    let dir = temporary();
    let render = |tolerance: &str, more: &[&str]| {
        let mut command = spherule();
        command
            .args([
                "render",
                "scenes/c60.xyz",
                "--device",
                "cpu",
                "--size",
                "16x9",
            ])
            .args(["--tolerance", tolerance, "-o"])
            .arg(dir.path().join("out.png"))
            .args(more);
        command.assert().success()
    };
    render("1e-9", &[]).stderr(
        contains("precision certified (within ")
            .and(contains("warning: no precision keeps this image within"))
            .and(contains("a larger --tolerance")),
    );
    render("1e-9", &["--precision", "robust"]).stderr(contains("warning").not());
    render("0.1", &[]).stderr(contains("warning").not());
    render("1e-9", &["-q"]).stderr("");
}

/// Prints one line before the work and one after it.
#[test]
fn render_says_what_renders_and_what_was_written() {
    let dir = temporary();
    let output = render("scenes/c60.xyz", "16x9", &dir.path().join("out.png"))
        .assert()
        .success();
    let stderr = String::from_utf8_lossy(&output.get_output().stderr).into_owned();
    let lines: Vec<&str> = stderr.lines().collect();
    assert_eq!(lines.len(), 2, "{stderr}");
    let before =
        contains("rendering on CPU, ").and(contains("(requested), precision robust (within "));
    assert!(before.eval(lines[0]), "{stderr}");
    assert!(lines[1].starts_with("wrote "), "{stderr}");
}

/// The log says each step, and a filter that is not understood is reported.
#[test]
fn the_log_says_what_happens() {
    let dir = temporary();
    let render = |log: &str| {
        let mut command = spherule();
        command
            .env("SPHERULE_LOG", log)
            .args([
                "render",
                "scenes/c60.xyz",
                "--device",
                "cpu",
                "--size",
                "16x9",
                "-o",
            ])
            .arg(dir.path().join("out.png"));
        command.assert().success()
    };
    render("debug").stderr(
        contains("read scenes/c60.xyz: 60 spheres, 1 material, 0 lights")
            .and(contains("the device is the CPU"))
            .and(contains("traced: "))
            .and(contains("encoded and wrote ")),
    );
    render("warn").stderr(contains("DEBUG").not());
    for wrong in ["debgu", "spherule=loud"] {
        render(wrong).stderr(contains("SPHERULE_LOG is ignored").and(contains("debug")));
    }
    if skips("the_log_says_what_happens on a GPU") {
        return;
    }
    spherule()
        .env("SPHERULE_LOG", "debug")
        .args([
            "render",
            "scenes/c60.xyz",
            "--device",
            "gpu",
            "--size",
            "16x9",
            "-o",
        ])
        .arg(dir.path().join("out.png"))
        .assert()
        .success()
        .stderr(contains("opened ").and(contains("compiled ")));
}

#[test]
fn explain_says_what_calls_for_each_effect_and_what_it_costs() {
    let scene = "scenes/glass-marble.toml";
    let size = ["--device", "cpu", "--size", "16x9", "--samples", "2"];
    spherule()
        .args(["explain", scene])
        .args(size)
        .assert()
        .success()
        .stdout(
            contains("glass")
                .and(contains("material `green` is of kind glass"))
                .and(contains("Not called for, and not in the pipeline"))
                .and(contains("fog")),
        );
    let output = spherule()
        .args(["explain", scene, "--json"])
        .args(size)
        .assert()
        .success();
    let report = printed_json(&output);
    let effects = report["effects"].as_array().expect("effects");
    assert_eq!(effects.len(), Effects::NAMED.len());
    let called = effects.iter().filter(|effect| effect["by"].is_string());
    for effect in called.clone() {
        let cost = effect["without"]["milliseconds"].as_f64();
        assert!(cost.expect("a time") > 0.0, "{effect}");
    }
    assert_eq!(
        called.count(),
        report["effect_bits"].as_u64().expect("bits").count_ones() as usize
    );
    assert!(report["frame"]["all_effects"]["milliseconds"].as_f64() > Some(0.0));
}

/// A scene that takes too long is measured in a smaller image of the same shape, and the output
/// says so.
#[test]
fn measuring_keeps_to_its_time() {
    let scene = "scenes/glass-marble.toml";
    // The limit is for the whole command. A much longer time would mean that samples, rounds or
    // rows were not counted.
    let started = Instant::now();
    let output = spherule()
        .args(["explain", scene, "--device", "cpu"])
        .args(["--time-limit", "1", "--json"])
        .assert()
        .success();
    assert!(started.elapsed() < Duration::from_secs(10), "{started:?}");
    let report = printed_json(&output);
    let size = |key: &str| report[key].as_u64().expect("a size");
    let (width, height) = (size("width"), size("height"));
    assert_eq!(report["whole_image"], serde_json::json!([960, 540]));
    assert!(
        (6..540).contains(&height) && width * 540 < (height + 1) * 960,
        "{width} × {height}"
    );
    assert_eq!(report["whole_samples"], 512);
    assert!(report["frame"]["own"]["milliseconds"].as_f64() > Some(0.0));
    // With no time at all, one frame is measured, and the output says that the others are missing.
    spherule()
        .args(["explain", scene, "--device", "cpu", "--time-limit", "1e-9"])
        .assert()
        .success()
        .stdout(
            contains("11 × 6 pixels and 2 samples").and(contains("no time left to measure it")),
        );
    spherule()
        .args(["explain", scene, "--time-limit", "1", "--size", "16x9"])
        .assert()
        .code(2)
        .stderr(contains("--time-limit").and(contains("--size")));
    let started = Instant::now();
    spherule()
        .args(["accuracy", "--device", "cpu", "--time-limit", "2"])
        .args(["--samples", "scenes/box.toml"])
        .assert()
        .success()
        .stderr(contains("to be done in time").and(contains("--size")));
    assert!(started.elapsed() < Duration::from_secs(10), "{started:?}");
    spherule()
        .args(["accuracy", "--device", "cpu", "--time-limit", "1e-9"])
        .args(["--samples", "scenes/box.toml", "--json", "-"])
        .assert()
        .code(1)
        .stdout("")
        .stderr(
            contains("nothing is measured")
                .and(contains("1 sample of the reference"))
                .and(contains("--time-limit")),
        );
    spherule()
        .args(["accuracy", "--time-limit", "1"])
        .assert()
        .code(2)
        .stderr(contains("--samples"));
    spherule()
        .args(["accuracy", "--time-limit", "1", "--scene", "far"])
        .assert()
        .code(2)
        .stderr(contains("--scene"));
}

/// A scene in thick fog, where light paths are as long as allowed: a pixel takes milliseconds.
fn heavy(folder: &Path, width: u32, height: u32) -> std::path::PathBuf {
    let path = folder.join("heavy.toml");
    let text = format!(
        "[image]\nwidth = {width}\nheight = {height}\nsamples = 64\nmax_bounces = 10000\n\
         [sky]\nhorizon = [1, 1, 1]\n[fog]\nextinction = 10\ncenter = [0, 0, 0]\nradius = 100\n\
         [camera]\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n"
    );
    std::fs::write(&path, text).expect("a scene");
    path
}

/// The first image that is measured has few pixels, even if the shorter side is short already.
#[test]
fn measuring_keeps_to_its_time_in_flat_images() {
    let dir = temporary();
    for (width, height) in [(4096, 16), (65_536, 1)] {
        let scene = heavy(dir.path(), width, height);
        spherule()
            .arg("explain")
            .arg(&scene)
            .args(["--device", "cpu", "--time-limit", "1"])
            .timeout(Duration::from_secs(15))
            .assert()
            .success()
            .stdout(contains("measured with"));
        let started = Instant::now();
        // It depends on the machine whether there is time for a reference.
        let output = spherule()
            .args(["accuracy", "--samples"])
            .arg(&scene)
            .args(["--device", "cpu", "--time-limit", "1"])
            .timeout(Duration::from_secs(15))
            .output()
            .expect("it runs");
        assert!(
            matches!(output.status.code(), Some(0 | 1)),
            "{output:?} after {:?}",
            started.elapsed()
        );
    }
}

/// The limit includes the preview, and the traced pixels are counted.
#[test]
fn a_time_limit_holds_however_long_a_pixel_takes() {
    let dir = temporary();
    let scene = heavy(dir.path(), 512, 512);
    for limit in ["0.01", "1"] {
        let started = Instant::now();
        let output = spherule()
            .arg("render")
            .arg(&scene)
            .args(["--device", "cpu", "--time-limit", limit, "--stats", "-"])
            .arg("-o")
            .arg(dir.path().join("out.png"))
            .assert()
            .success()
            .stderr(contains("% of the pixels (the time was up"));
        let took = started.elapsed().as_secs_f64();
        let limit: f64 = limit.parse().expect("a number");
        // The limit must hold within 4096 pixels, too.
        assert!(took < limit + 2.5, "{took} s");
        let stats = printed_json(&output);
        assert_eq!(stats["rays"], stats["traced_pixels"]);
        assert!(limit < 1.0 || stats["rays"].as_u64() > Some(0), "{stats}");
    }
}

/// A time limit also cuts an image without samples. A message before the work says that the other
/// options have no effect.
#[test]
fn a_time_limit_cuts_camera_rays() {
    let dir = temporary();
    let out = dir.path().join("out.png");
    let render = |limit: &str| {
        let mut command = spherule();
        command
            .args(["render", "scenes/c60.xyz", "--device", "cpu"])
            .args(["--size", "4096x4096", "--time-limit", limit])
            .args(["--seed", "1", "--stats", "-", "-o"])
            .arg(&out)
            .env("RAYON_NUM_THREADS", "1");
        command.assert()
    };
    render("1e-9")
        .code(1)
        .stdout("")
        .stderr(contains("nothing in this image is sampled").and(contains("nothing is written")));
    assert!(!out.exists());
    let output = render("0.05").success().stderr(contains(
        "% of the pixels (the time was up: the others are transparent)",
    ));
    let stats = printed_json(&output);
    let rays = stats["rays"].as_u64().expect("a count");
    assert!(rays > 0 && rays < 4096 * 4096, "{stats}");
    assert_eq!(stats["traced_pixels"], rays);
    assert!(image::open(&out).expect("a PNG").color().has_alpha());
}

/// A wrong name, or a scene or image too large for memory, is refused before anything is measured.
#[test]
fn bench_checks_everything_before_it_measures() {
    let bench = |arguments: &[&str]| {
        let mut command = spherule();
        command
            .args(["bench", "--device", "cpu", "--no-limit", "--scene", "S2"])
            .args(arguments);
        command.assert().stdout("")
    };
    for (wrong, words) in [
        ("nope", "there is no bench scene `nope`"),
        ("L1M-rotatd", "did you mean L1M-rotated?"),
        ("gone.toml", "there is no file `gone.toml`"),
        ("scenes", "`scenes` is a folder"),
        ("R2000M", "from 1 to 1073741824"),
        ("", "there is no bench scene ``"),
    ] {
        bench(&["--scene", wrong])
            .code(2)
            .stderr(contains(words).and(contains("give one of S2, S46")));
    }
    // Linux says how much memory there is.
    if cfg!(target_os = "linux") {
        for too_much in [&["--size", "65536x65536"][..], &["--scene", "R1000M"]] {
            bench(too_much)
                .code(1)
                .stderr(contains("out of memory").and(contains("GiB")));
        }
    }
}

/// Prints a share of the limit for each kind of rays, except with `--no-limit`.
#[test]
fn bench_says_shares_of_the_limit() {
    let bench = |options: &[&str]| {
        let output = spherule()
            .args(["bench", "--device", "cpu", "--scene", "S46"])
            .args(["--size", "64x36", "--rounds", "2", "--json", "-"])
            .args(options)
            .assert()
            .success();
        printed_json(&output)
    };
    let report = bench(&[]);
    assert!(report["limit"]["operations_per_s"].as_f64() > Some(1e8));
    let without = bench(&["--no-limit"]);
    assert!(without["limit"].is_null());
    for kind in ["primary", "shadow", "ambient", "incoherent"] {
        let rays = |report: &serde_json::Value| report["scenes"][0]["rays"][kind].clone();
        assert!(rays(&report)["mrays_per_s"].as_f64() > Some(0.0), "{kind}");
        assert!(
            rays(&report)["share_of_limit"].as_f64() > Some(0.0),
            "{kind}"
        );
        assert!(rays(&without)["share_of_limit"].is_null(), "{kind}");
        assert_eq!(rays(&report)["hits"], rays(&without)["hits"], "{kind}");
    }
}

#[test]
fn sampling_is_asked_for_and_reported() {
    let dir = temporary();
    let out = dir.path().join("out.png");
    let render = |scene: &str, options: &[&str]| {
        let mut command = spherule();
        command
            .args(["render", scene, "--device", "cpu", "--size", "24x16", "-o"])
            .arg(&out)
            .args(options);
        command
    };
    let box_scene = "scenes/box.toml";
    render(
        box_scene,
        &["--samples", "4", "--max-bounces", "2", "--seed", "7"],
    )
    .assert()
    .success()
    .stderr(contains("4 samples a pixel, noise at most"));
    let output = render(box_scene, &["--noise", "0.5", "--stats", "-"])
        .assert()
        .success();
    let stats = printed_json(&output);
    assert_eq!(stats["sampling"]["stopped_by"], "noise");
    let sampling = &stats["sampling"];
    assert!(sampling["noise"].as_f64() <= Some(0.5));
    assert_eq!(sampling["is_upper_estimate"], false);
    let number = |key: &str| sampling[key].as_f64().expect("a number");
    let (fewest, mean, most) = (
        number("samples"),
        number("mean_samples"),
        number("most_samples"),
    );
    assert!(16.0 <= fewest && fewest <= mean && mean <= most);
    assert!(stats["effects"].as_array().expect("effects").len() > 4);
    render(box_scene, &["--effects", "soft-shadow"])
        .assert()
        .code(2)
        .stderr(contains("there is no effect `soft-shadow`").and(contains("soft-shadows")));
    render(box_scene, &["--noise", "0.1", "--check"])
        .assert()
        .code(2)
        .stderr(contains("cannot be used with"));
    render("scenes/c60.xyz", &["--seed", "4"])
        .assert()
        .success()
        .stderr(contains("nothing in this image is sampled"));
}

#[test]
fn accuracy_measures_scenes_and_samples() {
    spherule()
        .args([
            "accuracy",
            "--device",
            "cpu",
            "--rays",
            "1000",
            "--size",
            "32x18",
            "--scene",
            "scenes/c60.xyz",
        ])
        .assert()
        .success()
        .stdout(contains("ms a frame").and(contains("scenes/c60.xyz: 60 spheres")));
    spherule()
        .args([
            "accuracy",
            "--device",
            "cpu",
            "--size",
            "8x6",
            "--samples",
            "scenes/box.toml",
        ])
        .assert()
        .success()
        .stdout(contains("error² × ms").and(contains("256")));
    spherule()
        .args(["accuracy", "--samples", "scenes/two-spheres.toml"])
        .assert()
        .code(2)
        .stderr(contains("calls for no effect"));
}

/// The image does not depend on the vector instructions that are used. Instructions that the
/// machine does not have are refused.
#[test]
fn instructions_are_chosen_by_the_environment() {
    let dir = temporary();
    let output = dir.path().join("out.png");
    let render = |instructions: &str, scene: &str, precision: &str| {
        let mut command = spherule();
        command
            .env("SPHERULE_CPU", instructions)
            .args(["render", scene, "--device", "cpu", "--size", "96x54"])
            .args(["--precision", precision, "-o"]);
        command.arg(&output).assert()
    };
    let there: Vec<_> = InstructionSet::ALL
        .into_iter()
        .filter(|instructions| instructions.is_there())
        .collect();
    for scene in ["scenes/1crn.pdb", "scenes/soft-light.toml"] {
        for precision in ["textbook", "robust", "compensated", "double", "certified"] {
            let images: Vec<Vec<u8>> = there
                .iter()
                .map(|instructions| {
                    render(instructions.name(), scene, precision).success();
                    std::fs::read(&output).expect("an image")
                })
                .collect();
            let are_equal = images.windows(2).all(|pair| pair[0] == pair[1]);
            assert!(are_equal, "{scene} on {precision}");
        }
    }
    let scene = "scenes/two-spheres.toml";
    for wrong in ["mmx", "AVX2 ", "\u{1b}[31m"] {
        render(wrong, scene, "robust").code(2).stderr(
            contains("SPHERULE_CPU")
                .and(contains("give one of"))
                .and(contains("\u{1b}").not()),
        );
    }
    if cfg!(not(target_arch = "x86_64")) {
        render("avx2", scene, "robust")
            .code(2)
            .stderr(contains("does not have"));
    }
}
