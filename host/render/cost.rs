//! What effects cost: the time of a frame by pipelines that hold more or fewer of them.

use serde::Serialize;

use super::paths::EffectChoice;
use super::{QUIET, Settings, render};
use crate::device::Device;
use crate::error::Result;
use crate::scene::Scene;

/// How often each pipeline renders the frame; they take turns, so that a machine whose speed drifts
/// slows all of them alike.
const ROUNDS: usize = 7;

/// What a frame costs by one pipeline, in milliseconds of tracing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Cost {
    /// The median.
    pub milliseconds: f64,
    /// The fastest run.
    pub fastest: f64,
    /// The slowest run.
    pub slowest: f64,
    /// Compiling the pipeline the first time; zero on the CPU. Drivers may have kept it from before.
    pub compile_milliseconds: f64,
}

/// How many frames [`measure`] renders by so many pipelines.
#[must_use]
pub fn frames(pipelines: usize) -> usize {
    pipelines * (1 + ROUNDS)
}

/// The costs of `scene` on `device` by the pipelines of each of `choices`.
///
/// # Errors
///
/// As [`render`].
pub fn measure(
    scene: &Scene,
    settings: Settings,
    device: &Device,
    choices: &[EffectChoice],
) -> Result<Vec<Cost>> {
    let mut runs = vec![Vec::new(); choices.len()];
    let mut compiling = vec![0.0; choices.len()];
    for round in 0..=ROUNDS {
        for (index, effects) in choices.iter().enumerate() {
            let settings = Settings {
                effects: *effects,
                ..settings
            };
            let timings = render(scene, settings, device, QUIET)?.timings;
            // The first round warms up.
            if round == 0 {
                compiling[index] = timings.compile.as_secs_f64() * 1e3;
            } else {
                runs[index].push(timings.trace.as_secs_f64() * 1e3);
            }
        }
    }
    Ok(runs
        .into_iter()
        .zip(compiling)
        .map(|(mut runs, compile_milliseconds)| {
            runs.sort_by(f64::total_cmp);
            Cost {
                milliseconds: runs[ROUNDS / 2],
                fastest: runs[0],
                slowest: runs[ROUNDS - 1],
                compile_milliseconds,
            }
        })
        .collect())
}
