//! How the command ends early: by Ctrl-C, `kill`, a closed terminal, a limit on its time, or a
//! batch system.
//!
//! The command removes its temporary files and exits with 128 plus the signal's number. While
//! something is [`Graceful`], the first signal only sets a flag, so that the work can finish early;
//! the next signal ends the command. The first signal also ends it if an output without a reader
//! blocks. SIGQUIT removes the temporary files and makes the system end the process with a core
//! dump.

use std::process::ExitCode;
use std::sync::atomic::{AtomicI32, AtomicUsize, Ordering};
use std::time::Duration;

use crate::write::{longest_wait, remove_unfinished};

/// How long an output may be blocked before a signal ends the command.
const PATIENCE: Duration = Duration::from_secs(1);

/// The number of the first signal; 0 before it.
static REQUESTED: AtomicI32 = AtomicI32::new(0);
/// How many [`Graceful`] there are.
static GRACEFUL: AtomicUsize = AtomicUsize::new(0);

/// Work that polls [`requested`] and finishes soon after a signal.
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

/// The number of the signal that requests the command to end, such as SIGINT's 2 or SIGTERM's 15.
pub(crate) fn requested() -> Option<i32> {
    match flag().load(Ordering::SeqCst) {
        0 => None,
        signal => Some(signal),
    }
}

/// The exit code of a command that a signal ended.
pub(crate) fn exit_code() -> Option<ExitCode> {
    requested().and_then(|signal| Some(ExitCode::from(u8::try_from(128 + signal).ok()?)))
}

/// The flag behind [`requested`], for code that polls it.
pub(crate) fn flag() -> &'static AtomicI32 {
    &REQUESTED
}

/// Handles a signal.
fn on_signal(signal: i32) {
    if ends_as_it_is(signal) {
        let _none_is_made_any_more = remove_unfinished();
        end_by(signal);
    }
    let first = REQUESTED.compare_exchange(0, signal, Ordering::SeqCst, Ordering::SeqCst);
    let is_patient = match first {
        Ok(_) => true,
        // The system repeats a timer's signal; that does not mean impatience.
        Err(_) => is_timer(signal),
    };
    if is_patient && GRACEFUL.load(Ordering::SeqCst) > 0 && !waits_in_vain() {
        return;
    }
    end_with(signal);
}

fn end_with(signal: i32) -> ! {
    let _none_is_made_any_more = remove_unfinished();
    end(128 + signal);
}

/// Whether an output has been blocked for too long.
fn waits_in_vain() -> bool {
    longest_wait().is_some_and(|wait| wait >= PATIENCE)
}

/// Handles signals from now on. If that is not possible, they end the process as usual.
#[cfg(unix)]
pub(crate) fn install() {
    use signal_hook::consts::{
        SIGALRM, SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGUSR1, SIGUSR2, SIGVTALRM, SIGXCPU, SIGXFSZ,
    };
    static ONCE: std::sync::Once = std::sync::Once::new();
    let mut is_first = false;
    ONCE.call_once(|| is_first = true);
    if !is_first {
        // Two listeners would count one signal twice.
        return;
    }
    // Exceeding `ulimit -f` is an error of the writer, not the end of the process.
    // SAFETY: the action does nothing.
    let _ = unsafe { signal_hook::low_level::register(SIGXFSZ, || {}) };
    // Signals that `nohup` or a shell ignores stay ignored.
    let asked = [SIGINT, SIGTERM, SIGHUP]
        .into_iter()
        .filter(|signal| action(*signal) != Some(libc::SIG_IGN));
    // If the calling program handles one of these, that stays so.
    let others = [SIGQUIT, SIGXCPU, SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM]
        .into_iter()
        .filter(|signal| action(*signal) == Some(libc::SIG_DFL));
    let signals: Vec<i32> = asked.chain(others).collect();
    let (installed, is_installed) = std::sync::mpsc::channel();
    // Without a listening thread, signals would be lost.
    let listener = std::thread::Builder::new()
        .name("signals".into())
        .spawn(move || {
            let signals = signal_hook::iterator::Signals::new(signals);
            let _ = installed.send(());
            if let Ok(signals) = signals {
                listen(signals);
            }
        });
    if listener.is_ok() {
        let _ = is_installed.recv();
    }
}

#[cfg(unix)]
fn listen(mut signals: signal_hook::iterator::Signals) {
    const EVERY: Duration = Duration::from_millis(50);
    for signal in signals.forever() {
        on_signal(signal);
        if requested().is_some() {
            break;
        }
    }
    // Output that is blocked after the first signal must not keep the process alive.
    loop {
        signals.pending().for_each(on_signal);
        if let Some(signal) = requested().filter(|_| waits_in_vain()) {
            end_with(signal);
        }
        std::thread::sleep(EVERY);
    }
}

/// Whether the sender wants the process to end as it is, without finishing an image.
#[cfg(unix)]
fn ends_as_it_is(signal: i32) -> bool {
    signal == libc::SIGQUIT
}

#[cfg(not(unix))]
fn ends_as_it_is(_signal: i32) -> bool {
    false
}

/// Whether the system may send the signal repeatedly.
#[cfg(unix)]
fn is_timer(signal: i32) -> bool {
    matches!(signal, libc::SIGXCPU | libc::SIGALRM | libc::SIGVTALRM)
}

#[cfg(not(unix))]
fn is_timer(_signal: i32) -> bool {
    false
}

/// Ends the process by the signal's default action.
#[cfg(unix)]
fn end_by(signal: i32) -> ! {
    let _ = signal_hook::low_level::emulate_default_handler(signal);
    end(128 + signal)
}

#[cfg(not(unix))]
fn end_by(signal: i32) -> ! {
    end(128 + signal)
}

/// The current action of a signal; `None` if it is unknown.
#[cfg(unix)]
fn action(signal: i32) -> Option<libc::sighandler_t> {
    // SAFETY: a struct of numbers and pointers, for which zero is valid.
    let mut action: libc::sigaction = unsafe { std::mem::zeroed() };
    // SAFETY: only reads the signal's current action, into a struct with room for it.
    let status = unsafe { libc::sigaction(signal, std::ptr::null(), &raw mut action) };
    (status == 0).then_some(action.sa_sigaction)
}

/// Ends the process at once. A normal exit may wait for threads that have not ended.
#[cfg(unix)]
fn end(code: i32) -> ! {
    signal_hook::low_level::exit(code)
}

/// Handles Ctrl-C from now on, the only signal on this system.
#[cfg(windows)]
pub(crate) fn install() {
    const CTRL_C: i32 = 2;
    let _ = ctrlc::set_handler(|| on_signal(CTRL_C));
}

#[cfg(windows)]
fn end(code: i32) -> ! {
    std::process::exit(code)
}

/// Signals end the process as usual.
#[cfg(not(any(unix, windows)))]
pub(crate) fn install() {}

#[cfg(not(any(unix, windows)))]
fn end(code: i32) -> ! {
    std::process::exit(code)
}
