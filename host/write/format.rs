//! [`Format`]: the image formats that can be written.

use std::path::Path;

use crate::error::{Error, Result};

/// An image format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8 bits a channel; light in sRGB, measurements unchanged.
    Png,
    /// 32-bit floats, linear.
    Exr,
}

impl Format {
    /// The format for the file's extension.
    ///
    /// # Errors
    ///
    /// [`Error::OutputRefused`] if it is not the extension of a format that can be written.
    pub fn of(path: &Path) -> Result<Self> {
        let extension = path
            .extension()
            .map(|extension| extension.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            _ => Err(Error::OutputRefused {
                path: path.into(),
                reason: "not an image format that spherule writes".into(),
                help: "give a name that ends in .png or .exr".into(),
            }),
        }
    }
}

/// The purpose that memory errors name.
pub(super) const PURPOSE: &str = "writing the image";
