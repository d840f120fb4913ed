//! Radiance's `.hdr` files: a header in text, then rows with shared exponents, run-length encoded.

use std::io::BufRead;

use image::ImageDecoder;
use image::codecs::hdr::HdrDecoder;

use super::{Wrong, guarded, room_for};
use crate::scene::surroundings::EnvironmentImage;

/// The fewest bytes of a row: one texel, for any width. Runs of the old kind have no limit.
const MIN_ROW: u64 = 4;

pub(super) fn decode(file: impl BufRead, length: u64) -> Result<EnvironmentImage, Wrong> {
    guarded(|| {
        // Many files start with #?RGBE, which only the lenient reader accepts.
        let decoder = HdrDecoder::new_nonstrict(file).map_err(Wrong::damaged)?;
        let (width, height) = decoder.dimensions();
        let mut texels = room_for(width.into(), height.into())?;
        if u64::from(height) * MIN_ROW > length {
            return Err(Wrong::damaged(format_args!(
                "{height} rows do not fit into {length} bytes"
            )));
        }
        decoder
            .read_image(bytemuck::cast_slice_mut(&mut texels))
            .map_err(Wrong::damaged)?;
        Ok(EnvironmentImage {
            width,
            height,
            texels,
        })
    })
}
