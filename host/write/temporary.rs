//! Temporary files, in the directory of the file that they become.
//!
//! Each is locked while its writer lives. So a file with such a name whose lock can be taken was
//! left by a run that was killed: the next run that writes to the directory removes it.

use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Seek};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::NamedTempFile;

const PREFIX: &str = ".spherule-";
const SUFFIX: &str = ".part";
const RANDOM: usize = 6;

/// The temporary files of this process. Whoever holds the lock may create, rename and remove them.
static LIVE: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn live() -> MutexGuard<'static, Vec<PathBuf>> {
    LIVE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A temporary file; it is removed when dropped.
#[derive(Debug)]
pub(super) struct Temporary {
    file: Option<NamedTempFile>,
}

impl Temporary {
    /// Creates a file in `directory`, with the permissions of any new file.
    pub(super) fn in_directory(directory: &Path) -> io::Result<Self> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(PREFIX).suffix(SUFFIX).rand_bytes(RANDOM);
        // The permissions of any new file, less the umask, instead of a temporary file's private
        // ones.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        loop {
            let mut live = live();
            let file = builder.tempfile_in(directory)?;
            match file.as_file().try_lock() {
                Ok(()) if !is_linked(file.as_file()) => {}
                // Another run checks whether the file is dead, and removes it.
                Err(TryLockError::WouldBlock) => {}
                // On a file system without locks nobody else can take it either.
                Ok(()) | Err(TryLockError::Error(_)) => {
                    live.push(file.path().into());
                    return Ok(Self { file: Some(file) });
                }
            }
        }
    }

    pub(super) fn file(&mut self) -> io::Result<&mut File> {
        match &mut self.file {
            Some(file) => Ok(file.as_file_mut()),
            None => Err(io::ErrorKind::NotFound.into()),
        }
    }

    /// Renames the file to `target`. At any time the name has either the old content or the new
    /// one, even if the machine stops. If a writable file cannot be replaced, it is overwritten
    /// instead.
    pub(super) fn rename_to(mut self, target: &Path) -> Result<(), Unnamed> {
        sync(self.file()?)?;
        let mut live = live();
        let Some(file) = self.file.take() else {
            return Err(io::Error::from(io::ErrorKind::NotFound).into());
        };
        let path = file.path().to_path_buf();
        // Under the new name nobody removes it, whatever happens to this process.
        let refused = match file.persist(target) {
            Ok(_) => None,
            Err(refused) => Some((keep(refused.file, target), refused.error)),
        };
        live.retain(|one| *one != path);
        drop(live);
        match refused {
            None => {}
            Some((Some((mut file, kept)), error)) => {
                match write_in_place(&mut file, target, &error) {
                    Some(Ok(())) => fs::remove_file(kept)?,
                    Some(Err(error)) => {
                        return Err(Unnamed {
                            error,
                            kept: Some(kept),
                            is_cut: true,
                        });
                    }
                    None => {
                        return Err(Unnamed {
                            error,
                            kept: Some(kept),
                            is_cut: false,
                        });
                    }
                }
            }
            Some((None, error)) => return Err(error.into()),
        }
        Ok(sync_directory(super::directory_of(target))?)
    }

    /// Removes the file. The error names it if it stays.
    pub(super) fn remove(mut self) -> Result<(), (io::Error, PathBuf)> {
        let Some(file) = self.file.take() else {
            return Ok(());
        };
        let mut live = live();
        let path = file.path().to_path_buf();
        let closed = file.close();
        live.retain(|one| *one != path);
        closed.map_err(|error| (error, path))
    }
}

/// Why a file was not renamed.
#[derive(Debug)]
pub(super) struct Unnamed {
    pub(super) error: io::Error,
    /// The file's name instead, if it is complete.
    pub(super) kept: Option<PathBuf>,
    /// Whether the file at the target was partly overwritten.
    pub(super) is_cut: bool,
}

impl From<io::Error> for Unnamed {
    fn from(error: io::Error) -> Self {
        Self {
            error,
            kept: None,
            is_cut: false,
        }
    }
}

/// Overwrites `target` with the content of `file`, if `target` is a file that the system does not
/// replace.
fn write_in_place(file: &mut File, target: &Path, refused: &io::Error) -> Option<io::Result<()>> {
    let is_irreplaceable = matches!(
        refused.kind(),
        io::ErrorKind::ResourceBusy
            | io::ErrorKind::PermissionDenied
            | io::ErrorKind::CrossesDevices
    );
    if !is_irreplaceable || !fs::symlink_metadata(target).is_ok_and(|about| about.is_file()) {
        return None;
    }
    let mut options = OpenOptions::new();
    options.write(true);
    // The directory's owner could meanwhile place a symlink there, to a file that only this user
    // may write.
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, libc::O_NOFOLLOW);
    let mut place = options.open(target).ok()?;
    if !place.metadata().is_ok_and(|about| about.is_file()) {
        return None;
    }
    let mut write = || {
        file.rewind()?;
        place.set_len(0)?;
        io::copy(file, &mut place)?;
        sync(&place)
    };
    Some(write())
}

/// Renames a file that could not become `target`, so that the next run does not remove it; `None`
/// if it no longer exists.
fn keep(file: NamedTempFile, target: &Path) -> Option<(File, PathBuf)> {
    let (file, path) = file.keep().ok()?;
    let name = path.file_name().and_then(OsStr::to_str).unwrap_or_default();
    let name = name.trim_start_matches('.').trim_end_matches(SUFFIX);
    let mut other = path.with_file_name(name);
    if let Some(extension) = target.extension() {
        other.set_extension(extension);
    }
    let is_free = fs::symlink_metadata(&other).is_err();
    let kept = if is_free && fs::rename(&path, &other).is_ok() {
        other
    } else {
        path
    };
    fs::symlink_metadata(&kept).ok()?;
    Some((file, kept))
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if let Some(file) = self.file.take() {
            let mut live = live();
            let path = file.path().to_path_buf();
            drop(file);
            live.retain(|one| *one != path);
        }
    }
}

