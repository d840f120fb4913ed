//! The pool of threads that work on the CPU is done by.
//!
//! Rayon starts its pool when it is first used, and panics where the system gives it no threads. [`start`] does so before that, and
//! takes fewer threads where there are fewer.

use std::num::NonZero;
use std::sync::mpsc;

use crate::error::{Error, Result};
use crate::memory;

/// The most threads, however many processors there are fewer.
const MOST: usize = 64;
/// The most threads for each processor: beyond that each only takes memory, and time to start.
const MOST_A_PROCESSOR: usize = 4;
/// What a thread takes of the memory that a process may use: its stack, and what the system puts beside it.
const BYTES_A_THREAD: u64 = 3 << 20;
/// The part of that memory which threads may take.
const SHARE: u64 = 4;

/// The pool, as it was started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Threads {
    /// How many threads there are.
    pub count: usize,
    /// How many were wanted: those that were asked for, or else one for each processor.
    pub wanted: usize,
    /// Why there are fewer; `None` if there are not.
    pub fewer: Option<Fewer>,
}

/// Why there are fewer threads than were wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fewer {
    /// More would only take memory.
    Capped,
    /// Their stacks would take more than a quarter of the memory that the process may use.
    Memory,
    /// The system starts no more of them.
    System,
}

/// How many threads are started at most: four for each processor, or 64.
#[must_use]
pub fn most() -> usize {
    (MOST_A_PROCESSOR * processors()).max(MOST)
}

fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, NonZero::get)
}

/// Starts the pool of `wanted` threads, or of one for each processor; of fewer where there are to be no more, down to one, which
/// then is the calling thread.
///
/// A program that does not call this gets rayon's own pool, or that which it has made itself.
///
/// # Errors
///
/// [`Error::Threads`] if there is a pool already.
pub fn start(wanted: Option<NonZero<usize>>) -> Result<Threads> {
    let wanted = wanted.map_or_else(processors, NonZero::get);
    let mut fewer = None;
    let mut count = wanted;
    let mut at_most = |most: usize, why: Fewer| {
        if count > most {
            (count, fewer) = (most.max(1), Some(why));
        }
    };
    at_most(most(), Fewer::Capped);
    if let Some(limit) = memory::limit() {
        let most = usize::try_from(limit / SHARE / BYTES_A_THREAD).unwrap_or(usize::MAX);
        at_most(most, Fewer::Memory);
    }

    // Rayon's pool cannot be started again where one of its threads cannot. These wait until all of them are there.
    let mut waiting = Vec::with_capacity(count);
    while waiting.len() < count {
        let (give, take) = mpsc::channel::<rayon::ThreadBuilder>();
        let thread = std::thread::Builder::new().spawn(move || {
            if let Ok(thread) = take.recv() {
                thread.run();
            }
        });
        if thread.is_err() {
            // Others want some of what is left.
            waiting.truncate(waiting.len() / 2);
            (count, fewer) = (waiting.len().max(1), Some(Fewer::System));
            break;
        }
        waiting.push(give);
    }
    let mut pool = rayon::ThreadPoolBuilder::new().num_threads(count);
    if waiting.is_empty() {
        pool = pool.use_current_thread();
    }
    pool.spawn_handler(|thread| match waiting.pop() {
        Some(give) => give
            .send(thread)
            .map_err(|_| std::io::Error::other("a thread has ended")),
        None => Err(std::io::Error::other("there are no more threads")),
    })
    .build_global()
    .map_err(|error| Error::Threads {
        reason: error.to_string(),
    })?;
    Ok(Threads {
        count,
        wanted,
        fewer,
    })
}
