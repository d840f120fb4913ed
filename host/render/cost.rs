//! What effects cost: the time of a frame by pipelines that hold more or fewer of them.

use std::time::{Duration, Instant};

use serde::Serialize;

use super::settings::EffectChoice;
use super::{Progress, Settings, render};
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
    /// How many runs there were.
    pub runs: usize,
    /// Compiling the pipeline the first time; zero on the CPU. Drivers may have kept it from
    /// before.
    pub compile_milliseconds: f64,
}

/// How many frames [`measure`] renders by so many pipelines.
#[must_use]
pub fn frames(pipelines: usize) -> usize {
    pipelines.saturating_mul(1 + ROUNDS)
}

/// The costs of `scene` on `device` by the pipelines of each of `choices`. Only the first is
/// certain to be measured: a frame that would not be done at `until`, by what frames took before,
/// is not begun. `compiling` is what it took to compile the first before, if it was; it is not
/// compiled again.
///
/// # Errors
///
/// As [`render`].
pub fn measure(
    scene: &Scene,
    settings: Settings,
    device: &Device,
    choices: &[EffectChoice],
    compiling: Duration,
    until: Option<Instant>,
    progress: Progress<'_>,
) -> Result<Vec<Option<Cost>>> {
    let mut times: Vec<Vec<Duration>> = vec![Vec::new(); choices.len()];
    // The longest frame of the first round, with all that is around it, and its last by each
    // pipeline.
    let mut longest = compiling;
    let mut compiled = vec![Duration::ZERO; choices.len()];
    let mut last = vec![Duration::ZERO; choices.len()];
    'rounds: for round in 0..=ROUNDS {
        for (index, effects) in choices.iter().enumerate() {
            let before = round * choices.len() + index;
            let expected = if round == 0 { longest } else { last[index] };
            let started = Instant::now();
            if before > 0
                && until.is_some_and(|until| until.saturating_duration_since(started) < expected)
            {
                break 'rounds;
            }
            let settings = Settings {
                effects: *effects,
                ..settings
            };
            let timings = render(scene, settings, device, &|done| {
                progress((before as f64 + done) / frames(choices.len()) as f64)
            })?
            .timings;
            if round == 0 {
                compiled[index] = timings.compile;
                longest = longest.max(started.elapsed());
            }
            last[index] = started.elapsed().saturating_sub(timings.compile);
            times[index].push(timings.trace);
        }
    }
    if let Some(first) = compiled.first_mut() {
        *first = compiling.max(*first);
    }
    Ok(times
        .into_iter()
        .zip(compiled)
        .map(|(times, compiled)| Cost::of(times, compiled))
        .collect())
}

impl Cost {
    /// `None` where there is no time. The first warms up, and counts where there is no other.
    fn of(times: Vec<Duration>, compiled: Duration) -> Option<Self> {
        let milliseconds = |time: &Duration| time.as_secs_f64() * 1e3;
        let warm_up = usize::from(times.len() > 1);
        let mut runs: Vec<f64> = times.iter().skip(warm_up).map(milliseconds).collect();
        runs.sort_by(f64::total_cmp);
        Some(Self {
            milliseconds: *runs.get(runs.len() / 2)?,
            fastest: *runs.first()?,
            slowest: *runs.last()?,
            runs: runs.len(),
            compile_milliseconds: milliseconds(&compiled),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn costs(until: Option<Instant>) -> Vec<Option<Cost>> {
        let mut scene = Scene::load("scenes/soft-light.toml").expect("a scene");
        (scene.width, scene.height) = (8, 8);
        let choices = [EffectChoice::Auto; 3];
        let quiet = crate::render::QUIET;
        let settings = Settings::default();
        let compiling = Duration::ZERO;
        measure(
            &scene,
            settings,
            &Device::Cpu,
            &choices,
            compiling,
            until,
            quiet,
        )
        .expect("the CPU")
    }

    #[test]
    fn without_a_limit_everything_is_measured() {
        for cost in costs(None) {
            assert_eq!(cost.expect("a time").runs, ROUNDS);
        }
    }

    /// When the time is up before it begins, there is one frame all the same, and no other.
    #[test]
    fn what_the_time_does_not_allow_is_left_out() {
        let costs = costs(Some(Instant::now()));
        assert_eq!(costs[0].map(|cost| cost.runs), Some(1));
        assert_eq!(costs[1..], [None, None]);
    }
}
