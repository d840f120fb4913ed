//! Which names are one file, whatever they are called: by another spelling, a symlink or a hard link.

use std::ffi::OsString;
use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};

use super::directory_of;
use super::output::Output;
use crate::error::{Error, Result};
use crate::shown::shown_path;

/// What a name stands for.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Identity {
    /// Something that exists.
    There(Id),
    /// A file that does not: its directory, and its name there.
    Missing(Id, OsString),
}

#[cfg(unix)]
type Id = (u64, u64);
#[cfg(not(unix))]
type Id = PathBuf;

impl Identity {
    /// `None` for what any number of outputs and inputs may share, as `/dev/null`, and where nothing can be told.
    pub(super) fn of(path: &Path) -> Option<Self> {
        match fs::metadata(path) {
            Ok(about) if is_shared(&about) => None,
            Ok(about) => Some(Self::There(id(path, &about)?)),
            Err(_) => {
                let directory = directory_of(path);
                let about = fs::metadata(directory).ok()?;
                let name = path.file_name()?;
                // Where case makes no other file.
                let name = if cfg!(any(windows, target_vendor = "apple")) {
                    name.to_string_lossy().to_lowercase().into()
                } else {
                    name.to_owned()
                };
                Some(Self::Missing(id(directory, &about)?, name))
            }
        }
    }
}

impl Identity {
    /// That of standard output, wherever it leads.
    #[cfg(unix)]
    pub(super) fn of_stdout() -> Option<Self> {
        use std::os::unix::fs::MetadataExt;
        let about = super::stream::stdout().ok()?.metadata().ok()?;
        (!is_shared(&about)).then(|| Self::There((about.dev(), about.ino())))
    }

    #[cfg(not(unix))]
    pub(super) fn of_stdout() -> Option<Self> {
        None
    }
}

#[cfg(unix)]
fn is_shared(about: &Metadata) -> bool {
    std::os::unix::fs::FileTypeExt::is_char_device(&about.file_type())
}

#[cfg(not(unix))]
fn is_shared(_about: &Metadata) -> bool {
    false
}

#[cfg(unix)]
fn id(_path: &Path, about: &Metadata) -> Option<Id> {
    use std::os::unix::fs::MetadataExt;
    Some((about.dev(), about.ino()))
}

#[cfg(not(unix))]
fn id(path: &Path, _about: &Metadata) -> Option<Id> {
    fs::canonicalize(path).ok()
}

/// Refuses outputs of which two are the same file, or both standard output.
///
/// # Errors
///
/// [`Error::OutputRefused`] names both.
pub fn refuse_clashes(outputs: &[&Output]) -> Result<()> {
    for (index, one) in outputs.iter().enumerate() {
        for other in &outputs[..index] {
            if one.is_stdout() && other.is_stdout() {
                return Err(refused(
                    one,
                    "two outputs cannot both go to standard output".into(),
                    "give one of them a file",
                ));
            }
            let identity = one.identity();
            if identity.is_some() && identity == other.identity() {
                return Err(refused(
                    one,
                    format!("is the same file as the output {}", name(other)),
                    "give each output a file of its own",
                ));
            }
        }
    }
    Ok(())
}

/// Refuses outputs that would replace what was read, or add to it.
///
/// # Errors
///
/// [`Error::OutputRefused`] names both.
pub fn refuse_inputs(outputs: &[&Output], inputs: &[PathBuf]) -> Result<()> {
    for output in outputs {
        let identity = output.identity();
        for input in inputs {
            if identity.is_some() && identity == Identity::of(input) {
                return Err(refused(
                    output,
                    format!("is the same file as the input {}", shown_path(input)),
                    "give the output a file of its own",
                ));
            }
        }
    }
    Ok(())
}

/// What a person calls an output.
fn name(output: &Output) -> String {
    if output.path() == Path::new("-") {
        "on standard output".into()
    } else {
        shown_path(output.path())
    }
}

fn refused(output: &Output, reason: String, help: &str) -> Error {
    let path = if output.path() == Path::new("-") {
        "standard output".into()
    } else {
        output.path().into()
    };
    Error::OutputRefused {
        path,
        reason,
        help: help.into(),
    }
}
