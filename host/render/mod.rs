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
#[cfg(feature = "gpu")]
pub mod gpu;
mod image_memory;
mod launch;
#[cfg(feature = "gpu")]
pub mod pace;
mod packet;
pub mod paths;
mod rendered;
mod settings;
#[cfg(feature = "gpu")]
mod tiles;

use std::borrow::Cow;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use glam::Vec3;
use spherule_kernel::shading::Quantity;
use spherule_kernel::{Hit, Pixel, Shading};

use crate::device::Device;
use crate::error::Result;
use crate::film::Image;
use crate::memory;
use crate::scene::Scene;
use image_memory::memory_for;
pub use launch::whole_image;
pub use rendered::{Rendered, Timings};
pub use settings::{EffectChoice, Progress, QUIET, Settings};

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
/// [`Error::Scene`](crate::Error::Scene) as [`Scene::validate`] has it, and the device's errors.
pub fn render(
    scene: &Scene,
    settings: impl Into<Settings>,
    device: &Device,
    progress: Progress<'_>,
) -> Result<Rendered> {
    let settings = settings.into();
    scene.require_rung(settings.rung)?;
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
    let world = match settings.shading.quantity() {
        Quantity::Index => Cow::Owned(scene.world.numbered()?),
        Quantity::Light | Quantity::Color | Quantity::Vector | Quantity::Distance => {
            Cow::Borrowed(&scene.world)
        }
    };
    let is_late = AtomicBool::new(false);
    let (mut pixels, timings) = match device {
        Device::Cpu => {
            let started = Instant::now();
            let world = cpu::Prepared::new(&world, settings.acceleration);
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
        #[cfg(feature = "gpu")]
        Device::Gpu(gpu) => {
            let started = Instant::now();
            let world = gpu::Prepared::new(gpu, &world, settings)?;
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

/// Breaks off as `progress` does, and when the time, which begins now, is up. `is_late` learns
/// that.
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

/// Makes pixels that no kernel has written black ones that show no sphere, and returns how opaque
/// each pixel is; nothing if all are there, or if there is no memory for it.
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
