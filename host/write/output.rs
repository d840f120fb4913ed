//! [`Output`]: where something goes, what is checked about it, and how it gets there.

use std::cell::OnceCell;
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};

use super::directory_of;
use super::image::{self, Format};
use super::same::Identity;
use super::sink::{Sink, Trouble};
use super::temporary::{Temporary, remove_dead};
use crate::error::{Error, Result};
use crate::memory;
use crate::shown::shown_path;

/// Where one output goes. What can be known before the work is checked when it is made.
///
/// | what has the name | what becomes of it |
/// | --- | --- |
/// | nothing, or a file | The file appears whole or not at all: it is written beside its place under a temporary name, and renamed when it is on the disk. |
/// | a file | What replaces it has its permissions, and its owner and group where this process may give them. Another hard link of it keeps the old content. |
/// | a file that may not be written | It is refused, though a rename would replace it: somebody protected it. |
/// | a symlink | It stays; the file that it leads to is made or replaced. |
/// | a pipe, a device, a socket | It is written into as it is, once all is there. |
/// | `-` | Standard output, except for images. |
#[derive(Debug)]
pub struct Output {
    /// As the user called it.
    path: PathBuf,
    place: Place,
}

#[derive(Debug)]
enum Place {
    Stdout,
    /// What is written into as it is.
    Stream,
    /// A file with this name, which is not a symlink's.
    File(PathBuf),
}

impl Output {
    /// An output of text or of numbers; `-` is standard output.
    ///
    /// # Errors
    ///
    /// [`Error::Output`] if the path is a directory or a file that may not be written, or if no file can be made in
    /// its directory.
    pub fn new(path: &Path) -> Result<Self> {
        if path == Path::new("-") {
            return Ok(Self {
                path: path.into(),
                place: Place::Stdout,
            });
        }
        let output = Self {
            path: path.into(),
            place: place_of(path)?,
        };
        if let Place::File(target) = &output.place {
            output.check(target)?;
        }
        Ok(output)
    }

    /// An image.
    ///
    /// # Errors
    ///
    /// As [`Output::new`], and [`Error::OutputRefused`] if the extension names no kind of image.
    pub fn image(path: &Path) -> Result<Self> {
        Format::of(path)?;
        Self::new(path)
    }

    /// As the user called it.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether it is `-`.
    #[must_use]
    pub fn is_stdout(&self) -> bool {
        matches!(self.place, Place::Stdout)
    }

    pub(super) fn identity(&self) -> Option<Identity> {
        match &self.place {
            Place::Stdout => None,
            Place::Stream => Identity::of(&self.path),
            Place::File(target) => Identity::of(target),
        }
    }

    /// Writes `bytes`. A reader of standard output that has gone away is no error.
    ///
    /// # Errors
    ///
    /// [`Error::Output`] if they cannot be written.
    pub fn write(&self, bytes: &[u8]) -> Result<()> {
        match &self.place {
            Place::Stdout => to_stdout(bytes),
            Place::Stream => open_stream(&self.path)
                .and_then(|mut stream| stream.write_all(bytes))
                .map_err(|error| self.explained(error.into(), bytes.len() as u64)),
            Place::File(_) => self.fill(bytes.len() as u64, |mut sink, _| {
                sink.write_all(bytes)?;
                Ok(())
            }),
        }
    }

