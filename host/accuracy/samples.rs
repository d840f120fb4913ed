//! What accuracy costs in time, for sampling: the error of an image as its samples grow.

use serde::Serialize;
use spherule_kernel::Rung;
use spherule_kernel::integrate::luminance;

use crate::device::Device;
use crate::error::Result;
use crate::film::Image;
use crate::film::flip::mean_flip;
use crate::render::{QUIET, Settings, render};
use crate::scene::Scene;
use crate::scene::limits::MAX_SAMPLES;

/// How many more samples the reference has than the last step.
const REFERENCE: u32 = 16;

/// An image of some samples, against one of many.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Step {
    /// The rung.
    pub rung: &'static str,
    /// Samples a pixel.
    pub samples: u32,
    /// The time of tracing, in milliseconds.
    pub milliseconds: f64,
    /// The root mean square error of the luminance, over the mean luminance of the reference.
    pub error: f64,
    /// What the render itself estimated of it, without a reference.
    pub estimate: f64,
    /// The mean ꟻLIP against the reference.
    pub flip: f64,
}

/// How many samples a pixel [`measure`] takes in all.
#[must_use]
pub fn in_all(rungs: usize, most: u32) -> u64 {
    2 * rungs as u64 * u64::from(most) + u64::from(of_reference(most))
}

/// How many samples a pixel the reference has.
fn of_reference(most: u32) -> u32 {
    most.saturating_mul(REFERENCE).min(MAX_SAMPLES)
}

/// Renders `scene` on `device` on each of `rungs` with 1, 2, 4, … up to `most` samples. The reference
/// is of another seed, on the highest of the rungs, with sixteen times as many.
///
/// # Errors
///
/// As [`render`].
pub fn measure(device: &Device, rungs: &[Rung], scene: &Scene, most: u32) -> Result<Vec<Step>> {
    let settings = |rung| Settings {
        rung,
        ..Settings::default()
    };
    let mut scene = scene.clone();
    scene.sampling.samples = Some(of_reference(most));
    scene.sampling.seed = scene.sampling.seed.wrapping_add(0x5eed);
    let highest = rungs.last().copied().unwrap_or_default();
    let reference = render(&scene, settings(highest), device, QUIET)?.image;
    scene.sampling.seed = scene.sampling.seed.wrapping_sub(0x5eed);
    let mut steps = Vec::new();
    for rung in rungs {
        let mut samples = 1;
        while samples <= most {
            scene.sampling.samples = Some(samples);
            let rendered = render(&scene, settings(*rung), device, QUIET)?;
            steps.push(Step {
                rung: rung.name(),
                samples,
                milliseconds: rendered.timings.trace.as_secs_f64() * 1e3,
                error: error(&rendered.image, &reference),
                estimate: rendered.reached.map_or(0.0, |reached| reached.noise),
                flip: mean_flip(&reference, &rendered.image).unwrap_or(f64::NAN),
            });
            samples *= 2;
        }
    }
    Ok(steps)
}

/// See [`Step::error`].
fn error(image: &Image, reference: &Image) -> f64 {
    let (mut squares, mut sum) = (0.0, 0.0);
    for (a, b) in image.pixels().iter().zip(reference.pixels()) {
        squares += f64::from(luminance(a.color() - b.color())).powi(2);
        sum += f64::from(luminance(b.color()));
    }
    let count = reference.pixels().len().max(1) as f64;
    if sum > 0.0 {
        (squares / count).sqrt() / (sum / count)
    } else {
        0.0
    }
}
