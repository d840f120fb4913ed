//! Outputs are checked before the work, appear whole or not at all, and never overwrite an input.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use assert_cmd::Command;
use assert_cmd::assert::{Assert, OutputAssertExt};
use assert_cmd::cargo::cargo_bin;
use predicates::prelude::*;
use predicates::str::contains;

/// The command, run in this directory.
fn spherule(directory: &Path) -> Command {
    let mut command = Command::new(cargo_bin("spherule"));
    command.env_remove("SPHERULE_LOG").current_dir(directory);
    command
}

fn temporary() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary directory")
}

const SPHERE: &str = "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n";

/// A directory with a small scene, `scene.toml`.
fn with_scene() -> tempfile::TempDir {
    let directory = temporary();
    let text = format!("[image]\nwidth = 16\nheight = 9\n{SPHERE}");
    fs::write(directory.path().join("scene.toml"), text).expect("a scene");
    directory
}

/// The names in the directory, sorted.
fn names(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).expect("a directory").flatten();
    let mut names: Vec<String> = entries
        .map(|entry| entry.file_name().to_string_lossy().into())
        .collect();
    names.sort();
    names
}

/// Runs `spherule render scene.toml --device cpu -o` with these arguments in a directory.
fn render(directory: &Path, arguments: &[&str]) -> Assert {
    spherule(directory).args(RENDER).args(arguments).assert()
}

/// Writes an old file that an output may replace.
fn write_old(path: &Path) {
    fs::write(path, "old").expect("a file");
}

/// Checks that the old file was not replaced.
fn assert_old(path: &Path) {
    assert_eq!(fs::read(path).expect("a file"), b"old");
}

/// What a command printed, which must be nothing but JSON.
fn printed_json(assert: &Assert) -> serde_json::Value {
    serde_json::from_slice(&assert.get_output().stdout).expect("JSON")
}

fn set_mode(path: &Path, mode: u32) {
    fs::set_permissions(path, fs::Permissions::from_mode(mode)).expect("permissions");
}

const RENDER: [&str; 5] = ["render", "scene.toml", "--device", "cpu", "-o"];
const ACCURACY: [&str; 5] = ["accuracy", "--device", "cpu", "--rays", "1000"];
const BENCH: [&str; 6] = ["bench", "--device", "cpu", "--no-limit", "--scene", "S2"];

#[test]
fn outputs_are_checked_before_the_work() {
    let directory = with_scene();
    let path = directory.path();
    fs::create_dir(path.join("folder.png")).expect("a directory");
    write_old(&path.join("protected.png"));
    set_mode(&path.join("protected.png"), 0o444);
    let cases: [(&[&str], &[&str], &str); 10] = [
        (&RENDER, &["no/out.png"], "there is no directory no"),
        (&RENDER, &["folder.png"], "is a directory"),
        (&RENDER, &["protected.png"], "is read-only"),
        (
            &RENDER,
            &["out.png", "--stats", "no/s.json"],
            "there is no directory no",
        ),
        (
            &RENDER,
            &["out.png", "--stats", "folder.png"],
            "is a directory",
        ),
        (
            &ACCURACY,
            &["-o", "no/page.html"],
            "there is no directory no",
        ),
        (
            &ACCURACY,
            &["--json", "no/n.json"],
            "there is no directory no",
        ),
        (&ACCURACY, &["--json", "protected.png"], "is read-only"),
        (&BENCH, &["--json", "no/n.json"], "there is no directory no"),
        (
            &BENCH,
            &["--export", "scene.toml/folder"],
            "cannot be created",
        ),
    ];
    for (command, rest, message) in cases {
        spherule(path)
            .args(command)
            .args(rest)
            .assert()
            .code(1)
            .stdout("")
            .stderr(
                contains(message)
                    .and(contains("help: "))
                    .and(contains("rendering on").not())
                    .and(contains("measuring").not()),
            );
    }
    assert_eq!(names(path), ["folder.png", "protected.png", "scene.toml"]);
    assert_old(&path.join("protected.png"));
}

/// A folder without write permission is refused before the work, too. Root may write anywhere.
#[test]
fn a_folder_that_may_not_be_written_is_refused_before_the_work() {
    let directory = with_scene();
    let path = directory.path();
    let closed = path.join("closed");
    fs::create_dir(&closed).expect("a directory");
    set_mode(&closed, 0o555);
    if fs::write(closed.join("probe"), "").is_ok() {
        eprintln!("SKIPPED a_folder_that_may_not_be_written_is_refused_before_the_work: root");
        return;
    }
    render(path, &["closed/out.png"])
        .code(1)
        .stderr(contains("no file can be created in closed").and(contains("rendering on").not()));
}

