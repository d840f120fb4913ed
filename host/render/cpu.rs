//! The CPU path: the functions that the GPU's entry points call, over bands of rows.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::UVec2;
use rayon::prelude::*;
use spherule_kernel::film::render_pixel;
use spherule_kernel::{Launch, Pixel, Shading};

use super::Progress;
use crate::scene::World;

/// Rows in a band: small enough to share the work out evenly, large enough that handing it out
/// costs nothing.
const BAND_ROWS: usize = 4;

/// Renders `launch`, which covers a whole image, on every thread of the pool.
#[must_use]
pub fn render(
    launch: &Launch,
    world: &World,
    shading: Shading,
    progress: Progress<'_>,
) -> Vec<Pixel> {
    match shading {
        Shading::Lit => bands::<{ Shading::Lit.to_u32() }>(launch, world, progress),
        Shading::Normals => bands::<{ Shading::Normals.to_u32() }>(launch, world, progress),
        Shading::Depth => bands::<{ Shading::Depth.to_u32() }>(launch, world, progress),
        Shading::Flat => bands::<{ Shading::Flat.to_u32() }>(launch, world, progress),
    }
}

/// Compiled once for each shading mode, as the GPU's pipeline is.
fn bands<const SHADING: u32>(launch: &Launch, world: &World, progress: Progress<'_>) -> Vec<Pixel> {
    let width = launch.tile_size.x as usize;
    let height = launch.tile_size.y as usize;
    let mut pixels = vec![Pixel::default(); width * height];
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
    pixels
}
