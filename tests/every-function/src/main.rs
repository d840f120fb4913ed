//! Calls every public function of spherule and of its kernel with random and extreme arguments, and
//! reports calls that panic, crash or take longer than they should: a second, unless the call is
//! for more.
//!
//!     every-function [--seed N] [--seconds N] [--calls N] [--only PART] [--skip PART]…
//!                    [--replay FUNCTION NUMBER]
//!
//! Functions share the time evenly, so fast ones are called millions of times. The program ends
//! when both the time is over and the calls are made. Each call has a number, and its arguments
//! depend only on that and on the seed: `--replay` repeats a call and prints the arguments. The
//! exit code is 1 if there is a finding.

mod calls;
mod odd;

use std::cell::Cell;
use std::collections::BTreeMap;
use std::fs::File;
use std::hint::black_box;
use std::os::unix::fs::FileExt as _;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::process::{Command, ExitCode};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use odd::Source;

/// How a public function is called.
pub struct Call {
    /// The function's path.
    name: &'static str,
    /// Whether the call needs a GPU, real or in software.
    needs_gpu: bool,
    /// The largest number of calls.
    most: u64,
    /// How many seconds one call may take.
    seconds: u64,
    /// Makes arguments and calls the function.
    call: fn(&mut Source),
}

impl Call {
    const fn new(name: &'static str, call: fn(&mut Source)) -> Self {
        Self {
            name,
            needs_gpu: false,
            most: u64::MAX,
            seconds: 1,
            call,
        }
    }

    const fn on_gpu(self) -> Self {
        Self {
            needs_gpu: true,
            ..self
        }
    }

    const fn at_most(self, most: u64, seconds: u64) -> Self {
        Self {
            most,
            seconds,
            ..self
        }
    }

    /// How many seconds the call may take beside others. All calls share one GPU, so that one that
    /// only reads from it may wait for the longest of them: a software adapter compiles the largest
    /// kernel for a minute.
    fn may_wait(&self) -> u64 {
        let of_gpu = calls::CALLS.iter().filter(|call| call.needs_gpu);
        let longest = of_gpu.map(|call| call.seconds).max().unwrap_or(0);
        self.seconds.max(if self.needs_gpu { longest } else { 0 })
    }
}

/// Consumes what a function returns.
fn seen<T>(value: T) {
    black_box(value);
}

/// How long a thread calls one function.
const BATCH: Duration = Duration::from_millis(1);
/// How many times a thread calls one function at most. After a crash, so many calls are repeated.
const LARGEST_BATCH: u64 = 500;
/// A call that takes this much longer than it may hangs; the machine may be busy.
const HANGS: Duration = Duration::from_secs(60);

struct Options {
    seed: u64,
    seconds: u64,
    calls: u64,
    only: Vec<String>,
    skip: Vec<String>,
    replay: Option<(String, u64, u64)>,
    is_child: bool,
    folder: PathBuf,
}

impl Options {
    fn read() -> Result<Self, String> {
        let mut options = Self {
            seed: 1,
            seconds: 150,
            calls: 10_000_000,
            only: Vec::new(),
            skip: Vec::new(),
            replay: None,
            is_child: false,
            folder: PathBuf::new(),
        };
        let mut words = std::env::args().skip(1);
        while let Some(word) = words.next() {
            let mut next = || words.next().ok_or(format!("{word} needs a value"));
            let number = |text: String| {
                text.parse::<u64>()
                    .map_err(|_| format!("{text} is not a number"))
            };
            match word.as_str() {
                "--seed" => options.seed = number(next()?)?,
                "--seconds" => options.seconds = number(next()?)?,
                "--calls" => options.calls = number(next()?)?,
                "--only" => options.only.push(next()?),
                "--skip" => options.skip.push(next()?),
                "--replay" => {
                    let (name, from) = (next()?, number(next()?)?);
                    options.replay = Some((name, from, from));
                }
                "--to" => {
                    let to = number(next()?)?;
                    if let Some(replay) = &mut options.replay {
                        replay.2 = to;
                    }
                }
                "--child" => {
                    options.is_child = true;
                    options.folder = next()?.into();
                }
                _ => return Err(format!("unknown option {word}")),
            }
        }
        Ok(options)
    }
}

/// The seed of a call's arguments.
fn seed_of(seed: u64, name: &str, number: u64) -> u64 {
    let hash = name.bytes().fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    let mut source = Source::new(seed ^ hash, false);
    source
        .bits()
        .wrapping_add(number.wrapping_mul(0xd134_2543_de82_ef95))
}

