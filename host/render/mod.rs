//! Rendering a scene on a device.
//!
//! | module | holds |
//! | --- | --- |
//! | [`cpu`] | on every thread of this machine |
//! | `packet` | camera rays on the CPU, a square of pixels at once |
//! | [`gpu`] | the kernel's entry point over tiles, within a device's limits |
//! | [`paths`] | light paths, for scenes that call for effects |
//! | [`estimate`] | whether a GPU is worth opening for an image |
//! | [`cost`] | the time of a frame by pipelines of more or fewer effects |
//! | [`fit`](mod@fit) | how large an image may be to be measured in the time there is |
//! | [`pace`] | how much work one launch gets |
//! | `tiles` | how an image is cut within a device's limits |

pub mod cost;
pub mod cpu;
pub mod estimate;
pub mod fit;
pub mod gpu;
pub mod pace;
mod packet;
pub mod paths;
mod tiles;

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use glam::Vec3;
use spherule_kernel::{Camera, Hit, Launch, PathLaunch, Pixel, Rung, Shading};

use crate::device::Device;
use crate::error::{Error, Result, SceneError};
use crate::film::Image;
use crate::memory;
use crate::plural::count_of;
use crate::scene::Scene;
use crate::scene::tree::{self, Acceleration};
use paths::{EffectChoice, Reached, StoppedBy};

/// What is fixed before the kernel is compiled, on the GPU and on the CPU.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// What the image shows of a hit.
    pub shading: Shading,
    /// How rays are intersected with spheres.
    pub rung: Rung,
    /// Whether spheres stand in a tree.
    pub acceleration: Acceleration,
    /// Which effects the pipeline holds; only [`Shading::Lit`] shows any.
    pub effects: EffectChoice,
    /// Stops after this time of tracing, give or take a launch on a GPU.
    pub time_limit: Option<Duration>,
    /// Stops taking samples when [`Reached::noise`](paths::Reached::noise) is as low as this.
    pub noise: Option<f64>,
}

impl From<Shading> for Settings {
    fn from(shading: Shading) -> Self {
        Self {
            shading,
            ..Self::default()
        }
    }
}

impl From<(Shading, Rung)> for Settings {
    fn from((shading, rung): (Shading, Rung)) -> Self {
        Self {
            shading,
            rung,
            ..Self::default()
        }
    }
}

/// Memory for all that is small, in bytes.
const MARGIN: u64 = 4 << 20;
/// What a texel of the surroundings takes at most while tables are made of it: its probability, its share of a vector that grows, and the
/// table.
const BYTES_A_TEXEL: u64 = 64;

/// Told how far a render is, a number from 0 to 1, and asked whether it goes on.
///
/// It is called from any thread, every few milliseconds of each on a CPU and after each launch on a GPU, and so must be quick. Where it
/// breaks off, the render ends with what it has: see [`Rendered::is_complete`].
pub type Progress<'a> = &'a (dyn Fn(f64) -> ControlFlow<()> + Sync);

/// Ignores progress, and always goes on.
pub const QUIET: Progress<'static> = &|_| ControlFlow::Continue(());

/// An image, and what it took.
#[derive(Debug)]
pub struct Rendered {
    /// The image. Pixels that no ray was traced for are transparent, and black where nothing shows that;
    /// where a time limit left them out of an image of samples, they show a coarse preview instead.
    pub image: Image,
    /// How many pixels a ray was traced for: all, unless the render was stopped early.
    pub traced: u64,
    /// How many camera rays were traced for the image: one for each sample of each pixel, and none for a preview. Light paths go
    /// on from there.
    pub rays: u64,
    /// What it took.
    pub timings: Timings,
    /// How far it came, where there is more than one ray a pixel.
    pub reached: Option<Reached>,
}

impl Rendered {
    /// Whether each pixel was traced, and nothing broke off its samples: a time limit or a noise target that was reached
    /// did not.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        let pixels = u64::from(self.image.width()) * u64::from(self.image.height());
        let is_broken_off = |reached: Reached| reached.stopped_by == StoppedBy::Interrupted;
        self.traced == pixels && !self.reached.is_some_and(is_broken_off)
    }
}

/// Where the time of a render went.
#[derive(Clone, Copy, Debug, Default)]
pub struct Timings {
    /// Growing the tree; on a GPU, compiling the kernel and uploading the world, too.
    pub setup: Duration,
    /// Of that, compiling the kernel for these effects and this rung.
    pub compile: Duration,
    /// Tracing: the device's own time where it can be measured, else the host's.
    pub trace: Duration,
    /// Copying the image back; zero on the CPU.
    pub readback: Duration,
}

