//! The GPU path: the `trace_paths` entry point, tile by tile and run of samples by run.

use std::cell::Cell;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use glam::{UVec2, Vec4};
use spherule_kernel::accel::node::Node;
use spherule_kernel::{Accumulator, Effects, Light, Material, PathLaunch, Sphere};

use super::budget::{Budget, Reached, StoppedBy, noise};
use super::preview::Preview;
use super::{Prepared, Progress, Sampled, Settings};
use crate::device::canary::Canary;
use crate::device::{Access, Buffer, Gpu, Kernel, Staging};
use crate::error::{Error, Result};
use crate::film;
use crate::kernel_module;
use crate::render::Timings;
use crate::render::launch::check_path_launch;
use crate::render::pace::Pace;
use crate::render::tiles::Tiles;

/// The entry point's name, for messages.
const ENTRY: &str = "trace_paths";
/// Boxes and spheres that a ray looks at in a tree, for the same.
const TESTS_IN_A_TREE: u64 = 256;
/// Rays of one sample of one pixel, for the size of the first launch.
const RAYS_A_SAMPLE: u64 = 4;
/// The fewest pixels of a launch: fewer threads leave a GPU idle, and then it takes as long however
/// little it does.
const FEWEST_ON_GPU: u64 = 1 << 16;
const FEWEST_IN_SOFTWARE: u64 = 1 << 12;
/// How many turns Mesa's software adapter, llvmpipe, takes in all of the loops of a thread
/// together: it leaves them after that without a word.
const TURNS_IN_SOFTWARE: u64 = u16::MAX as u64;
/// The turns of a ray through a tree, for the same.
const TURNS_IN_A_TREE: u64 = 64;

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

/// What the launches are given, and what they write to.
struct Launcher<'a> {
    gpu: &'a Gpu,
    kernel: Kernel,
    uniform: Buffer<PathLaunch>,
    spheres: Buffer<Sphere>,
    velocities: Buffer<Vec4>,
    material_ids: Buffer<u32>,
    materials: Buffer<Material>,
    lights: Buffer<Light>,
    tables: Buffer<f32>,
    nodes: Buffer<Node>,
    sums: Buffer<Accumulator>,
    /// What they are read through.
    staging: Staging,
    /// What a sample takes, in intersections; the fewest pixels of a launch; and what it gets as
    /// far as is known.
    work: u64,
    fewest: u64,
    pace: Pace,
}

impl<'a> Launcher<'a> {
    fn new(gpu: &'a Gpu, prepared: &Prepared, kernel: Kernel, pixels: usize) -> Result<Self> {
        let world = &prepared.world;
        let tests = if prepared.nodes.is_empty() {
            world.spheres.len() as u64
        } else {
            TESTS_IN_A_TREE
        };
        let work = tests.max(1) * RAYS_A_SAMPLE;
        let fewest = if gpu.is_software() {
            FEWEST_IN_SOFTWARE
        } else {
            FEWEST_ON_GPU
        };
        let sums = gpu.zeroed("accumulators", pixels)?;
        Ok(Self {
            gpu,
            kernel,
            uniform: gpu.upload_uniform("launch", &prepared.launch)?,
            spheres: gpu.upload("spheres", &world.spheres)?,
            velocities: gpu.upload("velocities", &prepared.velocities)?,
            material_ids: gpu.upload("material ids", &world.material_ids)?,
            materials: gpu.upload("materials", &world.materials)?,
            lights: gpu.upload("lights", &prepared.lights)?,
            tables: gpu.upload("tables", &prepared.tables)?,
            nodes: gpu.upload("nodes", &prepared.nodes)?,
            staging: gpu.staging(&sums, pixels)?,
            sums,
            work,
            fewest,
            // What a sample takes by fog, glass or bounces is known only from the first of them. On
            // a GPU few pixels take as long as many.
            pace: if gpu.is_software() {
                Pace::starting_at(work * fewest)
            } else {
                Pace::first_on(gpu)
            },
        })
    }

