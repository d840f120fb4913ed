//! Images: what a render yields, how it becomes a file, and how two are compared.
//!
//! | module | holds |
//! | --- | --- |
//! | [`encode`] | from pixels to 8-bit colours |
//! | [`compare`] | the difference between two images |
//! | [`agreement`] | whether that of light paths is chance |
//! | [`flip`] | that difference as somebody sees it |
//! | `denoise` | removes noise, by a library that the machine may have |

pub mod agreement;
pub mod compare;
#[cfg(feature = "denoise")]
pub mod denoise;
pub mod encode;
pub mod flip;

use std::path::PathBuf;

use bytemuck::Zeroable;
use spherule_kernel::{Pixel, Shading};

use crate::error::{Error, Result};
use crate::memory;
use crate::scene::Develop;

/// A rendered image: linear colours or measurements, row by row from the upper left.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    shading: Shading,
    pixels: Vec<Pixel>,
    /// How opaque each pixel is, from 0 to 1; empty if all are. Colours are premultiplied.
    alpha: Vec<f32>,
    /// How light becomes 8-bit colours; linear images are left as they are.
    pub develop: Develop,
    /// What a reader of the image should know of it; files hold it as a comment. Empty for nothing.
    pub remarks: String,
}

/// Room for what belongs to each pixel of an image, all of it zero. The system gives memory when it
/// is first written, and so to the threads that do.
///
/// # Errors
///
/// [`Error::OutOfHostMemory`] if the host has not that much.
pub fn allocate<T: Zeroable>(width: u32, height: u32) -> Result<Vec<T>> {
    memory::zeroed(
        u64::from(width) * u64::from(height),
        &format!("an image of {width} × {height} pixels"),
    )
}

impl Image {
    /// An image of these pixels.
    ///
    /// # Errors
    ///
    /// [`Error::Image`] if there are not `width × height` pixels.
    pub fn new(width: u32, height: u32, shading: Shading, pixels: Vec<Pixel>) -> Result<Self> {
        if pixels.len() as u64 != u64::from(width) * u64::from(height) {
            return Err(Error::Image {
                path: PathBuf::new(),
                reason: format!("{} pixels are no {width} × {height} image", pixels.len()),
                help: "give width × height pixels, row by row".into(),
            });
        }
        Ok(Self {
            width,
            height,
            shading,
            pixels,
            alpha: Vec::new(),
            develop: Develop::default(),
            remarks: String::new(),
        })
    }

    /// Makes pixels let through what is behind the image: `alpha` says how opaque each is, from 0
    /// to 1, and the colours are taken as premultiplied.
    ///
    /// # Errors
    ///
    /// [`Error::Image`] if there is not one for each pixel.
    pub fn set_alpha(&mut self, alpha: Vec<f32>) -> Result<()> {
        if alpha.len() != self.pixels.len() {
            return Err(Error::Image {
                path: PathBuf::new(),
                reason: format!("{} opacities for {} pixels", alpha.len(), self.pixels.len()),
                help: "give one for each pixel, row by row".into(),
            });
        }
        self.alpha = alpha;
        Ok(())
    }

    /// Whether any pixel may be less than opaque.
    #[must_use]
    pub fn has_alpha(&self) -> bool {
        !self.alpha.is_empty() || !self.shading.quantity().has_background()
    }

    /// How opaque the pixel with this index is, row by row from the upper left, from 0 to 1.
    /// Measurements are transparent where nothing is hit.
    #[must_use]
    pub fn opacity(&self, index: usize) -> f32 {
        let is_there = self.shading.quantity().has_background()
            || self.pixels.get(index).is_some_and(Pixel::is_hit);
        if is_there {
            self.alpha.get(index).copied().unwrap_or(1.0)
        } else {
            0.0
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
