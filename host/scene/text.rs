//! Text files, large ones read by all threads.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use rayon::prelude::*;

use crate::error::{Error, Result, SceneError};

/// Reads a whole text file.
///
/// # Errors
///
/// [`Error::Scene`] if there is none, or it is no text.
pub(super) fn read_text(path: &Path) -> Result<String> {
    let bytes = read_bytes(path).map_err(|error| {
        let (message, help) = match error.kind() {
            io::ErrorKind::NotFound => (
                "there is no such file".to_owned(),
                "check the name; a relative name counts from the current directory, or, inside a scene, from the scene's",
            ),
            io::ErrorKind::IsADirectory => (
                "is a directory".to_owned(),
                "name a file",
            ),
            _ => (
                format!("cannot be read: {error}"),
                "check that the file may be read",
            ),
        };
        SceneError::without_place(path, message, help)
    })?;
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        Error::Scene(SceneError::without_place(
            path,
            format!("byte {at} is not UTF-8 text"),
            "save the file as UTF-8; compressed files must be unpacked first",
        ))
    })
}

/// Files from this size on are read by all threads.
const LARGE_FILE: u64 = 1 << 24;
/// What each reads at once.
const PIECE: usize = 1 << 22;

/// Reads a whole file.
fn read_bytes(path: &Path) -> io::Result<Vec<u8>> {
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    match usize::try_from(length) {
        // Where there is no room, what follows says so.
        Ok(length) if length as u64 >= LARGE_FILE && has_room(length) => {
            read_in_pieces(&file, length, PIECE)
        }
        // What is no file has a length of zero, and may be opened once only.
        _ => {
            let mut bytes = Vec::new();
            file.read_to_end(&mut bytes)?;
            Ok(bytes)
        }
    }
}

fn has_room(length: usize) -> bool {
    Vec::<u8>::new().try_reserve_exact(length).is_ok()
}

/// Reads `length` bytes, `piece` at once.
fn read_in_pieces(file: &File, length: usize, piece: usize) -> io::Result<Vec<u8>> {
    // Zeros that the system gives as such: no thread writes them.
    let mut bytes = vec![0; length];
    bytes
        .par_chunks_mut(piece)
        .enumerate()
        .try_for_each(|(index, bytes)| read_at(file, bytes, (index * piece) as u64))?;
    Ok(bytes)
}

#[cfg(unix)]
fn read_at(file: &File, bytes: &mut [u8], offset: u64) -> io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, bytes, offset)
}

#[cfg(windows)]
fn read_at(file: &File, mut bytes: &mut [u8], mut offset: u64) -> io::Result<()> {
    while !bytes.is_empty() {
        let read = std::os::windows::fs::FileExt::seek_read(file, bytes, offset)?;
        if read == 0 {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        bytes = &mut bytes[read..];
        offset += read as u64;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_the_file() {
        let path = Path::new("scenes/2hhb.pdb");
        let (file, whole) = (
            File::open(path).expect("a file"),
            std::fs::read(path).expect("bytes"),
        );
        for piece in [whole.len(), whole.len() - 1, 1000] {
            let pieces = read_in_pieces(&file, whole.len(), piece).expect("bytes");
            assert_eq!(pieces, whole);
        }
        let error = read_in_pieces(&file, whole.len() + 1, 1000).expect_err("too few");
        assert_eq!(error.kind(), io::ErrorKind::UnexpectedEof);
    }
}
