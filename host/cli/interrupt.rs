//! What happens when somebody wants the command to end: Ctrl-C, `kill`, a terminal that goes away, a limit on its time, a
//! batch system.
//!
//! The command removes its temporary files and ends with 128 and the signal's number. While something is
//! [`Graceful`], the first signal only leaves a note, so that the work can end by itself; the next one ends the
//! command, and so does the first where nothing goes on because an output has no reader. SIGQUIT removes the temporary
//! files and has the system end the process, with a core.

use std::process::ExitCode;
use std::sync::atomic::{AtomicI32, AtomicUsize, Ordering};
use std::time::Duration;

use crate::write::{longest_wait, remove_unfinished};

/// How long an output may take nothing before it holds the end of the command up.
const PATIENCE: Duration = Duration::from_secs(1);

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

/// The number of the signal that asks the command to end, such as SIGINT's 2 or SIGTERM's 15.
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
    if ends_as_it_is(signal) {
        let _none_is_made_any_more = remove_unfinished();
        end_by(signal);
    }
    let first = REQUESTED.compare_exchange(0, signal, Ordering::SeqCst, Ordering::SeqCst);
    let is_patient = match first {
        Ok(_) => true,
        // A timer is nobody's impatience.
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

/// Whether an output has taken nothing for a while.
fn waits_in_vain() -> bool {
    longest_wait().is_some_and(|wait| wait >= PATIENCE)
}

/// Waits for signals from now on. Where that cannot be, they end the process as they do any other.
#[cfg(unix)]
pub(crate) fn install() {
    use signal_hook::consts::{
        SIGALRM, SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGUSR1, SIGUSR2, SIGVTALRM, SIGXCPU, SIGXFSZ,
    };
    static ONCE: std::sync::Once = std::sync::Once::new();
    let mut is_first = false;
    ONCE.call_once(|| is_first = true);
    if !is_first {
        // Two that listen would take one signal for two.
        return;
    }
    // A file beyond `ulimit -f` is an error of its writer, not the end of the process.
    // SAFETY: the action does nothing.
    let _ = unsafe { signal_hook::low_level::register(SIGXFSZ, || {}) };
    // What `nohup` or a shell has set aside stays so.
    let asked = [SIGINT, SIGTERM, SIGHUP]
        .into_iter()
        .filter(|signal| action(*signal) != Some(libc::SIG_IGN));
    // What the calling program does with one of these is its affair.
    let others = [SIGQUIT, SIGXCPU, SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM]
        .into_iter()
        .filter(|signal| action(*signal) == Some(libc::SIG_DFL));
    let signals: Vec<i32> = asked.chain(others).collect();
    let (installed, is_installed) = std::sync::mpsc::channel();
    // Without a thread that listens, signals would be lost.
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
    // What waits for a reader after the first signal is to end by it, too.
    loop {
        signals.pending().for_each(on_signal);
        if let Some(signal) = requested().filter(|_| waits_in_vain()) {
            end_with(signal);
        }
        std::thread::sleep(EVERY);
    }
}

/// Whether who sends the signal wants no picture, but the process as it is.
#[cfg(unix)]
fn ends_as_it_is(signal: i32) -> bool {
    signal == libc::SIGQUIT
}

#[cfg(not(unix))]
fn ends_as_it_is(_signal: i32) -> bool {
    false
}

/// Whether the system may send the signal again and again.
#[cfg(unix)]
fn is_timer(signal: i32) -> bool {
    matches!(signal, libc::SIGXCPU | libc::SIGALRM | libc::SIGVTALRM)
}

#[cfg(not(unix))]
fn is_timer(_signal: i32) -> bool {
    false
}

/// Ends the process as the signal does where nobody waits for it.
#[cfg(unix)]
fn end_by(signal: i32) -> ! {
    let _ = signal_hook::low_level::emulate_default_handler(signal);
    end(128 + signal)
}

#[cfg(not(unix))]
fn end_by(signal: i32) -> ! {
    end(128 + signal)
}

/// What happens at a signal now.
#[cfg(unix)]
fn action(signal: i32) -> Option<libc::sighandler_t> {
    // SAFETY: a struct of numbers and pointers, of which zero is a value.
    let mut action: libc::sigaction = unsafe { std::mem::zeroed() };
    // SAFETY: only the signal's present action is asked for, and there is room for it.
    let asked = unsafe { libc::sigaction(signal, std::ptr::null(), &raw mut action) };
    (asked == 0).then_some(action.sa_sigaction)
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
