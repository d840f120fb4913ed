//! The command line: arguments, what is printed, and exit codes. What it does is in the library.
//!
//! Exit codes: 0 done, 1 the machine could not do it (or a check failed), 2 the input is wrong.

mod accuracy;
mod args;
mod bench;
mod check;
mod devices;
mod explain;
mod progress;
mod render;
mod report;

use std::io::Write;
use std::process::ExitCode;

use clap::Parser;
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::prelude::*;

use args::{Arguments, Command};

use crate::error::{Error, Result};

/// Runs the command line of this process.
#[must_use]
pub fn main() -> ExitCode {
    set_panic_hook();
    quiet_mesa();
    start_log();
    let done = match Arguments::parse().command {
        Command::Render(arguments) => render::run(&arguments),
        Command::Devices(arguments) => devices::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Accuracy(arguments) => accuracy::run(&arguments),
        Command::Explain(arguments) => explain::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
    };
    match done {
        Ok(code) => code,
        Err(error) => {
            let code = if error.is_input() { 2 } else { 1 };
            report::print(&error);
            ExitCode::from(code)
        }
    }
}

/// Prints to stdout; a reader that has gone away is no error, a full disk is.
fn print(text: &str) -> Result<()> {
    let mut stdout = std::io::stdout().lock();
    match stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
    {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(Error::Image {
            path: "standard output".into(),
            reason: format!("cannot be written: {error}"),
            help: "check where it is redirected to".into(),
        }),
        _ => Ok(()),
    }
}

/// Prints to stderr, if anybody listens.
fn note(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// What the library and wgpu log goes to stderr; `SPHERULE_LOG` sets how much, for example
/// `debug` or `spherule=debug,wgpu_hal=info`.
fn start_log() {
    let quiet = Targets::new()
        .with_default(LevelFilter::ERROR)
        .with_target("spherule", LevelFilter::WARN)
        // wgpu's errors reach the user as errors of the call that caused them.
        .with_target("wgpu_core", LevelFilter::OFF)
        .with_target("wgpu_hal", LevelFilter::OFF);
    let filter = std::env::var("SPHERULE_LOG")
        .ok()
        .and_then(|text| text.parse::<Targets>().ok())
        .unwrap_or(quiet);
    let stderr = tracing_subscriber::fmt::layer()
        .with_writer(std::io::stderr)
        .without_time()
        .with_target(false)
        .compact();
    tracing_subscriber::registry()
        .with(stderr.with_filter(filter))
        .init();
}

/// On a machine without a desktop session, Mesa's device-select layer complains on stderr that
/// it finds no Wayland socket. The layer only reorders adapters, which spherule does itself.
fn quiet_mesa() {
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: the process has no other thread yet.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}

/// A panic is a mistake of ours; say so. One that the library catches is reported as an error
/// instead.
fn set_panic_hook() {
    std::panic::set_hook(Box::new(|panic| {
        if !crate::device::is_waiting() && !crate::scene::environment::is_decoding() {
            let _ = writeln!(
                std::io::stderr(),
                "spherule: internal error, please report it: {panic}"
            );
        }
    }));
}
