//! Calls that may block because of another process: they wait for a pipe's reader, or for room in a
//! pipe.
//!
//! A signal that ends the process does not wait for them.

use std::io::{self, Write};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// When each current call began.
static SINCE: Mutex<Vec<Instant>> = Mutex::new(Vec::new());
/// The most bytes that are written at once, which tells a slow reader from none.
const PIECE: usize = 1 << 14;

fn since() -> MutexGuard<'static, Vec<Instant>> {
    SINCE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A call that may block because of another process.
#[derive(Debug)]
pub(crate) struct Waiting(Instant);

impl Waiting {
    #[must_use]
    pub(crate) fn begin() -> Self {
        let now = Instant::now();
        since().push(now);
        Self(now)
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        let mut since = since();
        if let Some(index) = since.iter().position(|one| *one == self.0) {
            since.swap_remove(index);
        }
    }
}

/// How long the longest of the current calls has waited; `None` if there is none.
#[cfg_attr(
    not(feature = "cli"),
    expect(dead_code, reason = "only the command uses it")
)]
pub(crate) fn longest() -> Option<Duration> {
    since().iter().map(Instant::elapsed).max()
}

/// Writes all of `bytes` to a reader that may not read them.
pub(super) fn put(mut stream: impl Write, bytes: &[u8]) -> io::Result<()> {
    for piece in bytes.chunks(PIECE) {
        let _waiting = Waiting::begin();
        stream.write_all(piece)?;
        stream.flush()?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_counts_and_what_has_ended_does_not() {
        let one = Waiting::begin();
        std::thread::sleep(Duration::from_millis(20));
        let other = Waiting::begin();
        assert!(longest() >= Some(Duration::from_millis(20)));
        drop(one);
        drop(other);
        put(io::sink(), &[0; 3 * PIECE + 1]).expect("written");
        assert!(longest() < Some(Duration::from_millis(20)));
    }
}
