//! What waits for somebody else: for a pipe's reader, or for room in a pipe that nobody empties.
//!
//! Who wants the process to end need not wait with it.

use std::io::{self, Write};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// Since when each one waits.
static SINCE: Mutex<Vec<Instant>> = Mutex::new(Vec::new());
/// What is written at once, in bytes, so that a slow reader is told from none.
const PIECE: usize = 1 << 14;

fn since() -> MutexGuard<'static, Vec<Instant>> {
    SINCE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A call that may wait for somebody else.
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

/// Writes all of `bytes` to who may not read them.
pub(super) fn put(mut stream: impl Write, bytes: &[u8]) -> io::Result<()> {
    for piece in bytes.chunks(PIECE) {
        let _waiting = Waiting::begin();
        stream.write_all(piece)?;
        stream.flush()?;
    }
    Ok(())
}
