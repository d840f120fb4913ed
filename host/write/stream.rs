//! Streams: pipes, devices, sockets, and open files of this process, which are written to and never
//! replaced.

use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

use super::directory_of;
use super::waiting::{Waiting, put};

/// Something that is written to and never replaced.
#[derive(Debug)]
pub(super) struct Stream {
    path: PathBuf,
    #[cfg(feature = "lab")]
    is_stdout: bool,
    /// `None` for a pipe without a reader: opening it would wait for one.
    opened: Option<File>,
}

impl Stream {
    /// Opens the stream at `path`, if that is possible without waiting.
    pub(super) fn new(path: &Path) -> io::Result<Self> {
        Ok(Self {
            path: path.into(),
            #[cfg(feature = "lab")]
            is_stdout: own_number(path) == Some(1),
            opened: open(path)?,
        })
    }

    /// Whether it is standard output under another name than `-`.
    #[cfg(feature = "lab")]
    pub(super) fn is_stdout(&self) -> bool {
        self.is_stdout
    }

    #[cfg(feature = "lab")]
    pub(super) fn write(&self, bytes: &[u8]) -> io::Result<()> {
        self.fill(|write| write(bytes))
    }

    /// Calls `pieces` with a function that writes to the stream.
    pub(super) fn fill(
        &self,
        pieces: impl FnOnce(&mut dyn FnMut(&[u8]) -> io::Result<()>) -> io::Result<()>,
    ) -> io::Result<()> {
        let late;
        let file = match &self.opened {
            Some(file) => file,
            None => {
                let _waiting = Waiting::begin();
                late = OpenOptions::new().append(true).open(&self.path)?;
                &late
            }
        };
        pieces(&mut |bytes| put(file, bytes))
    }
}

/// The number of this process's open file that `path` names, as `/dev/fd/1` does. Such a path must
/// not be replaced: a file renamed onto its target would not reach the reader.
pub(super) fn of_this_process(path: &Path) -> Option<u32> {
    let directory = directory_of(path);
    let number = path.file_name()?.to_str()?.parse().ok()?;
    let own = [Path::new("/dev/fd"), Path::new("/proc/self/fd")]
        .into_iter()
        .filter_map(|own| fs::canonicalize(own).ok())
        .any(|own| fs::canonicalize(directory).is_ok_and(|directory| directory == own));
    own.then_some(number)
}

/// [`of_this_process`], with symlinks followed.
fn own_number(path: &Path) -> Option<u32> {
    const MOST_LINKS: u32 = 40;
    let mut target = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        if let Some(number) = of_this_process(&target) {
            return Some(number);
        }
        let link = fs::read_link(&target).ok()?;
        target = directory_of(&target).join(link);
    }
    None
}

/// Standard output as a second handle that shares its position.
#[cfg(unix)]
pub(super) fn stdout() -> io::Result<File> {
    use std::os::fd::AsFd;
    let file = File::from(io::stdout().as_fd().try_clone_to_owned()?);
    check_writable(&file)?;
    Ok(file)
}

/// Opens a stream for appending; `None` for a pipe without a reader.
#[cfg(unix)]
fn open(path: &Path) -> io::Result<Option<File>> {
    use std::os::fd::{AsFd, OwnedFd};
    use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
    // Duplicates the open file; a socket can only be reached that way.
    match own_number(path) {
        Some(1) => return stdout().map(Some),
        Some(2) => {
            let file = File::from(io::stderr().as_fd().try_clone_to_owned()?);
            check_writable(&file)?;
            return Ok(Some(file));
        }
        _ => {}
    }
    if fs::metadata(path)?.file_type().is_socket() {
        let socket = std::os::unix::net::UnixStream::connect(path)?;
        return Ok(Some(File::from(OwnedFd::from(socket))));
    }
    let opened = OpenOptions::new()
        .append(true)
        .custom_flags(libc::O_NONBLOCK | libc::O_NOCTTY)
        .open(path);
    match opened {
        Ok(file) => {
            let flags = flags(&file)?;
            // SAFETY: only sets flags of an open file.
            let set = unsafe {
                use std::os::fd::AsRawFd;
                libc::fcntl(file.as_raw_fd(), libc::F_SETFL, flags & !libc::O_NONBLOCK)
            };
            if set < 0 {
                return Err(io::Error::last_os_error());
            }
            Ok(Some(file))
        }
        // A pipe without a reader; for a device the error means that it has no driver.
        Err(error) if error.raw_os_error() == Some(libc::ENXIO) && is_pipe(path) => Ok(None),
        Err(error) => Err(error),
    }
}

#[cfg(unix)]
fn is_pipe(path: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt;
    std::fs::metadata(path).is_ok_and(|about| about.file_type().is_fifo())
}

#[cfg(unix)]
fn flags(file: &File) -> io::Result<i32> {
    use std::os::fd::AsRawFd;
    // SAFETY: only reads flags of an open file.
    match unsafe { libc::fcntl(file.as_raw_fd(), libc::F_GETFL) } {
        flags if flags < 0 => Err(io::Error::last_os_error()),
        flags => Ok(flags),
    }
}

/// Standard output may be open for reading only, and would then drop everything silently.
#[cfg(unix)]
fn check_writable(file: &File) -> io::Result<()> {
    if flags(file)? & libc::O_ACCMODE == libc::O_RDONLY {
        return Err(io::Error::from_raw_os_error(libc::EBADF));
    }
    Ok(())
}

#[cfg(not(unix))]
fn open(path: &Path) -> io::Result<Option<File>> {
    Ok(Some(OpenOptions::new().append(true).open(path)?))
}
