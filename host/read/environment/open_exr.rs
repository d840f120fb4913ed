//! `.exr` files: scan lines or tiles, of the first part that has R, G and B, at full resolution.
//! The image is the display window; the data window fills a part of it.

use std::io::{BufRead, Seek};

use exr::block::UncompressedBlock;
use exr::block::chunk::{Chunk, CompressedBlock};
use exr::block::reader::ChunksReader;
use exr::compression::Compression;
use exr::math::Vec2;
use exr::meta::attribute::{ChannelList, SampleType};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::f16;
use glam::Vec3;
use rayon::prelude::*;

use super::{Wrong, guarded, room_for};
use crate::scene::limits::MAX_TEXELS;
use crate::scene::surroundings::EnvironmentImage;

/// The most bytes that all channels of the part decode to: those of the most texels with four
/// channels of 32 bits.
const MAX_DECODED: u64 = 16 * MAX_TEXELS;
/// The most bytes that one block decodes to.
const MAX_BLOCK: u64 = 1 << 29;
/// The display window is at most this many times as large as the data window; the rest is black.
const MAX_MARGIN: u64 = 16;
/// Bytes of blocks that are decoded together, on all threads.
const AT_ONCE: u64 = 1 << 26;

pub(super) fn decode(file: impl BufRead + Seek, length: u64) -> Result<EnvironmentImage, Wrong> {
    let reader = guarded(|| exr::block::read(file, false).map_err(Wrong::damaged))?;
    let (part, header) = with_rgb(reader.headers())?;
    let header = header.clone();
    check(&header, length)?;
    let window = header.shared_attributes.display_window;
    let mut canvas = Canvas::new(&header)?;

    let chunks = guarded(|| {
        let chunks = reader.filter_chunks(false, |_, tile, block| {
            block.layer == part && tile.level_index == Vec2(0, 0)
        });
        chunks.map_err(Wrong::damaged)
    })?;
    let meta = chunks.meta_data().clone();
    let mut chunks = chunks.into_iter();
    let block_bytes = max_block_bytes(&header).unwrap_or(MAX_BLOCK).max(1);
    let at_once = (AT_ONCE / block_bytes).max(1) as usize;
    loop {
        let some = guarded(|| {
            let some = chunks.by_ref().take(at_once);
            some.collect::<exr::error::Result<Vec<Chunk>>>()
                .map_err(Wrong::damaged)
        })?;
        if some.is_empty() {
            break;
        }
        let blocks: Vec<UncompressedBlock> = some
            .into_par_iter()
            .map(|chunk| guarded(|| decompress(chunk, &meta, part)))
            .collect::<Result<_, Wrong>>()?;
        for block in blocks {
            guarded(|| canvas.put(&block))?;
        }
    }
    Ok(EnvironmentImage {
        width: window.size.width() as u32,
        height: window.size.height() as u32,
        texels: canvas.texels,
    })
}

/// The first part that is not deep and has R, G and B.
fn with_rgb(headers: &[Header]) -> Result<(usize, &Header), Wrong> {
    let part = headers
        .iter()
        .position(|header| !header.deep && rgb(&header.channels).is_some());
    if let Some(part) = part {
        return Ok((part, &headers[part]));
    }
    let names = headers.iter().flat_map(|header| &header.channels.list);
    let names: Vec<String> = names.map(|channel| channel.name.to_string()).collect();
    Err(Wrong::new(
        format!("has no channels R, G and B, but {}", names.join(", ")),
        "write the image as red, green and blue, neither deep nor in luminance and chroma",
    ))
}

/// The positions of R, G and B among the channels.
fn rgb(channels: &ChannelList) -> Option<[usize; 3]> {
    let place = |name: &str| {
        channels
            .list
            .iter()
            .position(|channel| channel.name.eq(name))
    };
    Some([place("R")?, place("G")?, place("B")?])
}

