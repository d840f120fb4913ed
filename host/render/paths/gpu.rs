//! The GPU path: the `trace_paths` entry point, tile by tile and run of samples by run.

use std::ops::{Range, RangeInclusive};
use std::time::{Duration, Instant};

use glam::{UVec2, Vec4};
use spherule_kernel::accel::node::Node;
use spherule_kernel::material::microfacet::ALBEDO_LEN;
use spherule_kernel::shape::{Kinds, Shape};
use spherule_kernel::{Accumulator, Effects, Light, Material, PathLaunch, Sphere};

use super::adaptive::{self, Adaptive, Goal, Tracer, take_samples, tiles_of};
use super::budget::{Budget, GoesOn, Reached, StoppedBy};
use super::preview::Preview;
use super::{Prepared, Progress, Sampled, Settings};
use crate::device::canary::Canary;
use crate::device::{Access, Buffer, Gpu, Kernel, Staging, rung};
use crate::error::{Error, Result};
use crate::film;
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
/// How many surfaces of glass light passes on its way, for the same.
const SURFACES_IN_THE_WAY: u64 = 8;
/// The turns of the solver that finds the ways of light by a sphere, and the rays along them.
const TURNS_OF_WAYS: u64 = 48;
const RAYS_OF_WAYS: u64 = 9;

