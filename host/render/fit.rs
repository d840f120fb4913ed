//! [`fit`]: how large an image may be, and of how many samples, to be measured in the time there is.

use std::time::Duration;

use crate::error::Result;
use crate::scene::Scene;

/// The shorter side of the smallest image, in pixels.
const LEAST: f64 = 16.0;
/// The shorter side of an image that has fewer samples instead of fewer pixels, in pixels.
const FAIR: f64 = 64.0;
/// The fewest samples of an image that has several: one alone is no antialiasing.
const FEWEST: u32 = 2;
/// How many more samples of all pixels there are from one frame to the next, at most: small images tell little of
/// what large ones take.
const MOST_GROWTH: f64 = 16.0;
/// By how much they must become more for another frame to be worth its time.
const LEAST_GROWTH: f64 = 1.2;

/// Makes the image of `scene` smaller, and its samples fewer, where a frame would take longer than `limit`. `frame` renders
/// one and says how long it took.
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
    let shorter = f64::from(width.min(height));
    // The pixels of an image whose shorter side is so long.
    let pixels = |side: f64| all * (side / shorter).min(1.0).powi(2);
    let fewest = samples.min(FEWEST);
    // Samples of all pixels.
    let most = all * f64::from(samples);
    let mut work = pixels(LEAST) * f64::from(fewest);
    while work < most {
        let taken = ((work / pixels(FAIR)) as u32).clamp(fewest, samples);
        let share = (work / (f64::from(taken) * all)).sqrt().min(1.0);
        let side = |whole: u32| (f64::from(whole) * share).round().max(1.0) as u32;
        (scene.width, scene.height) = (side(width), side(height));
        if taken < samples {
            scene.sampling.samples = Some(taken);
        } else {
            scene.sampling.samples = asked_for;
        }
        let took = frame(scene)?.as_secs_f64().max(1e-9);
        let growth = (limit.as_secs_f64() / took).min(MOST_GROWTH);
        if growth < LEAST_GROWTH {
            return Ok(());
        }
        work *= growth;
    }
    (scene.width, scene.height) = (width, height);
    scene.sampling.samples = asked_for;
    Ok(())
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
        assert_eq!(fitted(100, 10), (960, 540, 1));
        assert_eq!(fitted(100, 190).0, 960);
        let (width, height, took) = fitted(100, 2500);
        assert!(
            (32_000..=48_000).contains(&(width * height)),
            "{width} × {height}"
        );
        assert!((f64::from(width) / f64::from(height) - 16.0 / 9.0).abs() < 0.02);
        assert!(took < 300, "{took} ms to find out");
        // What takes too long at any size is as small as may be.
        assert_eq!(fitted(1, 1_000_000), (28, 16, 448));
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
        assert_eq!(fitted(1), (28, 16, 2));
        let (width, height, samples) = fitted(100);
        assert!((60..=72).contains(&height) && width > height);
        assert!((8..=14).contains(&samples), "{samples}");
        // 7,168 pixels of 64 rows in 500 samples take 3.6 seconds; the image grows after that.
        let (_, height, samples) = fitted(36_000);
        assert!((180..=220).contains(&height), "{height}");
        assert_eq!(samples, 500);
        assert_eq!(fitted(1_000_000), (960, 540, 500));
    }
}
