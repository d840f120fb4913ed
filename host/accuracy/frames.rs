//! Measures for each rung the time and the errors of a whole frame of a scene.

use serde::Serialize;
use spherule_kernel::{Effects, Pixel, Rung, Shading};

use crate::device::{Device, busy};
use crate::error::Result;
use crate::film::compare::{Comparison, Tolerance};
use crate::film::flip::mean_flip;
use crate::memory;
use crate::render::{self, EffectChoice, Progress, QUIET, Settings, render, whole_image};
use crate::scene::Scene;

/// How often each rung renders the frame; the rungs take turns.
const ROUNDS: usize = 7;

/// The measurements of a frame on one rung.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Frame {
    /// The rung.
    pub rung: &'static str,
    /// The median time of tracing, in milliseconds; on a GPU by its own clock, if it has one, while
    /// it is kept busy.
    pub milliseconds: f64,
    /// The fastest run, in milliseconds.
    pub fastest: f64,
    /// The slowest run, in milliseconds.
    pub slowest: f64,
    /// Pixels that differ from the reference by more than two 255ths, or hit where it misses.
    pub differing: usize,
    /// The number of pixels.
    pub pixels: usize,
    /// The mean ꟻLIP against the reference.
    pub flip: f64,
}

/// Renders `scene` on `device` on each of `rungs`. The reference is the CPU's image on the highest
/// rung.
///
/// # Errors
///
/// As [`render()`].
pub fn measure(
    device: &Device,
    rungs: &[Rung],
    scene: &Scene,
    progress: Progress<'_>,
) -> Result<Vec<Frame>> {
    let settings = |rung| Settings {
        shading: Shading::Lit,
        rung,
        // One ray a pixel, whatever effects the scene calls for.
        effects: EffectChoice::Only(Effects::NONE),
        ..Settings::default()
    };
    let pixels = u64::from(scene.width) * u64::from(scene.height);
    memory::require(
        pixels
            .saturating_mul(1 + rungs.len() as u64)
            .saturating_mul(size_of::<Pixel>() as u64),
        &format!("keeping an image of each precision of {pixels} pixels"),
    )?;
    let reference = render(scene, settings(Rung::Certified), &Device::Cpu, QUIET)?.image;
    let mut images = Vec::new();
    let mut worlds = Vec::new();
    for rung in rungs {
        images.push(render(scene, settings(*rung), device, QUIET)?.image);
        if let Device::Gpu(gpu) = device {
            let world = render::gpu::Prepared::new(gpu, &scene.world, settings(*rung))?;
            busy::keep_busy(gpu, busy::WARM_UP / rungs.len() as u32)?;
            worlds.push(world);
        }
    }
    let launch = whole_image(scene)?;
    let mut times = vec![Vec::new(); rungs.len()];
    for round in 0..ROUNDS {
        for (index, rung) in rungs.iter().enumerate() {
            let trace = match device {
                Device::Cpu => render(scene, settings(*rung), device, QUIET)?.timings.trace,
                Device::Gpu(gpu) => {
                    busy::keep_busy(gpu, busy::BETWEEN)?;
                    // The caches then hold the scene, as they do if one image follows another.
                    render::gpu::time(gpu, &launch, &worlds[index])?;
                    render::gpu::time(gpu, &launch, &worlds[index])?
                }
            };
            times[index].push(trace.as_secs_f64() * 1e3);
            let done = (1 + round) * rungs.len() + index + 1;
            let _ = progress(done as f64 / ((1 + ROUNDS) * rungs.len()) as f64);
        }
    }
    Ok(rungs
        .iter()
        .zip(images)
        .zip(times)
        .map(|((rung, image), mut times)| {
            times.sort_by(f64::total_cmp);
            let compared = Comparison::of(&image, &reference, Tolerance::default());
            Frame {
                rung: rung.name(),
                milliseconds: times[ROUNDS / 2],
                fastest: times[0],
                slowest: times[ROUNDS - 1],
                differing: compared.map_or(0, |compared| compared.differing),
                pixels: image.pixels().len(),
                flip: mean_flip(&reference, &image).unwrap_or(f64::NAN),
            }
        })
        .collect())
}
