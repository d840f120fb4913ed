//! Shared by all fuzz targets: runs the committed corpus unchanged, and then mutates it until the
//! time is over.
//!
//! `SPHERULE_FUZZ_SECONDS` is the time for each target, 2 s by default. `SPHERULE_FUZZ_SEED`
//! chooses the random numbers. An input with a new kind of outcome joins the corpus for the rest of
//! the run; this stands in for coverage that a compiler measures. An input that fails a target is
//! written to a file whose name is printed: add it to the corpus together with the fix.

use std::collections::HashSet;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use spherule::random::Random;

/// An input that takes longer than this hangs. Inputs are small and take milliseconds.
const HANGS: Duration = Duration::from_secs(20);
/// The largest number of inputs in a run's corpus.
const MOST: usize = 2000;
/// The largest input that mutations make, in bytes.
const LARGEST: usize = 1 << 16;

/// The words that mutations put into inputs.
pub struct Words {
    /// The words.
    pub words: &'static [&'static [u8]],
    /// Whether inputs are text with lines and numbers.
    pub is_text: bool,
}

/// Runs a target on its corpus and on mutations of it. `target` returns the outcome of an input.
pub fn fuzz(name: &str, words: &Words, target: impl Fn(&[u8]) -> String) {
    let number = |variable, otherwise| {
        let value = std::env::var(variable).ok();
        value
            .and_then(|value| value.parse().ok())
            .unwrap_or(otherwise)
    };
    let time = Duration::from_secs(number("SPHERULE_FUZZ_SECONDS", 2));
    let mut random = Random::new(number("SPHERULE_FUZZ_SEED", 1));
    let mut corpus = committed(name);
    assert!(!corpus.is_empty(), "tests/fuzz/corpus/{name} is empty");
    let now: Mutex<Option<(Instant, Vec<u8>)>> = Mutex::new(None);
    let mut seen = HashSet::new();
    let (mut runs, mut found) = (0_u64, 0);
    std::thread::scope(|scope| {
        let (over, wait) = std::sync::mpsc::channel::<()>();
        let watched = &now;
        scope.spawn(move || {
            while wait.recv_timeout(Duration::from_millis(500))
                == Err(std::sync::mpsc::RecvTimeoutError::Timeout)
            {
                let now = watched
                    .lock()
                    .expect("not poisoned: targets run without it");
                if let Some((started, input)) = &*now
                    && Instant::elapsed(started) > HANGS
                {
                    eprintln!("{name} hangs: {}", save(name, input).display());
                    std::process::exit(1);
                }
            }
        });
        let mut run = |input: &[u8]| {
            *now.lock().expect("not poisoned: targets run without it") =
                Some((Instant::now(), input.to_vec()));
            let outcome = catch_unwind(AssertUnwindSafe(|| target(input)));
            *now.lock().expect("not poisoned: targets run without it") = None;
            runs += 1;
            match outcome {
                Ok(outcome) => seen.insert(kind(&outcome)),
                Err(panic) => {
                    eprintln!("{name} fails: {}", save(name, input).display());
                    resume_unwind(panic)
                }
            }
        };
        for input in &corpus {
            run(input);
        }
        let started = Instant::now();
        while started.elapsed() < time {
            let input = mutate(&mut random, &corpus, words);
            if run(&input) {
                found += 1;
                if corpus.len() < MOST {
                    corpus.push(input);
                }
            }
        }
        drop(over);
    });
    println!("{name}: {runs} inputs, {found} with new outcomes");
}

fn committed(name: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/fuzz/corpus")
        .join(name);
    let mut paths: Vec<PathBuf> = std::fs::read_dir(&folder)
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        .filter_map(|entry| Some(entry.ok()?.path()))
        .collect();
    // Runs must be the same on every machine.
    paths.sort();
    paths
        .iter()
        .filter_map(|path| std::fs::read(path).ok())
        .collect()
}

/// Writes an input that fails to a file; returns its path.
fn save(name: &str, input: &[u8]) -> PathBuf {
    let hash = input.iter().fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    });
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzz");
    let path = folder.join(format!("{name}-{hash:016x}"));
    let _ = std::fs::create_dir_all(folder);
    let _ = std::fs::write(&path, input);
    path
}

/// The kind of an outcome: its lower-case letters, without numbers and quotations of the input.
fn kind(outcome: &str) -> String {
    let unquoted = outcome.split(['"', '`', '\'']).step_by(2);
    let kind: String = unquoted
        .flat_map(str::chars)
        .filter(|c| c.is_ascii_lowercase())
        .collect();
    kind[..kind.len().min(30)].into()
}

fn below(random: &mut Random, end: usize) -> usize {
    random.next_u32() as usize % end.max(1)
}

/// A random part of an input.
fn part(random: &mut Random, bytes: &[u8], words: &Words) -> std::ops::Range<usize> {
    let at = below(random, bytes.len() + 1);
    if words.is_text && below(random, 4) > 0 {
        let wants_line = below(random, 3) == 0;
        let is_in = |byte: &u8| {
            if wants_line {
                *byte != b'\n'
            } else {
                byte.is_ascii_alphanumeric() || b"._-+".contains(byte)
            }
        };
        let before = bytes[..at]
            .iter()
            .rev()
            .take_while(|byte| is_in(byte))
            .count();
        let behind = bytes[at..].iter().take_while(|byte| is_in(byte)).count();
        // A line includes its end.
        let end = (at + behind + usize::from(wants_line)).min(bytes.len());
        return at - before..end;
    }
    let longest = [1, 4, 16, 200][below(random, 4)];
    at..(at + below(random, longest + 1)).min(bytes.len())
}

/// A random input of the corpus with some changes.
fn mutate(random: &mut Random, corpus: &[Vec<u8>], words: &Words) -> Vec<u8> {
    let mut bytes = corpus[below(random, corpus.len())].clone();
    let most = [1, 3, 12][below(random, 3)];
    let changes = 1 + below(random, most);
    for _ in 0..changes {
        let here = part(random, &bytes, words);
        match below(random, 9) {
            0 if !bytes.is_empty() => {
                let at = below(random, bytes.len());
                bytes[at] ^= 1 << below(random, 8);
            }
            1 if !bytes.is_empty() => {
                let at = below(random, bytes.len());
                bytes[at] = random.next_u32() as u8;
            }
            // The first bytes matter most.
            2 if !bytes.is_empty() => {
                let at = below(random, bytes.len().min(64));
                bytes[at] = random.next_u32() as u8;
            }
            3 => drop(bytes.drain(here)),
            4 => {
                let copy = bytes[here.clone()].to_vec();
                let at = below(random, bytes.len() + 1);
                bytes.splice(at..at, copy);
            }
            5 => {
                let other = &corpus[below(random, corpus.len())];
                let there = part(random, other, words);
                bytes.splice(here, other[there].to_vec());
            }
            6 if below(random, 8) == 0 => bytes.truncate(here.start),
            _ => {
                let word = words.words[below(random, words.words.len())];
                // In binary files, what follows keeps its offset.
                let end = if words.is_text {
                    here.end
                } else {
                    (here.start + word.len()).min(bytes.len())
                };
                bytes.splice(here.start..end, word.to_vec());
            }
        }
    }
    bytes.truncate(LARGEST);
    bytes
}