/// An upper bound on the compression ratio; `None` for a compression that is not supported.
fn max_ratio(compression: Compression) -> Option<u64> {
    // Deflate's limit is 1032 (258 bytes for two bits).
    const DEFLATE: u64 = 1032;
    match compression {
        Compression::Uncompressed => Some(1),
        // 128 bytes for two bytes.
        Compression::RLE => Some(64),
        Compression::ZIP1 | Compression::ZIP16 => Some(DEFLATE),
        // The lowest of four bytes is dropped.
        Compression::PXR24 => Some(DEFLATE * 4 / 3),
        // 255 numbers of 16 bits for a bit and a count of eight bits.
        Compression::PIZ => Some(512),
        // 16 numbers of 16 bits for three bytes.
        Compression::B44 | Compression::B44A => Some(11),
        // One number of 16 bits, deflated, for 8 × 8 texels of two or four bytes each.
        Compression::DWAA(_) | Compression::DWAB(_) => Some(DEFLATE * 128),
        Compression::HTJ2K32 | Compression::HTJ2K256 => None,
    }
}

/// The most bytes that a block decodes to; `None` if they exceed 64 bits.
fn max_block_bytes(header: &Header) -> Option<u64> {
    let size = header.layer_size;
    let texels = match header.blocks {
        BlockDescription::ScanLines => {
            let lines = header.compression.scan_lines_per_block().min(size.height());
            size.width().checked_mul(lines)
        }
        BlockDescription::Tiles(tiles) => {
            let tile = tiles.tile_size;
            tile.width().checked_mul(tile.height())
        }
    };
    (texels? as u64).checked_mul(header.channels.bytes_per_pixel as u64)
}

/// Checks the header before anything is decoded.
fn check(header: &Header, length: u64) -> Result<(), Wrong> {
    let compression = header.compression;
    let Some(ratio) = max_ratio(compression) else {
        return Err(Wrong::new(
            format!("its compression is not supported: {compression}"),
            "write the image with zip, piz or no compression",
        ));
    };
    let channels = &header.channels;
    let [r, g, b] = rgb(channels).unwrap_or_default();
    for place in [r, g, b] {
        let channel = &channels.list[place];
        if channel.sample_type == SampleType::U32 {
            return Err(Wrong::new(
                format!(
                    "its channel {} holds whole numbers, not light",
                    channel.name
                ),
                "write the image as 16-bit or 32-bit floats",
            ));
        }
    }
    if channels
        .list
        .iter()
        .any(|channel| channel.sampling != Vec2(1, 1))
    {
        return Err(Wrong::new(
            "has channels with fewer samples than texels",
            "write the image with one sample for each texel in each channel",
        ));
    }

    let (width, height) = (header.layer_size.width(), header.layer_size.height());
    let texels = (width as u64).checked_mul(height as u64);
    let texels = texels.filter(|texels| *texels <= MAX_TEXELS);
    let decoded = texels.and_then(|texels| texels.checked_mul(channels.bytes_per_pixel as u64));
    let Some(decoded) = decoded.filter(|decoded| *decoded <= MAX_DECODED) else {
        return Err(Wrong::new(
            format!(
                "its data window claims {width} × {height} texels of {} bytes, more than {MAX_TEXELS} texels of 16",
                channels.bytes_per_pixel
            ),
            "use a smaller image of the surroundings, with R, G and B only",
        ));
    };
    // A table has the position of each block, in eight bytes.
    let table = (header.chunk_count as u64).saturating_mul(8);
    if decoded > ratio.saturating_mul(length) || table > length {
        return Err(Wrong::new(
            format!(
                "claims {width} × {height} texels in {} blocks, which {length} bytes cannot hold with {compression}",
                header.chunk_count
            ),
            "the file is damaged or cut short: get or write it again",
        ));
    }
    let window = header.shared_attributes.display_window.size;
    let shown = (window.width() as u64).checked_mul(window.height() as u64);
    if shown.is_none_or(|shown| shown / MAX_MARGIN > texels.unwrap_or(0)) {
        return Err(Wrong::new(
            format!(
                "its display window of {} × {} texels is almost empty: the data window has {width} × {height}",
                window.width(),
                window.height()
            ),
            "write the image with a display window that its texels fill",
        ));
    }
    if max_block_bytes(header).is_none_or(|bytes| bytes > MAX_BLOCK) {
        return Err(Wrong::new(
            format!("its blocks are larger than {MAX_BLOCK} bytes"),
            "write the image in scan lines or in smaller tiles",
        ));
    }
    Ok(())
}