/// The inputs are a scene, particles and a sky. Outputs name them by their names, another spelling,
/// a symlink and a hard link.
#[test]
fn no_output_replaces_an_input() {
    let directory = temporary();
    let path = directory.path();
    fs::create_dir(path.join("sub")).expect("a directory");
    let scene = "[image]\nwidth = 8\nheight = 8\nsamples = 1\n[sky]\nimage = \"sky.exr\"\n\
         [particles]\nfile = \"atoms.xyz\"\n";
    fs::write(path.join("scene.toml"), scene).expect("a scene");
    fs::write(path.join("atoms.xyz"), "1\n\nC 0 0 0\n").expect("atoms");
    image::Rgb32FImage::from_pixel(4, 2, image::Rgb([0.5; 3]))
        .save(path.join("sky.exr"))
        .expect("a sky");
    let inputs = ["scene.toml", "atoms.xyz", "sky.exr"];
    let content = || inputs.map(|input| fs::read(path.join(input)).expect("an input"));
    let before = content();
    for input in inputs {
        let end = Path::new(input).extension().expect("an extension");
        let linked = |name: &str| PathBuf::from(name).with_extension(end);
        symlink(input, path.join(linked("soft"))).expect("a symlink");
        fs::hard_link(path.join(input), path.join(linked("hard"))).expect("a hard link");
        let whole = path.join(input);
        let spelled = Path::new("sub/..").join(input);
        let others = [linked("soft"), linked("hard")];
        for output in [Path::new(input), &spelled, &whole, &others[0], &others[1]] {
            let refused = |arguments: &[&str]| {
                spherule(path)
                    .args(arguments)
                    .arg(output)
                    .assert()
                    .code(2)
                    .stdout("")
                    .stderr(contains("is the same file as the input").and(contains("help: ")));
            };
            refused(&["render", "scene.toml", "--device", "cpu", "--stats"]);
            refused(&[
                "accuracy",
                "--device",
                "cpu",
                "--scene",
                "scene.toml",
                "--json",
            ]);
            refused(&["accuracy", "--device", "cpu", "--scene", "scene.toml", "-o"]);
            refused(&[
                "accuracy",
                "--device",
                "cpu",
                "--samples",
                "scene.toml",
                "-o",
            ]);
            if input == "sky.exr" {
                refused(&["render", "scene.toml", "--device", "cpu", "-o"]);
            }
        }
    }
    spherule(path)
        .args(["bench", "--device", "cpu", "--no-limit", "--scene"])
        .args(["scene.toml", "--json", "soft.xyz"])
        .assert()
        .code(2)
        .stderr(contains("is the same file as the input atoms.xyz"));
    assert_eq!(content(), before);
}

#[test]
fn two_outputs_are_two_files() {
    let directory = with_scene();
    let path = directory.path();
    symlink("out.png", path.join("link.json")).expect("a symlink");
    for stats in ["out.png", "./out.png", "link.json"] {
        render(path, &["out.png", "--stats", stats])
            .code(2)
            .stderr(contains("is the same file as the output out.png"));
    }
    spherule(path)
        .args(ACCURACY)
        .args(["--scene", "far", "-o", "-", "--json", "-"])
        .assert()
        .code(2)
        .stdout("")
        .stderr(contains("standard output"));
    assert_eq!(names(path), ["link.json", "scene.toml"]);
}

#[test]
fn numbers_to_stdout_and_a_page_to_a_file() {
    let directory = temporary();
    let path = directory.path();
    let assert = spherule(path)
        .args(ACCURACY)
        .args(["--scene", "far", "--json", "-", "-o", "page.html"])
        .assert()
        .success();
    let numbers = printed_json(&assert);
    assert_eq!(numbers["families"][0]["family"], "far");
    let page = fs::read_to_string(path.join("page.html")).expect("the page");
    assert!(page.ends_with("</html>\n"));
}

/// An overwritten file keeps its permissions, a symlink stays a symlink, and a device stays a
/// device.
#[test]
fn overwriting_keeps_permissions_links_and_devices() {
    let directory = with_scene();
    let path = directory.path();
    let mode = |name: &str| fs::metadata(path.join(name)).expect("a file").mode() & 0o777;
    let render = |output: &str, stats: &str| {
        render(path, &[output, "--stats", stats]).success();
    };
    // New files have the permissions of any new file.
    fs::write(path.join("new"), "").expect("a file");
    render("out.png", "stats.json");
    assert_eq!([mode("out.png"), mode("stats.json")], [mode("new"); 2]);
    for (name, kept) in [("out.png", 0o600), ("stats.json", 0o640)] {
        set_mode(&path.join(name), kept);
    }
    fs::hard_link(path.join("out.png"), path.join("other.png")).expect("a hard link");
    let old = fs::metadata(path.join("other.png")).expect("a file").ino();
    render("out.png", "stats.json");
    assert_eq!([mode("out.png"), mode("stats.json")], [0o600, 0o640]);
    // The other name keeps the old content.
    assert_eq!(
        fs::metadata(path.join("other.png")).expect("a file").ino(),
        old
    );
    assert_ne!(
        fs::metadata(path.join("out.png")).expect("a file").ino(),
        old
    );

    fs::create_dir(path.join("far")).expect("a directory");
    symlink("far/target.png", path.join("link.png")).expect("a symlink");
    symlink("link.png", path.join("chain.png")).expect("a symlink");
    render("chain.png", "/dev/null");
    render("link.png", "/dev/null");
    for name in ["chain.png", "link.png"] {
        let about = fs::symlink_metadata(path.join(name)).expect("a link");
        assert!(about.is_symlink(), "{name}");
    }
    let target = path.join("far/target.png");
    assert!(fs::symlink_metadata(&target).expect("a file").is_file());
    image::open(&target).expect("an image");
    assert_eq!(names(&path.join("far")), ["target.png"]);
    let null = fs::metadata("/dev/null").expect("a device");
    assert!(null.file_type().is_char_device());
}

