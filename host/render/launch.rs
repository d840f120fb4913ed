//! The launch that covers an image, and whether one that a caller made can be rendered.

use spherule_kernel::{Camera, Launch, PathLaunch};

use crate::error::{Error, Result, SceneError};
use crate::scene::Scene;

/// The launch that covers the whole image and every sphere; tiles and runs are cut out of it.
///
/// # Errors
///
/// [`Error::Scene`] as [`Scene::validate`] has it.
pub fn whole_image(scene: &Scene) -> Result<Launch> {
    scene.validate()?;
    let size = glam::UVec2::new(scene.width, scene.height);
    Ok(Launch {
        camera: camera(scene)?,
        background: scene
            .sky
            .as_ref()
            .map_or(scene.background, |sky| sky.horizon),
        first_of_tile: 1,
        image_size: size,
        tile_origin: glam::UVec2::ZERO,
        tile_size: size,
        first_sphere: 0,
        sphere_count: u32::MAX,
    })
}

/// Whether a launch covers a part of an image that can be.
pub(super) fn check_launch(launch: &Launch) -> Result<()> {
    let Launch {
        image_size: size,
        tile_origin: origin,
        tile_size: tile,
        ..
    } = *launch;
    let is_image = size
        .cmple(glam::UVec2::splat(crate::scene::limits::MAX_IMAGE_SIDE))
        .all();
    let is_inside = origin.cmple(size).all() && tile.cmple(size - origin.min(size)).all();
    if is_image && is_inside && tile.min_element() > 0 {
        return Ok(());
    }
    Err(Error::Scene(SceneError::without_place(
        "",
        format!("a launch of {tile} pixels from {origin} on is no part of an image of {size}"),
        "make it by render::whole_image",
    )))
}

/// Whether a launch covers an image that can be, all of it.
#[cfg(feature = "gpu")]
pub(super) fn check_whole(launch: &Launch) -> Result<()> {
    check_launch(&Launch {
        tile_origin: glam::UVec2::ZERO,
        tile_size: launch.image_size,
        ..*launch
    })
}

/// Whether light paths are to be traced for an image that can be, all of it.
pub(super) fn check_path_launch(launch: &PathLaunch) -> Result<()> {
    check_launch(&Launch {
        image_size: launch.image_size,
        tile_origin: launch.tile_origin,
        tile_size: launch.tile_size,
        ..Launch::default()
    })?;
    if launch.tile_size == launch.image_size {
        return Ok(());
    }
    Err(Error::Scene(SceneError::without_place(
        "",
        format!(
            "light paths are to be traced for {} of {} pixels",
            launch.tile_size, launch.image_size
        ),
        "leave the launch as paths::Prepared::new makes it; parts of it are chosen by the device",
    )))
}

/// Whether these are as many pixels as a launch has, which was checked.
pub(super) fn check_pixels(launch: &Launch, count: usize) -> Result<()> {
    let tile = launch.tile_size;
    if count as u64 == u64::from(tile.x) * u64::from(tile.y) {
        return Ok(());
    }
    Err(Error::Scene(SceneError::without_place(
        "",
        format!("a launch of {tile} pixels has room for {count}"),
        "give as many pixels as the launch has",
    )))
}

fn camera(scene: &Scene) -> Result<Camera> {
    scene
        .view_or_framed()
        .camera(scene.aspect())
        .ok_or_else(|| {
            Error::Scene(SceneError::without_place(
                "",
                "the scene's camera is degenerate",
                "move eye and target apart, give an up that is not along the view, and a field of view between 0 and 180 degrees",
            ))
        })
}
