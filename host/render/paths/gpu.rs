//! The GPU path: the `trace_paths` entry point, tile by tile and run of samples by run.

use std::time::{Duration, Instant};

use glam::UVec2;
use spherule_kernel::tree::Node;
use spherule_kernel::{Accumulator, Effects, PathLaunch};

use super::budget::{Budget, Reached, StoppedBy, noise};
use super::{Prepared, Progress, Settings};
use crate::accuracy::canary::Canary;
use crate::device::{Access, Gpu, Kernel};
use crate::error::{Error, Result};
use crate::film;
use crate::kernel_module;
use crate::render::Timings;
use crate::render::pace::Pace;
use crate::render::tiles::Tiles;

/// The entry point's name, for messages.
const ENTRY: &str = "trace_paths";
/// Boxes and spheres that a ray looks at in a tree, for the same.
const TESTS_IN_A_TREE: u64 = 256;
/// Rays of one sample of one pixel, for the size of the first launch.
const RAYS_A_SAMPLE: u64 = 4;

/// Compiles the kernel for these settings.
///
/// # Errors
///
/// [`Error::RungRefused`] if the canary objects to the rung, and the device's errors.
pub fn compile(gpu: &Gpu, prepared: &Prepared, settings: &Settings) -> Result<Kernel> {
    Canary::require_on_gpu(gpu, settings.rung)?;
    let is_exact = prepared.compiled == prepared.shown;
    let module = kernel_module::for_rung(settings.rung)?
        .specialise(Effects::SPEC_ID, prepared.compiled.to_bits())?
        .specialise(Effects::IS_EXACT_SPEC_ID, is_exact.into())?
        .specialise(Node::SPEC_ID, u32::from(!prepared.nodes.is_empty()))?;
    let mut access = vec![Access::Read; 9];
    access[0] = Access::Uniform;
    access[8] = Access::ReadWrite;
    gpu.kernel(&module, ENTRY, &access)
}

/// Renders on `gpu`.
///
/// # Errors
///
/// The device's errors, [`Error::RungRefused`] if the canary objects to the rung, and
/// [`Error::Readback`] if a thread wrote no pixel.
pub fn render(
    gpu: &Gpu,
    prepared: &Prepared,
    settings: &Settings,
    progress: Progress<'_>,
) -> Result<(Vec<Accumulator>, Timings, Reached)> {
    let started = Instant::now();
    let world = &prepared.world;
    let kernel = compile(gpu, prepared, settings)?;
    let compile = started.elapsed();
    let size = prepared.launch.image_size;
    let spheres = gpu.upload("spheres", &world.spheres)?;
    let velocities = gpu.upload("velocities", &prepared.velocities)?;
    let material_ids = gpu.upload("material ids", &world.material_ids)?;
    let materials = gpu.upload("materials", &world.materials)?;
    let lights = gpu.upload("lights", &prepared.lights)?;
    let tables = gpu.upload("tables", &prepared.tables)?;
    let nodes = gpu.upload("nodes", &prepared.nodes)?;
    let uniform = gpu.upload_uniform("launch", &prepared.launch)?;
    let tiles = Tiles::new::<Accumulator>(gpu, size);
    let sums = gpu.zeroed::<Accumulator>("accumulators", tiles.max_pixels())?;
    let mut timings = Timings {
        setup: started.elapsed(),
        compile,
        ..Timings::default()
    };

    let tests = if prepared.nodes.is_empty() {
        world.spheres.len() as u64
    } else {
        TESTS_IN_A_TREE
    };
    let work = tests * RAYS_A_SAMPLE;
    let tracing = Instant::now();
    let mut image = film::allocate::<Accumulator>(size.x, size.y)?;
    let mut origin = UVec2::ZERO;
    let (mut fewest, mut stopped_by) = (u32::MAX, StoppedBy::Samples);
    while origin.y < size.y {
        // Noise is that of the whole image, as far as one readback reaches.
        let work = if settings.noise.is_some() { 1 } else { work };
        let tile = tiles.at(origin, &Pace::first_on(gpu), work);
        let count = (tile.x * tile.y) as usize;
        let start = tiles.start(origin);
        // What is left of the time is shared out evenly over what is left of the image.
        let deadline = settings.time_limit.map(|limit| {
            let left = limit.saturating_sub(tracing.elapsed());
            Instant::now() + left.mul_f64(count as f64 / (image.len() - start) as f64)
        });
        let mut budget = Budget::new(prepared.samples, deadline, settings.noise);
        gpu.clear(&sums)?;
        while let Some((first, samples)) = budget.next() {
            let launch = PathLaunch {
                tile_origin: origin,
                tile_size: tile,
                first_sample: first,
                sample_count: samples,
                ..prepared.launch
            };
            gpu.update(&uniform, &launch)?;
            let took = gpu.launch(
                &kernel,
                &[
                    uniform.binding(),
                    spheres.binding(),
                    velocities.binding(),
                    material_ids.binding(),
                    materials.binding(),
                    lights.binding(),
                    tables.binding(),
                    nodes.binding(),
                    sums.binding(),
                ],
                kernel.workgroups_for([tile.x, tile.y, 1]),
            )?;
            timings.trace += took.best();
            let stop = budget.took(samples, took.best(), || {
                Ok::<_, Error>(noise(&gpu.read_first(&sums, count)?))
            })?;
            progress((start as f64 + count as f64 * budget.share()) / image.len() as f64);
            if let Some(by) = stop {
                if by != StoppedBy::Samples {
                    stopped_by = by;
                }
                break;
            }
        }
        fewest = fewest.min(budget.done());

        let reading = Instant::now();
        let pixels = gpu.read_first(&sums, count)?;
        check_written(gpu, &pixels, budget.done())?;
        image[start..start + count].copy_from_slice(&pixels);
        timings.readback += reading.elapsed();
        origin = tiles.next(origin, tile);
    }
    if timings.trace == Duration::ZERO {
        timings.trace = tracing.elapsed();
    }
    let reached = Reached {
        samples: fewest,
        noise: noise(&image),
        stopped_by,
    };
    Ok((image, timings, reached))
}

/// A kernel that panics on the device returns without a word; its pixel then lacks samples.
fn check_written(gpu: &Gpu, pixels: &[Accumulator], samples: u32) -> Result<()> {
    let missing = pixels
        .iter()
        .filter(|pixel| pixel.samples() != samples as f32)
        .count();
    if missing == 0 {
        return Ok(());
    }
    Err(Error::Readback {
        what: "the image".into(),
        device: gpu.name().into(),
        reason: format!(
            "{missing} of {} threads of {ENTRY} did not take their {samples} samples",
            pixels.len()
        ),
    })
}
