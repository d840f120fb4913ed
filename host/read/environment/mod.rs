//! Reads images of the surroundings: equirectangular, as `.hdr` or `.exr` files.
//!
//! A file's header is checked before memory is allocated or anything is decoded: the size that it
//! claims must be within [`MAX_TEXELS`], and possible for a file of its length.

mod open_exr;
mod radiance;

use std::cell::Cell;
use std::fs::File;
use std::io::{self, BufReader, Cursor, Read, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use glam::Vec3;
use rayon::prelude::*;

use crate::error::{Error, Result, SceneError};
use crate::scene::limits::{MAX_TEXELS, RADIANCE};
use crate::scene::surroundings::EnvironmentImage;

/// Bytes of a file that are read at once.
const BUFFER: usize = 1 << 20;
/// The most bytes of a pipe or another stream: the largest image, uncompressed.
const MAX_STREAM: u64 = 16 * MAX_TEXELS;

/// A channel of a texel that is below zero by less than this is taken as zero: lossy compression
/// and resampling produce such values where there is no light.
const RINGING: f32 = 1e-3;

/// Reads the image at `path` and multiplies it by `strength`.
///
/// # Errors
///
/// [`Error::Scene`] if it cannot be read, is too large, or holds values that are not light.
pub fn load(path: &Path, strength: f32) -> Result<EnvironmentImage> {
    let in_file =
        |wrong: Wrong| Error::Scene(SceneError::without_place(path, wrong.message, wrong.help));
    let mut image = open(path).and_then(decode).map_err(in_file)?;
    multiply(&mut image, strength).map_err(in_file)?;
    Ok(image)
}

/// What is wrong with an image, and how to fix it.
struct Wrong {
    message: String,
    help: String,
}

impl Wrong {
    fn new(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            help: help.into(),
        }
    }

    /// The error for a damaged file, with a decoder's message.
    fn damaged(reason: impl std::fmt::Display) -> Self {
        Self::new(
            format!("cannot be decoded: {reason}"),
            "the file is damaged or cut short: get or write it again",
        )
    }
}

trait Source: Read + Seek {}
impl<T: Read + Seek> Source for T {}

/// A file that can be read anywhere, and its length in bytes.
struct Opened {
    file: BufReader<Box<dyn Source>>,
    length: u64,
}

fn open(path: &Path) -> Result<Opened, Wrong> {
    let wrong = |error: io::Error| match error.kind() {
        io::ErrorKind::IsADirectory => Wrong::new("is a directory", "name an image"),
        _ => Wrong::new(
            format!("cannot be opened: {error}"),
            "a relative name starts from the scene's directory",
        ),
    };
    let mut file = File::open(path).map_err(wrong)?;
    let metadata = file.metadata().map_err(wrong)?;
    if metadata.is_dir() {
        return Err(wrong(io::ErrorKind::IsADirectory.into()));
    }
    let (file, length): (Box<dyn Source>, u64) = if metadata.is_file() {
        (Box::new(file), metadata.len())
    } else {
        let mut bytes = Vec::new();
        let read = file.by_ref().take(MAX_STREAM + 1).read_to_end(&mut bytes);
        let length = read.map_err(wrong)? as u64;
        if length > MAX_STREAM {
            return Err(Wrong::new(
                format!("has more than {MAX_STREAM} bytes, and no end yet"),
                "give an image in a file",
            ));
        }
        (Box::new(Cursor::new(bytes)), length)
    };
    Ok(Opened {
        file: BufReader::with_capacity(BUFFER, file),
        length,
    })
}

fn decode(mut opened: Opened) -> Result<EnvironmentImage, Wrong> {
    let mut start = [0; 4];
    let is_whole = opened.file.read_exact(&mut start).is_ok();
    opened.file.rewind().map_err(Wrong::damaged)?;
    match start {
        [0x76, 0x2f, 0x31, 0x01] if is_whole => open_exr::decode(opened.file, opened.length),
        [b'#', b'?', _, _] if is_whole => radiance::decode(opened.file, opened.length),
        _ => Err(Wrong::new(
            "is not an image that spherule reads",
            "give an equirectangular image as .hdr or .exr",
        )),
    }
}

