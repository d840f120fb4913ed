//! The thread pool that all work on the CPU uses.
//!
//! Rayon starts its pool at the first use, and panics if the system refuses to start threads.
//! [`start`] starts the pool before that, with fewer threads if necessary.

use std::num::NonZero;
use std::sync::mpsc;

use crate::error::{Error, Result};
use crate::memory;

/// The most threads on a machine with few processors.
const MOST: usize = 64;
/// The most threads for each processor: more only take memory and time to start.
const MOST_A_PROCESSOR: usize = 4;
/// The memory that a thread takes of a process's limit: its stack, and what the system adds.
const BYTES_A_THREAD: u64 = 3 << 20;
/// Threads may take one over this of the process's memory limit.
const SHARE: u64 = 4;

/// The thread pool as it was started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Threads {
    /// The number of threads.
    pub count: usize,
    /// The wanted number: the requested one, or one for each processor.
    pub wanted: usize,
    /// Why there are fewer threads than wanted; `None` if there are not.
    pub fewer: Option<Fewer>,
}

/// Why there are fewer threads than wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fewer {
    /// More threads would only take memory.
    Capped,
    /// Their stacks would take more than a quarter of the memory that the process may use.
    Memory,
    /// The system refused to start more.
    System,
}

/// The most threads that are started: four for each processor, or 64 if that is more.
#[must_use]
pub fn most() -> usize {
    (MOST_A_PROCESSOR * processors()).max(MOST)
}

fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, NonZero::get)
}

/// Starts the pool with `wanted` threads, or with one for each processor; with fewer if there
/// cannot be as many. A pool of one may be the calling thread.
///
/// A program that does not call this gets rayon's default pool, or the pool that it started itself.
///
/// # Errors
///
/// [`Error::Threads`] if there is already a pool.
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

    // Rayon's pool cannot be started again after one of its threads failed to start. So all threads
    // are started first, and wait.
    let mut waiting = Vec::with_capacity(count);
    while waiting.len() < count {
        let (give, take) = mpsc::channel::<rayon::ThreadBuilder>();
        let thread = std::thread::Builder::new().spawn(move || {
            if let Ok(thread) = take.recv() {
                thread.run();
            }
        });
        if thread.is_err() {
            // Leaves some threads for others.
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
