//! Light paths on the CPU: bands of rows on every thread.

use std::ops::RangeInclusive;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;
use spherule_kernel::path::Scenery;
use spherule_kernel::precision::OnRung;
use spherule_kernel::{Accumulator, Effects, PathLaunch, Rung};

use super::adaptive::{Adaptive, Goal, Tracer, take_samples, tiles_of};
use super::budget::{Budget, GoesOn, Reached};
use super::preview::Preview;
use super::{Prepared, Progress, Sampled, Settings, together};
use crate::error::Result;
use crate::film;
use crate::render::Timings;
use crate::render::launch::check_path_launch;
use crate::trace::levels::Levels;
use crate::trace::single::Single;

/// Rows in a band.
const BAND_ROWS: usize = 2;
/// After so many pixels at most it is asked whether the render goes on; after fewer where they take
/// longer than this.
const RUN: usize = 64;
const PATIENCE: Duration = Duration::from_millis(5);

/// Effects of scenes whose light does not bounce.
const LOCAL: u32 = Effects::ANTIALIASING
    .and(Effects::HEADLAMP)
    .and(Effects::HARD_SHADOWS)
    .and(Effects::AMBIENT_OCCLUSION)
    .and(Effects::SKY_GRADIENT)
    .and(Effects::TRANSPARENT_BACKGROUND)
    .and(Effects::LARGE_SPHERES)
    .and(Effects::FILTER)
    .to_bits();
/// Effects of scenes without fog, motion, an image of the surroundings and caustics.
const STILL: u32 = Effects::ALL
    .without(Effects::FOG)
    .without(Effects::MOTION_BLUR)
    .without(Effects::ENVIRONMENT)
    .without(Effects::CAUSTICS)
    .to_bits();
const ALL: u32 = Effects::ALL.to_bits();

type Trace = fn(
    Rung,
    &Prepared,
    Option<&Levels>,
    &PathLaunch,
    &mut [Accumulator],
    &(dyn Fn(usize) -> bool + Sync),
);

/// Renders on every thread of the pool.
///
/// # Errors
///
/// [`OutOfHostMemory`](crate::Error::OutOfHostMemory) if the host has no room for the image,
/// [`Scene`](crate::Error::Scene) if the launch is not one of a whole image.
pub fn render(prepared: &Prepared, settings: &Settings, progress: Progress<'_>) -> Result<Sampled> {
    check_path_launch(&prepared.launch)?;
    let begun = Instant::now();
    let trace = settings.rung.with(TraceFor(prepared.compiled));
    let size = prepared.launch.image_size;
    let levels = Levels::of(prepared.nodes.tree());
    let mut accumulators = film::allocate::<Accumulator>(size.x, size.y)?;
    // Traces until `goes_on`, which is told the share of the pixels that are done, says no; whether
    // it never did.
    let pass = |launch: &PathLaunch, accumulators: &mut [Accumulator], goes_on: GoesOn<'_>| {
        let (done, all) = (AtomicUsize::new(0), accumulators.len());
        let goes_on = |more: usize| {
            let done = done.fetch_add(more, Ordering::Relaxed) + more;
            goes_on(done as f64 / all as f64)
        };
        let (rung, levels) = (settings.rung, levels.as_ref());
        trace(rung, prepared, levels, launch, accumulators, &goes_on);
        done.into_inner() == all
    };
    let started = Instant::now();
    let mut preview = None;
    if let Some(limit) = settings.time_limit {
        let most = accumulators.len();
        preview = Preview::finest(&prepared.launch, most, limit, |next, goes_on| {
            let goes_on = |_| progress(0.0).is_continue() && goes_on();
            let launch = next.launch;
            Ok(pass(&launch, &mut next.sums, &goes_on))
        })?;
    }
    let deadline = settings
        .time_limit
        .and_then(|limit| started.checked_add(limit));
    let reached = match settings.noise {
        Some(target) => {
            let goal = Goal {
                target,
                samples: prepared.samples,
                of_launch: u32::MAX,
                deadline,
            };
            take_where_needed(&prepared.launch, &goal, &mut accumulators, progress, &pass)?
        }
        None => {
            let mut budget = Budget::new(prepared.samples, deadline);
            let stopped_by = budget.spend(progress, |first, count, goes_on| {
                let launch = PathLaunch {
                    first_sample: first,
                    sample_count: count,
                    ..prepared.launch
                };
                let begun = Instant::now();
                let is_done = pass(&launch, &mut accumulators, goes_on);
                Ok((is_done, begun.elapsed()))
            })?;
            Reached::of(&accumulators, prepared.samples, stopped_by).with_noise_of(&accumulators)
        }
    };
    let timings = Timings {
        setup: started - begun,
        trace: started.elapsed(),
        ..Timings::default()
    };
    Ok(Sampled {
        accumulators,
        preview,
        timings,
        reached,
    })
}

