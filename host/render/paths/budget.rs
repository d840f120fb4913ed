//! How far a render came, and what ends it: the number of samples, or a time limit.

use std::ops::RangeInclusive;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;
use serde::Serialize;
use spherule_kernel::Accumulator;
use spherule_kernel::color::luminance;

use crate::error::Result;
use crate::render::Progress;

/// Is told the share of a launch's pixels that are traced, and says whether to go on.
pub(super) type GoesOn<'a> = &'a (dyn Fn(f64) -> bool + Sync);

/// How long the samples between two looks at the clock should take.
const STRIDE: Duration = Duration::from_millis(200);

/// What ended a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum StoppedBy {
    /// All samples were taken.
    Samples,
    /// The time was up.
    TimeLimit,
    /// The noise was low enough.
    Noise,
    /// Whoever watches the progress broke it off.
    Interrupted,
}

/// How far a render came.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Reached {
    /// The fewest samples that any pixel has. Where time ran out, the render was broken off, or a
    /// noise target was asked for, others may have more; each pixel is the mean of its own.
    pub samples: u32,
    /// The most samples that any pixel has.
    pub most_samples: u32,
    /// The mean number of samples of the pixels.
    pub mean_samples: f64,
    /// How many were asked for.
    pub asked: u32,
    /// The standard error of the pixels' luminance, root mean square over the image, over what they
    /// are measured against. Infinite where it is not known: for a single sample, a black image, or
    /// light beyond what floats square.
    ///
    /// Where a noise target was asked for, each pixel is measured against the mean luminance of its
    /// tile of 16 × 16 pixels, or against a sixteenth of what the image typically has, (mean of
    /// √luminance)², where that is more; a render that was stopped by noise has no tile above the
    /// target. Else all are measured against the mean luminance of the image.
    pub noise: f64,
    /// Whether `noise` is an upper estimate, because it takes the stratified samples for
    /// independent. Where a noise target was asked for, it has no bias.
    pub is_upper_estimate: bool,
    /// What ended it.
    pub stopped_by: StoppedBy,
}

impl Reached {
    /// What the samples of an image came to.
    pub(super) fn of(image: &[Accumulator], asked: u32, stopped_by: StoppedBy) -> Self {
        let (fewest, most, sum) = image
            .par_iter()
            .map(|pixel| {
                let samples = pixel.samples() as u32;
                (samples, samples, u64::from(samples))
            })
            .reduce(
                || (u32::MAX, 0, 0),
                |a, b| (a.0.min(b.0), a.1.max(b.1), a.2 + b.2),
            );
        Self {
            samples: fewest,
            most_samples: most,
            mean_samples: sum as f64 / image.len().max(1) as f64,
            asked,
            noise: f64::INFINITY,
            is_upper_estimate: true,
            stopped_by,
        }
    }

    /// With the noise of an image whose samples are one sequence.
    pub(super) fn with_noise_of(self, image: &[Accumulator]) -> Self {
        Self {
            noise: noise(image),
            ..self
        }
    }

    /// With the noise of so many pixels, the sum of whose squares is this.
    pub(super) fn with_noise_by_groups(self, (squares, pixels): (f64, f64)) -> Self {
        Self {
            noise: (squares / pixels).sqrt(),
            is_upper_estimate: false,
            ..self
        }
    }
}

/// Counts samples, and says how many the next launch takes and when to stop.
#[derive(Debug)]
pub(super) struct Budget {
    samples: u32,
    done: u32,
    /// The samples of a launch that was cut.
    in_part: u32,
    next: u32,
    /// The most of a launch.
    most: u32,
    deadline: Option<Instant>,
}

impl Budget {
    pub(super) fn new(samples: u32, deadline: Option<Instant>) -> Self {
        Self {
            samples,
            done: 0,
            in_part: 0,
            next: 1,
            most: u32::MAX,
            deadline,
        }
    }

    /// With no more samples in a launch than these, of which there is one.
    pub(super) fn with_at_most(self, most: u32) -> Self {
        Self {
            most: most.max(1),
            ..self
        }
    }

    /// Begins anew with so many samples. How long one takes is not forgotten.
    pub(super) fn again(&mut self, samples: u32) -> &mut Self {
        (self.samples, self.done, self.in_part) = (samples, 0, 0);
        self
    }