thread_local! {
    /// The call that this thread makes.
    static NOW: Cell<(&'static str, u64)> = const { Cell::new(("", 0)) };
}

thread_local! {
    /// The message of this thread's last panic.
    static OWN_PANIC: Cell<Option<String>> = const { Cell::new(None) };
}

/// The message of any thread's last panic: a call may panic on one of rayon's threads.
static LAST_PANIC: Mutex<String> = Mutex::new(String::new());

fn watch_panics() {
    std::panic::set_hook(Box::new(|info| {
        let message = info.to_string().replace('\n', " ");
        let (name, number) = NOW.get();
        // After these the process ends, and nothing else reports why.
        if message.contains("unsafe precondition") || message.contains("cannot unwind") {
            eprintln!(
                "{name} {number}: {message}\n{}",
                std::backtrace::Backtrace::force_capture()
            );
        }
        if let Ok(mut last) = LAST_PANIC.lock() {
            last.clone_from(&message);
        }
        OWN_PANIC.set(Some(message));
    }));
}

/// What a call that has panicked said.
fn last_panic() -> String {
    let of_any = || {
        LAST_PANIC
            .lock()
            .map(|last| last.clone())
            .unwrap_or_default()
    };
    OWN_PANIC.take().unwrap_or_else(of_any)
}

/// The call that a thread makes now, for the watcher of hangs.
#[derive(Default)]
struct Place {
    function: AtomicU64,
    number: AtomicU64,
}

/// The calls of a function so far.
#[derive(Clone, Copy, Default)]
struct Share {
    calls: u64,
    time: Duration,
    is_busy: bool,
}

#[derive(Default)]
struct Findings {
    /// For each function and message: how often it panicked, and the number of the first call.
    panics: BTreeMap<(&'static str, String), (u64, u64)>,
    /// The numbers of calls that took too long.
    slow: BTreeMap<&'static str, Vec<u64>>,
}

fn main() -> ExitCode {
    let options = match Options::read() {
        Ok(options) => options,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::from(2);
        }
    };
    let done = if options.is_child || options.replay.is_some() {
        child(&options)
    } else {
        parent(&options)
    };
    done.unwrap_or_else(|error| {
        eprintln!("{error}");
        ExitCode::from(2)
    })
}

/// Runs the calls in a child process, and finds the call after a crash.
fn parent(options: &Options) -> std::io::Result<ExitCode> {
    let folder = tempfile::tempdir()?;
    let of = |arguments: &[String]| {
        let mut command = Command::new(std::env::current_exe()?);
        command
            .args(["--seed", &options.seed.to_string()])
            .args(arguments);
        command.current_dir(folder.path()).status()
    };
    let mut arguments = vec!["--child".into(), folder.path().display().to_string()];
    for (name, values) in [("--only", &options.only), ("--skip", &options.skip)] {
        for value in values {
            arguments.extend([name.into(), value.clone()]);
        }
    }
    for (name, value) in [("--seconds", options.seconds), ("--calls", options.calls)] {
        arguments.extend([name.into(), value.to_string()]);
    }
    let status = of(&arguments)?;
    if let Some(code) = status.code() {
        return Ok(ExitCode::from(code as u8));
    }
    println!("CRASH: {status}; repeating the last calls:");
    for entry in std::fs::read_dir(folder.path())? {
        let path = entry?.path();
        if path
            .extension()
            .is_none_or(|extension| extension != "place")
        {
            continue;
        }
        let bytes = std::fs::read(&path)?;
        let word = |at: usize| {
            let word = bytes
                .get(8 * at..8 * at + 8)
                .and_then(|word| word.try_into().ok());
            u64::from_le_bytes(word.unwrap_or_default())
        };
        let Some(call) = calls::CALLS.get(word(0) as usize) else {
            continue;
        };
        let (from, to) = (word(1).to_string(), (word(1) + LARGEST_BATCH).to_string());
        let last = folder.path().join("last");
        let again = of(&[
            "--child".into(),
            folder.path().display().to_string(),
            "--replay".into(),
            call.name.into(),
            from,
            "--to".into(),
            to,
        ])?;
        if again.code().is_none() {
            println!(
                "CRASH: {}: {again}",
                std::fs::read_to_string(last).unwrap_or_default()
            );
        } else {
            println!("not in {}", call.name);
        }
    }
    Ok(ExitCode::FAILURE)
}

fn child(options: &Options) -> std::io::Result<ExitCode> {
    let own = tempfile::tempdir()?;
    std::env::set_current_dir(own.path())?;
    odd::write_files()?;
    watch_panics();
    if let Some((name, from, to)) = &options.replay {
        return Ok(replay(options, name, *from, *to));
    }
    let is_asked = |call: &Call| {
        let is_in = |parts: &[String]| parts.iter().any(|part| call.name.contains(part.as_str()));
        (options.only.is_empty() || is_in(&options.only)) && !is_in(&options.skip)
    };
    let mut asked: Vec<bool> = calls::CALLS.iter().map(is_asked).collect();
    let gpu = odd::gpu_of_all();
    let mut without = 0;
    for (call, is_asked) in calls::CALLS.iter().zip(&mut asked) {
        if call.needs_gpu && gpu.is_none() && *is_asked {
            *is_asked = false;
            without += 1;
        }
    }
    match gpu {
        Some(gpu) => println!("GPU: {}", gpu.name()),
        None => println!("SKIPPED: {without} functions that need a GPU: there is no adapter"),
    }
    println!(
        "{} calls to make, seed {}",
        asked.iter().filter(|it| **it).count(),
        options.seed
    );
    Ok(call_all(options, &asked))
}

fn call_all(options: &Options, asked: &[bool]) -> ExitCode {
    let started = Instant::now();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let shares = Mutex::new(vec![Share::default(); asked.len()]);
    let findings = Mutex::new(Findings::default());
    let places: Vec<Place> = (0..threads).map(|_| Place::default()).collect();
    let made = AtomicU64::new(0);
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let workers: Vec<_> = places
            .iter()
            .enumerate()
            .map(|(thread, place)| {
                let (shares, findings, made) = (&shares, &findings, &made);
                scope.spawn(move || {
                    work(
                        options, asked, thread, place, shares, findings, made, started,
                    );
                })
            })
            .collect();
        let (places, is_over) = (&places, &is_over);
        scope.spawn(move || watch(places, is_over));
        for worker in workers {
            let _ = worker.join();
        }
        is_over.store(true, Ordering::Relaxed);
    });
    let shares = shares.into_inner().unwrap_or_default();
    let findings = findings.into_inner().unwrap_or_default();
    report(options, asked, &shares, &findings, started.elapsed())
}

