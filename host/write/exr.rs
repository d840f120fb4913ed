//! `OpenEXR`, 32-bit floats, some tiles at a time: all threads compress them, then they are
//! written.

use exr::block::{self, UncompressedBlock, writer::ChunksWriter};
use exr::meta::attribute::{ChannelDescription, SampleType, Text};
use exr::meta::header::{Header, LayerAttributes};
use rayon::prelude::*;
use spherule_kernel::Hit;
use spherule_kernel::shading::{Quantity, index_of};

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
    // A tile, its bytes in another order, compressed, and as it is kept. Each has a place in the
    // table of offsets.
    4 * tile * threads * TILES_A_THREAD as u64 + 24 * tiles(width, height)
}

/// The bytes of a file none of whose tiles can be compressed.
pub(super) fn most(width: u32, height: u32, has_alpha: bool) -> u64 {
    let pixels = u64::from(width) * u64::from(height);
    // A tile has a head of 20 bytes and a place in the table of offsets.
    pixels * if has_alpha { 16 } else { 12 } + 28 * tiles(width, height) + 1000
}

/// What a channel of a file holds of each pixel.
#[derive(Clone, Copy)]
enum Channel {
    /// A component of the colour.
    Color(usize),
    Alpha,
    /// A distance, infinite where nothing is hit.
    Distance,
    /// The index of a sphere, [`Hit::NONE_SPHERE`] where nothing is hit.
    Index,
}

/// The channels of a file by name, in the order of the alphabet, as a file has them.
fn channels(image: &Image) -> Vec<(&'static str, SampleType, Channel)> {
    let (float, whole) = (SampleType::F32, SampleType::U32);
    let mut channels = match image.shading().quantity() {
        Quantity::Light | Quantity::Color | Quantity::Vector => vec![
            ("B", float, Channel::Color(2)),
            ("G", float, Channel::Color(1)),
            ("R", float, Channel::Color(0)),
        ],
        Quantity::Distance => vec![("Z", float, Channel::Distance)],
        Quantity::Index => vec![("id", whole, Channel::Index)],
    };
    if image.has_alpha() {
        channels.insert(0, ("A", float, Channel::Alpha));
    }
    channels
}

/// Writes the image. `OpenEXR`'s colours are premultiplied, as ours.
pub(super) fn write(image: &Image, sink: Sink<'_>, trouble: &Trouble) -> Result<(), Failure> {
    let channels = channels(image);
    let descriptions = channels
        .iter()
        .map(|(name, sample_type, _)| ChannelDescription::named(*name, *sample_type))
        .collect();
    let size = (image.width() as usize, image.height() as usize);
    // Run-length encoding, tiles of 64 × 64, in any order.
    let attributes = LayerAttributes {
        comments: Some(image.remarks.as_str())
            .filter(|remarks| !remarks.is_empty())
            .and_then(Text::new_or_none),
        ..LayerAttributes::default()
    };
    let header = Header::new("".into(), size, descriptions).with_attributes(attributes);
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
                        let (_, _, channel) = channels[line.location.channel];
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

/// One channel of the pixels from the one with the index `first` on, as bytes in the machine's
/// order.
fn put_line(image: &Image, first: usize, channel: Channel, bytes: &mut [u8]) {
    let (words, _) = bytes.as_chunks_mut::<4>();
    let pixels = &image.pixels()[first..];
    for (at, (bytes, pixel)) in words.iter_mut().zip(pixels).enumerate() {
        let has_measured = pixel.is_hit() || image.shading().quantity().has_background();
        *bytes = match channel {
            Channel::Color(component) if has_measured => pixel.color()[component].to_ne_bytes(),
            Channel::Color(_) => 0.0_f32.to_ne_bytes(),
            Channel::Alpha => image.opacity(first + at).to_ne_bytes(),
            Channel::Distance if has_measured => pixel.color().x.to_ne_bytes(),
            Channel::Distance => f32::INFINITY.to_ne_bytes(),
            Channel::Index if has_measured => index_of(pixel.color()).to_ne_bytes(),
            Channel::Index => Hit::NONE_SPHERE.to_ne_bytes(),
        };
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

    /// The file says what the image's remarks are, and nothing else if there are none.
    #[test]
    fn remarks_are_comments() {
        for remarks in ["", "of 5 µm"] {
            let mut image =
                Image::new(1, 1, Shading::Lit, vec![Pixel::default()]).expect("an image");
            image.remarks = remarks.into();
            let mut file = tempfile::tempfile().expect("a file");
            let trouble = OnceCell::new();
            assert!(write(&image, Sink::new(&mut file, &trouble), &trouble).is_ok());
            file.rewind().expect("its start");
            let meta = exr::meta::MetaData::read_from_buffered(BufReader::new(file), true);
            let header = meta.expect("an EXR").headers.remove(0);
            let comments = header.own_attributes.comments.map(|text| text.to_string());
            let expected = Some(remarks.to_owned()).filter(|remarks| !remarks.is_empty());
            assert_eq!(comments, expected);
        }
    }
}
