//! Light paths: scenes that call for more than one ray a pixel shows.
//!
//! | module | holds |
//! | --- | --- |
//! | [`prepare`] | what the kernel is told of a scene: the launch, the lights, the tables |
//! | [`cpu`] | the kernel's function over bands of rows, on every thread |
//! | [`gpu`] | the kernel's entry point over tiles and runs of samples |
//! | [`budget`] | when enough samples are enough |

pub mod budget;
pub mod cpu;
pub mod gpu;
pub mod prepare;

use spherule_kernel::{Accumulator, Effects, Pixel, Shading};

use super::{Progress, Rendered, Settings};
use crate::device::Device;
use crate::error::Result;
use crate::film::Image;
use crate::scene::Scene;
pub use budget::{Reached, StoppedBy};
pub use prepare::Prepared;

/// Which effects the pipeline is compiled for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EffectChoice {
    /// Those that the scene calls for.
    #[default]
    Auto,
    /// Every effect there is; those that the scene does not call for stay idle.
    All,
    /// Those of this set that the scene calls for; the others are left out of the image.
    Only(Effects),
}

impl EffectChoice {
    /// Of the effects that a scene calls for, those that its image shows.
    #[must_use]
    pub fn shown(self, called: Effects) -> Effects {
        match self {
            Self::Auto | Self::All => called,
            Self::Only(effects) => called.within(effects),
        }
    }

    /// The effects that the pipeline is compiled for.
    #[must_use]
    pub fn compiled(self, called: Effects) -> Effects {
        match self {
            Self::All => Effects::ALL,
            Self::Auto | Self::Only(_) => self.shown(called),
        }
    }
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
    let prepared = Prepared::new(scene, settings.effects, settings.acceleration)?;
    let (accumulators, timings, reached) = match device {
        Device::Cpu => cpu::render(&prepared, settings, progress)?,
        Device::Gpu(gpu) => gpu::render(gpu, &prepared, settings, progress)?,
    };
    let pixels = accumulators
        .iter()
        .map(|sum| Pixel::new(sum.color(), depth(sum)))
        .collect();
    let mut image = Image::new(scene.width, scene.height, Shading::Lit, pixels);
    if prepared.shown.any(Effects::TRANSPARENT_BACKGROUND) {
        image.set_alpha(accumulators.iter().map(Accumulator::alpha).collect());
    }
    image.develop = scene.develop;
    Ok(Rendered {
        image,
        timings,
        reached: Some(reached),
    })
}

/// A depth of exactly zero is a pixel that no kernel wrote.
fn depth(sum: &Accumulator) -> f32 {
    sum.depth().max(f32::MIN_POSITIVE)
}
