//! PNG, 8 bits a channel, a band of rows at a time: all threads convert them, then they are
//! compressed.

use std::io::{Seek, Write};

use png::{BitDepth, ColorType, DeflateCompression, Encoder, EncodingError, Filter, chunk};
use simd_adler32::Adler32;

use super::failure::Failure;
use super::sink::{Sink, Trouble};
use crate::film::Image;
use crate::film::encode;

/// How rows are prepared for compression: to choose anew for each row takes as long as to compress
/// them.
const FILTER: Filter = Filter::Up;
/// What is converted at once, in bytes, or else one row.
const BAND: usize = 1 << 20;
/// What the file is cut into, in bytes.
const CHUNK: usize = 1 << 18;

/// Bytes of a row of an image.
fn row(width: u32, has_alpha: bool) -> usize {
    width as usize * if has_alpha { 4 } else { 3 }
}

/// What [`write()`] allocates, in bytes, or a little less.
pub(super) fn room(width: u32, has_alpha: bool) -> u64 {
    const COMPRESSOR: u64 = 1 << 20;
    let row = row(width, has_alpha);
    // The encoder filters rows, and knows the one before.
    (BAND.max(row) + 3 * row + CHUNK) as u64 + COMPRESSOR
}

/// The bytes of a file whose pixels are not compressed.
pub(super) fn most(width: u32, height: u32, has_alpha: bool) -> u64 {
    let raw = (row(width, has_alpha) as u64 + 1) * u64::from(height);
    // Each chunk takes twelve bytes more than its block; the rest is the file's head and end.
    let block = Block::MOST as u64;
    raw + (Block::HEAD as u64 + 12) * raw.div_ceil(block) + 100
}

pub(super) fn write(image: &Image, mut sink: Sink<'_>, trouble: &Trouble) -> Result<(), Failure> {
    let mut writer = header(image, &mut sink)?;
    let mut stream = writer.stream_writer_with_size(CHUNK)?;
    for_bands(image, trouble, |band| {
        stream.write_all(band).map_err(Failure::from)
    })?;
    if trouble.get().is_some() {
        // Whoever made the sink knows what it is.
        return Ok(());
    }
    stream.finish()?;
    writer.finish()?;
    // Noise takes more room by this compression than without any.
    let most = most(image.width(), image.height(), image.has_alpha());
    let most = most + image.remarks.len() as u64;
    if sink.stream_position()? > most {
        sink.clear();
        write_stored(image, &mut sink, trouble)?;
    }
    Ok(())
}

/// The image without compression: a zlib stream (RFC 1950) of stored blocks (RFC 1951), each in a
/// chunk of its own.
fn write_stored(image: &Image, sink: &mut Sink<'_>, trouble: &Trouble) -> Result<(), Failure> {
    const UNFILTERED: u8 = 0;
    let mut writer = header(image, sink)?;
    let mut sum = Adler32::new();
    let mut block = Block::default();
    writer.write_chunk(chunk::IDAT, &[0x78, 0x01])?;
    let row = row(image.width(), image.has_alpha());
    for_bands(image, trouble, |band| {
        for row in band.chunks_exact(row) {
            for mut bytes in [&[UNFILTERED], row] {
                sum.write(bytes);
                while !bytes.is_empty() {
                    bytes = block.take(bytes);
                    if block.is_full() {
                        writer.write_chunk(chunk::IDAT, block.end(false))?;
                        block.empty();
                    }
                }
            }
        }
        Ok(())
    })?;
    writer.write_chunk(chunk::IDAT, block.end(true))?;
    writer.write_chunk(chunk::IDAT, &sum.finish().to_be_bytes())?;
    writer.finish()?;
    Ok(())
}

/// A stored block: whether it is the last, its length, that inverted, its bytes.
struct Block(Vec<u8>);

impl Default for Block {
    fn default() -> Self {
        Self(vec![0; Self::HEAD])
    }
}

impl Block {
    const HEAD: usize = 5;
    const MOST: usize = 0xffff;

    fn is_full(&self) -> bool {
        self.0.len() == Self::HEAD + Self::MOST
    }

    /// Takes what there is room for, and gives the rest back.
    fn take<'a>(&mut self, bytes: &'a [u8]) -> &'a [u8] {
        let room = Self::HEAD + Self::MOST - self.0.len();
        let (taken, rest) = bytes.split_at(room.min(bytes.len()));
        self.0.extend_from_slice(taken);
        rest
    }

    fn empty(&mut self) {
        self.0.truncate(Self::HEAD);
    }

    fn end(&mut self, is_last: bool) -> &[u8] {
        let length = (self.0.len() - Self::HEAD) as u16;
        self.0[0] = u8::from(is_last);
        self.0[1..3].copy_from_slice(&length.to_le_bytes());
        self.0[3..5].copy_from_slice(&(!length).to_le_bytes());
        &self.0
    }
}

fn header<'a, 'b>(
    image: &Image,
    sink: &'a mut Sink<'b>,
) -> Result<png::Writer<&'a mut Sink<'b>>, Failure> {
    let mut encoder = Encoder::new(sink, image.width(), image.height());
    encoder.set_color(if image.has_alpha() {
        ColorType::Rgba
    } else {
        ColorType::Rgb
    });
    encoder.set_depth(BitDepth::Eight);
    encoder.set_deflate_compression(DeflateCompression::FdeflateUltraFast);
    encoder.set_filter(FILTER);
    if !image.remarks.is_empty() {
        encoder.add_itxt_chunk("Comment".into(), image.remarks.clone())?;
    }
    Ok(encoder.write_header()?)
}

