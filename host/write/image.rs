//! Writes images to files, with memory reserved in advance.

use std::path::Path;

use super::failure::Failure;
use super::format::{Format, PURPOSE};
use super::output::Output;
use super::sink::Sink;
use super::{exr, png};
use crate::error::Result;
use crate::film::Image;
use crate::memory;

/// Memory that is reserved until an image is written, so that an image that took long is not lost
/// if there is none.
#[derive(Debug)]
pub struct ReservedMemory {
    /// Allocated but never touched; freed when the image is written.
    _bytes: Vec<u8>,
}

impl ReservedMemory {
    /// Reserves memory to write an image of `width` × `height` pixels, with or without opacities.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfHostMemory`](crate::Error::OutOfHostMemory) if the host does not have that
    /// much.
    pub fn reserve(format: Format, width: u32, height: u32, has_alpha: bool) -> Result<Self> {
        let encoder = match format {
            Format::Png => png::room(width, has_alpha),
            Format::Exr => exr::room(width, height, has_alpha),
        };
        let needed = encoder + Sink::BUFFER as u64;
        let bytes = memory::room(needed, PURPOSE)?;
        Ok(Self { _bytes: bytes })
    }
}

impl Image {
    /// Writes the image to `path`, in the format of its extension. The file appears whole or not at
    /// all.
    ///
    /// # Errors
    ///
    /// [`Error::OutputRefused`](crate::Error::OutputRefused) if the extension is unknown,
    /// [`Error::Output`](crate::Error::Output) if the file cannot be written,
    /// [`Error::OutOfHostMemory`](crate::Error::OutOfHostMemory) if there is no memory for its
    /// rows.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let output = Output::image(path.as_ref())?;
        let has_alpha = self.has_alpha();
        let format = Format::of(output.path())?;
        let room = ReservedMemory::reserve(format, self.width(), self.height(), has_alpha)?;
        self.save_to(&output, room)
    }

    /// Writes the image to `output`, in the format of its extension, with memory that was reserved
    /// for it.
    ///
    /// # Errors
    ///
    /// As [`Image::save`].
    pub(crate) fn save_to(&self, output: &Output, room: ReservedMemory) -> Result<()> {
        let format = Format::of(output.path())?;
        // From here on the memory is for the encoder.
        drop(room);
        output.fill(most(format, self), |sink, trouble| {
            if self.pixels().is_empty() {
                return Err(Failure::Encoding("it has no pixels".into()));
            }
            match format {
                Format::Png => png::write(self, sink, trouble),
                Format::Exr => exr::write(self, sink, trouble),
            }
        })
    }
}

/// The bytes of a file in this format that could not be compressed at all.
fn most(format: Format, image: &Image) -> u64 {
    let has_alpha = image.has_alpha();
    let pixels = match format {
        Format::Png => png::most(image.width(), image.height(), has_alpha),
        Format::Exr => exr::most(image.width(), image.height(), has_alpha),
    };
    pixels + image.remarks.len() as u64
}