/// Compiles the kernel for these settings.
///
/// # Errors
///
/// [`Error::RungRefused`] if the canary objects to the rung, and the device's errors.
pub fn compile(gpu: &Gpu, prepared: &Prepared, settings: &Settings) -> Result<Kernel> {
    Canary::require_on_gpu(gpu, settings.rung)?;
    let is_exact = prepared.compiled == prepared.shown;
    let module = rung::module(gpu, settings.rung)?
        .specialise(Effects::SPEC_ID, prepared.compiled.to_bits())?
        .specialise(Effects::IS_EXACT_SPEC_ID, is_exact.into())?
        .specialise(Node::SPEC_ID, u32::from(!prepared.nodes.is_empty()))?
        .specialise(Kinds::SPEC_ID, prepared.shapes.kinds.to_bits())?;
    let mut access = vec![Access::Read; 12];
    access[0] = Access::Uniform;
    access[11] = Access::ReadWrite;
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
    texels: Buffer<f32>,
    nodes: Buffer<Node>,
    shapes: Buffer<Shape>,
    shape_nodes: Buffer<Node>,
    sums: Buffer<Accumulator>,
    /// What they are read through.
    staging: Staging,
    /// The most rows of a launch.
    most_rows: u32,
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
            texels: gpu.upload("texels", &prepared.texels)?,
            nodes: gpu.upload("nodes", &prepared.nodes)?,
            shapes: gpu.upload("shapes", &prepared.shapes.shapes)?,
            shape_nodes: gpu.upload("nodes of shapes", &prepared.shapes.nodes)?,
            staging: gpu.staging(&sums, pixels)?,
            sums,
            most_rows: Tiles::most_rows(gpu),
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
            let rows = rows(width, pixels, alignment)
                .min(self.most_rows)
                .min(height - row);
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
                    self.texels.binding(),
                    self.nodes.binding(),
                    self.shapes.binding(),
                    self.shape_nodes.binding(),
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

/// Refuses an image of the sky that the device does not take.
fn check_sky(gpu: &Gpu, prepared: &Prepared) -> Result<()> {
    let UVec2 {
        x: width,
        y: height,
    } = prepared.launch.sky.environment_size;
    let limit = gpu.largest_storage();
    let needed = sky_bytes(width, height);
    if prepared.texels.is_empty() || needed <= limit {
        return Ok(());
    }
    Err(Error::SkyTooLarge {
        width,
        height,
        needed,
        limit,
        device: gpu.name().into(),
        fits: largest_sky(width, height, limit),
    })
}

/// The bytes of the largest buffer of an image of the sky: three floats a texel, or the tables,
/// with one a texel and one a row.
fn sky_bytes(width: u32, height: u32) -> u64 {
    let texels = u64::from(width) * u64::from(height);
    let tables = ALBEDO_LEN as u64 + u64::from(height) + texels;
    size_of::<f32>() as u64 * tables.max(3 * texels)
}

/// Width and height of the largest image of the sky of this shape that fits into a buffer of so
/// many bytes.
fn largest_sky(width: u32, height: u32, limit: u64) -> (u32, u32) {
    let shape = f64::from(width) / f64::from(height);
    let of = |height: u32| ((f64::from(height) * shape) as u32).max(1);
    let texels = limit as f64 / (3 * size_of::<f32>()) as f64;
    let mut rows = ((texels / shape).sqrt() as u32).clamp(1, height);
    while rows > 1 && sky_bytes(of(rows), rows) > limit {
        rows -= 1;
    }
    let mut columns = of(rows);
    // One row may be too long.
    while columns > 1 && sky_bytes(columns, rows) > limit {
        columns /= 2;
    }
    (columns, rows)
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
    // A ray on and one to a light from the camera's vertex and from that of each bounce. Light
    // that passes glass takes a ray from each surface to the next.
    let rays = if prepared.shown.any(Effects::CLEAR_SHADOWS) {
        2 + SURFACES_IN_THE_WAY
    } else {
        2
    };
    let mut turns_at_vertex = 1 + rays * tests;
    if prepared.compiled.any(Effects::CAUSTICS) {
        turns_at_vertex += TURNS_OF_WAYS + RAYS_OF_WAYS * tests;
    }
    let turns = (u64::from(prepared.launch.max_bounces) + 1) * turns_at_vertex;
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
/// [`Error::SkyTooLarge`] if the image of the sky is beyond what the device takes,
/// [`Error::Readback`] if a thread wrote no pixel, and [`Error::Scene`] if the launch is not one of
/// a whole image.
pub fn render(
    gpu: &Gpu,
    prepared: &Prepared,
    settings: &Settings,
    progress: Progress<'_>,
) -> Result<Sampled> {
    check_path_launch(&prepared.launch)?;
    check_sky(gpu, prepared)?;
    let started = Instant::now();
    let size = prepared.launch.image_size;
    let mut image = film::allocate::<Accumulator>(size.x, size.y)?;
    let kernel = compile(gpu, prepared, settings)?;
    let compile = started.elapsed();
    let tiles = Tiles::new::<Accumulator>(gpu, size);
    let tiled = of_a_buffer(gpu, size);
    let room = match settings.noise {
        Some(_) => tiled as usize * adaptive::PIXELS,
        None => tiles.max_pixels(),
    };
    let launcher = Launcher::new(gpu, prepared, kernel, room)?;
    let setup = Timings {
        setup: started.elapsed(),
        compile,
        ..Timings::default()
    };
    let mut work = Work {
        launcher,
        prepared,
        settings,
        progress,
        began: Instant::now(),
        timings: setup,
    };
    let preview = match settings.time_limit {
        Some(limit) => work.preview(room, limit)?,
        None => None,
    };
    let reached = match settings.noise {
        Some(target) => work.take_where_needed(&mut image, tiled, target)?,
        None => work.take_everywhere(&mut image, tiles)?,
    };
    let mut timings = work.timings;
    if timings.trace == Duration::ZERO {
        timings.trace = work.began.elapsed();
    }
    Ok(Sampled {
        accumulators: image,
        preview,
        timings,
        reached,
    })
}

/// How many tiles that take as many samples as they need one buffer holds, of an image of this
/// size.
fn of_a_buffer(gpu: &Gpu, size: UVec2) -> u32 {
    let pixels = Tiles::most::<Accumulator>(gpu);
    let tiles = (pixels / adaptive::PIXELS as u64).max(1);
    tiles.min(u64::from(tiles_of(size))) as u32
}

/// An image at work.
struct Work<'a> {
    launcher: Launcher<'a>,
    prepared: &'a Prepared,
    settings: &'a Settings,
    progress: Progress<'a>,
    /// When the tracing began.
    began: Instant,
    timings: Timings,
}

impl Work<'_> {
    /// Takes the same samples of each pixel of `image`, a piece of it that a buffer holds after the
    /// other.
    fn take_everywhere(&mut self, image: &mut [Accumulator], tiles: Tiles) -> Result<Reached> {
        let prepared = self.prepared;
        let size = prepared.launch.image_size;
        let mut stopped_by = StoppedBy::Samples;
        let mut origin = UVec2::ZERO;
        while origin.y < size.y {
            let tile = tiles.at(origin, &Pace::first_on(self.launcher.gpu), 1);
            let count = (tile.x * tile.y) as usize;
            let start = tiles.start(origin);
            let part =
                start as f64 / image.len() as f64..(start + count) as f64 / image.len() as f64;
            let launch = PathLaunch {
                tile_origin: origin,
                tile_size: tile,
                ..prepared.launch
            };
            let by = self.trace_tile(&launch, &mut image[start..start + count], part)?;
            if by != StoppedBy::Samples {
                stopped_by = by;
            }
            if by == StoppedBy::Interrupted {
                break;
            }
            origin = tiles.next(origin, tile);
        }
        Ok(Reached::of(image, prepared.samples, stopped_by).with_noise_of(image))
    }

    /// Takes the samples of the tile of `launch` and reads their sums into `pixels`; they are this
    /// part of the image. Returns what ended it.
    fn trace_tile(
        &mut self,
        launch: &PathLaunch,
        pixels: &mut [Accumulator],
        part: Range<f64>,
    ) -> Result<StoppedBy> {
        let most = most_samples(self.launcher.gpu, self.prepared);
        let mut budget =
            Budget::new(self.prepared.samples, self.deadline(&part)).with_at_most(most);
        let progress = self.progress;
        let progress = |share: f64| progress(part.start + share * (part.end - part.start));
        let (launcher, timings) = (&mut self.launcher, &mut self.timings);
        launcher.gpu.clear(&launcher.sums)?;
        let mut in_part = pixels.len();
        let by = budget.spend(&progress, |first, count, goes_on| {
            let launch = PathLaunch {
                first_sample: first,
                sample_count: count,
                ..*launch
            };
            let of_pixels = |done: usize| goes_on(done as f64 / pixels.len() as f64);
            let (done, took) = launcher.pass(&launch, of_pixels)?;
            timings.trace += took;
            in_part = done;
            Ok((done == pixels.len(), took))
        })?;

        let reading = Instant::now();
        launcher.read(pixels)?;
        let (with_more, others) = pixels.split_at(in_part);
        let taken = budget.taken();
        check_written(launcher.gpu, with_more, *taken.end())?;
        check_written(launcher.gpu, others, *taken.start())?;
        timings.readback += reading.elapsed();
        Ok(by)
    }

    /// Takes samples of each tile of `image` until its noise is no more than `target`. A buffer
    /// holds so many tiles; if there are more, they are looked at one bufferful after the other.
    fn take_where_needed(
        &mut self,
        image: &mut [Accumulator],
        of_a_buffer: u32,
        target: f64,
    ) -> Result<Reached> {
        let prepared = self.prepared;
        let size = prepared.launch.image_size;
        let all = tiles_of(size);
        let (mut stopped_by, mut noise) = (StoppedBy::Noise, (0.0, 0.0));
        let mut first = 0;
        while first < all {
            let end = first.saturating_add(of_a_buffer).min(all);
            let part = f64::from(first) / f64::from(all)..f64::from(end) / f64::from(all);
            let goal = Goal {
                target,
                samples: prepared.samples,
                of_launch: most_samples(self.launcher.gpu, prepared),
                deadline: self.deadline(&part),
            };
            let progress = self.progress;
            let progress = |share: f64| progress(part.start + share * (part.end - part.start));
            let mut adaptive = Adaptive::new(size, first..end)?;
            let by = take_samples(&mut adaptive, &prepared.launch, &goal, &progress, self)?;
            adaptive.put_into(image);
            let (squares, pixels) = adaptive.noise();
            noise = (noise.0 + squares, noise.1 + pixels);
            stopped_by = match (by, stopped_by) {
                (StoppedBy::Noise, before)
                | (StoppedBy::Samples, before @ StoppedBy::TimeLimit) => before,
                _ => by,
            };
            if by == StoppedBy::Interrupted {
                break;
            }
            first = end;
        }
        let reached = Reached::of(image, prepared.samples, stopped_by);
        Ok(reached.with_noise_by_groups(noise))
    }

    /// When the time is up for this part of the image: what is left is shared out evenly over what
    /// is left of the image.
    fn deadline(&self, part: &Range<f64>) -> Option<Instant> {
        let limit = self.settings.time_limit?;
        let left = limit.saturating_sub(self.began.elapsed()).as_secs_f64();
        let share = (part.end - part.start) / (1.0 - part.start);
        // One that is beyond what a clock counts is none.
        let left = Duration::try_from_secs_f64(left * share.min(1.0)).ok()?;
        Instant::now().checked_add(left)
    }

    /// The finest preview, in at most so many pixels, that is done in its part of `limit`.
    fn preview(&mut self, max_pixels: usize, limit: Duration) -> Result<Option<Preview>> {
        let (launcher, timings) = (&mut self.launcher, &mut self.timings);
        let progress = self.progress;
        Preview::finest(&self.prepared.launch, max_pixels, limit, |next, goes_on| {
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
}

/// The sums are on the device; the host has a copy of them.
impl Tracer for Work<'_> {
    fn pass(
        &mut self,
        launch: &PathLaunch,
        sums: &mut [Accumulator],
        goes_on: GoesOn<'_>,
    ) -> Result<(bool, Duration)> {
        let all = sums.len();
        let of_pixels = |done: usize| goes_on(done as f64 / all as f64);
        let (done, took) = self.launcher.pass(launch, of_pixels)?;
        self.timings.trace += took;
        Ok((done == all, took))
    }

    fn fetch(&mut self, adaptive: &mut Adaptive, taken: RangeInclusive<u32>) -> Result<()> {
        let reading = Instant::now();
        self.launcher.read(adaptive.active())?;
        let (lacking, all) = (adaptive.lacking(&taken), adaptive.active().len());
        self.timings.readback += reading.elapsed();
        if lacking == 0 {
            return Ok(());
        }
        Err(unwritten(self.launcher.gpu, lacking, all, *taken.start()))
    }

    fn give(&mut self, sums: &[Accumulator]) -> Result<()> {
        let launcher = &self.launcher;
        launcher.gpu.write_first(&launcher.sums, sums)
    }
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
    Err(unwritten(gpu, missing, pixels.len(), samples))
}

fn unwritten(gpu: &Gpu, missing: usize, all: usize, samples: u32) -> Error {
    Error::Readback {
        what: "the image".into(),
        device: gpu.name().into(),
        reason: format!(
            "{missing} of {all} threads of {ENTRY} did not take their {samples} samples"
        ),
    }
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

    /// The largest image that fits has the same shape, and one row more does not fit.
    #[test]
    fn the_largest_sky_fits() {
        // What wgpu binds at most.
        let most = i32::MAX as u64;
        assert!(sky_bytes(16_384, 8192) <= most);
        for limit in [1 << 16, 1 << 27, most] {
            for (width, height) in [(32_768, 16_384), (65_536, 3), (16_384, 16_384)] {
                if sky_bytes(width, height) <= limit {
                    continue;
                }
                let (fits, rows) = largest_sky(width, height, limit);
                assert!(sky_bytes(fits, rows) <= limit, "{fits} × {rows}, {limit}");
                let shape = f64::from(width) / f64::from(height);
                let next = (f64::from(rows + 1) * shape) as u32;
                assert!(
                    sky_bytes(next, rows + 1) > limit,
                    "{fits} × {rows}, {limit}"
                );
            }
        }
    }
}
