//! The command line: arguments, messages and exit codes. The work is done by the library.
//!
//! Exit codes: 0 success, 1 the machine could not do it (or a check failed), 2 the input is wrong.

mod accuracy;
mod args;
mod arithmetic;
mod bench;
mod check;
mod devices;
mod explain;
mod interrupt;
mod last_resort;
mod precision;
mod progress;
mod render;
mod report;

use std::ffi::OsString;
use std::io::Write;
use std::num::NonZero;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use serde::Serialize;
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::prelude::*;

use args::{Arguments, Command};

use crate::cpu::InstructionSet;
use crate::error::{Error, Result, SceneError};
use crate::plural::count_of;
use crate::scene::Scene;
use crate::shown::{shown, shown_lines, shown_path};
use crate::threads::{self, Fewer};
use crate::write::{Output, Waiting};
pub use last_resort::{Allocator, spare_addresses};

/// Runs the command line of this process. `main` returns the exit code.
///
/// For the whole process this sets the panic hook, the handlers of signals that end it, the logger
/// if there is none, and rayon's thread pool if there is none. It changes nothing else, so other
/// threads may continue.
#[must_use]
pub fn main() -> ExitCode {
    run(std::env::args_os())
}

/// [`main`] with other arguments; the first is the program's name.
///
/// ```
/// let code = spherule::cli::run(["spherule", "devices", "--json"]);
/// assert_eq!(code, std::process::ExitCode::SUCCESS);
/// ```
#[must_use]
pub fn run(arguments: impl IntoIterator<Item = impl Into<OsString> + Clone>) -> ExitCode {
    set_panic_hook();
    interrupt::install();
    last_resort::install();
    start_log();
    let words: Vec<OsString> = arguments.into_iter().map(Into::into).collect();
    let arguments = match Arguments::try_parse_from(&words) {
        Ok(arguments) => arguments,
        Err(error) => return without_arguments(&error, &words),
    };
    let ready = InstructionSet::wanted().and_then(|_| start_threads());
    let done = ready.and_then(|()| match arguments.command {
        Command::Render(arguments) => render::run(&arguments),
        Command::Devices(arguments) => devices::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Accuracy(arguments) => accuracy::run(&arguments),
        Command::Explain(arguments) => explain::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
    });
    match done {
        Ok(code) => code,
        Err(error) => {
            let code = if error.is_input() { 2 } else { 1 };
            report::print(&error);
            ExitCode::from(code)
        }
    }
}

/// Prints clap's message: an error in the arguments, or a requested help text, which is not an
/// error and goes to stdout.
fn without_arguments(error: &clap::Error, words: &[OsString]) -> ExitCode {
    if error.use_stderr() {
        print_refusal(error, words);
    } else {
        let _waiting = Waiting::begin();
        let printed = error.print().and_then(|()| std::io::stdout().flush());
        if let Err(error) = crate::write::output::printed(printed) {
            report::print(&error);
            return ExitCode::FAILURE;
        }
    }
    u8::try_from(error.exit_code()).map_or(ExitCode::FAILURE, ExitCode::from)
}

/// Prints what is wrong with these words, escaped so that they cannot control a terminal.
fn print_refusal(error: &clap::Error, words: &[OsString]) {
    let shown: Vec<OsString> = words
        .iter()
        .map(|word| shown_path(word.as_ref()).into())
        .collect();
    let printed = if shown == words {
        error.print()
    } else {
        // Parsing the escaped words gives the same error, with safe words in it.
        match Arguments::try_parse_from(&shown) {
            Err(again) if again.kind() == error.kind() => again.print(),
            _ => {
                note(&shown_lines(&error.to_string()));
                Ok(())
            }
        }
    };
    // Nobody may be reading.
    drop(printed);
}

/// Starts as many threads as `RAYON_NUM_THREADS` says, or one for each processor.
fn start_threads() -> Result<()> {
    const NAME: &str = "RAYON_NUM_THREADS";
    let refused = |text: &str| {
        SceneError::without_place(
            "",
            format!(
                "{NAME} is `{}`, which is not a number of threads",
                shown(text)
            ),
            format!(
                "give a number from 1 to {}, or unset it for one for each processor",
                threads::most()
            ),
        )
    };
    let wanted = match std::env::var_os(NAME) {
        // Rayon, too, takes 0 for the number of processors.
        Some(text) if text != "0" && !text.is_empty() => {
            let text = text.to_string_lossy();
            Some(text.parse::<NonZero<usize>>().map_err(|_| refused(&text))?)
        }
        _ => None,
    };
    let threads = match threads::start(wanted) {
        // A program that runs several commands already has its pool.
        Err(Error::Threads { .. }) => return Ok(()),
        started => started?,
    };
    if let Some(fewer) = threads.fewer {
        note(&format!(
            "{} instead of {}: {}",
            count_of(threads.count, "thread"),
            threads.wanted,
            match fewer {
                Fewer::Capped => "more would only take memory",
                Fewer::Memory =>
                    "more would take too much of the memory that this process may use (ulimit -v, ulimit -d)",
                Fewer::System => "the system starts no more (ulimit -u, ulimit -v, ulimit -d)",
            }
        ));
    }
    Ok(())
}

