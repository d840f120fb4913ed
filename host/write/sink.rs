//! The file that encoders write to.

use std::cell::OnceCell;
use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};

/// The first error of a [`Sink`].
pub(super) type Trouble = OnceCell<io::Error>;

/// A file that records its first error and ignores all writes after it.
///
/// Some encoders write where they cannot report an error, panic at one, or turn it into another.
pub(super) struct Sink<'a> {
    file: BufWriter<&'a mut File>,
    trouble: &'a Trouble,
    /// The position of the next byte.
    position: u64,
}

impl<'a> Sink<'a> {
    /// The size of a sink's buffer, in bytes.
    pub(super) const BUFFER: usize = 1 << 20;

    pub(super) fn new(file: &'a mut File, trouble: &'a Trouble) -> Self {
        Self {
            file: BufWriter::with_capacity(Self::BUFFER, file),
            trouble,
            position: 0,
        }
    }

    /// Truncates the file to nothing.
    pub(super) fn clear(&mut self) {
        self.run(|file| {
            file.flush()?;
            file.get_mut().set_len(0)?;
            file.rewind()
        });
        self.position = 0;
    }

    fn run(&mut self, action: impl FnOnce(&mut BufWriter<&'a mut File>) -> io::Result<()>) {
        if self.trouble.get().is_none()
            && let Err(error) = action(&mut self.file)
        {
            // It was not set, as checked above.
            let _ = self.trouble.set(error);
        }
    }
}

impl Write for Sink<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.run(|file| file.write_all(bytes));
        self.position += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.run(Write::flush);
        Ok(())
    }
}

impl Seek for Sink<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let position = match to {
            SeekFrom::Start(position) => Some(position),
            SeekFrom::Current(offset) => self.position.checked_add_signed(offset),
            SeekFrom::End(_) => None,
        };
        let Some(position) = position else {
            return Err(io::ErrorKind::Unsupported.into());
        };
        if position != self.position {
            self.run(|file| file.seek(SeekFrom::Start(position)).map(|_| ()));
            self.position = position;
        }
        Ok(position)
    }
}

impl Drop for Sink<'_> {
    fn drop(&mut self) {
        self.run(Write::flush);
    }
}
