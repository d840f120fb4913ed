//! Reads text files; large ones on all threads.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use flate2::bufread::GzDecoder;
use rayon::prelude::*;

use crate::error::{Error, Result, SceneError};
use crate::memory;

/// Reads a whole text file.
///
/// # Errors
///
/// [`Error::Scene`] if the file does not exist, or is not text.
pub(super) fn read_text(path: &Path) -> Result<String> {
    let bytes = read_bytes(path).map_err(|error| {
        let (message, help) = match error.kind() {
            io::ErrorKind::NotFound => (
                "there is no such file".to_owned(),
                "check the name; a relative name starts from the current directory or, inside a scene, from the scene's directory",
            ),
            io::ErrorKind::IsADirectory => (
                "is a directory".to_owned(),
                "name a file",
            ),
            io::ErrorKind::UnexpectedEof => (
                "ends too early".to_owned(),
                "wait until it is completely written, or get it again",
            ),
            io::ErrorKind::InvalidData => (
                format!("cannot be decompressed: {error}"),
                "get it again, or compress it with gzip",
            ),
            io::ErrorKind::OutOfMemory => (
                "there is not enough memory to read it".to_owned(),
                "use a machine with more memory",
            ),
            _ => (
                format!("cannot be read: {error}"),
                "check the file's permissions",
            ),
        };
        SceneError::without_place(path, message, help)
    })?;
    if bytes.first() == Some(&0) {
        return Err(Error::Scene(SceneError::without_place(
            path,
            "is not text: it begins with a byte of zero",
            "name a text file; UTF-16 must be converted to UTF-8 first",
        )));
    }
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes()[..at]
            .iter()
            .filter(|byte| **byte == b'\n')
            .count();
        Error::Scene(SceneError::without_place(
            path,
            format!("byte {at}, in line {line}, is not UTF-8 text"),
            "save the file as UTF-8; compressed files must be unpacked first",
        ))
    })
}

/// Files from this size on are read on all threads.
const LARGE_FILE: u64 = 1 << 24;
/// Bytes that a thread reads at once.
const PIECE: usize = 1 << 22;

/// The first bytes of a compressed file (RFC 1952).
const GZIP: &[u8] = &[0x1f, 0x8b];

/// Reads a whole file, decompressed if it is compressed. Of a file that begins with a zero byte,
/// only that byte may be read.
fn read_bytes(path: &Path) -> io::Result<Vec<u8>> {
    let bytes = read_as_they_are(path)?;
    if !bytes.starts_with(GZIP) {
        return Ok(bytes);
    }
    let (mut inner, mut left) = (Vec::new(), &bytes[..]);
    // Some files have zeros after the last member, to fill a block.
    while left.iter().any(|byte| *byte != 0) {
        let mut member = GzDecoder::new(left);
        read_stream(&mut member, &mut inner).map_err(|error| match error.kind() {
            io::ErrorKind::InvalidInput => io::Error::new(io::ErrorKind::InvalidData, error),
            _ => error,
        })?;
        left = member.into_inner();
    }
    Ok(inner)
}

fn read_as_they_are(path: &Path) -> io::Result<Vec<u8>> {
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    if length >= LARGE_FILE {
        let length = usize::try_from(length).map_err(|_| io::ErrorKind::OutOfMemory)?;
        return read_in_pieces(&file, length, PIECE);
    }
    // A pipe or device has a length of zero, may be opened only once, and may never end.
    let mut bytes = Vec::new();
    file.by_ref().take(1).read_to_end(&mut bytes)?;
    if bytes != [0] {
        read_stream(&mut file, &mut bytes)?;
    }
    Ok(bytes)
}

/// Reads a stream that may never end, for as long as there is memory.
fn read_stream(stream: &mut impl Read, bytes: &mut Vec<u8>) -> io::Result<()> {
    loop {
        let room = bytes.len().max(PIECE);
        memory::require(room as u64, "reading").map_err(|_| io::ErrorKind::OutOfMemory)?;
        bytes
            .try_reserve(room)
            .map_err(|_| io::ErrorKind::OutOfMemory)?;
        let read = stream.by_ref().take(room as u64).read_to_end(bytes)?;
        if read < room {
            return Ok(());
        }
    }
}

/// Reads `length` bytes, `piece` bytes at a time.
fn read_in_pieces(file: &File, length: usize, piece: usize) -> io::Result<Vec<u8>> {
    // The system provides the zeros: no thread writes them.
    let mut bytes: Vec<u8> =
        bytemuck::allocation::try_zeroed_vec(length).map_err(|()| io::ErrorKind::OutOfMemory)?;
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

/// The extension of compressed files, which every reader of text accepts.
pub(super) const COMPRESSED: &str = "gz";

/// A file's extension, in lower case.
pub(super) fn extension(path: &Path) -> String {
    let extension = path.extension().unwrap_or_default();
    extension.to_string_lossy().to_lowercase()
}

/// The name of a file without the extension of a compressed file.
pub(crate) fn uncompressed(path: &Path) -> &Path {
    match path.file_stem() {
        Some(inner) if extension(path) == COMPRESSED => Path::new(inner),
        _ => path,
    }
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

    /// Inputs that a user may name by mistake.
    #[test]
    fn what_is_no_text_is_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("file");
        for (bytes, word) in [
            (&[0; 5000][..], "byte of zero"),
            (b"one\ntwo \xff\n", "byte 8, in line 2,"),
            (b"\xff\xfea\0", "byte 0, in line 1,"),
        ] {
            std::fs::write(&file, bytes).expect("a file");
            let error = read_text(&file).expect_err("a refusal").to_string();
            assert!(error.contains(word), "{error}");
        }
        let large = vec![0; LARGE_FILE as usize];
        std::fs::write(&file, large).expect("a file");
        let error = read_text(&file).expect_err("a refusal").to_string();
        assert!(error.contains("byte of zero"), "{error}");
        std::fs::write(&file, "").expect("a file");
        assert_eq!(read_text(&file).expect("nothing"), "");
        let error = read_text(folder.path()).expect_err("a refusal").to_string();
        assert!(error.contains("is a directory"), "{error}");
    }

    /// Pipes are opened only once, and a stream that never ends is not read to the end.
    #[cfg(unix)]
    #[test]
    fn streams_are_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.expect("mkfifo").success());
        std::thread::scope(|scope| {
            scope.spawn(|| std::fs::write(&pipe, "a text").expect("a reader"));
            assert_eq!(read_text(&pipe).expect("a text"), "a text");
        });
        let error = read_text(Path::new("/dev/zero")).expect_err("a refusal");
        assert!(error.to_string().contains("byte of zero"), "{error}");
    }
}
