//! Ends the command with a message if memory runs out and nothing can be done about it.
//!
//! Memory that grows with a scene or an image is allocated in ways that can fail
//! (`host/memory.rs`). All other allocations are small. If one of them fails, Rust ends the process
//! by SIGABRT, and so do graphics drivers, unless they use the null pointer that they got and end
//! it by SIGSEGV. [`Allocator`] notes the size of a failed allocation; the handlers of these
//! signals print a message and end the command with 1.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The system's allocator, which also notes the size of the last allocation that failed.
pub struct Allocator;

/// The size in bytes; 0 if none failed.
static REFUSED: AtomicUsize = AtomicUsize::new(0);

fn noted(memory: *mut u8, bytes: usize) -> *mut u8 {
    if memory.is_null() {
        REFUSED.store(bytes, Ordering::Relaxed);
    }
    memory
}

// SAFETY: every call is passed to the system's allocator.
unsafe impl GlobalAlloc for Allocator {
    #[inline]
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller meets the requirements of `System`.
        noted(unsafe { System.alloc(layout) }, layout.size())
    }

    #[inline]
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        noted(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    #[inline]
    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above.
        noted(unsafe { System.realloc(memory, layout, size) }, size)
    }

    #[inline]
    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(memory, layout) }
    }
}

/// Makes the system's allocator use fewer addresses if they are limited (`ulimit -v`, `ulimit -d`):
/// glibc reserves 64 MiB of them for each thread.
///
/// # Safety
///
/// The process must have no other thread yet.
pub unsafe fn spare_addresses() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    if crate::memory::limit().is_some() {
        // SAFETY: the caller says that there is no other thread.
        unsafe { libc::mallopt(libc::M_ARENA_MAX, 1) };
    }
}

/// Handles SIGABRT from now on, and SIGSEGV if memory is limited.
#[cfg(unix)]
pub(super) fn install() {
    // Whether there is a limit does not change, and a signal handler must not look it up.
    let is_limited = crate::memory::limit().is_some();
    if is_limited {
        let handler: extern "C" fn(libc::c_int) = on_invalid_access;
        // SAFETY: `sigaction` reads a struct that is valid when zeroed. The handler writes to a
        // file descriptor and ends the process; neither allocates or locks. On the stack for
        // signals, if the thread has one, and once: what crashes in the handler ends the process.
        unsafe {
            let mut action: libc::sigaction = std::mem::zeroed();
            action.sa_sigaction = handler as libc::sighandler_t;
            action.sa_flags = libc::SA_ONSTACK | libc::SA_RESETHAND;
            libc::sigaction(libc::SIGSEGV, &raw const action, std::ptr::null_mut());
        }
    }
    // SAFETY: the handler reads an atomic, writes to a file descriptor and ends the process; none
    // of these allocates or locks.
    let _ = unsafe {
        signal_hook::low_level::register(signal_hook::consts::SIGABRT, move || {
            on_abort(is_limited);
        })
    };
}

#[cfg(not(unix))]
pub(super) fn install() {}

/// Memory is limited, and something used a pointer that is none: most likely to memory that it did
/// not get.
#[cfg(unix)]
extern "C" fn on_invalid_access(_: libc::c_int) {
    write(
        b"  \xc3\x97 probably out of memory: a part of the program crashed, and its memory is limited\n",
    );
    write(HELP);
    signal_hook::low_level::exit(1);
}

#[cfg(unix)]
const HELP: &[u8] =
    b"  help: render a smaller image or fewer spheres, or give the process more memory \
    (`ulimit -v` and `ulimit -d` show its limits)\n";

#[cfg(unix)]
fn write(text: &[u8]) {
    // SAFETY: the pointer and the length are those of a slice.
    let _ = unsafe { libc::write(libc::STDERR_FILENO, text.as_ptr().cast(), text.len()) };
}

#[cfg(unix)]
fn on_abort(is_limited: bool) {
    let refused = REFUSED.load(Ordering::Relaxed);
    if refused > 0 {
        write(b"  \xc3\x97 out of memory: could not allocate ");
        let mut digits = [0; 20];
        write(decimal(refused, &mut digits));
        write(b"  bytes\n");
    } else if is_limited {
        write(b"  \xc3\x97 probably out of memory: a part of the program aborted, and its memory is limited\n");
    } else {
        // A bug rather than a lack of memory: the process aborts as usual.
        return;
    }
    write(HELP);
    signal_hook::low_level::exit(1);
}

/// The decimal digits of a number.
#[cfg(unix)]
fn decimal(mut number: usize, digits: &mut [u8; 20]) -> &[u8] {
    let mut first = digits.len();
    loop {
        first -= 1;
        digits[first] = b'0' + (number % 10) as u8;
        number /= 10;
        if number == 0 {
            return &digits[first..];
        }
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::decimal;

    #[test]
    fn numbers_are_written_without_allocating() {
        for number in [0, 7, 10, 1_234_567, usize::MAX] {
            assert_eq!(decimal(number, &mut [0; 20]), number.to_string().as_bytes());
        }
    }
}
