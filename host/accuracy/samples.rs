//! Measures the error of an image, and the time, for more and more samples.

use std::time::{Duration, Instant};

use serde::Serialize;
use spherule_kernel::Rung;
use spherule_kernel::color::luminance;

use crate::device::Device;
use crate::error::Result;
use crate::film::Image;
use crate::film::denoise::Denoiser;
use crate::film::flip::mean_flip;
use crate::render::{Progress, Rendered, Settings, render};
use crate::scene::Scene;
use crate::scene::limits::MAX_SAMPLES;

/// The reference has this many times the samples of the last step.
const REFERENCE: u32 = 16;
/// If time runs out, it must still have this many times the samples of a step; with fewer, the
/// error would be that of the reference.
pub(crate) const LEAST_REFERENCE: u32 = 8;
/// The share of the time that the reference may take. If it gets all of its samples, the steps of
/// three rungs take a quarter of the whole.
const SHARE: f64 = 0.7;

/// The error and the time of an image with some samples, measured against an image with many.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Step {
    /// The rung.
    pub rung: &'static str,
    /// Whether the image was denoised, which makes it biased.
    pub denoised: bool,
    /// Samples a pixel.
    pub samples: u32,
    /// The time of tracing, and of denoising, in milliseconds.
    pub milliseconds: f64,
    /// The root mean square error of the luminance, over the mean luminance of the reference.
    pub error: f64,
    /// The render's own estimate of the error, without a reference; NaN for a denoised image.
    pub estimate: f64,
    /// The mean ꟻLIP against the reference.
    pub flip: f64,
}

impl Step {
    fn of(rendered: &Rendered, rung: &'static str, samples: u32, reference: &Image) -> Self {
        Self {
            rung,
            denoised: false,
            samples,
            milliseconds: rendered.timings.trace.as_secs_f64() * 1e3,
            error: error(&rendered.image, reference),
            estimate: rendered.reached.map_or(0.0, |reached| reached.noise),
            flip: mean_flip(reference, &rendered.image).unwrap_or(f64::NAN),
        }
    }

    /// The step of this image without its noise.
    fn denoised(
        self,
        mut rendered: Rendered,
        denoiser: &mut Denoiser,
        reference: &Image,
    ) -> Result<Self> {
        let started = Instant::now();
        denoiser.denoise(&mut rendered.image)?;
        let took = started.elapsed();
        Ok(Self {
            denoised: true,
            milliseconds: self.milliseconds + took.as_secs_f64() * 1e3,
            estimate: f64::NAN,
            ..Self::of(&rendered, self.rung, self.samples, reference)
        })
    }

    /// What the steps of one line of a plot have in common: the rung, or that they are denoised.
    #[must_use]
    pub fn series(&self) -> &'static str {
        if self.denoised { "denoised" } else { self.rung }
    }
}

/// How many samples a pixel [`measure`] takes in all.
#[must_use]
pub fn in_all(rungs: usize, most: u32) -> u64 {
    (rungs as u64)
        .saturating_mul(2 * u64::from(most))
        .saturating_add(u64::from(of_reference(most)))
}

/// How many samples a pixel the reference has.
fn of_reference(most: u32) -> u32 {
    most.saturating_mul(REFERENCE).min(MAX_SAMPLES)
}

/// What [`measure`] does, and how long it may take.
#[derive(Debug)]
pub struct Plan {
    /// The most samples of a step.
    pub most: u32,
    /// With a denoiser the images of the first rung are also measured after it has removed their
    /// noise.
    pub denoiser: Option<Denoiser>,
    /// The time that compiling a pipeline took before, if one was compiled.
    pub compiling: Duration,
    /// When to be done, with fewer samples if need be.
    pub until: Option<Instant>,
}

/// The steps, and the samples of their reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Convergence {
    /// Rung by rung, the fewest samples first.
    pub steps: Vec<Step>,
    /// How many samples a pixel the reference has.
    pub reference: u32,
    /// Whether time ran out before every step was measured.
    pub is_cut: bool,
}

/// Renders `scene` on `device` on each of `rungs` with 1, 2, 4, … samples, up to the plan's most.
/// The reference has another seed and sixteen times as many samples, on the highest of the rungs.
/// All have fewer samples if they would not be done in time. If the reference has fewer than eight
/// samples by then, there are no steps, because noise would be measured against noise; otherwise
/// the first step is always measured.
///
/// # Errors
///
/// As [`render`], and as [`Denoiser::denoise`].
pub fn measure(
    device: &Device,
    rungs: &[Rung],
    scene: &Scene,
    plan: Plan,
    progress: Progress<'_>,
) -> Result<Convergence> {
    let Plan {
        most,
        mut denoiser,
        compiling,
        until,
    } = plan;
    let left = || until.map(|until| until.saturating_duration_since(Instant::now()));
    let all = in_all(rungs.len(), most) as f64;
    let mut done = 0.0;
    let mut scene = scene.clone();
    let wanted = of_reference(most);
    scene.sampling.samples = Some(wanted);
    scene.sampling.seed = scene.sampling.seed.wrapping_add(0x5eed);
    let settings = Settings {
        rung: rungs.last().copied().unwrap_or_default(),
        time_limit: left().map(|left| left.mul_f64(SHARE)),
        ..Settings::default()
    };
    let started = Instant::now();
    let rendered = render(&scene, settings, device, &|part| {
        progress(part * f64::from(wanted) / all)
    })?;
    let took = started.elapsed();
    let compiling = compiling.max(rendered.timings.compile);
    let reference = rendered.image;
    let reached = rendered.reached.map_or(1, |reached| reached.samples).max(1);
    done += f64::from(wanted);
    scene.sampling.seed = scene.sampling.seed.wrapping_sub(0x5eed);

    let mut steps = Vec::new();
    let mut is_cut = false;
    for rung in rungs {
        let mut clean = Vec::new();
        let settings = Settings {
            rung: *rung,
            ..Settings::default()
        };
        let mut samples = 1;
        // First by the reference, whose pipeline is similar on another rung, then by the step
        // before.
        let mut expected = compiling.saturating_add(took / reached);
        while samples <= most {
            let is_late = left().is_some_and(|left| left < expected);
            let is_near = reached < wanted && reached / samples < LEAST_REFERENCE;
            if is_near || (is_late && !steps.is_empty()) {
                is_cut = true;
                break;
            }
            scene.sampling.samples = Some(samples);
            let started = Instant::now();
            let before = done;
            let rendered = render(&scene, settings, device, &|part| {
                progress((before + part * f64::from(samples)) / all)
            })?;
            let compile = rendered.timings.compile;
            expected = started.elapsed().saturating_sub(compile).saturating_mul(2);
            done += f64::from(samples);
            let step = Step::of(&rendered, rung.name(), samples, &reference);
            steps.push(step);
            if let Some(denoiser) = &mut denoiser {
                clean.push(step.denoised(rendered, denoiser, &reference)?);
            }
            let Some(next) = samples.checked_mul(2) else {
                break;
            };
            samples = next;
        }
        steps.append(&mut clean);
        denoiser = None;
    }
    Ok(Convergence {
        steps,
        reference: reached,
        is_cut,
    })
}

/// Computes [`Step::error`].
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
