//! [`Output`]: the destination of an output, the checks in advance, and the writing.

use std::cell::OnceCell;
use std::fs::{self, File, Metadata, OpenOptions};
#[cfg(feature = "lab")]
use std::io::Write;
use std::io::{self, Read, Seek};
use std::path::{Path, PathBuf};

use super::directory_of;
use super::failure::{Failure, failed, help_for, is_full, said, stdout_failed};
use super::format::{Format, PURPOSE};
#[cfg(feature = "lab")]
use super::identity::Identity;
use super::sink::{Sink, Trouble};
use super::stream::{Stream, of_this_process};
use super::temporary::{Temporary, remove_dead};
#[cfg(feature = "lab")]
use super::waiting;
use crate::error::{Error, Result, bytes};
use crate::memory;
use crate::shown::shown_path;

/// The destination of an output. Making one checks everything that can be checked before the work.
///
/// | what exists at the path | what happens |
/// | --- | --- |
/// | nothing, or a file | The file appears whole or not at all: it is written to a temporary file in the same directory, which is renamed when it is on the disk. |
/// | a file | The new file gets its permissions, and its owner and group if this process may set them. Other hard links keep the old content. |
/// | a file that may not be written | It is an error, though a rename could replace it: somebody protected the file. |
/// | a file that cannot be replaced | It is overwritten in place, once the output is complete. Such a file is a mount point (`mount --bind`, a container's volume), or belongs to another user in a sticky directory. |
/// | a symlink | It stays; the file that it points to is created or replaced. |
/// | a pipe, a device, a socket | It is opened before the work, and written to once the output is complete. A pipe without a reader is opened when the output is written. |
/// | `-` | Standard output; not for images. |
///
/// If the output is complete but cannot be given its name, it is kept in the same directory, and
/// the error names the file.
#[derive(Debug)]
pub struct Output {
    /// The path as the user gave it.
    path: PathBuf,
    place: Place,
    /// A temporary file for an image whose destination is a stream, which can only be written from
    /// start to end.
    spool: Option<File>,
}

#[derive(Debug)]
enum Place {
    Stdout,
    /// Something that is written to and never replaced.
    Stream(Stream),
    /// A file with this path, which is not a symlink.
    File(PathBuf),
}

/// Creates a folder for outputs, and those above it, unless they exist.
///
/// # Errors
///
/// [`Error::Output`] if it cannot be created.
#[cfg(feature = "lab")]
pub fn create_folder(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|error| Error::Output {
        path: folder.into(),
        reason: format!("cannot be created: {error}"),
        help: "name a folder in a directory that may be written".into(),
    })
}

impl Output {
    /// An output of text or numbers; `-` is standard output.
    ///
    /// # Errors
    ///
    /// [`Error::Output`] if the path is a directory or a file that may not be written, if no file
    /// can be created in its directory, or if it is something else that cannot be opened.
    pub fn new(path: &Path) -> Result<Self> {
        if path == Path::new("-") {
            return Self::stdout();
        }
        let output = Self {
            path: path.into(),
            place: place_of(path)?,
            spool: None,
        };
        if let Place::File(target) = &output.place {
            output.check(target)?;
        }
        Ok(output)
    }

    /// Standard output.
    ///
    /// # Errors
    ///
    /// [`Error::Output`] if it cannot be written to.
    pub fn stdout() -> Result<Self> {
        #[cfg(unix)]
        super::stream::stdout().map_err(|error| stdout_failed(&error))?;
        Ok(Self {
            path: "-".into(),
            place: Place::Stdout,
            spool: None,
        })
    }

    /// An output for an image.
    ///
    /// # Errors
    ///
    /// As [`Output::new`], and [`Error::OutputRefused`] if the extension is not that of an image
    /// format.
    pub fn image(path: &Path) -> Result<Self> {
        Format::of(path)?;
        let mut output = Self::new(path)?;
        if let Place::Stream(_) = output.place {
            let spool = tempfile::tempfile();
            output.spool = Some(spool.map_err(|error| output.spool_failed(&error, None))?);
        }
        Ok(output)
    }

    /// The path as the user gave it.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether this is standard output, as `-` or under another name.
    #[cfg(feature = "lab")]
    #[must_use]
    pub fn is_stdout(&self) -> bool {
        match &self.place {
            Place::Stdout => true,
            Place::Stream(stream) => stream.is_stdout(),
            Place::File(_) => false,
        }
    }