#[test]
fn a_pipe_is_written_into() {
    let directory = with_scene();
    let path = directory.path();
    for name in ["out.exr", "out.png"] {
        let pipe = path.join(name);
        make_fifo(&pipe);
        let reader = {
            let pipe = pipe.clone();
            std::thread::spawn(move || fs::read(pipe).expect("the image"))
        };
        render(path, &[name]).success();
        // If the pipe was replaced, the reader waits for ever.
        let about = fs::symlink_metadata(&pipe).expect("a pipe");
        assert!(about.file_type().is_fifo(), "the pipe was replaced");
        let read = reader.join().expect("a reader");
        image::load_from_memory(&read).expect("an image");
    }
    let assert = render(path, &["plain.png", "--stats", "/dev/stdout"]).success();
    let stats = printed_json(&assert);
    assert_eq!(stats["width"], 16);
}

/// The message says that the disk is full, and no old file is lost.
#[test]
fn a_full_disk_is_reported_and_loses_nothing() {
    let directory = with_scene();
    let path = directory.path();
    for name in ["out.exr", "out.png"] {
        symlink("/dev/full", path.join(name)).expect("a symlink");
        render(path, &[name])
            .code(1)
            .stderr(contains("No space left on device").and(contains("another size").not()));
    }
    render(path, &["fine.png", "--stats", "/dev/full"])
        .code(1)
        .stderr(contains(
            "/dev/full: cannot be written: No space left on device",
        ));

    let room = path.join("room");
    fs::create_dir(&room).expect("a directory");
    let mounted = "mount -t tmpfs -o size=64k tmpfs room && echo old > room/out.exr && \
         echo old > room/out.png && echo old > room/s.json";
    let name_space = |script: String| {
        let mut command = Command::new("unshare");
        command.current_dir(path).args(["-m", "sh", "-c", &script]);
        command
    };
    if name_space(mounted.into()).ok().is_err() {
        eprintln!(
            "SKIPPED the disk in a_full_disk_is_reported_and_loses_nothing: no permission to mount"
        );
        return;
    }
    let spherule = cargo_bin("spherule");
    let spherule = spherule.display();
    // Normals are hard to compress.
    for name in ["out.exr", "out.png"] {
        let script = format!(
            "{mounted} && {spherule} render scene.toml --device cpu --size 400x300 --shade normals -o room/{name}; \
             echo $?; ls -A room; cat room/{name}"
        );
        name_space(script)
            .assert()
            .success()
            .stdout("1\nout.exr\nout.png\ns.json\nold\n")
            .stderr(contains("No space left on device").and(contains(" bytes) or less")));
    }
    // There is no room for a single byte.
    let script = format!(
        "{mounted} && head -c 60k /dev/zero > room/fill; {spherule} render scene.toml --device cpu -o fine.png \
         --stats room/s.json; echo $?; ls -A room; cat room/s.json"
    );
    name_space(script)
        .assert()
        .success()
        .stdout("1\nfill\nout.exr\nout.png\ns.json\nold\n")
        .stderr(contains("No space left on device"));
}

/// A limit on file sizes (`ulimit -f`) ends in an error, not by its signal.
#[test]
fn a_limit_on_file_sizes_is_an_error() {
    let directory = with_scene();
    let path = directory.path();
    write_old(&path.join("out.exr"));
    let spherule = cargo_bin("spherule");
    let script = format!(
        "ulimit -f 1; exec {} render scene.toml --device cpu --size 400x300 -o out.exr",
        spherule.display()
    );
    Command::new("sh")
        .current_dir(path)
        .args(["-c", &script])
        .assert()
        .code(1)
        .stderr(contains("File too large"));
    assert_eq!(names(path), ["out.exr", "scene.toml"]);
    assert_old(&path.join("out.exr"));
}

/// Starts a render of an image that takes a while to write, and returns while it is being written.
fn writing(directory: &Path, output: &str) -> Child {
    let before = names(directory);
    let child = std::process::Command::new(cargo_bin("spherule"))
        .current_dir(directory)
        .args(["render", "scene.toml", "--device", "cpu"])
        .args([
            "--precision",
            "robust",
            "--size",
            "6000x4000",
            "-q",
            "-o",
            output,
        ])
        .spawn()
        .expect("it starts");
    wait_for(|| {
        let names = names(directory);
        let new = |name: &&String| name.ends_with(".part") && !before.contains(name);
        let part = names.iter().find(new);
        let about = part.and_then(|name| fs::metadata(directory.join(name)).ok());
        about.is_some_and(|about| about.len() > 0)
    });
    child
}

