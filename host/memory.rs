//! Whether what a measurement needs is there, asked before it begins: a system that is out of memory ends the program
//! without a word.

use crate::error::{Error, Result};

/// Refuses what needs more bytes than the system has to give. Where it does not say what it has, nothing is refused.
///
/// # Errors
///
/// [`Error::OutOfMemory`], with both numbers.
pub fn require(bytes: u64, during: &str) -> Result<()> {
    match available() {
        Some(available) if bytes > available => Err(Error::OutOfMemory {
            device: "the host".into(),
            during: format!(
                "{during}: it takes about {:.1} GiB, and there are {:.1}",
                gib(bytes),
                gib(available)
            ),
        }),
        _ => Ok(()),
    }
}

fn gib(bytes: u64) -> f64 {
    bytes as f64 / f64::from(1 << 30)
}

/// The bytes that Linux says a new program may take without swapping.
fn available() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_machine_has_is_refused_with_the_sum() {
        assert!(require(1 << 20, "making room").is_ok());
        if available().is_some() {
            let error = require(1 << 60, "making room").expect_err("an exbibyte");
            assert!(error.to_string().contains("1073741824.0 GiB"), "{error}");
        }
    }
}
