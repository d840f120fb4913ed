//! Memory of the host that may not be available.
//!
//! Memory that grows with a scene or an image is allocated here, so that an
//! [`Error::OutOfHostMemory`] can say what it was for. What a measurement needs is compared with
//! the available memory before it begins: a system that runs out of memory kills the program
//! without a message.

use bytemuck::Zeroable;

use crate::error::{Error, Result};

/// The error of a failed allocation of `needed` bytes.
pub(crate) fn failed(needed: u64, purpose: &str) -> Error {
    Error::OutOfHostMemory {
        needed,
        available: None,
        purpose: purpose.into(),
    }
}

/// A vector of `count` zeros. The system provides the memory when it is first written, near the
/// threads that write it.
///
/// # Errors
///
/// [`Error::OutOfHostMemory`] if the host does not have that much.
pub(crate) fn zeroed<T: Zeroable>(count: u64, purpose: &str) -> Result<Vec<T>> {
    let failed = || failed(count.saturating_mul(size_of::<T>() as u64), purpose);
    let count = usize::try_from(count).map_err(|_| failed())?;
    let elements = bytemuck::allocation::try_zeroed_slice_box(count).map_err(|()| failed())?;
    Ok(elements.into_vec())
}

/// An empty vector with room for `count` elements.
///
/// # Errors
///
/// [`Error::OutOfHostMemory`] if the host does not have that much.
pub(crate) fn room<T>(count: u64, purpose: &str) -> Result<Vec<T>> {
    let failed = || failed(count.saturating_mul(size_of::<T>() as u64), purpose);
    let mut elements = Vec::new();
    let room = usize::try_from(count).map_err(|_| failed())?;
    elements.try_reserve_exact(room).map_err(|_| failed())?;
    Ok(elements)
}

/// Allocates and frees this many bytes, so that a later allocation that has no way to
/// report failure will succeed.
///
/// # Errors
///
/// [`Error::OutOfHostMemory`] if the host does not have that much.
pub(crate) fn check(bytes: u64, purpose: &str) -> Result<()> {
    room::<u8>(bytes, purpose).map(drop)
}

/// Fails if `needed` bytes are more than the system has available. If the system does not say what
/// is available, nothing fails.
///
/// # Errors
///
/// [`Error::OutOfHostMemory`], with both numbers.
pub fn require(needed: u64, purpose: &str) -> Result<()> {
    match available() {
        Some(available) if needed > available => Err(Error::OutOfHostMemory {
            needed,
            available: Some(available),
            purpose: purpose.into(),
        }),
        _ => Ok(()),
    }
}

/// The bytes that, according to Linux, a new program may use without swapping.
fn available() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

/// The bytes that this process may use, of addresses (`ulimit -v`) or of data (`ulimit -d`),
/// whichever are fewer; `None` without a limit.
pub(crate) fn limit() -> Option<u64> {
    #[cfg(unix)]
    {
        let of_addresses = soft_limit!(libc::RLIMIT_AS);
        let of_data = soft_limit!(libc::RLIMIT_DATA);
        of_addresses.into_iter().chain(of_data).min()
    }
    #[cfg(not(unix))]
    None
}

/// A soft limit of this process, by its number, whose type depends on the system; `None` if
/// unlimited.
#[cfg(unix)]
macro_rules! soft_limit {
    ($resource:expr) => {{
        let mut limit = libc::rlimit {
            rlim_cur: libc::RLIM_INFINITY,
            rlim_max: libc::RLIM_INFINITY,
        };
        // SAFETY: `getrlimit` writes only to the struct that it is given.
        let status = unsafe { libc::getrlimit($resource, &raw mut limit) };
        (status == 0 && limit.rlim_cur != libc::RLIM_INFINITY).then_some(limit.rlim_cur)
    }};
}
#[cfg(unix)]
use soft_limit;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_machine_has_is_refused_with_the_sum() {
        assert!(require(1 << 20, "making room").is_ok());
        if available().is_some() {
            let error = require(1 << 60, "making room").expect_err("an exbibyte");
            assert!(
                error
                    .to_string()
                    .contains("1.0 EiB (1152921504606846976 bytes)"),
                "{error}"
            );
        }
    }
}
