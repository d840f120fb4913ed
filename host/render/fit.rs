//! [`fit`]: how large an image may be, and of how many samples, to be measured in the time there
//! is.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use super::{Settings, render};
use crate::device::Device;
use crate::error::Result;
use crate::scene::Scene;

/// The pixels of the smallest image. With the longest light paths, even these take a fraction of a
/// second.
const LEAST: f64 = 64.0;
/// The pixels that an image keeps while its samples are reduced.
const FAIR: f64 = 8192.0;
/// The fewest samples of an image that has several: with one there is no antialiasing.
const FEWEST: u32 = 2;
/// The most by which the samples of all pixels grow from one frame to the next: small images
/// predict large ones poorly.
const MOST_GROWTH: f64 = 16.0;
/// The least growth that makes another frame worthwhile.
const LEAST_GROWTH: f64 = 1.2;
/// The share of the remaining time after which a frame is given up as too large.
const SHARE: f64 = 0.5;

/// Makes the image of `scene` smaller, and its samples fewer, where a frame would take longer than
/// `limit`. `frame` renders one and says how long it took. It begins with few pixels, whatever the
/// shape of the image.
///
/// # Errors
///
/// Those of `frame`.
pub fn fit(
    scene: &mut Scene,
    limit: Duration,
    mut frame: impl FnMut(&Scene) -> Result<Duration>,
) -> Result<()> {
    let (width, height, samples) = (scene.width, scene.height, scene.samples());
    let asked_for = scene.sampling.samples;
    let all = f64::from(width) * f64::from(height);
    let fewest = samples.min(FEWEST);
    // Work is counted in samples of all pixels.
    let set = |scene: &mut Scene, work: f64| {
        let taken = ((work / all.min(FAIR)) as u32).clamp(fewest, samples);
        (scene.width, scene.height) = size((width, height), work / f64::from(taken));
        scene.sampling.samples = if taken < samples {
            Some(taken)
        } else {
            asked_for
        };
    };
    let most = all * f64::from(samples);
    let mut work = all.min(LEAST) * f64::from(fewest);
    // The most work that was done in time, or else the least work.
    let mut fits = work;
    while work < most {
        set(scene, work);
        let took = frame(scene)?.as_secs_f64().max(1e-9);
        let growth = (limit.as_secs_f64() / took).min(MOST_GROWTH);
        if growth < 1.0 {
            set(scene, (work * growth).max(fits));
            return Ok(());
        }
        if growth < LEAST_GROWTH {
            return Ok(());
        }
        fits = work;
        work *= growth;
    }
    (scene.width, scene.height) = (width, height);
    scene.sampling.samples = asked_for;
    Ok(())
}

/// The size of an image of about so many pixels, with the aspect ratio of `whole` unless a side
/// would be shorter than a pixel.
fn size(whole: (u32, u32), pixels: f64) -> (u32, u32) {
    let (width, height) = (f64::from(whole.0), f64::from(whole.1));
    let share = (pixels / (width * height)).sqrt().min(1.0);
    let shorter = width.min(height) * share;
    // If the shorter side is rounded up to a pixel, the longer one shrinks.
    let longer = if shorter < 1.0 {
        pixels
    } else {
        width.max(height) * share
    };
    let side = |side: f64, whole: f64| side.round().clamp(1.0, whole) as u32;
    let shorter = side(shorter, width.min(height));
    let longer = side(longer, width.max(height));
    if width > height {
        (longer, shorter)
    } else {
        (shorter, longer)
    }
}