/// Renders `scene` on `device`.
///
/// ```
/// use spherule::kernel::Shading;
/// use spherule::{Device, DeviceChoice, Scene, render};
/// # fn main() -> spherule::Result<()> {
/// let scene = Scene::load("scenes/two-spheres.toml")?;
/// let (device, _why) = Device::open(&DeviceChoice::Cpu)?;
/// let rendered = render::render(&scene, Shading::Normals, &device, render::QUIET)?;
/// assert_eq!(rendered.image.width(), scene.width);
/// # Ok(()) }
/// ```
///
/// # Errors
///
/// [`Error::Scene`] as [`Scene::validate`] has it, and the device's errors.
pub fn render(
    scene: &Scene,
    settings: impl Into<Settings>,
    device: &Device,
    progress: Progress<'_>,
) -> Result<Rendered> {
    let settings = settings.into();
    // Whoever has once broken off is not asked again.
    let is_over = AtomicBool::new(false);
    let progress: Progress<'_> = &|done| {
        if is_over.load(Ordering::Relaxed) || progress(done).is_break() {
            is_over.store(true, Ordering::Relaxed);
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    };
    let shown = settings.effects.shown(scene.effects());
    if settings.shading == Shading::Lit && !shown.is_empty() {
        return paths::render(scene, &settings, device, progress);
    }
    let launch = whole_image(scene)?;
    memory_for(scene, size_of::<Pixel>() as u64)?;
    let is_late = AtomicBool::new(false);
    let (mut pixels, timings) = match device {
        Device::Cpu => {
            let started = Instant::now();
            let world = cpu::Prepared::new(&scene.world, settings.acceleration);
            let setup = started.elapsed();
            let progress = within(settings.time_limit, &is_late, progress);
            let pixels = cpu::render(&launch, &world, settings, &progress)?;
            let timings = Timings {
                setup,
                trace: started.elapsed() - setup,
                ..Timings::default()
            };
            (pixels, timings)
        }
        Device::Gpu(gpu) => {
            let started = Instant::now();
            let world = gpu::Prepared::new(gpu, &scene.world, settings)?;
            let setup = started.elapsed();
            let progress = within(settings.time_limit, &is_late, progress);
            let (pixels, timings) = gpu::render(gpu, &launch, &world, &progress)?;
            let timings = Timings {
                setup: setup + timings.setup,
                ..timings
            };
            (pixels, timings)
        }
    };
    let mut missing = Vec::new();
    let mut traced = pixels.len() as u64;
    if is_over.into_inner() || is_late.into_inner() {
        traced = pixels.iter().filter(|pixel| pixel.is_written()).count() as u64;
        missing = blank_the_rest(&mut pixels);
    }
    let mut image = Image::new(scene.width, scene.height, settings.shading, pixels)?;
    image.develop = scene.develop;
    if !missing.is_empty() {
        image.set_alpha(missing)?;
    }
    Ok(Rendered {
        image,
        traced,
        rays: traced,
        timings,
        reached: None,
    })
}

/// Breaks off as `progress` does, and when the time, which begins now, is up. `is_late` learns that.
fn within<'a>(
    limit: Option<Duration>,
    is_late: &'a AtomicBool,
    progress: Progress<'a>,
) -> impl Fn(f64) -> ControlFlow<()> + Sync + 'a {
    let started = Instant::now();
    move |done| {
        if limit.is_some_and(|limit| started.elapsed() >= limit) {
            is_late.store(true, Ordering::Relaxed);
            return ControlFlow::Break(());
        }
        progress(done)
    }
}

/// Whether there is memory for the image of `scene`, of which each pixel takes so many bytes on the host, and for the tree: what is
/// computed is not to be lost for want of it.
///
/// # Errors
///
/// [`Error::OutOfHostMemory`] with the sum.
fn memory_for(scene: &Scene, bytes_a_pixel: u64) -> Result<()> {
    let pixels = u64::from(scene.width) * u64::from(scene.height);
    let spheres = scene.world.spheres.len() as u64;
    let image = scene.sky.as_ref().and_then(|sky| sky.image.as_ref());
    let texels = image.map_or(0, |image| image.texels.len() as u64);
    memory::check(
        bytes_a_pixel
            .saturating_mul(pixels)
            .saturating_add(tree::BYTES_A_SPHERE * spheres + BYTES_A_TEXEL * texels + MARGIN),
        &format!(
            "an image of {} × {} pixels of {}",
            scene.width,
            scene.height,
            count_of(scene.world.spheres.len(), "sphere"),
        ),
    )
}

/// Makes pixels that no kernel has written black ones that show no sphere, and returns how opaque each pixel is; nothing if all are
/// there, or if there is no memory for it.
fn blank_the_rest(pixels: &mut [Pixel]) -> Vec<f32> {
    if pixels.iter().all(Pixel::is_written) {
        return Vec::new();
    }
    let mut alpha = memory::room(pixels.len() as u64, "the alpha channel").unwrap_or_default();
    let has_room = alpha.capacity() > 0;
    for pixel in pixels {
        let is_there = pixel.is_written();
        if !is_there {
            *pixel = Pixel::new(Vec3::ZERO, Hit::NONE_T);
        }
        if has_room {
            alpha.push(f32::from(u8::from(is_there)));
        }
    }
    alpha
}

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
fn check_launch(launch: &Launch) -> Result<()> {
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
fn check_whole(launch: &Launch) -> Result<()> {
    check_launch(&Launch {
        tile_origin: glam::UVec2::ZERO,
        tile_size: launch.image_size,
        ..*launch
    })
}

/// Whether light paths are to be traced for an image that can be, all of it.
fn check_path_launch(launch: &PathLaunch) -> Result<()> {
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
fn check_pixels(launch: &Launch, count: usize) -> Result<()> {
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
