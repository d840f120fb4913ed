//! Turns wgpu's error reports into an [`Error`].
//!
//! wgpu reports errors in four places: error scopes, the uncaptured-error handler (which panics
//! unless it is replaced), the device-lost callback, and panics of `poll` if the driver loses the
//! device while the host waits. [`Watch`] collects all four.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use crate::error::{Error, Result};

/// What the device has reported outside of any scope.
#[derive(Debug, Default)]
struct Reported {
    lost: Option<String>,
    uncaptured: Option<String>,
}

/// Collects the errors of one device.
#[derive(Clone, Debug)]
pub(super) struct Watch {
    device_name: String,
    reported: Arc<Mutex<Reported>>,
}

impl Watch {
    /// Installs the device's error handlers.
    pub(super) fn over(device: &wgpu::Device, device_name: &str) -> Self {
        let watch = Self {
            device_name: device_name.into(),
            reported: Arc::default(),
        };
        let reported = Arc::clone(&watch.reported);
        device.set_device_lost_callback(move |reason, message| {
            // Called with wgpu's locks held: it only takes a note.
            let message = match reason {
                wgpu::DeviceLostReason::Destroyed => "it was destroyed".to_owned(),
                _ if message.is_empty() => "the driver gave no reason".to_owned(),
                _ => message,
            };
            lock(&reported).lost.get_or_insert(message);
        });
        let reported = Arc::clone(&watch.reported);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            tracing::error!("GPU error outside of any scope: {error}");
            lock(&reported).uncaptured.get_or_insert(error.to_string());
        }));
        watch
    }

    /// Runs `call` in error scopes and turns what they catch into an [`Error`].
    pub(super) fn checked<T>(
        &self,
        device: &wgpu::Device,
        during: &str,
        call: impl FnOnce() -> T,
    ) -> Result<T> {
        let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
        let out_of_memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let value = call();
        let validation = pollster::block_on(validation.pop());
        let out_of_memory = pollster::block_on(out_of_memory.pop());
        let internal = pollster::block_on(internal.pop());
        // A lost device's complaint about a call, such as "invalid buffer", is not the cause.
        self.still_there(during)?;
        match out_of_memory.or(validation).or(internal) {
            Some(wgpu::Error::OutOfMemory { .. }) => Err(Error::OutOfMemory {
                device: self.device_name.clone(),
                during: during.into(),
            }),
            Some(error) => Err(Error::Validation {
                during: during.into(),
                reason: one_line(&error),
            }),
            None => Ok(value),
        }
    }

    /// Fails with [`Error::DeviceLost`] if the device is lost, and with [`Error::Validation`] if an
    /// error was reported outside of any scope.
    pub(super) fn still_there(&self, during: &str) -> Result<()> {
        let mut reported = lock(&self.reported);
        if let Some(reason) = &reported.lost {
            return Err(self.lost(during, reason.clone()));
        }
        match reported.uncaptured.take() {
            Some(reason) => Err(Error::Validation {
                during: during.into(),
                reason,
            }),
            None => Ok(()),
        }
    }

    fn lost(&self, during: &str, reason: String) -> Error {
        Error::DeviceLost {
            device: self.device_name.clone(),
            during: during.into(),
            reason,
        }
    }

    /// Waits until the device has finished `submission`, for at most `limit`.
    pub(super) fn wait(
        &self,
        device: &wgpu::Device,
        submission: wgpu::SubmissionIndex,
        limit: Duration,
        during: &str,
    ) -> Result<()> {
        self.still_there(during)?;
        // `poll` panics if the driver reports a lost device or no memory; wgpu holds none of its
        // locks at that point.
        let polled = caught(|| {
            device.poll(wgpu::PollType::Wait {
                submission_index: Some(submission),
                timeout: Some(limit),
            })
        });
        match polled {
            Ok(Ok(_)) => self.still_there(during),
            Ok(Err(wgpu::PollError::Timeout)) => Err(Error::Timeout {
                device: self.device_name.clone(),
                during: during.into(),
                limit,
            }),
            Ok(Err(error)) => {
                // The submission never reached the device, which was lost before.
                self.still_there(during)?;
                Err(self.lost(during, error.to_string()))
            }
            Err(reason) => {
                self.still_there(during)?;
                Err(self.lost(during, reason))
            }
        }
    }
}

thread_local! {
    static IS_CATCHING: Cell<bool> = const { Cell::new(false) };
}

/// Whether this thread is inside a call whose panic will be caught and reported as an [`Error`]. A
/// panic hook can then stay silent.
#[must_use]
pub fn is_catching() -> bool {
    IS_CATCHING.get()
}

/// Calls `call`, which may panic but must not hold a lock when it does. Returns its result, or the
/// message of the panic.
pub(super) fn caught<T>(call: impl FnOnce() -> T) -> Result<T, String> {
    let before = IS_CATCHING.replace(true);
    let done = catch_unwind(AssertUnwindSafe(call));
    IS_CATCHING.set(before);
    done.map_err(|panic| {
        panic
            .downcast_ref::<String>()
            .cloned()
            .or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned()))
            .unwrap_or_else(|| "no reason was given".into())
    })
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Joins wgpu's multi-line error, with its causes, into one line.
pub(super) fn one_line(error: &impl ToString) -> String {
    error
        .to_string()
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
}
