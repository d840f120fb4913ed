//! The GPU path: the `render` entry point, tile by tile and run by run.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use glam::UVec2;
use spherule_kernel::accel::node::Node;
use spherule_kernel::film::TILE;
use spherule_kernel::shape::{Kinds, Shape};
use spherule_kernel::{Launch, Material, Pixel, Shading, Sphere};

use super::launch::check_whole;
use super::pace::Pace;
use super::tiles::Tiles;
use super::{Progress, QUIET, Settings, Timings};
use crate::accel::{self, BuiltTree, ShapeTree};
use crate::device::canary::Canary;
use crate::device::{Access, Buffer, Deferring, Gpu, Kernel, Staging, rung};
use crate::error::{Error, Result};
use crate::film;
use crate::scene::World;

/// From how many spheres on a tree is grown. Where they lie evenly, lists for each tile are up to
/// four times as fast and stay ahead up to 30,000; where most lie in a few tiles, a tree is ahead
/// long before, and at 5,000 six times as fast.
const MIN_FOR_TREE: usize = 512;
/// From this many spheres on, those without a tree are listed for each tile.
const MIN_FOR_LISTS: usize = 16;

/// How the spheres that a pixel may see are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Search {
    /// By a tree.
    Tree,
    /// By lists that workgroups make.
    Lists,
    /// Each is asked about.
    None,
}

impl Search {
    /// The fewest intersections that a pixel takes with lists, and how many spheres take one more.
    const WITH_LISTS: u64 = 30;
    const SPHERES_WITH_LISTS: u64 = 128;

    /// The kernel.
    fn entry_point(self) -> &'static str {
        match self {
            Self::Lists => "render_by_tiles",
            Self::Tree | Self::None => "render",
        }
    }

    /// What a pixel takes with so many spheres, in intersections: a guess, of which [`Pace`] learns
    /// more.
    fn work(self, spheres: u64) -> u64 {
        match self {
            Self::Tree => 100,
            Self::Lists => Self::WITH_LISTS + spheres / Self::SPHERES_WITH_LISTS,
            Self::None => spheres,
        }
    }

    /// How many spheres of `left` take about as many intersections, or the fewest that can be asked
    /// for.
    fn spheres(self, work: u32, left: u32) -> u32 {
        match self {
            Self::Tree => left,
            Self::Lists => {
                let more = u64::from(work).saturating_sub(Self::WITH_LISTS).max(1);
                (more * Self::SPHERES_WITH_LISTS).min(left.into()) as u32
            }
            Self::None => work.min(left),
        }
    }
}

/// A world on a GPU, and the kernel for it.
#[derive(Debug)]
pub struct Prepared {
    kernel: Deferring,
    /// The world, in parts that each fit one binding.
    parts: Vec<Part>,
    materials: Buffer<Material>,
    shapes: Option<OtherShapes>,
    search: Search,
    /// What a pixel takes, in intersections.
    work: u64,
    /// What was learned of this kernel so far.
    pace: Mutex<Pace>,
}

/// The shapes beside the spheres, and the kernel for them.
#[derive(Debug)]
struct OtherShapes {
    kernel: Kernel,
    shapes: Buffer<Shape>,
    material_ids: Buffer<u32>,
    nodes: Buffer<Node>,
}

impl OtherShapes {
    /// The entry point's name.
    const ENTRY: &str = "render_shapes";

    /// Grows the tree, uploads the shapes, and compiles the kernel; `None` without shapes.
    fn new(gpu: &Gpu, world: &World, settings: Settings) -> Result<Option<Self>> {
        let tree = ShapeTree::of(world, (0.0, 0.0));
        if tree.kinds.is_empty() {
            return Ok(None);
        }
        let module = rung::module(gpu, settings.rung)?
            .specialise(Shading::SPEC_ID, settings.shading.to_u32())?
            .specialise(Kinds::SPEC_ID, tree.kinds.to_bits())?;
        let mut access = [Access::Read; 6];
        (access[0], access[5]) = (Access::Uniform, Access::ReadWrite);
        Ok(Some(Self {
            kernel: gpu.kernel(&module, Self::ENTRY, &access)?,
            shapes: gpu.upload("shapes", &tree.shapes)?,
            material_ids: gpu.upload("material ids of shapes", &tree.material_ids)?,
            nodes: gpu.upload("nodes of shapes", &tree.nodes)?,
        }))
    }
}

#[derive(Debug)]
struct Part {
    spheres: Buffer<Sphere>,
    material_ids: Buffer<u32>,
    nodes: Buffer<Node>,
}

