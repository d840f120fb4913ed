//! [`fit`]: how large an image may be to be measured in the time there is.

use std::time::Duration;

use crate::error::Result;
use crate::scene::Scene;

/// The shorter side of the smallest image, in pixels.
const LEAST: f64 = 16.0;
/// How much longer sides become between two frames, at most: small images tell little of what large ones take.
const MOST_GROWTH: f64 = 4.0;
/// By how much they must become longer for another frame to be worth its time.
const LEAST_GROWTH: f64 = 1.1;

/// Makes the image of `scene` smaller where a frame would take longer than `limit`. `frame` renders one and says how long it took.
///
/// # Errors
///
/// Those of `frame`.
pub fn fit(
    scene: &mut Scene,
    limit: Duration,
    mut frame: impl FnMut(&Scene) -> Result<Duration>,
) -> Result<()> {
    let (width, height) = (scene.width, scene.height);
    let mut share = LEAST / f64::from(width.min(height));
    while share < 1.0 {
        let side = |whole: u32| (f64::from(whole) * share).round().max(1.0) as u32;
        (scene.width, scene.height) = (side(width), side(height));
        let took = frame(scene)?.as_secs_f64().max(1e-9);
        let growth = (limit.as_secs_f64() / took).sqrt().min(MOST_GROWTH);
        if growth < LEAST_GROWTH {
            return Ok(());
        }
        share *= growth;
    }
    (scene.width, scene.height) = (width, height);
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
}
