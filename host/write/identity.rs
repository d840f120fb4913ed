//! [`Identity`]: which file a path refers to.

use std::ffi::OsString;
use std::fs::{self, Metadata};
use std::path::Path;

use super::directory_of;

/// The file that a path refers to.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Identity {
    /// A file that exists.
    There(Id),
    /// A file that does not exist: its directory, and its name there.
    Missing(Id, OsString),
}

#[cfg(unix)]
type Id = (u64, u64);
#[cfg(not(unix))]
type Id = std::path::PathBuf;

impl Identity {
    /// The identity of a path; `None` for what any number of outputs and inputs may share, such as
    /// `/dev/null`, and if it cannot be determined.
    pub(super) fn of(path: &Path) -> Option<Self> {
        match fs::metadata(path) {
            Ok(about) if is_shared(&about) => None,
            Ok(about) => Some(Self::There(id(path, &about)?)),
            Err(_) => {
                let directory = directory_of(path);
                let about = fs::metadata(directory).ok()?;
                let name = path.file_name()?;
                // On systems that ignore case.
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
    /// The identity of standard output, wherever it goes.
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
