//! `OpenEXR`, 32-bit floats, some tiles at a time: all threads compress them, then they are written.

use exr::block::{self, UncompressedBlock, writer::ChunksWriter};
use exr::meta::attribute::{ChannelDescription, SampleType};
use exr::meta::header::{Header, LayerAttributes};
use rayon::prelude::*;

use super::failure::Failure;
use super::sink::{Sink, Trouble};
use crate::film::Image;

/// Width and height of a tile.
const TILE: u64 = 64;
/// Tiles that each thread gets at once.
const TILES_A_THREAD: usize = 4;

fn tiles(width: u32, height: u32) -> u64 {
    u64::from(width).div_ceil(TILE) * u64::from(height).div_ceil(TILE)
}

/// What [`write()`] allocates, in bytes, or a little less.
pub(super) fn room(width: u32, height: u32, has_alpha: bool) -> u64 {
    let tile = TILE * TILE * if has_alpha { 16 } else { 12 };
    let threads = rayon::current_num_threads() as u64;
    // A tile, its bytes in another order, compressed, and as it is kept. Each has a place in the table of offsets.
    4 * tile * threads * TILES_A_THREAD as u64 + 24 * tiles(width, height)
}

/// The bytes of a file none of whose tiles can be compressed.
pub(super) fn most(width: u32, height: u32, has_alpha: bool) -> u64 {
    let pixels = u64::from(width) * u64::from(height);
    // A tile has a head of 20 bytes and a place in the table of offsets.
    pixels * if has_alpha { 16 } else { 12 } + 28 * tiles(width, height) + 1000
}

/// Writes the image. `OpenEXR`'s colours are premultiplied, as ours.
pub(super) fn write(image: &Image, sink: Sink<'_>, trouble: &Trouble) -> Result<(), Failure> {
    // A file's channels are in the order of the alphabet; each is where its letter is in a colour.
    let channels: &[(&str, usize)] = match image.alpha() {
        Some(_) => &[("A", 3), ("B", 2), ("G", 1), ("R", 0)],
        None => &[("B", 2), ("G", 1), ("R", 0)],
    };
    let descriptions = channels
        .iter()
        .map(|(name, _)| ChannelDescription::named(*name, SampleType::F32))
        .collect();
    let size = (image.width() as usize, image.height() as usize);
    // Run-length encoding, tiles of 64 × 64, in any order.
    let header =
        Header::new("".into(), size, descriptions).with_attributes(LayerAttributes::default());
    let headers = std::iter::once(header).collect();
    block::write(sink, headers, true, |meta, writer| {
        let mut order = block::enumerate_ordered_header_block_indices(&meta.headers);
        let at_once = TILES_A_THREAD * rayon::current_num_threads();
        loop {
            let batch: Vec<_> = order.by_ref().take(at_once).collect();
            if batch.is_empty() || trouble.get().is_some() {
                // Whoever made the sink knows what the trouble is.
                return Ok(());
            }
            let chunks: Vec<_> = batch
                .into_par_iter()
                .map(|(at, index)| {
                    let channel_list = &meta.headers[0].channels;
                    let block = UncompressedBlock::from_lines(channel_list, index, |line| {
                        let (_, channel) = channels[line.location.channel];
                        let from = line.location.position;
                        let first = from.y() * size.0 + from.x();
                        put_line(image, first, channel, line.value);
                    });
                    Ok((at, block.compress_to_chunk(&meta.headers)?))
                })
                .collect::<exr::error::Result<_>>()?;
            for (at, chunk) in chunks {
                writer.write_chunk(at, chunk)?;
            }
        }
    })?;
    Ok(())
}

/// One channel of the pixels from the one with the index `first` on, as bytes in the machine's order.
fn put_line(image: &Image, first: usize, channel: usize, bytes: &mut [u8]) {
    let (floats, _) = bytes.as_chunks_mut::<4>();
    match image.alpha() {
        Some(alpha) if channel == 3 => {
            for (bytes, alpha) in floats.iter_mut().zip(&alpha[first..]) {
                *bytes = alpha.to_ne_bytes();
            }
        }
        _ => {
            for (bytes, pixel) in floats.iter_mut().zip(&image.pixels()[first..]) {
                *bytes = pixel.color()[channel].to_ne_bytes();
            }
        }
    }
}

impl From<exr::error::Error> for Failure {
    fn from(error: exr::error::Error) -> Self {
        match error {
            exr::error::Error::Io(error) => Self::Io(error),
            other => Self::Encoding(other.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use glam::Vec3;
    use spherule_kernel::{Pixel, Shading};
    use std::cell::OnceCell;
    use std::io::{BufReader, Read, Seek};

    /// Bit for bit, with opacities and without, whether tiles are whole or cut off.
    #[test]
    fn pixels_are_those_of_the_image() {
        let mut random = Random::new(7);
        for (width, height) in [(1, 1), (64, 128), (130, 70)] {
            for has_alpha in [false, true] {
                let count = (width * height) as usize;
                let mut color = || random.vec3(-1.0, 1e6);
                let pixels: Vec<Pixel> = (0..count).map(|_| Pixel::new(color(), 1.0)).collect();
                let alpha: Vec<f32> = (0..count).map(|_| color().x).collect();
                let mut image =
                    Image::new(width, height, Shading::Lit, pixels.clone()).expect("an image");
                if has_alpha {
                    image.set_alpha(alpha.clone()).expect("one for each");
                }
                let mut file = tempfile::tempfile().expect("a file");
                let trouble = OnceCell::new();
                assert!(write(&image, Sink::new(&mut file, &trouble), &trouble).is_ok());
                file.rewind().expect("its start");
                let mut bytes = Vec::new();
                BufReader::new(file).read_to_end(&mut bytes).expect("bytes");
                assert!(bytes.len() as u64 <= most(width, height, has_alpha));
                let decoded = ::image::load_from_memory(&bytes).expect("an EXR");
                let decoded = decoded.into_rgba32f();
                for (index, found) in decoded.pixels().enumerate() {
                    let [red, green, blue, opacity] = found.0;
                    assert_eq!(Vec3::new(red, green, blue), pixels[index].color());
                    assert_eq!(opacity, if has_alpha { alpha[index] } else { 1.0 });
                }
            }
        }
    }
}