impl Prepared {
    /// Grows the trees, uploads the world, and compiles the kernel.
    ///
    /// # Errors
    ///
    /// The device's errors, and [`Error::RungRefused`] if the canary objects to the rung.
    pub fn new(gpu: &Gpu, world: &World, settings: Settings) -> Result<Self> {
        Canary::require_on_gpu(gpu, settings.rung)?;
        let limits = gpu.limits();
        let binding = limits
            .max_storage_buffer_binding_size
            .min(limits.max_buffer_size);
        let spheres_a_part = (binding / size_of::<Sphere>() as u64).max(1) as usize;
        let count = world.spheres.len();
        let starts = (0..count.max(1)).step_by(spheres_a_part);
        let runs: Vec<_> = starts
            .map(|first| first..(first + spheres_a_part).min(count))
            .collect();
        // All have trees, or none has.
        let grow = |run: &Range<usize>| {
            let spheres = &world.spheres[run.clone()];
            accel::build_still(spheres, settings.acceleration.min_spheres(MIN_FOR_TREE))
        };
        let trees: Option<Vec<BuiltTree>> = runs.iter().map(grow).collect();
        let parts = runs.iter().enumerate().map(|(index, run)| {
            let spheres = &world.spheres[run.clone()];
            // The kernel has a material for spheres that have none.
            let ids = world.material_ids.get(run.clone()).unwrap_or_default();
            Ok(match &trees {
                Some(trees) => Part {
                    spheres: gpu.upload("spheres", &trees[index].sort(spheres))?,
                    material_ids: gpu.upload("material ids", &trees[index].sort(ids))?,
                    nodes: gpu.upload("nodes", &trees[index].nodes)?,
                },
                None => Part {
                    spheres: gpu.upload("spheres", spheres)?,
                    material_ids: gpu.upload("material ids", ids)?,
                    nodes: gpu.upload("nodes", &[])?,
                },
            })
        });
        let module = rung::module(gpu, settings.rung)?;
        // Vulkan promises workgroups of 128 threads only.
        let has_lists = module.entry_points().iter().any(|entry| {
            let threads: u32 = entry.workgroup_size.iter().product();
            entry.name == Search::Lists.entry_point()
                && threads <= limits.max_compute_invocations_per_workgroup
        });
        let search = if trees.is_some() {
            Search::Tree
        } else if count >= MIN_FOR_LISTS && has_lists {
            Search::Lists
        } else {
            Search::None
        };
        let mut access = vec![Access::Read; if search == Search::Lists { 5 } else { 6 }];
        if let [first, .., last] = &mut access[..] {
            (*first, *last) = (Access::Uniform, Access::ReadWrite);
        }
        let entry_point = search.entry_point();
        let kernel = Deferring::compile(gpu, settings.rung, entry_point, &access, |module| {
            module
                .specialise(Shading::SPEC_ID, settings.shading.to_u32())?
                .specialise(Node::SPEC_ID, trees.is_some().into())
        })?;
        Ok(Self {
            kernel,
            search,
            parts: parts.collect::<Result<_>>()?,
            shapes: OtherShapes::new(gpu, world, settings)?,
            materials: gpu.upload("materials", &world.materials)?,
            work: search.work(count as u64),
            pace: Mutex::new(Pace::first_on(gpu)),
        })
    }
}

impl Prepared {
    /// Starts from what was learned, and keeps what is.
    fn paced<T>(&self, render: impl FnOnce(&mut Pace) -> T) -> T {
        let learned = || self.pace.lock().unwrap_or_else(PoisonError::into_inner);
        let mut pace = *learned();
        let result = render(&mut pace);
        *learned() = pace;
        result
    }
}

/// Renders `launch`, which covers a whole image, on `gpu`. Where `progress` breaks off, the pixels
/// that were not reached are [not written](Pixel::is_written).
///
/// # Errors
///
/// The device's errors, and [`Error::Readback`] if a thread wrote no pixel.
pub fn render(
    gpu: &Gpu,
    launch: &Launch,
    world: &Prepared,
    progress: Progress<'_>,
) -> Result<(Vec<Pixel>, Timings)> {
    world.paced(|pace| render_paced(gpu, launch, world, progress, pace))
}

/// [`render`] with launches sized by `pace`.
///
/// # Errors
///
/// As [`render`].
pub fn render_paced(
    gpu: &Gpu,
    launch: &Launch,
    world: &Prepared,
    progress: Progress<'_>,
    pace: &mut Pace,
) -> Result<(Vec<Pixel>, Timings)> {
    check_whole(launch)?;
    let size = launch.image_size;
    let mut image = film::allocate(size.x, size.y)?;
    let mut readback = Duration::ZERO;
    let timings = each_tile(
        gpu,
        launch,
        world,
        pace,
        progress,
        |target, start, count| {
            let reading = Instant::now();
            let pixels = &mut image[start..start + count];
            gpu.read_through(&target.staging, &target.pixels, pixels)?;
            check_written(gpu, pixels)?;
            readback += reading.elapsed();
            Ok(())
        },
    )?;
    Ok((
        image,
        Timings {
            readback,
            ..timings
        },
    ))
}

/// What [`render`] takes on the device, by its clock if it has one; the image stays there.
///
/// # Errors
///
/// As [`render`].
pub fn time(gpu: &Gpu, launch: &Launch, world: &Prepared) -> Result<Duration> {
    check_whole(launch)?;
    let all = world.paced(|pace| each_tile(gpu, launch, world, pace, QUIET, |_, _, _| Ok(())))?;
    Ok(all.trace)
}