#[expect(clippy::too_many_arguments, reason = "what all threads share")]
fn work(
    options: &Options,
    asked: &[bool],
    thread: usize,
    place: &Place,
    shares: &Mutex<Vec<Share>>,
    findings: &Mutex<Findings>,
    made: &AtomicU64,
    started: Instant,
) {
    let file = File::create(options.folder.join(format!("{thread}.place"))).ok();
    loop {
        let is_late = started.elapsed().as_secs() >= options.seconds;
        let is_done = is_late && made.load(Ordering::Relaxed) >= options.calls;
        // The function that has had the least time.
        let next = {
            let mut shares = shares
                .lock()
                .expect("not poisoned: calls are made without it");
            let free = |index: &usize| {
                let share = &shares[*index];
                asked[*index] && !share.is_busy && share.calls < calls::CALLS[*index].most
            };
            let next = (0..asked.len())
                .filter(free)
                .min_by_key(|index| shares[*index].time)
                .filter(|index| !is_done || shares[*index].calls == 0);
            if let Some(next) = next {
                shares[next].is_busy = true;
            }
            next.map(|next| (next, shares[next].calls))
        };
        let Some((function, first)) = next else {
            // Other threads may still call the last functions.
            let shares = shares
                .lock()
                .expect("not poisoned: calls are made without it");
            if is_done || !shares.iter().any(|share| share.is_busy) {
                return;
            }
            drop(shares);
            std::thread::yield_now();
            continue;
        };
        let call = &calls::CALLS[function];
        place.function.store(function as u64, Ordering::Relaxed);
        if let Some(file) = &file {
            let mut bytes = (function as u64).to_le_bytes().to_vec();
            bytes.extend(first.to_le_bytes());
            let _ = file.write_all_at(&bytes, 0);
        }
        let begun = Instant::now();
        let mut number = first;
        let mut last = begun;
        while number < call.most {
            place.number.store(number, Ordering::Relaxed);
            NOW.set((call.name, number));
            let mut source = Source::new(seed_of(options.seed, call.name, number), false);
            let outcome = catch_unwind(AssertUnwindSafe(|| (call.call)(black_box(&mut source))));
            if outcome.is_err() {
                let message = last_panic();
                let mut findings = findings.lock().expect("not poisoned");
                let key = (call.name, without_numbers(&message));
                findings.panics.entry(key).or_insert((0, number)).0 += 1;
            }
            let now = Instant::now();
            if now - last > Duration::from_secs(call.seconds) {
                let mut findings = findings.lock().expect("not poisoned");
                findings.slow.entry(call.name).or_default().push(number);
            }
            last = now;
            number += 1;
            if now - begun > BATCH || number - first >= LARGEST_BATCH {
                break;
            }
        }
        place.function.store(u64::MAX, Ordering::Relaxed);
        made.fetch_add(number - first, Ordering::Relaxed);
        let mut shares = shares
            .lock()
            .expect("not poisoned: calls are made without it");
        let share = &mut shares[function];
        share.calls = number;
        share.time += begun.elapsed();
        share.is_busy = false;
    }
}

