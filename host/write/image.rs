//! PNG and EXR files, written whole or not at all.

use std::io::{BufWriter, Seek, Write};
use std::path::Path;

use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use super::Image;
use crate::error::{Error, Result};
use crate::shown::shown_path;

/// How rows are prepared for compression: to choose anew for each row takes as long as to compress them.
const FILTER: FilterType = FilterType::Up;

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
    /// [`Error::Image`] if it names none that can be written.
    pub fn of(path: &Path) -> Result<Self> {
        let extension = path
            .extension()
            .map(|extension| extension.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            _ => Err(failed(
                path,
                "not a kind of image that spherule writes",
                "give a name that ends in .png or .exr",
            )),
        }
    }
}

impl Image {
    /// Writes the image to `path`, as its extension says. The file appears whole or not at all:
    /// it is written beside its place under a temporary name, then renamed.
    ///
    /// # Errors
    ///
    /// [`Error::Image`] if the extension is unknown or the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let format = Format::of(path)?;
        Self::check_destination(path)?;
        let cannot_write = |error: std::io::Error| {
            // The kind alone: the rest names the temporary file.
            failed(
                path,
                format!("cannot be written: {}", error.kind()),
                "check that the directory exists, may be written and has room",
            )
        };
        let mut builder = tempfile::Builder::new();
        builder.prefix(".spherule-");
        // What any new file gets, less the umask, instead of a temporary file's privacy.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let mut file = builder
            .tempfile_in(directory_of(path))
            .map_err(cannot_write)?;
        {
            let mut writer = BufWriter::with_capacity(1 << 20, file.as_file_mut());
            self.encode_as(format, &mut writer)
                .map_err(|error| match error {
                    image::ImageError::IoError(error) => cannot_write(error),
                    other => failed(
                        path,
                        format!("cannot be encoded: {other}"),
                        "try another size or format",
                    ),
                })?;
            writer.flush().map_err(cannot_write)?;
        }
        file.persist(path)
            .map_err(|error| cannot_write(error.error))?;
        Ok(())
    }

    /// Whether an image can be written to `path`, as far as that can be told beforehand.
    ///
    /// # Errors
    ///
    /// [`Error::Image`] if the extension is unknown, the path is a directory, or its directory does
    /// not exist.
    pub fn check_destination(path: &Path) -> Result<()> {
        Format::of(path)?;
        if path.is_dir() {
            return Err(failed(path, "is a directory", "name a file"));
        }
        let directory = directory_of(path);
        if !directory.is_dir() {
            return Err(failed(
                path,
                format!(
                    "cannot be written: there is no directory {}",
                    shown_path(directory)
                ),
                "make the directory, or name another",
            ));
        }
        Ok(())
    }

    fn encode_as(
        &self,
        format: Format,
        writer: &mut (impl Write + Seek),
    ) -> image::ImageResult<()> {
        match format {
            Format::Png if self.alpha().is_some() => {
                PngEncoder::new_with_quality(writer, CompressionType::Fast, FILTER).write_image(
                    &self.to_rgba8(),
                    self.width,
                    self.height,
                    ExtendedColorType::Rgba8,
                )
            }
            Format::Png => PngEncoder::new_with_quality(writer, CompressionType::Fast, FILTER)
                .write_image(
                    &self.to_rgb8(),
                    self.width,
                    self.height,
                    ExtendedColorType::Rgb8,
                ),
            // OpenEXR's colours are premultiplied, as ours.
            Format::Exr if let Some(alpha) = self.alpha() => {
                let floats: Vec<f32> = self
                    .pixels
                    .iter()
                    .zip(alpha)
                    .flat_map(|(pixel, alpha)| pixel.color().extend(*alpha).to_array())
                    .collect();
                OpenExrEncoder::new(writer).write_image(
                    bytemuck::cast_slice(&floats),
                    self.width,
                    self.height,
                    ExtendedColorType::Rgba32F,
                )
            }
            Format::Exr => {
                let floats: Vec<f32> = self
                    .pixels
                    .iter()
                    .flat_map(|pixel| pixel.color().to_array())
                    .collect();
                OpenExrEncoder::new(writer).write_image(
                    bytemuck::cast_slice(&floats),
                    self.width,
                    self.height,
                    ExtendedColorType::Rgb32F,
                )
            }
        }
    }
}

fn directory_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

fn failed(path: &Path, reason: impl Into<String>, help: impl Into<String>) -> Error {
    Error::Image {
        path: path.into(),
        reason: reason.into(),
        help: help.into(),
    }
}
