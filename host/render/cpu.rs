//! The CPU path: the functions that the GPU's entry points call, over bands of rows.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::UVec2;
use rayon::prelude::*;
use spherule_kernel::film::render_pixel;
use spherule_kernel::{Launch, Pixel, Rung, Shading};

use super::{Progress, Settings};
use crate::error::Result;
use crate::film;
use crate::scene::World;

/// Rows in a band: small enough to share the work out evenly, large enough that handing it out
/// costs nothing.
const BAND_ROWS: usize = 4;

/// Renders `launch`, which covers a whole image, on every thread of the pool.
///
/// # Errors
///
/// [`OutOfMemory`](crate::Error::OutOfMemory) if the host has no room for the image.
pub fn render(
    launch: &Launch,
    world: &World,
    settings: Settings,
    progress: Progress<'_>,
) -> Result<Vec<Pixel>> {
    const TEXTBOOK: u32 = Rung::Textbook.to_u32();
    const ROBUST: u32 = Rung::Robust.to_u32();
    const COMPENSATED: u32 = Rung::Compensated.to_u32();
    const DOUBLE: u32 = Rung::Double.to_u32();
    const CERTIFIED: u32 = Rung::Certified.to_u32();
    let bands = match settings.rung {
        Rung::Textbook => bands_on::<TEXTBOOK>,
        Rung::Robust => bands_on::<ROBUST>,
        Rung::Compensated => bands_on::<COMPENSATED>,
        Rung::Double => bands_on::<DOUBLE>,
        Rung::Certified => bands_on::<CERTIFIED>,
    };
    let size = launch.tile_size;
    let mut pixels = film::allocate(size.x, size.y)?;
    bands(launch, world, settings.shading, progress, &mut pixels);
    Ok(pixels)
}

fn bands_on<const RUNG: u32>(
    launch: &Launch,
    world: &World,
    shading: Shading,
    progress: Progress<'_>,
    pixels: &mut [Pixel],
) {
    const LIT: u32 = Shading::Lit.to_u32();
    const NORMALS: u32 = Shading::Normals.to_u32();
    const DEPTH: u32 = Shading::Depth.to_u32();
    const FLAT: u32 = Shading::Flat.to_u32();
    match shading {
        Shading::Lit => bands::<LIT, RUNG>(launch, world, progress, pixels),
        Shading::Normals => bands::<NORMALS, RUNG>(launch, world, progress, pixels),
        Shading::Depth => bands::<DEPTH, RUNG>(launch, world, progress, pixels),
        Shading::Flat => bands::<FLAT, RUNG>(launch, world, progress, pixels),
    }
}

/// Compiled once for each shading mode and rung, as the GPU's pipeline is.
fn bands<const SHADING: u32, const RUNG: u32>(
    launch: &Launch,
    world: &World,
    progress: Progress<'_>,
    pixels: &mut [Pixel],
) {
    let width = launch.tile_size.x as usize;
    let height = launch.tile_size.y as usize;
    let rows_done = AtomicUsize::new(0);
    pixels
        .par_chunks_mut(width * BAND_ROWS)
        .enumerate()
        .for_each(|(band, pixels)| {
            for (index, pixel) in pixels.iter_mut().enumerate() {
                let at = UVec2::new(
                    (index % width) as u32,
                    (band * BAND_ROWS + index / width) as u32,
                );
                *pixel = render_pixel(
                    SHADING,
                    RUNG,
                    launch,
                    &world.spheres,
                    &world.material_ids,
                    &world.materials,
                    at,
                    *pixel,
                );
            }
            let rows = pixels.len() / width;
            let done = rows_done.fetch_add(rows, Ordering::Relaxed) + rows;
            progress(done as f64 / height as f64);
        });
}
