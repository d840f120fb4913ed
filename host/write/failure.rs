//! Failures of writing an output, and how to fix them.

use std::io;
use std::path::{Path, PathBuf};

use super::temporary::Unnamed;
use crate::error::Error;

/// Why an output was not written.
pub(super) enum Failure {
    Io(io::Error),
    /// It cannot be encoded in its format.
    Encoding(String),
    /// This many bytes of memory were not available.
    Memory(u64),
    /// The temporary file for a stream cannot be written or read.
    Spool(io::Error),
    /// The output is complete, but under the name `kept`, because it could not be given its own.
    Kept {
        error: io::Error,
        kept: PathBuf,
        /// Whether the file with the output's name was partly overwritten.
        is_cut: bool,
    },
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl From<Unnamed> for Failure {
    fn from(unnamed: Unnamed) -> Self {
        match unnamed.kept {
            Some(kept) => Self::Kept {
                error: unnamed.error,
                kept,
                is_cut: unnamed.is_cut,
            },
            None => Self::Io(unnamed.error),
        }
    }
}

pub(super) fn failed(path: &Path, reason: impl Into<String>, help: &str) -> Error {
    Error::Output {
        path: path.into(),
        reason: reason.into(),
        help: help.into(),
    }
}

/// The system's message, without the name of a temporary file.
pub(super) fn said(error: &io::Error) -> String {
    let text = error.to_string();
    if error.raw_os_error().is_some() {
        return text;
    }
    // The form of `tempfile`'s messages.
    match text.split_once(" at path \"") {
        Some((said, _)) => said.into(),
        None => error.kind().to_string(),
    }
}

/// Whether the disk is full, or a quota or limit of this user or process is reached.
pub(super) fn is_full(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge
    )
}

/// How to fix a system error.
pub(super) fn help_for(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::StorageFull => {
            "make room (`df` and `df -i` show what is used up), or name a file on another disk"
        }
        io::ErrorKind::QuotaExceeded => {
            "make room (`quota` shows your limit), or name a file on another disk"
        }
        io::ErrorKind::FileTooLarge => {
            "allow larger files (`ulimit -f` shows the limit), or name a file on another disk"
        }
        io::ErrorKind::InvalidFilename => {
            "give a shorter name: most file systems take names of 255 bytes"
        }
        io::ErrorKind::ReadOnlyFilesystem => "name a file on a disk that may be written",
        io::ErrorKind::PermissionDenied => {
            "name a file that you may write, in a directory that you may write"
        }
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => {
            "create the directory, or name another"
        }
        io::ErrorKind::ConnectionRefused => "start its reader first",
        io::ErrorKind::BrokenPipe | io::ErrorKind::ConnectionReset => {
            "the reader must read to the end"
        }
        _ => "name another file, or fix the reported problem",
    }
}

pub(super) fn stdout_failed(error: &io::Error) -> Error {
    failed(
        Path::new("standard output"),
        format!("cannot be written: {}", said(error)),
        "check where it is redirected to",
    )
}
