//! [`Identity`]: which file a path leads to.

use std::ffi::OsString;
use std::fs::{self, Metadata};
use std::path::Path;

use super::directory_of;

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