fn wait_for(condition: impl Fn() -> bool) {
    let started = Instant::now();
    while !condition() {
        assert!(started.elapsed() < Duration::from_secs(120), "timed out");
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn send(child: &Child, signal: &str) {
    let sent = std::process::Command::new("kill")
        .args(["-s", signal, &child.id().to_string()])
        .status();
    assert!(sent.expect("kill").success());
}

const SIGNALS: [(&str, i32); 3] = [("INT", 130), ("TERM", 143), ("HUP", 129)];

/// After the first signal the image is still written, after the second it is not. Neither leaves
/// other files behind.
#[test]
fn signals_leave_nothing_behind() {
    for (signal, code) in SIGNALS {
        let directory = with_scene();
        let path = directory.path();
        write_old(&path.join("out.exr"));
        let mut child = writing(path, "out.exr");
        send(&child, signal);
        assert_eq!(child.wait().expect("it ends").code(), Some(code));
        assert_eq!(names(path), ["out.exr", "scene.toml"]);
        let image = image::open(path.join("out.exr")).expect("an image");
        assert_eq!(image.width(), 6000);

        write_old(&path.join("out.exr"));
        let mut child = writing(path, "out.exr");
        send(&child, signal);
        // Two pending signals of one kind would be merged into one.
        std::thread::sleep(Duration::from_millis(50));
        send(&child, signal);
        assert_eq!(child.wait().expect("it ends").code(), Some(code));
        assert_eq!(names(path), ["out.exr", "scene.toml"]);
        assert_old(&path.join("out.exr"));
    }
}

/// A measurement, which cannot be interrupted, ends at the first signal.
#[test]
fn a_signal_ends_a_measurement() {
    let directory = temporary();
    for (signal, code) in SIGNALS {
        let mut child = std::process::Command::new(cargo_bin("spherule"))
            .current_dir(directory.path())
            .args(["accuracy", "--device", "cpu", "--rays", "100000000"])
            .stderr(Stdio::piped())
            .spawn()
            .expect("it starts");
        // It prints a note when it begins to measure.
        let mut first = [0];
        let stderr = child.stderr.as_mut().expect("its errors");
        std::io::Read::read_exact(stderr, &mut first).expect("a note");
        let sent = Instant::now();
        send(&child, signal);
        assert_eq!(child.wait().expect("it ends").code(), Some(code));
        assert!(sent.elapsed() < Duration::from_secs(20));
    }
}

/// A signal that is ignored from the start, as under `nohup`, stays ignored.
#[test]
fn an_ignored_signal_stays_ignored() {
    let directory = with_scene();
    let path = directory.path();
    let spherule = cargo_bin("spherule");
    let script = format!(
        "trap '' HUP; {} render scene.toml --device cpu --size 4000x3000 -o out.png & kill -s HUP $!; wait $!",
        spherule.display()
    );
    Command::new("sh")
        .current_dir(path)
        .args(["-c", &script])
        .assert()
        .success();
    assert!(path.join("out.png").exists());
}

/// A run removes the temporary files of killed runs, and not those of running ones.
#[test]
fn the_next_run_removes_what_a_killed_one_left() {
    let directory = with_scene();
    let path = directory.path();
    let mut killed = writing(path, "killed.exr");
    killed.kill().expect("SIGKILL");
    killed.wait().expect("it ends");
    assert_eq!(names(path).len(), 2, "the temporary file of the killed run");
    let mut live = writing(path, "live.exr");
    assert_eq!(
        names(path).len(),
        2,
        "only the temporary file of the running one"
    );
    render(path, &["out.png"]).success();
    assert!(live.wait().expect("it ends").success());
    assert_eq!(names(path), ["live.exr", "out.png", "scene.toml"]);
}

/// The command's path, quoted for a shell.
fn quoted() -> String {
    format!("'{}'", cargo_bin("spherule").display())
}

/// Runs `script` in bash, in `directory`.
fn shell(directory: &Path, script: &str) -> Assert {
    Command::new("bash")
        .env_remove("SPHERULE_LOG")
        .current_dir(directory)
        .args(["-c", script])
        .timeout(Duration::from_secs(120))
        .assert()
}

fn make_fifo(path: &Path) {
    let made = std::process::Command::new("mkfifo").arg(path).status();
    assert!(made.expect("mkfifo").success());
}

/// Tables of a scene with a sky, which is sampled.
const LIGHT: &str = "[image]\nwidth = 16\nheight = 16\nsamples = 4\n[sky]\nhorizon = [1, 1, 1]\n";

/// The files of each scene are compared with the inputs of all scenes before any file is written.
#[test]
fn an_export_replaces_no_input() {
    let directory = with_scene();
    let path = directory.path();
    let scene = "[image]\nwidth = 8\nheight = 8\n[particles]\nfile = \"atoms.xyz\"\n";
    fs::write(path.join("atoms.toml"), scene).expect("a scene");
    fs::write(path.join("atoms.xyz"), "1\n\nC 0 0 0\n").expect("atoms");
    let inputs = ["scene.toml", "atoms.toml", "atoms.xyz"];
    let content = || inputs.map(|input| fs::read(path.join(input)).expect("an input"));
    let before = content();
    let export = ["bench", "--device", "cpu", "--size", "8x8", "--export", "D"];
    for input in inputs {
        for name in ["meta.json", "spheres.f32", "primary.hits"] {
            for folder in ["D", "D/S2", "D/scene.toml"] {
                fs::create_dir_all(path.join(folder)).expect("a folder");
                symlink(path.join(input), path.join(folder).join(name)).expect("a link");
                let scenes: &[&str] = match folder {
                    "D" => &["atoms.toml"],
                    _ => &["S2", "scene.toml", "atoms.toml"],
                };
                if folder == "D" && input == "scene.toml" {
                    fs::remove_dir_all(path.join("D")).expect("a folder");
                    continue;
                }
                let scenes = scenes.iter().flat_map(|scene| ["--scene", scene]);
                spherule(path)
                    .args(export)
                    .args(scenes)
                    .assert()
                    .code(2)
                    .stderr(
                        contains("is the same file as the input")
                            .and(contains(input))
                            .and(contains("wrote").not()),
                    );
                fs::remove_dir_all(path.join("D")).expect("a folder");
            }
        }
    }
    // Two of the outputs are one file.
    fs::create_dir(path.join("D")).expect("a folder");
    symlink("spheres.f32", path.join("D/meta.json")).expect("a link");
    spherule(path)
        .args(export)
        .args(["--scene", "S2"])
        .assert()
        .code(2)
        .stderr(contains("is the same file as the output"));
    assert_eq!(names(&path.join("D")), ["meta.json"]);
    assert_eq!(content(), before);
}

/// Every scene is read before the first is measured.
#[test]
fn a_later_scene_of_a_bench_is_checked_before_the_first_is_measured() {
    let directory = with_scene();
    let path = directory.path();
    fs::write(path.join("wrong.toml"), "[[sphere]]\nradius = -1\n").expect("a scene");
    spherule(path)
        .args(BENCH)
        .args(["--scene", "wrong.toml"])
        .assert()
        .code(2)
        .stdout("");
}

#[test]
fn an_export_of_several_scenes_has_a_folder_for_each() {
    let directory = with_scene();
    let path = directory.path();
    let export = ["bench", "--device", "cpu", "--size", "8x8", "--export", "D"];
    spherule(path)
        .args(export)
        .args(["--scene", "scene.toml", "--scene", "s2"])
        .assert()
        .success();
    assert_eq!(names(&path.join("D")), ["S2", "scene.toml"]);
    for (folder, spheres) in [("S2", 2), ("scene.toml", 1)] {
        let meta = fs::read(path.join("D").join(folder).join("meta.json")).expect("a file");
        let meta: serde_json::Value = serde_json::from_slice(&meta).expect("JSON");
        assert_eq!(meta["spheres"], spheres);
    }
    fs::create_dir(path.join("other")).expect("a folder");
    fs::copy(path.join("scene.toml"), path.join("other/scene.toml")).expect("a copy");
    for twice in [["S2", "s2"], ["scene.toml", "other/scene.toml"]] {
        let scenes = twice.iter().flat_map(|scene| ["--scene", scene]);
        spherule(path)
            .args(export)
            .args(scenes)
            .assert()
            .code(2)
            .stderr(contains("two scenes").and(contains("wrote").not()));
    }
}

#[test]
fn a_name_that_is_too_long_is_refused_before_the_work() {
    let directory = with_scene();
    let path = directory.path();
    let long = "a".repeat(300);
    for arguments in [
        vec![format!("{long}.png")],
        vec!["out.png".into(), "--stats".into(), format!("{long}.json")],
        vec![format!("{long}/out.png")],
    ] {
        spherule(path)
            .args(RENDER)
            .args(arguments)
            .assert()
            .code(1)
            .stderr(
                contains("File name too long")
                    .and(contains("shorter"))
                    .and(contains("rendering on").not()),
            );
    }
    assert_eq!(names(path), ["scene.toml"]);
}

/// A file that is a mount point cannot be replaced by another file, nor can another user's file in
/// a sticky directory.
#[test]
fn a_file_that_cannot_be_replaced_is_written_in_place() {
    let directory = with_scene();
    let path = directory.path();
    set_mode(path, 0o755);
    let spherule = quoted();
    fs::write(
        path.join("from.png"),
        "old, and longer than the image is   ".repeat(999),
    )
    .expect("a file");
    fs::write(path.join("to.png"), "").expect("a file");
    let mounted = Command::new("unshare")
        .current_dir(path)
        .args(["-m", "sh", "-c", "mount --bind from.png to.png"])
        .ok();
    if mounted.is_err() {
        eprintln!(
            "SKIPPED a_file_that_cannot_be_replaced_is_written_in_place: no permission to mount"
        );
        return;
    }
    let script = format!(
        "unshare -m sh -c \"mount --bind from.png to.png && {spherule} render scene.toml --device cpu -o to.png\""
    );
    shell(path, &script).success();
    image::open(path.join("from.png")).expect("an image");
    assert_eq!(names(path), ["from.png", "scene.toml", "to.png"]);

    // If there is no room to write it twice, the whole image is kept in a file beside it.
    let script = format!(
        "mkdir room; unshare -m sh -c \"mount -t tmpfs -o size=2m tmpfs room && echo old > room/from.exr && \
         echo old > room/to.exr && mount --bind room/from.exr room/to.exr && \
         {spherule} render scene.toml --device cpu --size 400x300 -o room/to.exr; \
         echo \\$?; cp room/spherule-*.exr kept.exr\""
    );
    shell(path, &script).success().stdout("1\n").stderr(
        contains("partly overwritten")
            .and(contains("the complete output is in"))
            .and(contains("No space left on device")),
    );
    image::open(path.join("kept.exr")).expect("an image");
    fs::remove_file(path.join("kept.exr")).expect("it is there");
    fs::remove_dir(path.join("room")).expect("it is empty");

    let sticky = path.join("sticky");
    fs::create_dir(&sticky).expect("a folder");
    write_old(&sticky.join("out.png"));
    set_mode(&sticky.join("out.png"), 0o666);
    set_mode(&sticky, 0o1777);
    let script = format!(
        "test -x {spherule} && exec setpriv --reuid 65534 --regid 65534 --clear-groups {spherule} \
         render scene.toml --device cpu -o sticky/out.png"
    );
    let runs = shell(
        path,
        &format!("setpriv --reuid 65534 --regid 65534 --clear-groups {spherule} --version"),
    );
    if runs.try_success().is_err() {
        eprintln!("SKIPPED the sticky directory: no other user may run the command");
        return;
    }
    shell(path, &script).success();
    image::open(sticky.join("out.png")).expect("an image");
    assert_eq!(names(&sticky), ["out.png"]);
}

#[test]
fn an_append_only_directory_is_refused_before_the_work() {
    let directory = with_scene();
    let path = directory.path();
    let closed = path.join("closed");
    fs::create_dir(&closed).expect("a folder");
    let flag = |flag: &str| {
        let set = std::process::Command::new("chattr")
            .arg(flag)
            .arg(&closed)
            .output();
        set.is_ok_and(|set| set.status.success())
    };
    if !flag("+a") {
        eprintln!(
            "SKIPPED an_append_only_directory_is_refused_before_the_work: no permission to make one"
        );
        return;
    }
    let output = spherule(path).args(RENDER).arg("closed/out.png").output();
    let names = names(&closed);
    assert!(flag("-a"));
    output
        .expect("it runs")
        .assert()
        .code(1)
        .stderr(contains("append").and(contains("rendering on").not()));
    assert!(names.is_empty(), "{names:?}");
}

/// An image that cannot be given its name is kept under another.
#[test]
fn an_image_that_cannot_get_its_name_is_kept_under_another() {
    let directory = with_scene();
    let path = directory.path();
    let child = writing(path, "out.exr");
    fs::create_dir(path.join("out.exr")).expect("a folder");
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(1));
    let kept: Vec<String> = names(path)
        .into_iter()
        .filter(|name| name.starts_with("spherule-"))
        .collect();
    assert_eq!(kept.len(), 1, "{:?}", names(path));
    image::open(path.join(&kept[0])).expect("an image");
    // The next run does not remove it as a killed run's file.
    render(path, &["next.png"]).success();
    assert!(path.join(&kept[0]).exists());
}

/// What writing to a stream needs is checked before the work, and the error names what is missing.
#[test]
fn streams_are_checked_before_the_work() {
    let directory = with_scene();
    let path = directory.path();
    let spherule = quoted();
    make_fifo(&path.join("fifo.png"));
    let render = format!("{spherule} render scene.toml --device cpu");
    let before = || contains("help: ").and(contains("rendering on").not());
    shell(path, &format!("timeout 20 cat fifo.png > got & TMPDIR=/nonexistent {render} -o fifo.png; code=$?; kill %1; exit $code"))
        .code(1)
        .stderr(before().and(contains("/nonexistent")).and(contains("TMPDIR")));
    drop(std::os::unix::net::UnixListener::bind(path.join("socket.png")).expect("a socket"));
    shell(path, &format!("{render} -o socket.png"))
        .code(1)
        .stderr(
            before()
                .and(contains("Connection refused"))
                .and(contains("socket.png")),
        );
    shell(path, &format!("{render} -o out.png --stats socket.png"))
        .code(1)
        .stderr(before().and(contains("Connection refused")));
    // Standard output is open for reading only.
    fs::write(path.join("read"), "").expect("a file");
    shell(path, &format!("{render} -o out.png --stats - 1<read"))
        .code(1)
        .stderr(before());
    // A reader of a pipe gets the whole image, and does not wait for ever.
    shell(
        path,
        &format!("cat fifo.png > got & {render} -o fifo.png && wait"),
    )
    .success();
    let got = fs::read(path.join("got")).expect("a file");
    image::load_from_memory(&got).expect("an image");
}

#[test]
fn a_socket_is_written_into() {
    let directory = with_scene();
    let path = directory.path();
    let listener = std::os::unix::net::UnixListener::bind(path.join("out.png")).expect("a socket");
    let reader = std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().expect("a connection");
        let mut read = Vec::new();
        std::io::Read::read_to_end(&mut stream, &mut read).expect("an image");
        read
    });
    render(path, &["out.png"]).success();
    image::load_from_memory(&reader.join().expect("a reader")).expect("an image");
}