    /// Writes what `write` does, which is `most` bytes or less. An error that the sink remembers goes before what
    /// `write` says.
    pub(super) fn fill(
        &self,
        most: u64,
        write: impl FnOnce(Sink<'_>, &Trouble) -> Result<(), Failure>,
    ) -> Result<()> {
        let filled = match &self.place {
            Place::Stdout => Err(Failure::Encoding("it is for a file".into())),
            Place::Stream => self.fill_stream(write),
            Place::File(target) => fill_file(target, write),
        };
        filled.map_err(|failure| self.explained(failure, most))
    }

    /// The error for a failure to write `most` bytes or less.
    fn explained(&self, failure: Failure, most: u64) -> Error {
        match failure {
            Failure::Memory(needed) => memory::failed(needed, image::PURPOSE),
            Failure::Encoding(reason) => self.failed(
                format!("cannot be encoded: {reason}"),
                "try another size or format",
            ),
            Failure::Io(error) if is_full(&error) => self.failed(
                format!(
                    "cannot be written: {}; it takes {:.1} MiB or less",
                    said(&error),
                    most as f64 / f64::from(1 << 20)
                ),
                "make room, or name a file on another disk",
            ),
            Failure::Io(error) => self.failed(
                format!("cannot be written: {}", said(&error)),
                "check that the directory exists, may be written and has room",
            ),
        }
    }

    fn fill_stream(
        &self,
        write: impl FnOnce(Sink<'_>, &Trouble) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        // A stream cannot be written in an order of its own, as some kinds of files are.
        let mut file = tempfile::tempfile()?;
        into_sink(&mut file, write)?;
        file.rewind()?;
        let mut stream = open_stream(&self.path)?;
        io::copy(&mut file, &mut stream)?;
        stream.flush()?;
        Ok(())
    }

    /// Whether `target` may be made or replaced.
    fn check(&self, target: &Path) -> Result<()> {
        let directory = directory_of(target);
        if !directory.is_dir() {
            return Err(self.failed(
                format!(
                    "cannot be written: there is no directory {}",
                    shown_path(directory)
                ),
                "make the directory, or name another",
            ));
        }
        if let Ok(about) = fs::metadata(target) {
            let opened = OpenOptions::new().write(true).open(target);
            // Who may write everything is protected from mistakes all the same.
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
        }
        let mut probe = Temporary::in_directory(directory).map_err(|error| {
            self.failed(
                format!(
                    "cannot be written: no file can be made in {}: {}",
                    shown_path(directory),
                    said(&error)
                ),
                "name a file in a directory that may be written: files are made beside their place, and appear whole",
            )
        })?;
        remove_dead(directory, &mut probe);
        Ok(())
    }

    fn failed(&self, reason: impl Into<String>, help: &str) -> Error {
        failed(&self.path, reason, help)
    }
}

/// Why something was not written.
pub(super) enum Failure {
    Io(io::Error),
    /// It cannot be put into a file of its kind.
    Encoding(String),
    /// So many bytes of memory were needed.
    Memory(u64),
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

fn failed(path: &Path, reason: impl Into<String>, help: &str) -> Error {
    Error::Output {
        path: path.into(),
        reason: reason.into(),
        help: help.into(),
    }
}

/// What the system said, without the name of a temporary file.
fn said(error: &io::Error) -> String {
    match error.raw_os_error() {
        Some(_) => error.to_string(),
        None => error.kind().to_string(),
    }
}

/// Whether there is no room on the disk, or none for this user or this process.
fn is_full(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge
    )
}

fn to_stdout(bytes: &[u8]) -> Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(failed(
            Path::new("standard output"),
            format!("cannot be written: {}", said(&error)),
            "check where it is redirected to",
        )),
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
        take_after(temporary.file()?, &old)?;
    }
    into_sink(temporary.file()?, write)?;
    temporary.rename_to(target)?;
    Ok(())
}

/// Gives a new file the rights of the old one.
#[cfg(unix)]
fn take_after(file: &File, old: &Metadata) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, PermissionsExt, fchown};
    let new = file.metadata()?;
    let mut mode = old.mode() & 0o777;
    if new.uid() != old.uid() {
        // Only who may do anything can give a file away.
        let _ = fchown(file, Some(old.uid()), None);
    }
    if new.gid() != old.gid() && fchown(file, None, Some(old.gid())).is_err() {
        // What the old group could do is not for this one, unless it is for everybody.
        mode &= 0o707 | (mode & 0o7) << 3;
    }
    file.set_permissions(PermissionsExt::from_mode(mode))
}

#[cfg(not(unix))]
fn take_after(_file: &File, _old: &Metadata) -> io::Result<()> {
    Ok(())
}

/// What has the name `path`, symlinks followed.
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
                return Ok(Place::Stream);
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
        "cannot be written: its symlinks lead to no file",
        "name a file",
    ))
}

fn ends_in_separator(path: &Path) -> bool {
    let last = path.as_os_str().as_encoded_bytes().last();
    last.is_some_and(|byte| std::path::is_separator(char::from(*byte)))
}

/// The number of the open file of this process that `path` names, as `/dev/fd/1` does. A link to one is no other
/// file: renaming one onto what it leads to would not reach whoever reads it.
fn of_this_process(path: &Path) -> Option<u32> {
    let directory = directory_of(path);
    let number = path.file_name()?.to_str()?.parse().ok()?;
    let own = [Path::new("/dev/fd"), Path::new("/proc/self/fd")]
        .into_iter()
        .filter_map(|own| fs::canonicalize(own).ok())
        .any(|own| fs::canonicalize(directory).is_ok_and(|directory| directory == own));
    own.then_some(number)
}

/// Opens what is written into as it is, at its end.
#[cfg(unix)]
fn open_stream(path: &Path) -> io::Result<Box<dyn Write>> {
    use std::os::fd::AsFd;
    use std::os::unix::fs::FileTypeExt;
    let mut target = path.to_path_buf();
    loop {
        // A copy, which goes on where this process is in the file; a socket can only be had that way.
        match of_this_process(&target) {
            Some(1) => {
                return Ok(Box::new(File::from(
                    io::stdout().as_fd().try_clone_to_owned()?,
                )));
            }
            Some(2) => {
                return Ok(Box::new(File::from(
                    io::stderr().as_fd().try_clone_to_owned()?,
                )));
            }
            _ => {}
        }
        match fs::read_link(&target) {
            Ok(link) => target = directory_of(&target).join(link),
            Err(_) => break,
        }
    }
    if fs::metadata(path)?.file_type().is_socket() {
        return Ok(Box::new(std::os::unix::net::UnixStream::connect(path)?));
    }
    Ok(Box::new(OpenOptions::new().append(true).open(path)?))
}

#[cfg(not(unix))]
fn open_stream(path: &Path) -> io::Result<Box<dyn Write>> {
    Ok(Box::new(OpenOptions::new().append(true).open(path)?))
}
