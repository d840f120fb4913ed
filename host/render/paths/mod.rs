//! Light paths: scenes that need more than one ray a pixel.
//!
//! | module | holds |
//! | --- | --- |
//! | [`prepare`] | what the kernel is told of a scene: the launch, the tables |
//! | `lights` | the lights, in a list or a tree |
//! | [`cpu`], `together` | the kernel's functions over bands of rows, on every thread; paths in step |
//! | [`gpu`] | the kernel's entry point over tiles and runs of samples |
//! | [`budget`] | how far a render came, and what ends it |
//! | `numbers` | random numbers of paths in step, side by side |
//! | `adaptive` | samples where they are needed, for a noise target |
//! | `rebase` | moves scenes that are far from the origin to it |
//! | `preview` | a coarse image, for pixels that have no sample when the time is up |

mod adaptive;
pub mod budget;
pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
mod lights;
mod numbers;
pub mod prepare;
mod preview;
mod rebase;
mod together;

use std::time::Instant;

use rayon::prelude::*;
use spherule_kernel::{Accumulator, Effects, Hit, Pixel, Shading};

use super::image_memory::memory_for;
use super::{Progress, Rendered, Settings, Timings};
use crate::device::Device;
use crate::error::Result;
use crate::film::Image;
use crate::memory;
use crate::scene::Scene;
pub use budget::{Reached, StoppedBy};
pub use prepare::Prepared;
use preview::Preview;

/// What a device made of a scene.
pub struct Sampled {
    /// The sums of each pixel's samples.
    accumulators: Vec<Accumulator>,
    /// What pixels without a sample show.
    preview: Option<Preview>,
    timings: Timings,
    reached: Reached,
}

/// Renders `scene` by light paths.
///
/// # Errors
///
/// As [`render`](super::render).
pub fn render(
    scene: &Scene,
    settings: &Settings,
    device: &Device,
    progress: Progress<'_>,
) -> Result<Rendered> {
    let started = Instant::now();
    let pixels = u64::from(scene.width) * u64::from(scene.height);
    // Sums, tile by tile before they are an image where there is a noise target, and opacities
    // beside them.
    let sums = 1 + usize::from(settings.noise.is_some());
    memory_for(
        scene,
        (sums * size_of::<Accumulator>() + size_of::<f32>()) as u64,
    )?;
    let prepared = Prepared::new(scene, settings.effects, settings.acceleration)?;
    let setup = started.elapsed();
    // Reserved first, so that no work is lost if memory runs out.
    let room_for_alpha = || memory::room(pixels, "the image's alpha channel");
    let is_transparent = prepared.shown.any(Effects::TRANSPARENT_BACKGROUND);
    let mut alpha: Vec<f32> = if is_transparent {
        room_for_alpha()?
    } else {
        Vec::new()
    };
    let Sampled {
        mut accumulators,
        preview,
        mut timings,
        reached,
    } = match device {
        Device::Cpu => cpu::render(&prepared, settings, progress)?,
        #[cfg(feature = "gpu")]
        Device::Gpu(gpu) => gpu::render(gpu, &prepared, settings, progress)?,
    };
    timings.setup += setup;
    let rays = accumulators
        .par_iter()
        .map(|sum| sum.samples() as u64)
        .sum();
    let mut traced = pixels;
    if reached.samples == 0 {
        let is_traced = |sum: &&Accumulator| sum.samples() > 0.0;
        traced = accumulators.par_iter().filter(is_traced).count() as u64;
        match &preview {
            Some(preview) => preview.fill(scene.width, &mut accumulators),
            // Without memory for them the missing pixels are black.
            None if !is_transparent => alpha = room_for_alpha().unwrap_or_default(),
            None => {}
        }
    }
    if alpha.capacity() > 0 {
        let of = |sum: &Accumulator| {
            if is_transparent {
                sum.alpha()
            } else {
                sum.samples().min(1.0)
            }
        };
        alpha.extend(accumulators.iter().map(of));
    }
    let mut image = Image::new(
        scene.width,
        scene.height,
        Shading::Lit,
        into_pixels(accumulators),
    )?;
    if !alpha.is_empty() {
        image.set_alpha(alpha)?;
    }
    image.develop = scene.develop;
    image.remarks = scene.remarks(prepared.shown);
    Ok(Rendered {
        image,
        traced,
        rays,
        timings,
        reached: Some(reached),
    })
}

/// Turns the sums into pixels, in place.
fn into_pixels(sums: Vec<Accumulator>) -> Vec<Pixel> {
    const SUMS_SIZE: usize = size_of::<Accumulator>() / size_of::<Pixel>();
    let count = sums.len();
    let mut pixels: Vec<Pixel> = bytemuck::allocation::cast_vec(sums);
    for index in 0..count {
        let from = index * SUMS_SIZE;
        let sum: Accumulator =
            *bytemuck::from_bytes(bytemuck::cast_slice(&pixels[from..][..SUMS_SIZE]));
        pixels[index] = Pixel::new(sum.color(), depth(&sum));
    }
    pixels.truncate(count);
    pixels.shrink_to_fit();
    pixels
}

/// Zero marks a pixel that no kernel wrote, so that real depths stay above it. A pixel without
/// samples has no hit.
fn depth(sum: &Accumulator) -> f32 {
    if sum.samples() == 0.0 {
        return Hit::NONE_T;
    }
    sum.depth().max(f32::MIN_POSITIVE)
}