/// A folder with `input.toml`, a scene with light, and `so.png`, a link to standard output.
fn with_input() -> tempfile::TempDir {
    let directory = with_scene();
    let path = directory.path();
    fs::write(path.join("light.toml"), format!("{LIGHT}{SPHERE}")).expect("a scene");
    fs::copy(path.join("light.toml"), path.join("input.toml")).expect("a copy");
    symlink("/dev/stdout", path.join("so.png")).expect("a link");
    directory
}

/// The commands that the tests of standard output run in such a folder.
fn render_input() -> String {
    format!("{} render input.toml --device cpu", quoted())
}

fn accuracy_of_few() -> String {
    format!("{} accuracy --device cpu --rays 1000", quoted())
}

fn brief_bench() -> String {
    format!(
        "{} bench --device cpu --no-limit --size 8x8 --rounds 1",
        quoted()
    )
}

/// Standard output is compared with the other outputs and the inputs, whatever its name.
#[test]
fn standard_output_is_shared_with_nothing() {
    let directory = with_input();
    let path = directory.path();
    let spherule = quoted();
    let (render, accuracy, bench) = (render_input(), accuracy_of_few(), brief_bench());
    let content = fs::read(path.join("input.toml")).expect("a file");
    for (script, message) in [
        (
            format!("{render} -o so.png --stats - > both"),
            "standard output",
        ),
        (
            format!("{render} -o so.png --stats - | cat > both"),
            "standard output",
        ),
        (
            format!("{render} -o so.png --stats /dev/fd/1 > both"),
            "standard output",
        ),
        (
            format!("{accuracy} --scene generic -o /dev/stdout --json - > both"),
            "standard output",
        ),
        (
            format!("{render} -o a.png -q --stats - > a.png"),
            "standard output",
        ),
        (
            format!("{render} -o a.png -q --stats - >> input.toml"),
            "the input input.toml",
        ),
        (
            format!("{accuracy} --scene input.toml 1<> input.toml"),
            "the input input.toml",
        ),
        (
            format!("{accuracy} --scene generic --json n.json > n.json"),
            "standard output",
        ),
        (
            format!("{accuracy} --scene generic -o n.html > n.html"),
            "standard output",
        ),
        (
            format!("{bench} --scene input.toml 1<> input.toml"),
            "the input input.toml",
        ),
        (
            format!("{bench} --scene input.toml --verify 1<> input.toml"),
            "the input input.toml",
        ),
        (
            format!("{bench} --scene S2 --json n.json > n.json"),
            "standard output",
        ),
        (
            format!("{spherule} explain --no-costs --device cpu input.toml 1<> input.toml"),
            "the input input.toml",
        ),
        (
            format!("{spherule} explain --no-costs --device cpu --json input.toml >> input.toml"),
            "the input input.toml",
        ),
    ] {
        eprintln!("{script}");
        let script = format!("set -o pipefail; {script}");
        shell(path, &script)
            .code(2)
            .stderr(contains(message).and(contains("help: ")));
        assert!(
            fs::read(path.join("input.toml")).expect("a file") == content,
            "{script}"
        );
        for name in ["both", "a.png", "n.json", "n.html"] {
            let written = fs::read(path.join(name)).unwrap_or_default();
            assert!(written.is_empty(), "{script}");
        }
    }
}

