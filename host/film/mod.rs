//! Images: what a render yields, how it becomes a file, and how two are compared.
//!
//! | module | holds |
//! | --- | --- |
//! | [`encode`] | from pixels to 8-bit colours |
//! | [`mod@file`] | PNG and EXR files, written whole or not at all |
//! | [`compare`] | the difference between two images |

pub mod compare;
pub mod encode;
pub mod file;

use spherule_kernel::{Pixel, Shading};

/// A rendered image: linear colours or measurements, row by row from the upper left.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    shading: Shading,
    pixels: Vec<Pixel>,
}

impl Image {
    /// An image of these pixels.
    ///
    /// # Panics
    ///
    /// If there are not `width × height` pixels.
    #[must_use]
    pub fn new(width: u32, height: u32, shading: Shading, pixels: Vec<Pixel>) -> Self {
        assert_eq!(pixels.len(), width as usize * height as usize);
        Self {
            width,
            height,
            shading,
            pixels,
        }
    }

    /// Width in pixels.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// What the colours mean.
    #[must_use]
    pub fn shading(&self) -> Shading {
        self.shading
    }

    /// The pixels, row by row from the upper left.
    #[must_use]
    pub fn pixels(&self) -> &[Pixel] {
        &self.pixels
    }

    /// The pixel in column `x` and row `y`, if there is one.
    #[must_use]
    pub fn pixel(&self, x: u32, y: u32) -> Option<&Pixel> {
        (x < self.width && y < self.height)
            .then(|| &self.pixels[y as usize * self.width as usize + x as usize])
    }
}