/// Renders a launch tile by tile, for as long as `progress` goes on. `finished` is told where a
/// tile's pixels are, which of the image its first is, and how many there are.
fn each_tile(
    gpu: &Gpu,
    launch: &Launch,
    world: &Prepared,
    pace: &mut Pace,
    progress: Progress<'_>,
    mut finished: impl FnMut(&Target, usize, usize) -> Result<()>,
) -> Result<Timings> {
    let started = Instant::now();
    let size = launch.image_size;
    let tiles = Tiles::new::<Pixel>(gpu, size);
    let pixels = gpu.zeroed("pixels", tiles.max_pixels())?;
    let target = Target {
        launch: gpu.upload_uniform("launch", launch)?,
        staging: gpu.staging(&pixels, tiles.max_pixels())?,
        pixels,
        deferred: Deferring::list(gpu, tiles.max_pixels())?,
    };
    let mut timings = Timings {
        setup: started.elapsed(),
        ..Timings::default()
    };
    let mut origin = UVec2::ZERO;
    while origin.y < size.y {
        let tile = tiles.at(origin, pace, world.work);
        let launch = Launch {
            tile_origin: origin,
            tile_size: tile,
            ..*launch
        };
        let count = tile.x as usize * tile.y as usize;
        let (start, all) = (tiles.start(origin), size.x as usize * size.y as usize);
        let goes_on = |share: f64| {
            let done = (start as f64 + count as f64 * share) / all as f64;
            progress(done).is_continue()
        };
        let (took, is_whole) = render_tile(gpu, &launch, world, &target, pace, goes_on)?;
        timings.trace += took;
        if !is_whole {
            break;
        }
        finished(&target, start, count)?;
        if progress((start + count) as f64 / all as f64).is_break() {
            break;
        }
        origin = tiles.next(origin, tile);
    }
    Ok(timings)
}

/// What the launches write to, and what they are told.
struct Target {
    launch: Buffer<Launch>,
    pixels: Buffer<Pixel>,
    /// The pixels, or tiles of them, that a first launch leaves to a second.
    deferred: Buffer<u32>,
    /// What they are read through.
    staging: Staging,
}

/// Renders one tile against every part of the world. Returns how long that took, and whether every
/// sphere was tested: not where `goes_on`, which is asked between launches and told the share of
/// the spheres that were, says no.
fn render_tile(
    gpu: &Gpu,
    launch: &Launch,
    world: &Prepared,
    target: &Target,
    pace: &mut Pace,
    goes_on: impl Fn(f64) -> bool,
) -> Result<(Duration, bool)> {
    gpu.clear(&target.pixels)?;
    let tile = launch.tile_size;
    let pixels = u64::from(tile.x) * u64::from(tile.y);
    let mut launch = *launch;
    let mut took = Duration::ZERO;
    let all: usize = world.parts.iter().map(|part| part.spheres.len()).sum();
    let mut before = 0;
    for part in &world.parts {
        launch.first_sphere = 0;
        loop {
            let tested = before + launch.first_sphere as usize;
            if !goes_on(tested as f64 / all.max(1) as f64) {
                return Ok((took, false));
            }
            let left = part.spheres.len() as u32 - launch.first_sphere;
            launch.sphere_count = world.search.spheres(pace.spheres(pixels), left);
            gpu.update(&target.launch, &launch)?;
            let mut bindings = vec![
                target.launch.binding(),
                part.spheres.binding(),
                part.material_ids.binding(),
                world.materials.binding(),
            ];
            let groups = if world.search == Search::Lists {
                [tile.x.div_ceil(TILE), tile.y.div_ceil(TILE), 1]
            } else {
                bindings.push(part.nodes.binding());
                world.kernel.workgroups_for([tile.x, tile.y, 1])
            };
            bindings.push(target.pixels.binding());
            let time = world
                .kernel
                .launch(gpu, bindings, &target.deferred, groups)?;
            let work = world.search.work(launch.sphere_count.into());
            pace.learn(pixels * work, time.best());
            took += time.best();
            launch.first_of_tile = 0;
            launch.first_sphere += launch.sphere_count;
            if launch.first_sphere as usize >= part.spheres.len() {
                break;
            }
        }
        before += part.spheres.len();
    }
    if let Some(shapes) = &world.shapes {
        gpu.update(&target.launch, &launch)?;
        let bindings = [
            target.launch.binding(),
            shapes.shapes.binding(),
            shapes.material_ids.binding(),
            world.materials.binding(),
            shapes.nodes.binding(),
            target.pixels.binding(),
        ];
        let groups = shapes.kernel.workgroups_for([tile.x, tile.y, 1]);
        took += gpu.launch(&shapes.kernel, &bindings, groups)?.best();
    }
    Ok((took, true))
}

/// A kernel that panics on the device returns without a word; what it leaves behind is the zero
/// that the buffer was filled with.
fn check_written(gpu: &Gpu, pixels: &[Pixel]) -> Result<()> {
    let missing = pixels.iter().filter(|pixel| !pixel.is_written()).count();
    if missing == 0 {
        return Ok(());
    }
    Err(Error::Readback {
        what: "the image".into(),
        device: gpu.name().into(),
        reason: format!("{missing} of {} pixels were not written", pixels.len()),
    })
}
