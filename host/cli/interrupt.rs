//! What happens when somebody wants the command to end: Ctrl-C, `kill`, a terminal that goes away.
//!
//! The command removes its temporary files and ends with 128 and the signal's number. While something is
//! [`Graceful`], the first signal only leaves a note, so that the work can end by itself; the next one ends the
//! command.

use std::process::ExitCode;
use std::sync::atomic::{AtomicI32, AtomicUsize, Ordering};

use crate::write::remove_unfinished;

/// The first signal's number; 0 before it.
static REQUESTED: AtomicI32 = AtomicI32::new(0);
/// How much there is that ends by itself.
static GRACEFUL: AtomicUsize = AtomicUsize::new(0);

/// Work that looks at [`requested`] and ends soon when there is a signal.
#[derive(Debug)]
pub(crate) struct Graceful(());

impl Graceful {
    #[must_use]
    pub(crate) fn new() -> Self {
        GRACEFUL.fetch_add(1, Ordering::SeqCst);
        Self(())
    }
}

impl Drop for Graceful {
    fn drop(&mut self) {
        GRACEFUL.fetch_sub(1, Ordering::SeqCst);
    }
}

/// The number of the signal that asks the command to end: SIGHUP's 1, SIGINT's 2 or SIGTERM's 15.
pub(crate) fn requested() -> Option<i32> {
    match flag().load(Ordering::SeqCst) {
        0 => None,
        signal => Some(signal),
    }
}

/// The exit code of a command that a signal has ended.
pub(crate) fn exit_code() -> Option<ExitCode> {
    requested().and_then(|signal| Some(ExitCode::from(u8::try_from(128 + signal).ok()?)))
}

/// Where [`requested`] looks, for what polls it.
pub(crate) fn flag() -> &'static AtomicI32 {
    &REQUESTED
}

/// What each signal does.
fn on_signal(signal: i32) {
    let is_first = REQUESTED
        .compare_exchange(0, signal, Ordering::SeqCst, Ordering::SeqCst)
        .is_ok();
    if is_first && GRACEFUL.load(Ordering::SeqCst) > 0 {
        return;
    }
    let _none_is_made_any_more = remove_unfinished();
    end(128 + signal);
}

/// Waits for signals from now on. Where that cannot be, they end the process as they do any other.
#[cfg(unix)]
pub(crate) fn install() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    // A file beyond `ulimit -f` is an error of its writer, not the end of the process.
    // SAFETY: the action does nothing.
    let _ = unsafe { signal_hook::low_level::register(SIGXFSZ, || {}) };
    // What `nohup` or a shell has set aside stays so.
    let signals: Vec<i32> = [SIGINT, SIGTERM, SIGHUP]
        .into_iter()
        .filter(|signal| !is_ignored(*signal))
        .collect();
    let (installed, is_installed) = std::sync::mpsc::channel();
    // Without a thread that listens, signals would be lost.
    let listener = std::thread::Builder::new()
        .name("signals".into())
        .spawn(move || {
            let signals = signal_hook::iterator::Signals::new(signals);
            let _ = installed.send(());
            if let Ok(mut signals) = signals {
                signals.forever().for_each(on_signal);
            }
        });
    if listener.is_ok() {
        let _ = is_installed.recv();
    }
}

#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    // SAFETY: a struct of numbers and pointers, of which zero is a value.
    let mut action: libc::sigaction = unsafe { std::mem::zeroed() };
    // SAFETY: only the signal's present action is asked for, and there is room for it.
    let asked = unsafe { libc::sigaction(signal, std::ptr::null(), &raw mut action) };
    asked == 0 && action.sa_sigaction == libc::SIG_IGN
}

/// Ends the process at once: what it would do at its end may wait for threads that have not ended.
#[cfg(unix)]
fn end(code: i32) -> ! {
    signal_hook::low_level::exit(code)
}

/// Waits for signals from now on. There, all of them are Ctrl-C's.
#[cfg(windows)]
pub(crate) fn install() {
    const CTRL_C: i32 = 2;
    let _ = ctrlc::set_handler(|| on_signal(CTRL_C));
}

#[cfg(windows)]
fn end(code: i32) -> ! {
    std::process::exit(code)
}

/// Signals end the process as they do any other.
#[cfg(not(any(unix, windows)))]
pub(crate) fn install() {}

#[cfg(not(any(unix, windows)))]
fn end(code: i32) -> ! {
    std::process::exit(code)
}
