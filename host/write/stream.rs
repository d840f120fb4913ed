//! What is written into as it is: pipes, devices, sockets, and what this process has open.

use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

use super::directory_of;
use super::waiting::{Waiting, put};

/// Something that is written into as it is.
#[derive(Debug)]
pub(super) struct Stream {
    path: PathBuf,
    #[cfg(feature = "lab")]
    is_stdout: bool,
    /// `None` for a pipe that nobody reads yet: opening that waits for a reader.
    opened: Option<File>,
}

impl Stream {
    /// Opens what `path` names, if that can be without waiting.
    pub(super) fn new(path: &Path) -> io::Result<Self> {
        Ok(Self {
            path: path.into(),
            #[cfg(feature = "lab")]
            is_stdout: own_number(path) == Some(1),
            opened: open(path)?,
        })
    }

    /// Whether it is standard output, by another name than `-`.
    #[cfg(feature = "lab")]
    pub(super) fn is_stdout(&self) -> bool {
        self.is_stdout
    }

    #[cfg(feature = "lab")]
    pub(super) fn write(&self, bytes: &[u8]) -> io::Result<()> {
        self.fill(|write| write(bytes))
    }

    /// Writes what `pieces` gives to the function that it is given.
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

/// The number of the open file of this process that `path` names, as `/dev/fd/1` does. A link to one is no other
/// file: renaming one onto what it leads to would not reach whoever reads it.
pub(super) fn of_this_process(path: &Path) -> Option<u32> {
    let directory = directory_of(path);
    let number = path.file_name()?.to_str()?.parse().ok()?;
    let own = [Path::new("/dev/fd"), Path::new("/proc/self/fd")]
        .into_iter()
        .filter_map(|own| fs::canonicalize(own).ok())
        .any(|own| fs::canonicalize(directory).is_ok_and(|directory| directory == own));
    own.then_some(number)
}

/// As [`of_this_process`], symlinks followed.
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

/// Standard output, as another open file that goes on where this process is in it.
#[cfg(unix)]
pub(super) fn stdout() -> io::Result<File> {
    use std::os::fd::AsFd;
    let file = File::from(io::stdout().as_fd().try_clone_to_owned()?);
    check_writable(&file)?;
    Ok(file)
}

/// Opens what is written into as it is, at its end; `None` for a pipe without a reader.
#[cfg(unix)]
fn open(path: &Path) -> io::Result<Option<File>> {
    use std::os::fd::{AsFd, OwnedFd};
    use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
    // A copy of what is open; a socket can only be had that way.
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
            // SAFETY: only flags of a file that is open are set.
            let set = unsafe {
                use std::os::fd::AsRawFd;
                libc::fcntl(file.as_raw_fd(), libc::F_SETFL, flags & !libc::O_NONBLOCK)
            };
            if set < 0 {
                return Err(io::Error::last_os_error());
            }
            Ok(Some(file))
        }
        // A pipe without a reader; a device would be without a driver.
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
    // SAFETY: only flags of a file that is open are asked for.
    match unsafe { libc::fcntl(file.as_raw_fd(), libc::F_GETFL) } {
        flags if flags < 0 => Err(io::Error::last_os_error()),
        flags => Ok(flags),
    }
}

/// Standard output may be open for reading only, and then takes nothing without saying so.
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
