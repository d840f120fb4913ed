//! [`Format`]: the kinds of image files that are written.

use std::path::Path;

use crate::error::{Error, Result};

/// A kind of image file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8 bits a channel; light in sRGB, measurements as they are.
    Png,
    /// 32-bit floats, linear.
    Exr,
}

impl Format {
    /// The format that the file's extension names.
    ///
    /// # Errors
    ///
    /// [`Error::OutputRefused`] if it names none that can be written.
    pub fn of(path: &Path) -> Result<Self> {
        let extension = path
            .extension()
            .map(|extension| extension.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            _ => Err(Error::OutputRefused {
                path: path.into(),
                reason: "not a kind of image that spherule writes".into(),
                help: "give a name that ends in .png or .exr".into(),
            }),
        }
    }
}

/// What memory is for here.
pub(super) const PURPOSE: &str = "writing the image";
