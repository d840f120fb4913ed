//! `spherule check --export`, and the two programs that score answers: docs/hard-rays.md.

use std::path::{Path, PathBuf};
use std::process::Command;

/// What a program prints; it must succeed.
fn printed(command: &mut Command) -> String {
    let output = command.output().expect("the program starts");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {said}");
    String::from_utf8(output.stdout).expect("text")
}

/// The numbers of a sum's line: rays, false hits, missed hits, nearest floats, hits, worst ulp.
fn sums(table: &str, of: &str) -> Vec<u64> {
    let mut lines = table.lines().rev();
    let numbers = lines.find_map(|line| line.strip_prefix(of)).expect(table);
    let numbers = numbers.split_whitespace().map(str::parse);
    numbers.collect::<Result<_, _>>().expect("numbers")
}

/// The folder of the scorers.
fn sources() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/hard-rays")
}

/// The scorer in C, compiled into a folder.
fn scorer_in(folder: &Path) -> PathBuf {
    let scorer = folder.join("score");
    printed(
        Command::new("cc")
            .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-o"])
            .arg(&scorer)
            .arg(sources().join("score.c")),
    );
    scorer
}

/// Exports so many rays of each family into a folder.
fn export(rays: u64, folder: &Path) {
    let spherule = assert_cmd::cargo::cargo_bin("spherule");
    printed(
        Command::new(spherule)
            .args(["check", "--device", "cpu", "--rays", &rays.to_string()])
            .arg("--export")
            .arg(folder),
    );
}

/// The table of some answers, which both scorers print alike.
fn scored(scorer: &Path, folder: &Path, answers: &str) -> String {
    let of = |name: &str| folder.join(name);
    let table = printed(Command::new(scorer).args([of("hard-rays.txt"), of(answers)]));
    if Command::new("python3").arg("--version").output().is_ok() {
        let mut other = Command::new("python3");
        other.arg(sources().join("score.py"));
        let other = printed(other.args([of("hard-rays.json"), of(answers)]));
        assert_eq!(table, other, "{answers}");
    }
    table
}

#[test]
fn the_scorers_agree_on_every_rung() {
    const RAYS: u64 = 300;
    let folder = tempfile::tempdir().expect("a folder");
    export(RAYS, folder.path());
    let scorer = scorer_in(folder.path());
    for (rung, is_right) in [("textbook", false), ("robust", false), ("certified", true)] {
        let table = scored(&scorer, folder.path(), &format!("answers-{rung}.txt"));
        let [rays, false_hits, missed, nearest, hits, worst] = sums(&table, "all")[..] else {
            panic!("{table}");
        };
        assert_eq!(sums(&table, "families")[0], 6 * RAYS, "{table}");
        assert!(rays > 6 * RAYS && hits > rays / 4 && hits < rays, "{table}");
        let is_perfect = (false_hits, missed, nearest, worst) == (0, 0, hits, 0);
        assert_eq!(is_perfect, is_right, "{rung}:\n{table}");
    }
}

/// Rays that were not asked do not count, and a hit without its t has no nearest float.
#[test]
fn a_program_may_answer_less() {
    let folder = tempfile::tempdir().expect("a folder");
    let of = |name: &str| folder.path().join(name);
    export(20, folder.path());
    let scorer = scorer_in(folder.path());
    let right = std::fs::read_to_string(of("answers-certified.txt")).expect("the file");
    let score = |answers: &[&str]| {
        std::fs::write(of("mine.txt"), answers.join("\n")).expect("a file");
        sums(&scored(&scorer, folder.path(), "mine.txt"), "all")
    };
    let full: Vec<&str> = right.lines().collect();
    let [rays, .., hits, _] = score(&full)[..] else {
        panic!("no sums");
    };
    let without_t: Vec<&str> = full
        .iter()
        .map(|answer| if *answer == "miss" { "miss" } else { "hit" })
        .collect();
    assert_eq!(score(&without_t), [rays, 0, 0, 0, hits, 0]);
    let mut fewer = full.clone();
    for answer in fewer.iter_mut().filter(|answer| **answer == "miss") {
        *answer = "-";
    }
    assert_eq!(score(&fewer), [hits, 0, 0, hits, hits, 0]);
}

/// Brackets are as narrow as 64-bit floats are, and round to the nearest 32-bit float.
#[test]
fn brackets_hold_the_nearest_floats() {
    let folder = tempfile::tempdir().expect("a folder");
    let spherule = assert_cmd::cargo::cargo_bin("spherule");
    printed(
        Command::new(spherule)
            .args(["check", "--device", "cpu", "--rays", "20", "--export"])
            .arg(folder.path()),
    );
    let text = std::fs::read_to_string(folder.path().join("hard-rays.json")).expect("the file");
    let suite: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let mut hits = 0;
    for set in suite["sets"].as_array().expect("sets") {
        for ray in set["rays"].as_array().expect("rays") {
            if ray["answer"] != "hit" {
                continue;
            }
            let number = |value: &serde_json::Value| parsed(value.as_str().expect("a float"));
            let [low, high] = [0, 1].map(|index| number(&ray["bracket"][index]));
            let t = number(&ray["t"]);
            assert!(low == high || high == low.next_up(), "{ray}");
            // Both ends round to it, unless one is half-way between two.
            assert!(
                [low, high].iter().any(|end| f64::from(*end as f32) == t),
                "{ray}"
            );
            hits += 1;
        }
    }
    assert!(hits > 100);
}

/// A number in the hexadecimal form of C99.
fn parsed(text: &str) -> f64 {
    let (sign, text) = match text.strip_prefix('-') {
        Some(text) => (-1.0, text),
        None => (1.0, text),
    };
    let (digits, exponent) = text.trim_start_matches("0x").split_once('p').expect("a p");
    let digits: String = digits.split('.').collect();
    let integer = u64::from_str_radix(&digits, 16).expect("digits") as f64;
    let exponent: i32 = exponent.parse().expect("an exponent");
    sign * integer * 2.0_f64.powi(exponent - 4 * (digits.len() as i32 - 1))
}