    /// Adds the samples of `launch`, some of its rows after the other, so that no launch takes
    /// long. Between them `goes_on` is told how many pixels are done. Returns how many are done in
    /// the end, and how long they took.
    fn pass(
        &mut self,
        launch: &PathLaunch,
        goes_on: impl Fn(usize) -> bool,
    ) -> Result<(usize, Duration)> {
        let (width, height) = (launch.tile_size.x, launch.tile_size.y);
        let alignment = self.gpu.limits().min_storage_buffer_offset_alignment;
        let work = self.work * u64::from(launch.sample_count);
        let mut took = Duration::ZERO;
        let mut row = 0;
        while row < height && goes_on((row * width) as usize) {
            let pixels = self.pace.pixels(work).max(self.fewest);
            let rows = rows(width, pixels, alignment).min(height - row);
            let part = PathLaunch {
                tile_origin: launch.tile_origin + UVec2::new(0, row),
                tile_size: UVec2::new(width, rows),
                ..*launch
            };
            self.gpu.update(&self.uniform, &part)?;
            let range = (row * width) as usize..((row + rows) * width) as usize;
            let time = self.gpu.launch(
                &self.kernel,
                &[
                    self.uniform.binding(),
                    self.spheres.binding(),
                    self.velocities.binding(),
                    self.material_ids.binding(),
                    self.materials.binding(),
                    self.lights.binding(),
                    self.tables.binding(),
                    self.nodes.binding(),
                    self.sums.binding_of(range),
                ],
                self.kernel.workgroups_for([width, rows, 1]),
            )?;
            self.pace.learn(u64::from(width * rows) * work, time.best());
            took += time.best();
            row += rows;
        }
        Ok(((row * width) as usize, took))
    }

    /// Reads the sums of the first pixels.
    fn read(&self, pixels: &mut [Accumulator]) -> Result<()> {
        self.gpu.read_through(&self.staging, &self.sums, pixels)
    }
}

/// The most samples of a launch: a small image is else given so many that a software adapter does
/// not take all of them.
fn most_samples(gpu: &Gpu, prepared: &Prepared) -> u32 {
    if !gpu.is_software() {
        return u32::MAX;
    }
    let tests = if prepared.nodes.is_empty() {
        prepared.world.spheres.len() as u64
    } else {
        TURNS_IN_A_TREE
    };
    // A ray on and one to a light from the camera's vertex and from that of each bounce.
    let turns = (u64::from(prepared.launch.max_bounces) + 1) * (1 + 2 * tests);
    (TURNS_IN_SOFTWARE / turns) as u32
}

/// How many rows make at least so many pixels, if each launch's first is to lie in memory where the
/// device takes it.
fn rows(width: u32, pixels: u64, alignment: u32) -> u32 {
    let pixel = size_of::<Accumulator>() as u64;
    let mut step = 1;
    while !(u64::from(width) * pixel * step).is_multiple_of(u64::from(alignment)) {
        step *= 2;
    }
    let rows = pixels.div_ceil(u64::from(width));
    rows.next_multiple_of(step).min(u64::from(u32::MAX)) as u32
}

/// Renders on `gpu`.
///
/// # Errors
///
/// The device's errors, [`Error::RungRefused`] if the canary objects to the rung,
/// [`Error::Readback`] if a thread wrote no pixel, and [`Error::Scene`] if the launch is not one of
/// a whole image.
pub fn render(
    gpu: &Gpu,
    prepared: &Prepared,
    settings: &Settings,
    progress: Progress<'_>,
) -> Result<Sampled> {
    check_path_launch(&prepared.launch)?;
    let started = Instant::now();
    let size = prepared.launch.image_size;
    let mut image = film::allocate::<Accumulator>(size.x, size.y)?;
    let kernel = compile(gpu, prepared, settings)?;
    let compile = started.elapsed();
    let tiles = Tiles::new::<Accumulator>(gpu, size);
    let mut launcher = Launcher::new(gpu, prepared, kernel, tiles.max_pixels())?;
    let mut timings = Timings {
        setup: started.elapsed(),
        compile,
        ..Timings::default()
    };

    let tracing = Instant::now();
    let preview = match settings.time_limit {
        Some(limit) => {
            let most = tiles.max_pixels();
            let launch = &prepared.launch;
            preview(&mut launcher, launch, most, limit, progress, &mut timings)?
        }
        None => None,
    };
    let mut origin = UVec2::ZERO;
    let (mut fewest, mut stopped_by) = (u32::MAX, StoppedBy::Samples);
    while origin.y < size.y {
        // A tile is as large as one buffer may be: noise is that of the whole image, as far as this
        // reaches.
        let tile = tiles.at(origin, &Pace::first_on(gpu), 1);
        let count = (tile.x * tile.y) as usize;
        let start = tiles.start(origin);
        let all = image.len();
        // What is left of the time is shared out evenly over what is left of the image.
        let deadline = settings.time_limit.and_then(|limit| {
            let left = limit.saturating_sub(tracing.elapsed()).as_secs_f64();
            let share = count as f64 / (all - start) as f64;
            // One that is beyond what a clock counts is none.
            let left = Duration::try_from_secs_f64(left * share).ok()?;
            Instant::now().checked_add(left)
        });
        let most = most_samples(gpu, prepared);
        let budget = Budget::new(prepared.samples, deadline, settings.noise).with_at_most(most);
        let launch = PathLaunch {
            tile_origin: origin,
            tile_size: tile,
            ..prepared.launch
        };
        let progress = |share: f64| progress((start as f64 + count as f64 * share) / all as f64);
        let pixels = &mut image[start..start + count];
        let (samples, by) = trace_tile(
            &mut launcher,
            &launch,
            budget,
            &progress,
            pixels,
            &mut timings,
        )?;
        fewest = fewest.min(samples);
        if by != StoppedBy::Samples {
            stopped_by = by;
        }
        origin = tiles.next(origin, tile);
        if by == StoppedBy::Interrupted {
            if origin.y < size.y {
                fewest = 0;
            }
            break;
        }
    }
    if timings.trace == Duration::ZERO {
        timings.trace = tracing.elapsed();
    }
    let reached = Reached {
        samples: fewest,
        asked: prepared.samples,
        noise: noise(&image),
        stopped_by,
    };
    Ok(Sampled {
        accumulators: image,
        preview,
        timings,
        reached,
    })
}