/// Renders a frame of `scene` to see what it takes. It is broken off after a part of the time that
/// is left until `until`, because that is to be enough for others after it. Returns how long the
/// frame took, [`Duration::MAX`] if it was broken off, and how long compiling took, which does not
/// count.
///
/// # Errors
///
/// As [`render`].
#[cfg_attr(not(feature = "cli"), expect(dead_code, reason = "the command asks"))]
pub(crate) fn probe(
    scene: &Scene,
    settings: Settings,
    device: &Device,
    until: Instant,
) -> Result<(Duration, Duration)> {
    let started = Instant::now();
    let patience = until.saturating_duration_since(started).mul_f64(SHARE);
    let rendered = render(scene, settings, device, &|_| {
        if started.elapsed() < patience {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    })?;
    let compiling = rendered.timings.compile;
    let took = if rendered.is_complete() {
        started.elapsed().saturating_sub(compiling)
    } else {
        Duration::MAX
    };
    Ok((took, compiling))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::World;

    fn fitted(limit_ms: u64, nanoseconds_a_pixel: u64) -> (u32, u32, u64) {
        let mut scene = Scene::new(World::default());
        (scene.width, scene.height) = (960, 540);
        let mut all = 0;
        fit(&mut scene, Duration::from_millis(limit_ms), |scene| {
            let pixels = u64::from(scene.width) * u64::from(scene.height);
            all += pixels * nanoseconds_a_pixel;
            Ok(Duration::from_nanos(pixels * nanoseconds_a_pixel))
        })
        .expect("frames");
        (scene.width, scene.height, all / 1_000_000)
    }

    #[test]
    fn images_are_as_large_as_the_time_allows() {
        // 518,400 pixels.
        assert_eq!(fitted(100, 10), (960, 540, 2));
        assert_eq!(fitted(100, 190).0, 960);
        let (width, height, took) = fitted(100, 2500);
        assert!(
            (32_000..=48_000).contains(&(width * height)),
            "{width} × {height}"
        );
        assert!((f64::from(width) / f64::from(height) - 16.0 / 9.0).abs() < 0.02);
        assert!(took < 300, "{took} ms to find out");
        // What takes too long at any size is as small as may be.
        assert_eq!(fitted(1, 1_000_000), (11, 6, 66));
    }

    /// Where the image would be too small to tell anything, it has fewer samples.
    #[test]
    fn samples_are_as_many_as_the_time_allows() {
        let fitted = |limit_ms: u64| {
            let mut scene = Scene::new(World::default());
            (scene.width, scene.height) = (960, 540);
            scene.sampling.samples = Some(500);
            fit(&mut scene, Duration::from_millis(limit_ms), |scene| {
                let pixels = u64::from(scene.width) * u64::from(scene.height);
                let samples = u64::from(scene.samples());
                Ok(Duration::from_micros(pixels * samples))
            })
            .expect("frames");
            (scene.width, scene.height, scene.samples())
        };
        assert_eq!(fitted(1), (29, 17, 2));
        let (width, height, samples) = fitted(100);
        assert!((60..=72).contains(&height) && width > height);
        assert!((8..=14).contains(&samples), "{samples}");
        // 8,192 pixels in 500 samples take 4.1 seconds; the image grows after that.
        let (_, height, samples) = fitted(36_000);
        assert!((180..=220).contains(&height), "{height}");
        assert_eq!(samples, 500);
        assert_eq!(fitted(1_000_000), (960, 540, 500));
    }

    /// However wide and flat an image is, the first frame is a small one.
    #[test]
    fn flat_images_begin_small() {
        for (width, height) in [(4096, 16), (16, 4096), (65_536, 1), (1, 65_536), (3, 2)] {
            let frames = |nanoseconds_a_sample: u64| {
                let mut scene = Scene::new(World::default());
                (scene.width, scene.height) = (width, height);
                scene.sampling.samples = Some(64);
                let mut frames = Vec::new();
                fit(&mut scene, Duration::from_millis(10), |scene| {
                    let pixels = u64::from(scene.width) * u64::from(scene.height);
                    assert!(scene.width <= width && scene.height <= height);
                    let work = pixels * u64::from(scene.samples());
                    frames.push(work);
                    Ok(Duration::from_nanos(work * nanoseconds_a_sample))
                })
                .expect("frames");
                (frames, (scene.width, scene.height, scene.samples()))
            };
            let (works, smallest) = frames(1_000_000);
            assert_eq!(works.len(), 1);
            assert!(works[0] <= 2 * 66, "{works:?} of {width} × {height}");
            assert!(smallest.0 * smallest.1 <= 66);
            assert!(width > height || smallest.0 <= smallest.1);
            let (works, _) = frames(1000);
            assert!(works.iter().all(|work| *work < 12_000), "{works:?}");
            let (_, whole) = frames(1);
            assert_eq!(whole, (width, height, 64));
        }
    }

    /// If a frame is cut short because smaller ones promised less time, the size before is used.
    #[test]
    fn a_frame_that_is_broken_off_is_made_smaller_again() {
        let mut scene = Scene::new(World::default());
        (scene.width, scene.height) = (960, 540);
        let mut frames = Vec::new();
        fit(&mut scene, Duration::from_millis(100), |scene| {
            frames.push((scene.width, scene.height));
            Ok(if frames.len() < 3 {
                Duration::from_millis(1)
            } else {
                Duration::MAX
            })
        })
        .expect("frames");
        assert_eq!(frames.len(), 3);
        assert_eq!((scene.width, scene.height), frames[1]);
    }
}