/// Ends the process if a thread hangs.
fn watch(places: &[Place], is_over: &AtomicBool) {
    let mut seen = vec![(u64::MAX, 0, Instant::now()); places.len()];
    while !is_over.load(Ordering::Relaxed) {
        std::thread::sleep(Duration::from_millis(200));
        for (place, seen) in places.iter().zip(&mut seen) {
            let function = place.function.load(Ordering::Relaxed);
            let number = place.number.load(Ordering::Relaxed);
            if (seen.0, seen.1) != (function, number) {
                *seen = (function, number, Instant::now());
            } else if let Some(call) = calls::CALLS.get(function as usize)
                && seen.2.elapsed() > HANGS + Duration::from_secs(call.may_wait())
            {
                println!("HANGS: {} {number}", call.name);
                std::process::exit(1);
            }
        }
    }
}

/// The message with its numbers replaced, so that panics at one place count as one.
fn without_numbers(message: &str) -> String {
    let mut short = String::new();
    for c in message.chars().take(400) {
        // The place comes first and keeps its numbers.
        if c.is_ascii_digit() && short.contains(": ") {
            if !short.ends_with('#') {
                short.push('#');
            }
        } else {
            short.push(c);
        }
    }
    short
}

fn replay(options: &Options, name: &str, from: u64, to: u64) -> ExitCode {
    let Some(call) = calls::CALLS.iter().find(|call| call.name == name) else {
        eprintln!("there is no function {name}");
        return ExitCode::from(2);
    };
    let mut is_good = true;
    for number in from..=to {
        NOW.set((call.name, number));
        // After a crash, this file names the call.
        let last = options.folder.join("last");
        if std::fs::write(last, format!("{name} {number}")).is_err() || from == to {
            println!("{name} {number}:");
        }
        let started = Instant::now();
        let mut source = Source::new(seed_of(options.seed, name, number), from == to);
        if catch_unwind(AssertUnwindSafe(|| (call.call)(&mut source))).is_err() {
            is_good = false;
            if from == to {
                println!("{}", last_panic());
            }
        }
        if from == to {
            println!("took {:?}", started.elapsed());
        }
    }
    if is_good {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

fn report(
    options: &Options,
    asked: &[bool],
    shares: &[Share],
    findings: &Findings,
    took: Duration,
) -> ExitCode {
    let mut is_good = true;
    for ((name, message), (count, first)) in &findings.panics {
        is_good = false;
        println!("PANIC: {name} {first} ({count} times): {message}");
    }
    for (name, numbers) in &findings.slow {
        let Some(call) = calls::CALLS.iter().find(|call| call.name == *name) else {
            continue;
        };
        // The machine may have been busy: repeat the call alone.
        for number in numbers.iter().take(3) {
            let mut source = Source::new(seed_of(options.seed, name, *number), false);
            let started = Instant::now();
            let _ = catch_unwind(AssertUnwindSafe(|| (call.call)(&mut source)));
            if started.elapsed() > Duration::from_secs(call.seconds) {
                is_good = false;
                println!("SLOW: {name} {number}: {:?}", started.elapsed());
            }
        }
    }
    let mut counts: Vec<(u64, Duration, &str)> = (calls::CALLS.iter().zip(shares).zip(asked))
        .filter(|(_, is_asked)| **is_asked)
        .map(|((call, share), _)| (share.calls, share.time, call.name))
        .collect();
    counts.sort_unstable_by_key(|(count, time, _)| time.as_nanos() / u128::from(*count).max(1));
    println!("the slowest:");
    for (count, time, name) in counts.iter().rev().take(12) {
        println!("    {count} calls in {:.1} s: {name}", time.as_secs_f64());
    }
    counts.sort_unstable();
    let all: u64 = counts.iter().map(|(count, ..)| count).sum();
    let median = counts.get(counts.len() / 2).map_or(0, |(count, ..)| *count);
    println!(
        "{all} calls of {} functions in {:.0} s; half of the functions at least {median} times",
        counts.len(),
        took.as_secs_f64()
    );
    if let Some((0, _, name)) = counts.first() {
        println!("NOT CALLED: {name}");
        is_good = false;
    }
    if is_good {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