    /// Takes samples, launch by launch, until all are taken, the time is up, or `progress`, which
    /// is told the share of them that is done, breaks it off. `pass` is given the first sample and
    /// the number of samples of each launch, and is to trace them for as long as what it tells the
    /// share of the pixels that are done says so. It returns whether all are done, and how long
    /// that took.
    pub(super) fn spend(
        &mut self,
        progress: Progress<'_>,
        mut pass: impl FnMut(u32, u32, GoesOn<'_>) -> Result<(bool, Duration)>,
    ) -> Result<StoppedBy> {
        while let Some((first, count)) = self.next() {
            let is_interrupted = AtomicBool::new(false);
            let goes_on = |of_pixels: f64| {
                let goes_on = progress(self.share(count, of_pixels)).is_continue();
                if !goes_on {
                    is_interrupted.store(true, Ordering::Relaxed);
                }
                goes_on && !self.is_late()
            };
            let (is_done, time) = pass(first, count, &goes_on)?;
            if !is_done {
                self.in_part = count;
                return Ok(if is_interrupted.into_inner() {
                    StoppedBy::Interrupted
                } else {
                    StoppedBy::TimeLimit
                });
            }
            if let Some(by) = self.took(count, time) {
                return Ok(by);
            }
        }
        Ok(StoppedBy::Samples)
    }

    /// The first sample and the number of samples of the next launch; `None` when all are taken.
    fn next(&self) -> Option<(u32, u32)> {
        let left = self.samples - self.done;
        (left > 0).then(|| (self.done, self.next.min(self.most).min(left)))
    }

    /// Learns from a launch of `count` samples; says what ends the render now, if anything.
    fn took(&mut self, count: u32, time: Duration) -> Option<StoppedBy> {
        self.done += count;
        let wanted = f64::from(count) * STRIDE.as_secs_f64() / time.as_secs_f64().max(1e-6);
        self.next = wanted.clamp(1.0, f64::from(count) * 8.0) as u32;
        if self.done >= self.samples {
            return Some(StoppedBy::Samples);
        }
        self.is_late().then_some(StoppedBy::TimeLimit)
    }

    /// How many samples each pixel has got: where a launch was cut, some have more than others.
    pub(super) fn taken(&self) -> RangeInclusive<u32> {
        self.done..=self.done + self.in_part
    }

    /// How many samples every pixel has got.
    pub(super) fn done(&self) -> u32 {
        self.done
    }

    /// How much of the samples is done, with `count` more of a share of the pixels.
    fn share(&self, count: u32, of_pixels: f64) -> f64 {
        (f64::from(self.done) + f64::from(count) * of_pixels) / f64::from(self.samples)
    }

    /// Whether the time is up.
    fn is_late(&self) -> bool {
        self.deadline
            .is_some_and(|deadline| Instant::now() >= deadline)
    }
}

/// The standard error of the pixels' luminance over the mean luminance of the image, an upper
/// estimate: see [`Reached::noise`].
fn noise(accumulators: &[Accumulator]) -> f64 {
    let is_known = |sum: &Accumulator| {
        let light = luminance(sum.color());
        sum.samples() > 1.0 && (light * light).is_finite() && sum.variance_of_mean().is_finite()
    };
    if !accumulators.par_iter().all(is_known) {
        return f64::INFINITY;
    }
    let (variance, mean) = accumulators
        .par_iter()
        .map(|sum| {
            (
                f64::from(sum.variance_of_mean()),
                f64::from(luminance(sum.color())),
            )
        })
        .reduce(|| (0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
    let count = accumulators.len().max(1) as f64;
    // Of a black image nothing is known yet: the first sample that meets light changes all.
    if mean > 0.0 {
        (variance / count).sqrt() / (mean / count)
    } else {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::render::QUIET;

    /// Spends the budget on launches that take no time, and returns them.
    fn launches(budget: &mut Budget) -> (Vec<(u32, u32)>, StoppedBy) {
        let mut launches = Vec::new();
        let by = budget.spend(QUIET, |first, count, goes_on| {
            launches.push((first, count));
            Ok((goes_on(0.0), Duration::ZERO))
        });
        (launches, by.expect("no error"))
    }

    fn assert_each_once(launches: &[(u32, u32)], samples: u32) {
        let end = launches.iter().fold(0, |taken, (first, count)| {
            assert_eq!(*first, taken);
            taken + count
        });
        assert_eq!(end, samples);
    }

    #[test]
    fn every_sample_is_taken_once() {
        let mut budget = Budget::new(1000, None);
        let (taken, by) = launches(&mut budget);
        assert_each_once(&taken, 1000);
        assert!(taken.len() < 10);
        assert_eq!((by, budget.taken()), (StoppedBy::Samples, 1000..=1000));
        // The second time it knows that they take no time.
        assert_eq!(launches(budget.again(30)).0, [(0, 30)]);
    }

    #[test]
    fn no_launch_has_more_than_it_may() {
        let mut budget = Budget::new(1000, None).with_at_most(7);
        let (taken, _) = launches(&mut budget);
        assert_each_once(&taken, 1000);
        assert!(taken.iter().all(|(_, count)| *count <= 7));
        // One is always taken.
        assert_eq!(Budget::new(5, None).with_at_most(0).next(), Some((0, 1)));
    }

    #[test]
    fn the_time_and_whoever_watches_end_it() {
        let mut budget = Budget::new(100_000, Some(Instant::now()));
        let (taken, by) = launches(&mut budget);
        assert_eq!((taken, by), (vec![(0, 1)], StoppedBy::TimeLimit));
        assert_eq!(budget.taken(), 0..=1);
        let mut budget = Budget::new(100_000, None);
        let by = budget.spend(&|_| ControlFlow::Break(()), |_, _, goes_on| {
            Ok((goes_on(0.5), Duration::ZERO))
        });
        assert_eq!(by.expect("no error"), StoppedBy::Interrupted);
    }
}