#[test]
fn every_name_of_standard_output_means_it() {
    let directory = with_input();
    let path = directory.path();
    for name in ["-", "/dev/stdout", "/dev/fd/1"] {
        for command in [
            format!("{} --scene far --json {name}", accuracy_of_few()),
            format!("{} --scene S2 --json {name}", brief_bench()),
        ] {
            for to in ["| cat", "> both; cat both"] {
                let assert = shell(path, &format!("{command} {to}")).success();
                let read = serde_json::from_slice::<serde_json::Value>(&assert.get_output().stdout);
                assert!(read.is_ok(), "{command} {to}");
            }
        }
    }
}

/// /dev/null may be shared, and another file is no conflict.
#[test]
fn standard_output_may_be_where_nothing_is_lost() {
    let directory = with_input();
    let path = directory.path();
    let render = render_input();
    shell(path, &format!("{render} -o a.png --stats - > /dev/null")).success();
    shell(
        path,
        &format!("{render} -o a.png --stats /dev/null > /dev/null"),
    )
    .success();
    shell(
        path,
        &format!(
            "{render} -o a.png --stats - > stats && {render} -o a.png --stats - | cat > stats"
        ),
    )
    .success();
}

/// Timers, limits and batch systems send these signals.
#[test]
fn other_signals_keep_the_image_too() {
    for (signal, code) in [
        ("XCPU", 152),
        ("USR1", 138),
        ("USR2", 140),
        ("ALRM", 142),
        ("VTALRM", 154),
    ] {
        let directory = with_scene();
        let path = directory.path();
        let mut child = writing(path, "out.exr");
        send(&child, signal);
        if signal != "USR1" && signal != "USR2" {
            // A timer sends its signal again.
            std::thread::sleep(Duration::from_millis(50));
            send(&child, signal);
        }
        assert_eq!(
            child.wait().expect("it ends").code(),
            Some(code),
            "{signal}"
        );
        assert_eq!(names(path), ["out.exr", "scene.toml"]);
        image::open(path.join("out.exr")).expect("an image");
    }
    // This signal ends the process at once.
    let directory = with_scene();
    let path = directory.path();
    let mut child = writing(path, "out.exr");
    send(&child, "QUIT");
    let status = child.wait().expect("it ends");
    assert_eq!(
        std::os::unix::process::ExitStatusExt::signal(&status),
        Some(3)
    );
    // The system may have written a core file.
    let mut names = names(path);
    names.retain(|name| !name.starts_with("core"));
    assert_eq!(names, ["scene.toml"]);
}