/// Prints to stdout.
fn print(text: &str) -> Result<()> {
    Output::stdout()?.write(text.as_bytes())
}

/// Writes `value` as JSON.
fn write_json(output: &Output, value: &impl Serialize) -> Result<()> {
    let text = serde_json::to_string_pretty(value).map_err(|error| Error::Output {
        path: output.path().into(),
        reason: format!("cannot be written as JSON: {error}"),
        help: "this is a bug in spherule; please report it".into(),
    })?;
    output.write(format!("{text}\n").as_bytes())
}

/// Prints to stderr; errors are ignored.
fn note(text: &str) {
    let _waiting = Waiting::begin();
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// Reads a scene for a command.
fn load(path: &Path) -> Result<Scene> {
    let started = Instant::now();
    let scene = Scene::load(path)?;
    let effects: Vec<&str> = scene
        .called_effects()
        .iter()
        .map(|called| called.name)
        .collect();
    tracing::debug!(
        "read {}: {}, {}, {}, {} × {} pixels, {}, effects: [{}]: {:.1?}",
        shown_path(path),
        scene.world.contents(),
        count_of(scene.world.materials.len(), "material"),
        count_of(scene.lights.len(), "light"),
        scene.width,
        scene.height,
        count_of(scene.samples() as usize, "sample"),
        effects.join(" "),
        started.elapsed()
    );
    Ok(scene)
}

/// Sends the records of the library and of wgpu to stderr. `SPHERULE_LOG` sets how many; a value
/// that is not understood is ignored with a warning.
fn start_log() {
    let quiet = Targets::new()
        .with_default(LevelFilter::ERROR)
        .with_target("spherule", LevelFilter::WARN)
        // wgpu's errors reach the user as errors of the call that caused them.
        .with_target("wgpu_core", LevelFilter::OFF)
        .with_target("wgpu_hal", LevelFilter::OFF);
    let wish = std::env::var_os("SPHERULE_LOG").unwrap_or_default();
    let filter = log_filter(&wish.to_string_lossy(), &quiet).unwrap_or_else(|wrong| {
        note(&format!(
            "warning: SPHERULE_LOG is ignored: {wrong}. Give off, error, warn, info, debug or trace, or targets with levels \
             such as spherule=debug,wgpu_hal=info"
        ));
        quiet
    });
    let stderr = tracing_subscriber::fmt::layer()
        .with_writer(std::io::stderr)
        .without_time()
        .with_target(false)
        .compact();
    tracing_subscriber::registry()
        .with(stderr.with_filter(filter))
        // A program that calls `main` may have a logger of its own.
        .try_init()
        .ok();
}

/// Adds `wish` to `quiet`. A level alone is for spherule's own records, `target=level` for those of
/// others.
fn log_filter(wish: &str, quiet: &Targets) -> Result<Targets, String> {
    let mut filter = quiet.clone();
    for part in wish.split(',').map(str::trim).filter(|p| !p.is_empty()) {
        let (target, level) = part.split_once('=').unwrap_or(("spherule", part));
        let no_level = || format!("`{}` is not a level", shown(level.trim()));
        // The parser would take an empty level for "error".
        if level.trim().is_empty() {
            return Err(no_level());
        }
        let level: LevelFilter = level.trim().parse().map_err(|_| no_level())?;
        filter = filter.with_target(target.trim(), level);
    }
    Ok(filter)
}

/// Reports a panic as a bug, unless the library catches it and reports it as an error.
fn set_panic_hook() {
    std::panic::set_hook(Box::new(|panic| {
        if !crate::device::is_catching() && !crate::read::environment::is_decoding() {
            let _ = writeln!(
                std::io::stderr(),
                "spherule: internal error, please report it: {panic}"
            );
        }
    }));
}

#[cfg(test)]
mod tests {
    use super::*;
    use tracing::Level;

    #[test]
    fn wishes_for_the_log_are_understood_or_refused() {
        let quiet = Targets::new().with_target("spherule", LevelFilter::WARN);
        let logs = |wish: &str, target: &str, level: Level| {
            let filter = log_filter(wish, &quiet).expect(wish);
            filter.would_enable(target, &level)
        };
        assert!(logs("", "spherule::cli", Level::WARN));
        assert!(!logs("", "spherule::cli", Level::INFO));
        assert!(logs("debug", "spherule::device", Level::DEBUG));
        assert!(!logs("debug", "wgpu_core", Level::ERROR));
        assert!(logs(
            "wgpu_hal = INFO, debug",
            "wgpu_hal::vulkan",
            Level::INFO
        ));
        assert!(logs("wgpu_hal=info,debug", "spherule", Level::DEBUG));
        assert!(!logs("off", "spherule", Level::ERROR));
        for wrong in ["debgu", "spherule=loud", "a=b=c", "=", "spherule"] {
            assert!(log_filter(wrong, &quiet).is_err(), "{wrong}");
        }
    }
}
