//! When enough samples are enough: their number, a time limit, or a noise target.

use std::time::{Duration, Instant};

use rayon::prelude::*;
use serde::Serialize;
use spherule_kernel::Accumulator;
use spherule_kernel::color::luminance;

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
    /// The fewest samples that any pixel has. Where time ran out or the render was broken off,
    /// others may have more; each pixel is the mean of its own.
    pub samples: u32,
    /// How many were asked for.
    pub asked: u32,
    /// The standard error of the pixels' luminance, root mean square over the image, over the mean
    /// luminance of the image. An upper estimate: it takes the stratified samples for independent.
    /// Infinite where it is not known: for a single sample, a black image, or light beyond what
    /// floats square.
    pub noise: f64,
    /// What ended it.
    pub stopped_by: StoppedBy,
}

/// Counts the samples of a tile, and says when to stop.
#[derive(Debug)]
pub(super) struct Budget {
    samples: u32,
    done: u32,
    next: u32,
    /// The most of a launch.
    most: u32,
    deadline: Option<Instant>,
    noise: Option<f64>,
    /// At which number of samples the noise is looked at next.
    look_at: u32,
}

impl Budget {
    pub(super) fn new(samples: u32, deadline: Option<Instant>, noise: Option<f64>) -> Self {
        Self {
            samples,
            done: 0,
            next: 1,
            most: u32::MAX,
            deadline,
            noise,
            look_at: 16,
        }
    }

    /// With no more samples in a launch than these, of which there is one.
    #[cfg(feature = "gpu")]
    pub(super) fn with_at_most(self, most: u32) -> Self {
        Self {
            most: most.max(1),
            ..self
        }
    }

    /// The first sample and the number of samples of the next launch; `None` when all are taken.
    pub(super) fn next(&self) -> Option<(u32, u32)> {
        let left = self.samples - self.done;
        (left > 0).then(|| {
            let until_look = match self.noise {
                Some(_) if self.look_at > self.done => self.look_at - self.done,
                _ => left,
            };
            (
                self.done,
                self.next.min(self.most).min(left).min(until_look),
            )
        })
    }

    /// Learns from a launch of `count` samples; says what ends the render now, if anything.
    /// `noise` is asked only where it matters.
    pub(super) fn took<E>(
        &mut self,
        count: u32,
        time: Duration,
        noise: impl FnOnce() -> Result<f64, E>,
    ) -> Result<Option<StoppedBy>, E> {
        self.done += count;
        let wanted = f64::from(count) * STRIDE.as_secs_f64() / time.as_secs_f64().max(1e-6);
        self.next = wanted.clamp(1.0, f64::from(count) * 8.0) as u32;
        if self.done >= self.samples {
            return Ok(Some(StoppedBy::Samples));
        }
        if let Some(target) = self.noise
            && self.done >= self.look_at
        {
            // By a quarter each time, so that little is done in vain.
            self.look_at = (self.done + self.done / 4).max(self.done + 1);
            if noise()? <= target {
                return Ok(Some(StoppedBy::Noise));
            }
        }
        Ok(self.is_late().then_some(StoppedBy::TimeLimit))
    }

    pub(super) fn done(&self) -> u32 {
        self.done
    }

    /// How much of the samples is done, with `count` more of a share of the pixels.
    pub(super) fn share(&self, count: u32, of_pixels: f64) -> f64 {
        (f64::from(self.done) + f64::from(count) * of_pixels) / f64::from(self.samples)
    }

    /// Whether the time is up.
    pub(super) fn is_late(&self) -> bool {
        self.deadline
            .is_some_and(|deadline| Instant::now() >= deadline)
    }
}

/// See [`Reached::noise`].
pub(super) fn noise(accumulators: &[Accumulator]) -> f64 {
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
    use super::*;

    fn run(budget: &mut Budget, noise_at: impl Fn(u32) -> f64) -> (u32, StoppedBy) {
        loop {
            let (first, count) = budget.next().expect("samples are left");
            let stop = budget
                .took(count, Duration::from_millis(1), || {
                    Ok::<_, ()>(noise_at(first + count))
                })
                .expect("no error");
            if let Some(stop) = stop {
                return (budget.done(), stop);
            }
        }
    }

    #[test]
    fn every_sample_is_taken_once() {
        let mut budget = Budget::new(1000, None, None);
        assert_eq!(run(&mut budget, |_| 1.0), (1000, StoppedBy::Samples));
        assert_eq!(budget.next(), None);
    }

    #[test]
    fn no_launch_has_more_than_it_may() {
        let mut budget = Budget::new(1000, None, None).with_at_most(7);
        let mut launches = 0;
        while let Some((first, count)) = budget.next() {
            assert!(count <= 7 && first == budget.done());
            launches += 1;
            budget
                .took(count, Duration::ZERO, || Ok::<_, ()>(1.0))
                .expect("no error");
        }
        assert_eq!((budget.done(), launches), (1000, 144));
        // One is always taken.
        assert_eq!(
            Budget::new(5, None, None).with_at_most(0).next(),
            Some((0, 1))
        );
    }

    #[test]
    fn noise_and_time_end_it() {
        let mut budget = Budget::new(100_000, None, Some(0.01));
        let (done, by) = run(&mut budget, |n| 1.0 / f64::from(n));
        assert_eq!(by, StoppedBy::Noise);
        assert!((100..=130).contains(&done), "{done}");
        let mut budget = Budget::new(100_000, Some(Instant::now()), None);
        assert_eq!(run(&mut budget, |_| 1.0), (1, StoppedBy::TimeLimit));
    }
}