    #[cfg(feature = "lab")]
    pub(super) fn identity(&self) -> Option<Identity> {
        match &self.place {
            _ if self.is_stdout() => Identity::of_stdout(),
            Place::File(target) => Identity::of(target),
            Place::Stream(_) | Place::Stdout => Identity::of(&self.path),
        }
    }

    /// Writes `bytes`. It is not an error if the reader of standard output has closed it.
    ///
    /// # Errors
    ///
    /// [`Error::Output`] if they cannot be written.
    #[cfg(feature = "lab")]
    pub fn write(&self, bytes: &[u8]) -> Result<()> {
        match &self.place {
            Place::Stdout => to_stdout(bytes),
            Place::Stream(stream) => match stream.write(bytes) {
                Err(error) if stream.is_stdout() && error.kind() == io::ErrorKind::BrokenPipe => {
                    Ok(())
                }
                written => {
                    written.map_err(|error| self.explained(error.into(), bytes.len() as u64))
                }
            },
            Place::File(_) => self.fill(bytes.len() as u64, |mut sink, _| {
                sink.write_all(bytes)?;
                Ok(())
            }),
        }
    }

    /// Writes what `write` produces, which is at most `most` bytes. An error that the sink recorded
    /// takes precedence over the one that `write` returns.
    pub(super) fn fill(
        &self,
        most: u64,
        write: impl FnOnce(Sink<'_>, &Trouble) -> Result<(), Failure>,
    ) -> Result<()> {
        let filled = match &self.place {
            Place::Stdout => Err(Failure::Encoding("it is for a file".into())),
            Place::Stream(stream) => self.fill_stream(stream, write),
            Place::File(target) => fill_file(target, write),
        };
        filled.map_err(|failure| self.explained(failure, most))
    }

    /// The error for a failure to write at most `most` bytes.
    fn explained(&self, failure: Failure, most: u64) -> Error {
        match failure {
            Failure::Memory(needed) => memory::failed(needed, PURPOSE),
            Failure::Encoding(reason) => self.failed(
                format!("cannot be encoded: {reason}"),
                "try another size or format",
            ),
            Failure::Spool(error) => self.spool_failed(&error, Some(most)),
            Failure::Kept { error, kept, is_cut } => self.failed(
                format!(
                    "{}: {}; the complete output is in {}",
                    if is_cut {
                        "was partly overwritten, because it cannot be replaced, and the rest cannot be written"
                    } else {
                        "cannot be written"
                    },
                    said(&error),
                    shown_path(&kept)
                ),
                "rename that file before its directory is cleaned up",
            ),
            Failure::Io(error) if is_full(&error) => self.failed(
                format!(
                    "cannot be written: {}; it needs {} or less",
                    said(&error),
                    bytes(most)
                ),
                help_for(&error),
            ),
            Failure::Io(error) => self.failed(
                format!("cannot be written: {}", said(&error)),
                help_for(&error),
            ),
        }
    }

    fn fill_stream(
        &self,
        stream: &Stream,
        write: impl FnOnce(Sink<'_>, &Trouble) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        // A stream is written from start to end, but some formats are not.
        let spool = match &self.spool {
            Some(spool) => spool.try_clone(),
            None => tempfile::tempfile(),
        };
        let mut spool = spool.map_err(Failure::Spool)?;
        let in_spool = |failure| match failure {
            Failure::Io(error) => Failure::Spool(error),
            other => other,
        };
        let emptied = spool.rewind().and_then(|()| spool.set_len(0));
        emptied.map_err(Failure::Spool)?;
        into_sink(&mut spool, write).map_err(in_spool)?;
        spool.rewind().map_err(Failure::Spool)?;
        let mut trouble = None;
        let filled = stream.fill(|put| {
            let mut piece = [0; 1 << 14];
            loop {
                let count = match spool.read(&mut piece) {
                    Ok(0) => return Ok(()),
                    Ok(count) => count,
                    Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                    Err(error) => {
                        trouble = Some(error);
                        return Ok(());
                    }
                };
                put(&piece[..count])?;
            }
        });
        match trouble {
            Some(error) => Err(Failure::Spool(error)),
            None => Ok(filled?),
        }
    }

    /// The error for a temporary file that could not hold the output of a stream.
    fn spool_failed(&self, error: &io::Error, most: Option<u64>) -> Error {
        let size = match most {
            Some(most) if is_full(error) => format!("; it needs {} or less", bytes(most)),
            _ => String::new(),
        };
        failed(
            &std::env::temp_dir(),
            format!(
                "no temporary file can be written there: {}{size}. An image for {} is first written to one",
                said(error),
                shown_path(&self.path)
            ),
            "set TMPDIR to a directory that is writable and has room, or name a file instead of a stream",
        )
    }

    /// Checks whether `target` may be created or replaced.
    fn check(&self, target: &Path) -> Result<()> {
        let directory = directory_of(target);
        self.check_directory(directory)?;
        let old = self.check_old(target)?;
        if is_append_only(directory) {
            return Err(self.failed(
                format!(
                    "cannot be written: {} is append-only: files in it cannot be renamed",
                    shown_path(directory)
                ),
                "name a file in another directory (`lsattr -d` shows its attributes, `chattr -a` removes this one)",
            ));
        }
        self.check_by_making(directory, old.as_ref())
    }

    /// Checks whether there is this directory.
    fn check_directory(&self, directory: &Path) -> Result<()> {
        let about = fs::metadata(directory);
        if let Err(error) = &about
            && error.kind() != io::ErrorKind::NotFound
            && error.kind() != io::ErrorKind::NotADirectory
        {
            return Err(self.failed(
                format!(
                    "cannot be written: the directory {} cannot be looked up: {}",
                    shown_path(directory),
                    said(error)
                ),
                help_for(error),
            ));
        }
        if !about.is_ok_and(|about| about.is_dir()) {
            return Err(self.failed(
                format!(
                    "cannot be written: there is no directory {}",
                    shown_path(directory)
                ),
                "create the directory, or name another",
            ));
        }
        Ok(())
    }

    /// Checks whether the file at `target` may be written, if there is one; returns what is known
    /// of it.
    fn check_old(&self, target: &Path) -> Result<Option<Metadata>> {
        // A name that cannot be looked up cannot be given to a file either.
        let about = match fs::symlink_metadata(target) {
            Ok(about) => about,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => {
                return Err(self.failed(
                    format!("cannot be written: {}", said(&error)),
                    help_for(&error),
                ));
            }
        };
        let opened = OpenOptions::new().write(true).open(target);
        // A read-only file is protected even from users who may write everything.
        if about.permissions().readonly() || opened.is_err() {
            let reason = match opened {
                Err(error) => format!("cannot be written: {}", said(&error)),
                Ok(_) => "is read-only".into(),
            };
            return Err(self.failed(
                reason,
                "make the file writable or remove it, or name another",
            ));
        }
        Ok(Some(about))
    }

    /// Checks whether a new file can be made in `directory`, be given the permissions of `old`, and
    /// be removed: makes one.
    fn check_by_making(&self, directory: &Path, old: Option<&Metadata>) -> Result<()> {
        let unmade = |error: io::Error| {
            let help = match error.kind() {
                io::ErrorKind::PermissionDenied => {
                    "name a file in a directory that may be written: new files are created there first, so that they appear whole"
                }
                _ => help_for(&error),
            };
            self.failed(
                format!(
                    "cannot be written: no file can be created in {}: {}",
                    shown_path(directory),
                    said(&error)
                ),
                help,
            )
        };
        let mut probe = Temporary::in_directory(directory).map_err(unmade)?;
        if let Some(old) = old {
            let file = probe.file().map_err(unmade)?;
            take_after(file, old).map_err(|error| {
                self.failed(
                    format!(
                        "cannot be replaced: its permissions cannot be given to a new file: {}",
                        said(&error)
                    ),
                    "remove the file, or name another",
                )
            })?;
        }
        remove_dead(directory, &mut probe);
        probe.remove().map_err(|(error, path)| {
            self.failed(
                format!(
                    "cannot be written: new files in {} cannot be renamed or removed: {}; {} is left there",
                    shown_path(directory),
                    said(&error),
                    shown_path(&path)
                ),
                "name a file in another directory",
            )
        })
    }

    fn failed(&self, reason: impl Into<String>, help: &str) -> Error {
        failed(&self.path, reason, help)
    }
}

#[cfg(feature = "lab")]
fn to_stdout(bytes: &[u8]) -> Result<()> {
    printed(waiting::put(io::stdout().lock(), bytes))
}

/// The result of printing to standard output. It is not an error if the reader has closed it.
///
/// # Errors
///
/// [`Error::Output`] for any other error.
#[cfg(feature = "lab")]
pub(crate) fn printed(printed: io::Result<()>) -> Result<()> {
    match printed {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(stdout_failed(&error)),
        _ => Ok(()),
    }
}

fn into_sink(
    file: &mut File,
    write: impl FnOnce(Sink<'_>, &Trouble) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let trouble = OnceCell::new();
    let written = write(Sink::new(file, &trouble), &trouble);
    match trouble.into_inner() {
        Some(error) => Err(error.into()),
        None => written,
    }
}

fn fill_file(
    target: &Path,
    write: impl FnOnce(Sink<'_>, &Trouble) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let mut temporary = Temporary::in_directory(directory_of(target))?;
    if let Ok(old) = fs::metadata(target) {
        // It worked before the work; now the image matters more.
        let _ = take_after(temporary.file()?, &old);
    }
    into_sink(temporary.file()?, write)?;
    temporary.rename_to(target)?;
    Ok(())
}

/// Gives a new file the permissions, owner and group of the old one.
#[cfg(unix)]
fn take_after(file: &File, old: &Metadata) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, PermissionsExt, fchown};
    let new = file.metadata()?;
    let mut mode = old.mode() & 0o777;
    if new.uid() != old.uid() {
        // Only privileged users can give a file away.
        let _ = fchown(file, Some(old.uid()), None);
    }
    if new.gid() != old.gid() && fchown(file, None, Some(old.gid())).is_err() {
        // The new group does not get the old group's permissions, unless everybody has them.
        mode &= 0o707 | (mode & 0o7) << 3;
    }
    match file.set_permissions(PermissionsExt::from_mode(mode)) {
        // Some file systems have one mode for all files.
        Err(_) if file.metadata()?.mode() & 0o777 & !mode == 0 => Ok(()),
        set => set,
    }
}

/// Whether files in the directory can be created but not renamed (`chattr +a`).
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn is_append_only(directory: &Path) -> bool {
    use std::os::unix::ffi::OsStrExt;
    let Ok(name) = std::ffi::CString::new(directory.as_os_str().as_bytes()) else {
        return false;
    };
    // SAFETY: a struct of numbers, for which zero is valid.
    let mut about: libc::statx = unsafe { std::mem::zeroed() };
    // SAFETY: the name ends in a zero, and the struct has room for the result.
    let status = unsafe { libc::statx(libc::AT_FDCWD, name.as_ptr(), 0, 0, &raw mut about) };
    status == 0 && about.stx_attributes & libc::STATX_ATTR_APPEND as u64 != 0
}

/// On other systems the removal of the first file shows it.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
fn is_append_only(_directory: &Path) -> bool {
    false
}

#[cfg(not(unix))]
fn take_after(_file: &File, _old: &Metadata) -> io::Result<()> {
    Ok(())
}

/// The destination at `path`, with symlinks followed.
fn place_of(path: &Path) -> Result<Place> {
    const MOST_LINKS: u32 = 40;
    let is_a_directory = || failed(path, "is a directory", "name a file");
    let mut target = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        if let Ok(about) = fs::metadata(&target) {
            if about.is_dir() {
                return Err(is_a_directory());
            }
            if !about.is_file() || of_this_process(&target).is_some() {
                return Stream::new(path)
                    .map(Place::Stream)
                    .map_err(|error| cannot_be_opened(path, &error));
            }
        }
        match fs::read_link(&target) {
            Ok(link) => target = directory_of(&target).join(link),
            Err(_) if target.file_name().is_none() || ends_in_separator(&target) => {
                return Err(is_a_directory());
            }
            Err(_) => return Ok(Place::File(target)),
        }
    }
    Err(failed(
        path,
        "cannot be written: too many symlinks",
        "name a file",
    ))
}

fn cannot_be_opened(path: &Path, error: &io::Error) -> Error {
    let reason = format!("cannot be written: {}", said(error));
    failed(path, reason, help_for(error))
}

fn ends_in_separator(path: &Path) -> bool {
    let last = path.as_os_str().as_encoded_bytes().last();
    last.is_some_and(|byte| std::path::is_separator(char::from(*byte)))
}
