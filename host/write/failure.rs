//! What can go wrong while an output is written, and how to mend it.

use std::io;
use std::path::{Path, PathBuf};

use super::temporary::Unnamed;
use crate::error::Error;

/// Why something was not written.
pub(super) enum Failure {
    Io(io::Error),
    /// It cannot be put into a file of its kind.
    Encoding(String),
    /// So many bytes of memory were needed.
    Memory(u64),
    /// The temporary file that it was to go through cannot be written or read.
    Spool(io::Error),
    /// It is whole, and where it is, because it did not get its name.
    Kept {
        error: io::Error,
        kept: PathBuf,
        /// Whether what has the name was overwritten in part.
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

/// What the system said, without the name of a temporary file.
pub(super) fn said(error: &io::Error) -> String {
    let text = error.to_string();
    if error.raw_os_error().is_some() {
        return text;
    }
    // So `tempfile` puts it.
    match text.split_once(" at path \"") {
        Some((said, _)) => said.into(),
        None => error.kind().to_string(),
    }
}

/// Whether there is no room on the disk, or none for this user or this process.
pub(super) fn is_full(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge
    )
}

/// How to mend what the system said.
pub(super) fn help_for(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::StorageFull => {
            "make room (`df` and `df -i` show what is used up), or name a file on another disk"
        }
        io::ErrorKind::QuotaExceeded => {
            "make room (`quota` shows how much you may use), or name a file on another disk"
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
            "make the directory, or name another"
        }
        io::ErrorKind::ConnectionRefused => "start what is to read it before",
        io::ErrorKind::BrokenPipe | io::ErrorKind::ConnectionReset => {
            "let what reads it read to the end"
        }
        _ => "name another file, or mend what the system says of this one",
    }
}

pub(super) fn stdout_failed(error: &io::Error) -> Error {
    failed(
        Path::new("standard output"),
        format!("cannot be written: {}", said(error)),
        "check where it is redirected to",
    )
}