/// Allocates this many texels, all black.
fn room_for(width: u64, height: u64) -> Result<Vec<Vec3>, Wrong> {
    let help = "use a smaller image of the surroundings";
    if width == 0 || height == 0 {
        return Err(Wrong::new(
            format!("has {width} × {height} texels"),
            "give an image that shows something",
        ));
    }
    let count = width
        .checked_mul(height)
        .filter(|count| *count <= MAX_TEXELS);
    let Some(count) = count else {
        return Err(Wrong::new(
            format!("claims {width} × {height} texels, more than {MAX_TEXELS}"),
            help,
        ));
    };
    // The system provides the zeros: no memory is used before texels are written.
    bytemuck::allocation::try_zeroed_vec(count as usize).map_err(|()| {
        let bytes = count * size_of::<Vec3>() as u64;
        Wrong::new(
            format!(
                "has {width} × {height} texels, and there is no memory for their {bytes} bytes"
            ),
            help,
        )
    })
}

/// Multiplies the texels, and fails for values that are not light.
fn multiply(image: &mut EnvironmentImage, strength: f32) -> Result<(), Wrong> {
    let width = image.width as usize;
    let wrong = image
        .texels
        .par_chunks_mut(width)
        .enumerate()
        .find_map_first(|(row, texels)| {
            texels.iter_mut().enumerate().find_map(|(column, texel)| {
                for channel in texel.as_mut() {
                    if (-RINGING..0.0).contains(channel) {
                        *channel = 0.0;
                    }
                }
                let light = *texel * strength;
                let is_light = RADIANCE.holds_all(light) && texel.is_finite();
                let was = std::mem::replace(texel, light);
                (!is_light).then_some((row, column, was))
            })
        });
    let Some((row, column, texel)) = wrong else {
        return Ok(());
    };
    let at = format!("the texel in column {column} of row {row} is {texel}");
    Err(if texel.is_finite() && texel.min_element() >= 0.0 {
        Wrong::new(
            format!("{at}, times a strength of {strength:e}"),
            format!(
                "give a smaller strength: the product is at most {:e}",
                RADIANCE.high
            ),
        )
    } else {
        Wrong::new(at, "light must be finite and not negative: fix the image")
    })
}

thread_local! {
    static IS_DECODING: Cell<bool> = const { Cell::new(false) };
}

/// Whether this thread is inside a decoder whose panic will be caught and reported as an [`Error`].
/// A panic hook can then stay silent.
#[must_use]
pub fn is_decoding() -> bool {
    IS_DECODING.get()
}