/// The finest preview, in at most so many pixels, that is done in its part of `limit`.
fn preview(
    launcher: &mut Launcher<'_>,
    whole: &PathLaunch,
    max_pixels: usize,
    limit: Duration,
    progress: Progress<'_>,
    timings: &mut Timings,
) -> Result<Option<Preview>> {
    Preview::finest(whole, max_pixels, limit, |next, goes_on| {
        let goes_on = |_| progress(0.0).is_continue() && goes_on();
        // In small sums of its own: to make those of a whole tile zero again takes longer.
        let mut sums = launcher
            .gpu
            .zeroed("accumulators of a preview", next.sums.len())?;
        std::mem::swap(&mut launcher.sums, &mut sums);
        let (done, took) = launcher.pass(&next.launch, goes_on)?;
        timings.trace += took;
        launcher.read(&mut next.sums)?;
        std::mem::swap(&mut launcher.sums, &mut sums);
        Ok(done == next.sums.len())
    })
}

/// Takes the samples of the tile of `launch`, until `budget` or `progress` ends that, and reads
/// their sums into `pixels`. `progress` is told the share of the tile that is done. Returns the
/// fewest samples of a pixel, and what ended it.
fn trace_tile(
    launcher: &mut Launcher<'_>,
    launch: &PathLaunch,
    mut budget: Budget,
    progress: &dyn Fn(f64) -> ControlFlow<()>,
    pixels: &mut [Accumulator],
    timings: &mut Timings,
) -> Result<(u32, StoppedBy)> {
    let gpu = launcher.gpu;
    let mut in_part = (0, 0);
    let mut stopped_by = StoppedBy::Samples;
    gpu.clear(&launcher.sums)?;
    while let Some((first, samples)) = budget.next() {
        let launch = PathLaunch {
            first_sample: first,
            sample_count: samples,
            ..*launch
        };
        let is_interrupted = Cell::new(false);
        let goes_on = |done: usize| {
            let share = budget.share(samples, done as f64 / pixels.len() as f64);
            is_interrupted.set(progress(share).is_break());
            !is_interrupted.get() && !budget.is_late()
        };
        let (done, took) = launcher.pass(&launch, goes_on)?;
        timings.trace += took;
        if done < pixels.len() {
            in_part = (done, samples);
            stopped_by = if is_interrupted.get() {
                StoppedBy::Interrupted
            } else {
                StoppedBy::TimeLimit
            };
            break;
        }
        let stop = budget.took(samples, took, || {
            launcher.read(pixels)?;
            Ok::<_, Error>(noise(pixels))
        })?;
        if let Some(by) = stop {
            stopped_by = by;
            break;
        }
    }

    let reading = Instant::now();
    launcher.read(pixels)?;
    let (with_more, others) = pixels.split_at(in_part.0);
    check_written(gpu, with_more, budget.done() + in_part.1)?;
    check_written(gpu, others, budget.done())?;
    timings.readback += reading.elapsed();
    Ok((budget.done(), stopped_by))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_a_tile_begin_where_a_device_takes_them() {
        assert_eq!(rows(1920, 65_536, 256), 35);
        // 17 pixels of 32 bytes.
        assert_eq!(rows(17, 100, 256), 8);
        assert_eq!(rows(17, 100, 32), 6);
        assert_eq!(rows(18, 1, 64), 1);
        assert_eq!(rows(65_536, 1, 256), 1);
    }
}