/// Traces a launch for as long as it is told to go on, and says whether all of it was traced.
type Pass<'a> = &'a dyn Fn(&PathLaunch, &mut [Accumulator], GoesOn<'_>) -> bool;

/// Takes samples of each tile of `image` until `goal` or `progress` ends that.
fn take_where_needed(
    launch: &PathLaunch,
    goal: &Goal,
    image: &mut [Accumulator],
    progress: Progress<'_>,
    pass: Pass<'_>,
) -> Result<Reached> {
    let size = launch.image_size;
    let mut adaptive = Adaptive::new(size, 0..tiles_of(size))?;
    let by = take_samples(&mut adaptive, launch, goal, progress, &mut Here(pass))?;
    adaptive.put_into(image);
    Ok(Reached::of(image, goal.samples, by).with_noise_by_groups(adaptive.noise()))
}

/// Traces where the sums are.
struct Here<'a>(Pass<'a>);

impl Tracer for Here<'_> {
    fn pass(
        &mut self,
        launch: &PathLaunch,
        sums: &mut [Accumulator],
        goes_on: GoesOn<'_>,
    ) -> Result<(bool, Duration)> {
        let begun = Instant::now();
        let is_done = (self.0)(launch, sums, goes_on);
        Ok((is_done, begun.elapsed()))
    }

    fn fetch(&mut self, _: &mut Adaptive, _: RangeInclusive<u32>) -> Result<()> {
        Ok(())
    }

    fn give(&mut self, _: &[Accumulator]) -> Result<()> {
        Ok(())
    }
}

/// The loop that was compiled for the rung and for the fewest effects that hold these.
struct TraceFor(Effects);

impl OnRung for TraceFor {
    type Output = Trace;

    fn run<const RUNG: u32>(self) -> Trace {
        let fits = |set: u32| self.0.without(Effects::from_bits(set)).is_empty();
        if fits(LOCAL) {
            trace::<LOCAL, RUNG>
        } else if fits(STILL) {
            trace::<STILL, RUNG>
        } else {
            trace::<ALL, RUNG>
        }
    }
}

fn trace<const EFFECTS: u32, const RUNG: u32>(
    rung: Rung,
    prepared: &Prepared,
    levels: Option<&Levels>,
    launch: &PathLaunch,
    accumulators: &mut [Accumulator],
    goes_on: &(dyn Fn(usize) -> bool + Sync),
) {
    let world = &prepared.world;
    let called = Effects::from_bits(launch.called_effects);
    let scenery = Scenery {
        effects: called,
        rung: RUNG,
        launch,
        traversal: Single::new(rung, prepared.nodes.tree(), levels),
        spheres: &world.spheres,
        shapes: prepared.shapes.shapes(launch.first_shape),
        velocities: &prepared.velocities,
        material_ids: &world.material_ids,
        materials: &world.materials,
        lights: &prepared.lights,
        tables: &prepared.tables,
        texels: &prepared.texels,
    };
    let width = launch.tile_size.x as usize;
    accumulators
        .par_chunks_mut(width * BAND_ROWS)
        .enumerate()
        .for_each(|(band, accumulators)| {
            let mut first = width * BAND_ROWS * band;
            let mut left = accumulators;
            // One that takes long may be the first.
            let (mut asked_at, mut run, mut before) = (Instant::now(), 0, 0);
            while !left.is_empty() {
                if !goes_on(before) {
                    return;
                }
                let now = Instant::now();
                run = if now - asked_at > PATIENCE {
                    1
                } else {
                    (2 * run).clamp(1, RUN)
                };
                asked_at = now;
                let (accumulators, others) = left.split_at_mut(run.min(left.len()));
                trace_run::<EFFECTS, RUNG>(&scenery, width, first, accumulators);
                before = accumulators.len();
                first += before;
                left = others;
            }
            goes_on(before);
        });
}

/// Traces some pixels, of an image so wide, from the one with index `first` on. A function of its
/// own, because what is asked between runs takes registers.
#[inline(never)]
fn trace_run<const EFFECTS: u32, const RUNG: u32>(
    scenery: &Scenery<'_, Single<'_>>,
    width: usize,
    first: usize,
    accumulators: &mut [Accumulator],
) {
    // Said here again, where they are constants.
    let scenery = Scenery {
        effects: Effects::from_bits(EFFECTS)
            .within(Effects::BUILT)
            .within(scenery.effects),
        rung: RUNG,
        ..*scenery
    };
    together::trace_pixels(&scenery, width, first, accumulators);
}