/// Calls `decode`, and turns a panic into an error: decoders from other crates are given files of
/// unknown origin, and a damaged image is not a bug in this program.
fn guarded<T>(decode: impl FnOnce() -> Result<T, Wrong>) -> Result<T, Wrong> {
    let before = IS_DECODING.replace(true);
    // Whatever the closure leaves half done is dropped.
    let decoded = catch_unwind(AssertUnwindSafe(decode));
    IS_DECODING.set(before);
    decoded.unwrap_or_else(|_| Err(Wrong::damaged("its decoder panicked")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use exr::prelude::*;
    use std::time::{Duration, Instant};

    const WIDTH: usize = 40;
    const HEIGHT: usize = 24;

    /// Half floats, so that all lossless compressions preserve them.
    fn color(x: usize, y: usize) -> Vec3 {
        Vec3::new(0.5, x as f32 / 32.0, y as f32 / 32.0)
    }

    fn load_bytes(bytes: &[u8]) -> crate::error::Result<EnvironmentImage> {
        let file = tempfile::NamedTempFile::new().expect("a file");
        std::fs::write(file.path(), bytes).expect("bytes");
        load(file.path(), 1.0)
    }

    fn refusal(bytes: &[u8]) -> String {
        let error = load_bytes(bytes).expect_err("a refusal");
        assert!(error.is_input() && !error.help().is_empty(), "{error}");
        error.to_string()
    }

    fn encoded(compression: Compression, blocks: Blocks) -> Vec<u8> {
        let encoding = Encoding {
            compression,
            blocks,
            line_order: LineOrder::Increasing,
        };
        let channels = SpecificChannels::rgb(|at: Vec2<usize>| {
            let color = color(at.x(), at.y()).to_array().map(f16::from_f32);
            (color[0], color[1], color[2])
        });
        let size = (WIDTH, HEIGHT);
        let layer = Layer::new(size, LayerAttributes::default(), encoding, channels);
        let mut bytes = Cursor::new(Vec::new());
        let image = Image::from_layer(layer);
        image.write().to_buffered(&mut bytes).expect("an image");
        bytes.into_inner()
    }

    fn plain() -> Vec<u8> {
        encoded(Compression::Uncompressed, Blocks::ScanLines)
    }

    /// Replaces a window in the header: the smallest x and y, then the largest.
    fn with_window(mut bytes: Vec<u8>, name: &str, window: [i32; 4]) -> Vec<u8> {
        // Renames this key: the number of blocks then follows from the window.
        if let Some(at) = bytes.windows(10).position(|w| w == b"chunkCount") {
            bytes[at] = b'x';
        }
        let key = [name.as_bytes(), b"\0box2i\0\x10\0\0\0"].concat();
        let places: Vec<usize> = (0..bytes.len())
            .filter(|at| bytes[*at..].starts_with(&key))
            .collect();
        for at in places {
            for (index, number) in window.iter().enumerate() {
                let at = at + key.len() + 4 * index;
                bytes[at..at + 4].copy_from_slice(&number.to_le_bytes());
            }
        }
        bytes
    }

    #[test]
    fn every_compression_and_tiles_are_read() {
        let tiles = Blocks::Tiles(Vec2(16, 16));
        for (compression, blocks, tolerance) in [
            (Compression::Uncompressed, Blocks::ScanLines, 0.0),
            (Compression::RLE, Blocks::ScanLines, 0.0),
            (Compression::ZIP1, Blocks::ScanLines, 0.0),
            (Compression::ZIP16, tiles, 0.0),
            (Compression::PIZ, Blocks::ScanLines, 0.0),
            (Compression::PXR24, tiles, 0.0),
            (Compression::B44, Blocks::ScanLines, 0.1),
            (Compression::B44A, Blocks::ScanLines, 0.1),
            (Compression::DWAA(None), Blocks::ScanLines, 0.1),
            (Compression::DWAB(None), Blocks::ScanLines, 0.1),
        ] {
            let image = load_bytes(&encoded(compression, blocks)).expect("an image");
            assert_eq!((image.width, image.height), (WIDTH as u32, HEIGHT as u32));
            for (index, texel) in image.texels.iter().enumerate() {
                let expected = color(index % WIDTH, index / WIDTH);
                let off = (*texel - expected).abs().max_element();
                assert!(
                    off <= tolerance,
                    "{compression} {index}: {texel} {expected}"
                );
            }
        }
    }

    #[test]
    fn the_image_is_the_display_window() {
        let (w, h) = (WIDTH as i32, HEIGHT as i32);
        // Two columns to the left of the data and one row below it; the other data are outside.
        let bytes = with_window(plain(), "displayWindow", [-2, 3, w - 6, h]);
        let image = load_bytes(&bytes).expect("an image");
        assert_eq!(
            (image.width, image.height),
            (WIDTH as u32 - 3, HEIGHT as u32 - 2)
        );
        for (index, texel) in image.texels.iter().enumerate() {
            let x = index as i32 % image.width as i32 - 2;
            let y = index as i32 / image.width as i32 + 3;
            let expected = if x < 0 || y >= h {
                Vec3::ZERO
            } else {
                color(x as usize, y as usize)
            };
            assert_eq!(*texel, expected, "{x} {y}");
        }
        let outside = with_window(plain(), "displayWindow", [100, 100, 139, 123]);
        assert!(
            load_bytes(&outside)
                .expect("an image")
                .texels
                .iter()
                .all(|t| *t == Vec3::ZERO)
        );
    }

    #[test]
    fn what_a_header_claims_is_refused_before_it_is_made_room_for() {
        let start = Instant::now();
        for (bytes, word) in [
            (
                &include_bytes!("../../../tests/inputs/sky_dwa_huge_window.exr")[..],
                "20000000 × 256",
            ),
            (
                &include_bytes!("../../../tests/inputs/sky_dwa_slow.exr")[..],
                "1000000 × 2560",
            ),
        ] {
            assert!(refusal(bytes).contains(word), "{}", refusal(bytes));
        }
        let huge = [0, 0, 99_999, 99_999];
        let refusal_of_huge = refusal(&with_window(plain(), "dataWindow", huge));
        assert!(
            refusal_of_huge.contains("100000 × 100000"),
            "{refusal_of_huge}"
        );
        // Within the limit, but more than the file can hold.
        for compression in [
            Compression::ZIP16,
            Compression::DWAA(None),
            Compression::PIZ,
        ] {
            let bytes = encoded(compression, Blocks::ScanLines);
            let bytes = with_window(bytes, "dataWindow", [0, 0, 16383, 8191]);
            assert!(
                refusal(&bytes).contains("cannot hold"),
                "{}",
                refusal(&bytes)
            );
        }
        let bytes = with_window(plain(), "displayWindow", [0, 0, 16383, 8191]);
        assert!(refusal(&bytes).contains("almost empty"));
        for (header, word) in [
            ("-Y 60000 +X 60000", "more than"),
            ("-Y 4294967295 +X 4294967295", "too large"),
            ("-Y 1000000 +X 10", "do not fit"),
            ("-Y 0 +X 10", "10 × 0"),
            ("-Y 10 +X -10", "width dimension"),
            ("+X 10 -Y 10", "Orientation"),
            ("", "line too short"),
        ] {
            let file = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{header}\nxxxxxxxx");
            let refusal = refusal(file.as_bytes());
            assert!(refusal.contains(word), "{header}: {refusal}");
        }
        // It could have taken minutes and gigabytes.
        assert!(start.elapsed() < Duration::from_secs(20));
    }

    #[test]
    fn streams_of_dwa_are_no_longer_than_their_block() {
        let bytes = encoded(Compression::DWAA(None), Blocks::ScanLines);
        // A block starts with its version, 2, and ten lengths.
        let version = 2_u64.to_le_bytes();
        let start = bytes.windows(8).rposition(|w| w == version);
        for place in [1, 6, 7, 8, 9] {
            let at = start.expect("a block") + 8 * place;
            let mut hostile = bytes.clone();
            hostile[at..at + 8].copy_from_slice(&(1_u64 << 45).to_le_bytes());
            let refusal = refusal(&hostile);
            assert!(refusal.contains("claims more"), "{place}: {refusal}");
        }
    }

    /// A layer of 2 × 2 texels with these channels.
    fn layer(channels: &[(&str, FlatSamples)]) -> Layer<AnyChannels<FlatSamples>> {
        let channels = channels
            .iter()
            .map(|(name, samples)| AnyChannel::new(*name, samples.clone()));
        Layer::new(
            (2, 2),
            LayerAttributes::named(channels.clone().count().to_string().as_str()),
            Encoding::UNCOMPRESSED,
            AnyChannels::sort(channels.collect()),
        )
    }

    fn bytes_of(layers: Vec<Layer<AnyChannels<FlatSamples>>>) -> Vec<u8> {
        let size = IntegerBounds::from_dimensions((2, 2));
        let mut bytes = Cursor::new(Vec::new());
        let image = Image::from_layers(ImageAttributes::new(size), layers);
        image.write().to_buffered(&mut bytes).expect("an image");
        bytes.into_inner()
    }

    #[test]
    fn what_is_no_light_is_refused() {
        let floats = |last: f32| FlatSamples::F32(vec![0.5, 0.5, 0.5, last]);
        let with = |last| {
            bytes_of(vec![layer(&[
                ("R", floats(0.5)),
                ("G", floats(last)),
                ("B", floats(0.5)),
            ])])
        };
        assert_eq!(load_bytes(&with(0.25)).expect("an image").texels[3].y, 0.25);
        assert_eq!(load_bytes(&with(-1e-4)).expect("an image").texels[3].y, 0.0);
        for last in [f32::NAN, f32::INFINITY, -1e-2, 1e16] {
            let refusal = refusal(&with(last));
            assert!(refusal.contains("column 1 of row 1"), "{refusal}");
        }
        let y = bytes_of(vec![layer(&[("Y", floats(0.5)), ("A", floats(0.5))])]);
        assert!(refusal(&y).contains("but A, Y"), "{}", refusal(&y));
        let whole = bytes_of(vec![layer(&[
            ("R", floats(0.5)),
            ("G", FlatSamples::U32(vec![1; 4])),
            ("B", floats(0.5)),
        ])]);
        assert!(refusal(&whole).contains("channel G holds whole numbers"));
        assert!(refusal(b"GIF89a").contains("not an image that spherule reads"));
        assert!(refusal(b"").contains("not an image that spherule reads"));
    }

    #[test]
    fn of_several_parts_the_first_with_red_green_and_blue_is_read() {
        let halves = |value| FlatSamples::F16(vec![f16::from_f32(value); 4]);
        let depth = layer(&[("Z", FlatSamples::F32(vec![9.0; 4]))]);
        let color = layer(&[
            ("A", halves(1.0)),
            ("B", halves(3.0)),
            ("G", halves(2.0)),
            ("R", halves(1.0)),
        ]);
        let image = load_bytes(&bytes_of(vec![depth, color])).expect("an image");
        assert_eq!(image.texels, [Vec3::new(1.0, 2.0, 3.0); 4]);
    }

    #[test]
    fn of_several_resolutions_the_largest_is_read() {
        let levels = |value: f32| Levels::Mip {
            rounding_mode: exr::math::RoundingMode::Down,
            level_data: [16, 4, 1]
                .map(|texels| FlatSamples::F32(vec![value * texels as f32; texels]))
                .to_vec(),
        };
        let channels = ["B", "G", "R"].map(|name| AnyChannel::new(name, levels(1.0)));
        let tiles = Encoding {
            blocks: Blocks::Tiles(Vec2(2, 2)),
            ..Encoding::UNCOMPRESSED
        };
        let channels = AnyChannels::sort(channels.into_iter().collect());
        let layer = Layer::new((4, 4), LayerAttributes::default(), tiles, channels);
        let mut bytes = Cursor::new(Vec::new());
        let image = Image::from_layer(layer);
        image.write().to_buffered(&mut bytes).expect("an image");
        let image = load_bytes(bytes.get_ref()).expect("an image");
        assert_eq!(image.texels, [Vec3::splat(16.0); 16]);
    }

    #[test]
    fn files_that_are_cut_short_are_refused() {
        let zip = encoded(Compression::ZIP16, Blocks::ScanLines);
        let radiance = b"#?RGBE\n\n-Y 1 +X 2\nabcdefgh";
        assert_eq!(load_bytes(radiance).expect("an image").texels.len(), 2);
        for whole in [&zip[..], &plain(), radiance] {
            for end in (0..whole.len()).step_by(5).chain([whole.len() - 1]) {
                let error = load_bytes(&whole[..end]).expect_err("a refusal");
                assert!(error.is_input(), "{end}: {error}");
            }
        }
    }

    /// Some bytes are changed: nothing panics, and nothing takes long.
    #[test]
    fn no_damage_breaks_the_reader() {
        let mut random = Random::new(3);
        let mut below = |count: usize| (random.within(0.0, count as f32) as usize).min(count - 1);
        let mut files: Vec<Vec<u8>> = [
            Compression::Uncompressed,
            Compression::RLE,
            Compression::ZIP1,
            Compression::ZIP16,
            Compression::PIZ,
            Compression::PXR24,
            Compression::B44,
            Compression::DWAA(None),
        ]
        .map(|compression| encoded(compression, Blocks::ScanLines))
        .to_vec();
        files.push(encoded(Compression::ZIP16, Blocks::Tiles(Vec2(16, 16))));
        files.push(b"#?RADIANCE\n\n-Y 2 +X 9\n\x02\x02\0\x09\x89a\x89b\x89c\x89\x80zzzz".to_vec());
        let start = Instant::now();
        let mut read = 0;
        for round in 0..600 {
            let mut bytes = files[round % files.len()].clone();
            for _ in 0..1 + below(4) {
                // Headers are short, and most effective.
                let end = if below(2) == 0 {
                    400.min(bytes.len())
                } else {
                    bytes.len()
                };
                bytes[below(end)] = [0, 1, 0x7f, 0x80, 0xff, below(256) as u8][below(6)];
            }
            match load_bytes(&bytes) {
                Ok(_) => read += 1,
                Err(error) => assert!(error.is_input(), "{error}"),
            }
        }
        assert!((1..600).contains(&read), "{read}");
        assert!(start.elapsed() < Duration::from_secs(300));
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_is_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let pipe = folder.path().join("sky");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.expect("mkfifo").success());
        std::thread::scope(|scope| {
            scope.spawn(|| std::fs::write(&pipe, plain()).expect("a reader"));
            assert_eq!(
                load(&pipe, 1.0).expect("an image").texels.len(),
                WIDTH * HEIGHT
            );
        });
        let error = load(folder.path(), 1.0).expect_err("a folder");
        assert!(error.to_string().contains("is a directory"));
    }
}
