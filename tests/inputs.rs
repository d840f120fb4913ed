//! Untrusted inputs on the command line: they are either rendered or refused at once with exit code
//! 2, and nothing in them controls the terminal.

use std::io::Write as _;
use std::path::Path;
use std::time::{Duration, Instant};

use assert_cmd::Command;
use flate2::Compression;
use flate2::write::GzEncoder;
use predicates::str::contains;

fn spherule() -> Command {
    Command::cargo_bin("spherule").expect("the command")
}

fn render(input: &Path, output: &Path) -> Command {
    let mut command = spherule();
    command
        .args(["render", "--device", "cpu", "--size", "40x30", "-o"])
        .args([output, input])
        .timeout(Duration::from_secs(120));
    command
}

#[test]
fn skies_that_claim_a_huge_window_are_refused_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let (scene, output) = (folder.path().join("s.toml"), folder.path().join("o.png"));
    for name in ["sky_dwa_huge_window.exr", "sky_dwa_slow.exr"] {
        let sky = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("tests/inputs")
            .join(name);
        let text = format!(
            "[sky]\nimage = '{}'\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n",
            sky.display()
        );
        std::fs::write(&scene, text).expect("a scene");
        let start = Instant::now();
        render(&scene, &output)
            .assert()
            .code(2)
            .stderr(contains("data window claims"));
        // Decoding would take minutes, and allocating a gigabyte would exceed this time, too.
        assert!(start.elapsed() < Duration::from_secs(20));
        assert!(!output.exists());
    }
}

#[test]
fn no_name_controls_the_terminal() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = folder.path().join("o.png");
    let scene = folder.path().join("\u{1b}[31m\u{202e}\u{9b}J.toml");
    let glass = "[materials.\"\\u001b[2J\"]\nkind = \"glass\"\n";
    let sphere = "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = ";
    for material in ["\"\\u001b[2J\"", "\"\u{202e}\\u0007\"", "\"\u{9b}2J\"", "1"] {
        std::fs::write(&scene, format!("{glass}{sphere}{material}\n")).expect("a scene");
        let explain = |command: &mut Command| {
            let said = command.output().expect("it ends");
            let said = [said.stdout, said.stderr].concat();
            let said = String::from_utf8(said).expect("UTF-8");
            let is_control = |c: char| c.is_control() && c != '\n' || c == '\u{202e}';
            assert!(!said.contains(is_control), "{said:?}");
            said
        };
        let _ = explain(&mut render(&scene, &output));
        let said = explain(
            spherule()
                .args(["explain", "--device", "cpu", "--no-costs"])
                .arg(&scene),
        );
        assert!(said.contains("\\u{1b}"), "{said:?}");
    }
}

/// Thousands of atoms in one place render as one atom does, and do not take minutes.
#[test]
fn many_atoms_in_one_place_are_rendered() {
    let folder = tempfile::tempdir().expect("a folder");
    let atoms = folder.path().join("atoms.xyz");
    std::fs::write(&atoms, format!("32000\n\n{}", "C 0 0 0\n".repeat(32_000))).expect("a file");
    let one = folder.path().join("one.xyz");
    std::fs::write(&one, "1\n\nC 0 0 0\n").expect("a file");
    let (many, single) = (folder.path().join("m.png"), folder.path().join("1.png"));
    render(&atoms, &many).assert().success();
    render(&one, &single).assert().success();
    let [many, single] = [many, single].map(|path| std::fs::read(path).expect("a picture"));
    assert!(many == single);
}

fn compressed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).expect("memory");
    encoder.finish().expect("memory")
}

/// A compressed file is read in the format of its content: given on its own, in two gzip members,
/// or named by a scene.
#[test]
fn compressed_files_are_read_by_the_format_of_their_content() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let picture = |input: &Path| {
        render(input, &at("o.png")).assert().success();
        std::fs::read(at("o.png")).expect("a picture")
    };
    let scene = "[particles]\nfile = '1crn.ent.gz'\n";
    std::fs::write(at("s.toml.gz"), compressed(scene.as_bytes())).expect("a file");
    for (from, to) in [("c60.xyz", "c60.extxyz.gz"), ("1crn.pdb", "1crn.ent.gz")] {
        let from = Path::new("scenes").join(from);
        let text = std::fs::read(&from).expect("a molecule");
        std::fs::write(at(to), compressed(&text)).expect("a file");
        assert!(picture(&at(to)) == picture(&from), "{to}");
        let (first, second) = text.split_at(text.len() / 2);
        let members = [compressed(first), compressed(second)].concat();
        std::fs::write(at(to), members).expect("a file");
        assert!(picture(&at(to)) == picture(&from), "{to} of two members");
    }
    assert!(picture(&at("s.toml.gz")) == picture(Path::new("scenes/1crn.pdb")));
    // The image's name is the file's without both extensions.
    spherule()
        .current_dir(folder.path())
        .args([
            "render",
            "c60.extxyz.gz",
            "--device",
            "cpu",
            "--size",
            "8x8",
        ])
        .assert()
        .success();
    assert!(at("c60.png").is_file());
}

#[test]
fn compressed_files_that_are_wrong_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let (input, output) = (folder.path().join("a.xyz.gz"), folder.path().join("o.png"));
    let whole = compressed(&std::fs::read("scenes/c60.xyz").expect("a molecule"));
    let padded = [&whole[..], &[0; 512]].concat();
    std::fs::write(&input, padded).expect("a file");
    render(&input, &output).assert().success();
    std::fs::remove_file(&output).expect("a picture");
    let mut wrong = whole.clone();
    wrong[whole.len() / 2] ^= 0x55;
    for (bytes, says) in [
        (&whole[..whole.len() / 2], "ends too early"),
        (&whole[..2], "ends too early"),
        (&wrong[..], "compressed"),
        (&compressed(&compressed(b"1\n\nC 0 0 0\n"))[..], "UTF-8"),
        (&compressed(b"1\n\nC 0 0\n")[..], "a.xyz.gz:3:"),
        (&compressed(b"")[..], "number of its atoms"),
    ] {
        std::fs::write(&input, bytes).expect("a file");
        render(&input, &output)
            .assert()
            .code(2)
            .stderr(contains(says));
        assert!(!output.exists());
    }
}
