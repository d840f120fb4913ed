//! Images of the surroundings: equirectangular, as `.hdr` or `.exr` files.

use std::path::Path;

use glam::Vec3;

use super::surroundings::EnvironmentImage;
use crate::error::{Error, Result, SceneError};

/// Reads the image at `path` and multiplies it by `strength`.
///
/// # Errors
///
/// [`Error::Scene`] if it cannot be read, or holds what light cannot be.
pub fn load(path: &Path, strength: f32) -> Result<EnvironmentImage> {
    let wrong =
        |message: String, help: &str| Error::Scene(SceneError::without_place(path, message, help));
    let reader = image::ImageReader::open(path)
        .map_err(|error| {
            wrong(
                format!("cannot be opened: {error}"),
                "a relative name counts from the scene's directory",
            )
        })?
        .with_guessed_format()
        .map_err(|error| wrong(format!("cannot be read: {error}"), "check the file"))?;
    let decoded = reader.decode().map_err(|error| {
        wrong(
            format!("is no image that spherule reads: {error}"),
            "give an equirectangular image as .hdr or .exr",
        )
    })?;
    if !matches!(
        decoded.color(),
        image::ColorType::Rgb32F | image::ColorType::Rgba32F
    ) {
        return Err(wrong(
            "holds no linear light: its channels are not floats".into(),
            "give an equirectangular image as .hdr or .exr",
        ));
    }
    let linear = decoded.to_rgb32f();
    let (width, height) = linear.dimensions();
    if width == 0 || height == 0 {
        return Err(wrong(
            format!("has {width} × {height} pixels"),
            "give an image that shows something",
        ));
    }
    let texels: Vec<Vec3> = linear
        .pixels()
        .map(|pixel| Vec3::from_array(pixel.0) * strength)
        .collect();
    if let Some(index) = texels
        .iter()
        .position(|texel| !texel.is_finite() || texel.min_element() < 0.0)
    {
        return Err(wrong(
            format!(
                "the texel in column {} of row {} is {}",
                index as u32 % width,
                index as u32 / width,
                texels[index]
            ),
            "light is finite and not below zero: mend the image",
        ));
    }
    Ok(EnvironmentImage {
        width,
        height,
        texels,
    })
}