/// When the processor time of `ulimit -t` is over, the image so far is kept.
#[test]
fn a_limit_on_processor_time_keeps_the_image() {
    let directory = temporary();
    let path = directory.path();
    fs::write(path.join("light.toml"), format!("{LIGHT}{SPHERE}")).expect("a scene");
    let spherule = quoted();
    let script = format!(
        "ulimit -St 2; exec {spherule} render light.toml --device cpu --size 512x512 --samples 60000 -o out.png"
    );
    shell(path, &script)
        .code(152)
        .stderr(contains("interrupted: wrote out.png"));
    image::open(path.join("out.png")).expect("an image");
}

/// A command that waits for a reader of its output ends at the first signal.
#[test]
fn a_signal_ends_a_command_that_waits_for_a_reader() {
    let directory = with_scene();
    let path = directory.path();
    make_fifo(&path.join("fifo.png"));
    let render = |output: &str| {
        let mut command = std::process::Command::new(cargo_bin("spherule"));
        command
            .current_dir(path)
            .args(["render", "scene.toml", "--device", "cpu", "-q"])
            .args(["--size", "600x600", "-o", output]);
        command
    };
    let ends = |mut child: Child| {
        std::thread::sleep(Duration::from_millis(1500));
        send(&child, "TERM");
        let sent = Instant::now();
        while child.try_wait().expect("a child").is_none() {
            if sent.elapsed() > Duration::from_secs(10) {
                child.kill().expect("SIGKILL");
                child.wait().expect("it ends");
                panic!("the signal was swallowed");
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        assert_eq!(child.wait().expect("it ends").code(), Some(143));
    };
    ends(
        render("fifo.png")
            .args(["--shade", "normals"])
            .spawn()
            .expect("it starts"),
    );
    // The signal comes during the render. The image so far is then written, and nobody reads it.
    fs::write(path.join("scene.toml"), format!("{LIGHT}{SPHERE}")).expect("a scene");
    let mut long = render("fifo.png");
    long.args(["--samples", "60000"]);
    ends(long.spawn().expect("it starts"));
    // This pipe is full.
    symlink("/dev/stdout", path.join("so.png")).expect("a link");
    let mut child = render("so.png")
        .args(["--shade", "normals"])
        .stdout(Stdio::piped())
        .spawn()
        .expect("it starts");
    let reader = child.stdout.take().expect("a pipe");
    ends(child);
    drop(reader);
    assert_eq!(names(path), ["fifo.png", "scene.toml", "so.png"]);
}

#[test]
fn missing_room_is_reported_in_suitable_units() {
    let directory = with_scene();
    let path = directory.path();
    render(path, &["fine.png", "--stats", "/dev/full"])
        .code(1)
        .stderr(contains(" bytes or less").and(contains("0.0").not()));
    let script = format!(
        "mkdir room; unshare -m sh -c \"mount -t tmpfs -o nr_inodes=1 tmpfs room && \
         {} render scene.toml --device cpu -o room/out.png\"",
        quoted()
    );
    if Command::new("unshare").args(["-m", "true"]).ok().is_err() {
        eprintln!("SKIPPED the inodes: no permission to mount");
        return;
    }
    shell(path, &script)
        .code(1)
        .stderr(contains("No space left on device").and(contains("df -i")));
}

#[test]
fn help_that_cannot_be_printed_is_an_error() {
    let directory = temporary();
    let spherule = quoted();
    for asked in ["--help", "--version", "render --help"] {
        shell(directory.path(), &format!("{spherule} {asked} > /dev/full"))
            .code(1)
            .stderr(contains("standard output").and(contains("No space left on device")));
        shell(directory.path(), &format!("{spherule} {asked} | true"))
            .success()
            .stderr("");
    }
}

#[test]
fn names_need_not_be_unicode() {
    use std::os::unix::ffi::OsStrExt;
    let directory = with_scene();
    let path = directory.path();
    let name =
        |end: &str| std::ffi::OsStr::from_bytes(&[b"\xff", end.as_bytes()].concat()).to_owned();
    spherule(path)
        .args(RENDER)
        .arg(name(".png"))
        .assert()
        .success();
    image::open(path.join(name(".png"))).expect("an image");
    fs::rename(path.join("scene.toml"), path.join(name(".toml"))).expect("a name");
    spherule(path)
        .args(ACCURACY)
        .arg("--size")
        .arg("8x8")
        .arg("--scene")
        .arg(name(".toml"))
        .assert()
        .success();
    spherule(path)
        .args([
            "bench",
            "--device",
            "cpu",
            "--no-limit",
            "--size",
            "8x8",
            "--rounds",
            "1",
            "--scene",
        ])
        .arg(name(".toml"))
        .assert()
        .success();
}