/// Calls `write` with the bytes of some rows after another, until there is trouble.
fn for_bands(
    image: &Image,
    trouble: &Trouble,
    mut write: impl FnMut(&[u8]) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let width = image.width() as usize;
    let has_alpha = image.has_alpha();
    let row = row(image.width(), has_alpha);
    let rows = (BAND / row).clamp(1, image.height() as usize);
    let mut band = Vec::new();
    band.try_reserve_exact(rows * row)
        .map_err(|_| Failure::Memory((rows * row) as u64))?;
    band.resize(rows * row, 0);
    let pixels = encode::Encoder::of(image);
    for first in (0..image.height() as usize).step_by(rows) {
        let rows = rows.min(image.height() as usize - first);
        let band = &mut band[..rows * row];
        if has_alpha {
            pixels.encode_rgba8(image, first * width, band);
        } else {
            pixels.encode_rgb8(image, first * width, band);
        }
        write(band)?;
        if trouble.get().is_some() {
            break;
        }
    }
    Ok(())
}

impl From<EncodingError> for Failure {
    fn from(error: EncodingError) -> Self {
        match error {
            EncodingError::IoError(error) => Self::Io(error),
            other => Self::Encoding(other.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use spherule_kernel::{Pixel, Shading};
    use std::cell::OnceCell;
    #[cfg(target_os = "linux")]
    use std::fs::File;
    use std::io::{BufReader, Read};

    /// An image of noise or of one colour, as normals, which are stored as they are.
    fn image(width: u32, height: u32, is_noise: bool, has_alpha: bool) -> Image {
        let mut random = crate::random::Random::new(7);
        let mut value = || {
            if is_noise {
                random.vec3(0.0, 1.0)
            } else {
                Vec3::splat(0.5)
            }
        };
        let count = (width * height) as usize;
        let pixels = (0..count).map(|_| Pixel::new(value(), 1.0)).collect();
        let mut image = Image::new(width, height, Shading::Flat, pixels).expect("an image");
        if has_alpha {
            image
                .set_alpha((0..count).map(|_| value().x).collect())
                .expect("one for each");
        }
        image
    }

    fn written(image: &Image) -> Vec<u8> {
        let mut file = tempfile::tempfile().expect("a file");
        let trouble = OnceCell::new();
        let done = write(image, Sink::new(&mut file, &trouble), &trouble);
        assert!(done.is_ok() && trouble.get().is_none());
        file.rewind().expect("its start");
        let mut bytes = Vec::new();
        BufReader::new(file).read_to_end(&mut bytes).expect("bytes");
        bytes
    }

    /// Whether of one band or of several, with compression or without, the file holds the image's
    /// bytes.
    #[test]
    fn pixels_are_those_of_the_whole_image() {
        for (width, height) in [(1, 1), (7, 3), (1000, 1001), (350_000, 5)] {
            for is_noise in [false, true] {
                for has_alpha in [false, true] {
                    let image = image(width, height, is_noise, has_alpha);
                    let file = written(&image);
                    let decoded = ::image::load_from_memory(&file).expect("a PNG");
                    let (found, expected) = if has_alpha {
                        (decoded.into_rgba8().into_raw(), image.to_rgba8())
                    } else {
                        (decoded.into_rgb8().into_raw(), image.to_rgb8())
                    };
                    assert!(
                        found == expected,
                        "{width} × {height} {is_noise} {has_alpha}"
                    );
                    assert!(file.len() as u64 <= most(width, height, has_alpha));
                }
            }
        }
    }

    /// The file says what the image's remarks are, and nothing else if there are none.
    #[test]
    fn remarks_are_a_comment() {
        for remarks in ["", "of 5 µm"] {
            let mut image = image(7, 3, false, false);
            image.remarks = remarks.into();
            let file = written(&image);
            let decoder = png::Decoder::new(std::io::Cursor::new(&file));
            let reader = decoder.read_info().expect("a PNG");
            let texts = reader.info().utf8_text.iter();
            let found: Vec<(String, String)> = texts
                .map(|chunk| (chunk.keyword.clone(), chunk.get_text().expect("UTF-8")))
                .collect();
            let comment = ("Comment".to_owned(), remarks.to_owned());
            let expected = Some(comment).filter(|_| !remarks.is_empty());
            assert_eq!(found, Vec::from_iter(expected));
        }
    }

    /// At whatever byte the disk is full: no panic, and the error is there.
    #[test]
    #[cfg(target_os = "linux")]
    fn a_full_disk_is_remembered() {
        for (width, height) in [(1, 1), (1000, 1001)] {
            let image = image(width, height, true, false);
            let mut file = File::options()
                .write(true)
                .open("/dev/full")
                .expect("a device");
            let trouble = OnceCell::new();
            let _ = write(&image, Sink::new(&mut file, &trouble), &trouble);
            let error = trouble.get().expect("an error");
            assert_eq!(error.kind(), std::io::ErrorKind::StorageFull);
        }
    }
}