/// Decodes a chunk.
fn decompress(chunk: Chunk, meta: &MetaData, part: usize) -> Result<UncompressedBlock, Wrong> {
    let header = &meta.headers[part];
    if chunk.layer_index != part {
        return Err(Wrong::damaged("a block belongs to another part"));
    }
    if matches!(
        header.compression,
        Compression::DWAA(_) | Compression::DWAB(_)
    ) {
        check_dwa(
            &chunk.compressed_block,
            max_block_bytes(header).unwrap_or(0),
        )?;
    }
    UncompressedBlock::decompress_chunk(chunk, meta, false).map_err(Wrong::damaged)
}

/// Checks the lengths of the four streams with which a DWA block starts: the decoder allocates
/// memory for them without checking.
fn check_dwa(block: &CompressedBlock, bytes: u64) -> Result<(), Wrong> {
    let (CompressedBlock::ScanLine(exr::block::chunk::CompressedScanLineBlock {
        compressed_pixels_le: data,
        ..
    })
    | CompressedBlock::Tile(exr::block::chunk::CompressedTileBlock {
        compressed_pixels_le: data,
        ..
    })) = block
    else {
        return Ok(());
    };
    let length = |place: usize| {
        let at = 8 * place;
        let bytes = data.get(at..at + 8)?;
        Some(u64::from_le_bytes(bytes.try_into().ok()?))
    };
    // Lengths of uncompressed streams: other channels, runs and what they expand to; and numbers of
    // 16 bits. None is longer than the block, except for the overhead of small ones.
    let fits = |place, size: u64| {
        let length: Option<u64> = length(place);
        length.is_some_and(|length| length.saturating_mul(size) <= 2 * bytes + 4096)
    };
    let plain = data.len() as u64 == bytes;
    if plain || fits(1, 1) && fits(6, 1) && fits(7, 1) && fits(8, 2) && fits(9, 2) {
        return Ok(());
    }
    Err(Wrong::damaged("a block claims more than it can hold"))
}

/// The texels of the display window.
struct Canvas {
    texels: Vec<Vec3>,
    width: i64,
    height: i64,
    /// The offset of the data window in the display window.
    offset: [i64; 2],
    channels: ChannelList,
    rgb: [usize; 3],
}

impl Canvas {
    fn new(header: &Header) -> Result<Self, Wrong> {
        let window = header.shared_attributes.display_window;
        let data = header.own_attributes.layer_position;
        let (width, height) = (window.size.width(), window.size.height());
        let apart = |data: i32, window: i32| i64::from(data) - i64::from(window);
        Ok(Self {
            texels: room_for(width as u64, height as u64)?,
            width: width as i64,
            height: height as i64,
            offset: [
                apart(data.x(), window.position.x()),
                apart(data.y(), window.position.y()),
            ],
            channels: header.channels.clone(),
            rgb: rgb(&header.channels).unwrap_or_default(),
        })
    }

    fn put(&mut self, block: &UncompressedBlock) -> Result<(), Wrong> {
        for line in block.lines(&self.channels) {
            let Some(color) = self
                .rgb
                .iter()
                .position(|place| *place == line.location.channel)
            else {
                continue;
            };
            let row = line.location.position.y() as i64 + self.offset[1];
            if !(0..self.height).contains(&row) {
                continue;
            }
            let start = line.location.position.x() as i64 + self.offset[0];
            // The part of the line that is inside the window.
            let first = (-start).max(0);
            let count = line.location.sample_count as i64;
            let end = count.min(self.width - start);
            if first >= end {
                continue;
            }
            let at = (row * self.width + start + first) as usize;
            let texels = self.texels[at..].iter_mut();
            let skipped = first as usize;
            let wanted = (end - first) as usize;
            match self.channels.list[line.location.channel].sample_type {
                SampleType::F16 => {
                    let samples = line.value.as_chunks().0.iter().skip(skipped).take(wanted);
                    for (texel, sample) in texels.zip(samples) {
                        texel[color] = f16::from_ne_bytes(*sample).to_f32();
                    }
                }
                SampleType::F32 => {
                    let samples = line.value.as_chunks().0.iter().skip(skipped).take(wanted);
                    for (texel, sample) in texels.zip(samples) {
                        texel[color] = f32::from_ne_bytes(*sample);
                    }
                }
                // The header check rejects these.
                SampleType::U32 => {}
            }
        }
        Ok(())
    }
}