/// Removes every temporary file of this process. No other is created or renamed until the guard is
/// dropped; a process that is about to end keeps it.
#[cfg(feature = "cli")]
#[must_use]
pub(crate) fn remove_all() -> impl Sized {
    let mut live = live();
    for path in live.drain(..) {
        let _ = fs::remove_file(path);
    }
    live
}

/// Removes from `directory` the temporary files of killed runs of the user that owns `own`.
pub(super) fn remove_dead(directory: &Path, own: &mut Temporary) {
    let Some(own) = own.file().ok().and_then(|file| file.metadata().ok()) else {
        return;
    };
    for entry in fs::read_dir(directory).into_iter().flatten().flatten() {
        if is_temporary(&entry.file_name()) {
            // A file that cannot be checked or removed stays; it does no harm.
            let _ = remove_if_dead(&entry.path(), &own);
        }
    }
}

fn remove_if_dead(path: &Path, own: &fs::Metadata) -> io::Result<()> {
    let about = fs::symlink_metadata(path)?;
    if !about.is_file() || !has_owner_of(&about, own) {
        return Ok(());
    }
    let file = OpenOptions::new().read(true).write(true).open(path)?;
    if file.try_lock().is_ok() {
        fs::remove_file(path)?;
    }
    Ok(())
}

/// Whether a file's name is one that [`Temporary`] gives.
fn is_temporary(name: &OsStr) -> bool {
    name.to_str()
        .and_then(|name| name.strip_prefix(PREFIX)?.strip_suffix(SUFFIX))
        .is_some_and(|random| {
            random.len() == RANDOM && random.bytes().all(|b| b.is_ascii_alphanumeric())
        })
}

#[cfg(unix)]
fn is_linked(file: &File) -> bool {
    use std::os::unix::fs::MetadataExt;
    file.metadata().is_ok_and(|about| about.nlink() > 0)
}

/// On other systems an open file cannot be removed.
#[cfg(not(unix))]
fn is_linked(_file: &File) -> bool {
    true
}

#[cfg(unix)]
fn has_owner_of(one: &fs::Metadata, other: &fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    one.uid() == other.uid()
}

/// On other systems only the owner can take the lock and remove the file.
#[cfg(not(unix))]
fn has_owner_of(_one: &fs::Metadata, _other: &fs::Metadata) -> bool {
    true
}

/// Waits until the file is on the disk, if the file system supports it.
fn sync(file: &File) -> io::Result<()> {
    match file.sync_all() {
        Err(error)
            if matches!(
                error.kind(),
                io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported
            ) =>
        {
            Ok(())
        }
        done => done,
    }
}

#[cfg(unix)]
fn sync_directory(directory: &Path) -> io::Result<()> {
    // A directory may be writable but not readable.
    File::open(directory).map_or(Ok(()), |directory| sync(&directory))
}

/// On other systems directories cannot be synchronised.
#[cfg(not(unix))]
fn sync_directory(_directory: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(directory: &Path) -> Vec<String> {
        let entries = fs::read_dir(directory).expect("a directory").flatten();
        let mut names: Vec<String> = entries
            .map(|entry| entry.file_name().to_string_lossy().into())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn only_the_dead_are_removed() {
        let directory = tempfile::tempdir().expect("a directory");
        let path = directory.path();
        let mut own = Temporary::in_directory(path).expect("a file");
        let live = Temporary::in_directory(path).expect("a file");
        let own_name = own.file.as_ref().expect("a file").path().to_path_buf();
        let live_name = live.file.as_ref().expect("a file").path().to_path_buf();
        let others = [
            ".spherule-notes.txt",
            ".spherule-abc.part",
            ".spherule-abc-de.part",
            "spherule-abcdef.part",
        ];
        for name in others.into_iter().chain([".spherule-abcdef.part"]) {
            fs::write(path.join(name), "x").expect("a file");
        }
        fs::create_dir(path.join(".spherule-folder.part")).expect("a directory");
        remove_dead(path, &mut own);
        assert!(!path.join(".spherule-abcdef.part").exists());
        assert!(own_name.exists() && live_name.exists());
        assert_eq!(names(path).len(), others.len() + 3);
    }

    #[test]
    fn a_file_is_renamed_gone_or_kept() {
        let directory = tempfile::tempdir().expect("a directory");
        drop(Temporary::in_directory(directory.path()).expect("a file"));
        let file = Temporary::in_directory(directory.path()).expect("a file");
        file.rename_to(&directory.path().join("out"))
            .expect("renamed");
        let file = Temporary::in_directory(directory.path()).expect("a file");
        fs::create_dir(directory.path().join("folder")).expect("a directory");
        let target = directory.path().join("folder");
        let unnamed = file.rename_to(&target).expect_err("a folder is there");
        let kept = unnamed.kept.expect("a file");
        assert!(!is_temporary(kept.file_name().expect("a name")));
        fs::remove_file(kept).expect("it is there");
        assert_eq!(names(directory.path()), ["folder", "out"]);
        let file = Temporary::in_directory(directory.path()).expect("a file");
        file.remove().expect("removed");
        assert_eq!(names(directory.path()), ["folder", "out"]);
    }
}
