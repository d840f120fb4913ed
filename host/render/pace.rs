//! [`Pace`]: how much work one launch gets, so that none runs for long.
//!
//! Drivers end launches that keep a display waiting, and a person wants to see progress. A
//! launch is therefore a tile against a run of spheres, and both are sized by what the launches
//! before it took.

use std::time::Duration;

use glam::UVec2;

use crate::device::Gpu;

/// What one launch should take.
const TARGET: Duration = Duration::from_millis(200);
/// The first launch's work on a software adapter, in intersections: a second on the slowest one
/// seen.
const FIRST_IN_SOFTWARE: u64 = 1 << 27;
/// The first launch's work on a GPU: a quarter of a millisecond on a fast one, a tenth of a second
/// on a slow one. Small launches cost: each waits for the last of its threads.
const FIRST_ON_GPU: u64 = 1 << 30;
/// No tile is smaller than this, however many spheres there are: fewer threads leave a GPU idle,
/// and then a launch takes as long however little it does. The spheres are split instead.
const MIN_TILE_PIXELS: u64 = 1 << 16;
/// The bounds on any launch's work.
const RANGE: (u64, u64) = (1 << 20, 1 << 42);

/// Keeps launches near a fifth of a second each.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    intersections: u64,
}

impl Pace {
    /// What `gpu` starts at, before anything is known of a kernel on it.
    #[must_use]
    pub fn first_on(gpu: &Gpu) -> Self {
        Self::starting_at(if gpu.is_software() {
            FIRST_IN_SOFTWARE
        } else {
            FIRST_ON_GPU
        })
    }

    /// A pace at which every launch does about this many intersections at first.
    #[must_use]
    pub fn starting_at(intersections: u64) -> Self {
        Self {
            intersections: intersections.max(1),
        }
    }

    /// The size of the next tile: as many whole rows of an image `width` pixels wide as fit
    /// both the work and `max_pixels`, or a part of one row, and never more than is `left`
    /// (the rest of the current row, and the rows below it).
    #[must_use]
    pub fn tile(&self, width: u32, left: UVec2, max_pixels: u64, spheres: u64) -> UVec2 {
        let pixels = (self.intersections / spheres.max(1))
            .max(MIN_TILE_PIXELS)
            .min(max_pixels.max(1));
        let row_is_whole = left.x == width;
        if row_is_whole && width > 0 && pixels >= u64::from(width) {
            let rows = (pixels / u64::from(width)).min(u64::from(left.y));
            UVec2::new(width, rows as u32)
        } else {
            UVec2::new(pixels.min(u64::from(left.x)) as u32, 1)
        }
    }

    /// How many pixels the next launch takes, of `work` intersections each.
    #[must_use]
    pub fn pixels(&self, work: u64) -> u64 {
        self.intersections / work.max(1)
    }

    /// How many spheres the next launch over `pixels` pixels tests.
    #[must_use]
    pub fn spheres(&self, pixels: u64) -> u32 {
        (self.intersections / pixels.max(1)).clamp(1, u64::from(u32::MAX)) as u32
    }

    /// Learns from a launch of this many intersections that took this long.
    pub fn learn(&mut self, intersections: u64, took: Duration) {
        let took = took.as_secs_f64().max(1e-6);
        // At most a factor of eight a step: one odd measurement must not decide the next launch.
        let factor = (TARGET.as_secs_f64() / took).clamp(0.125, 8.0);
        let wanted = (intersections as f64 * factor) as u64;
        // A small launch says nothing against a large one.
        if factor < 1.0 || wanted > self.intersections {
            // One that began below the range stays below it: after a slow launch none is larger.
            self.intersections = wanted.clamp(RANGE.0.min(self.intersections), RANGE.1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_the_image_exactly_once() {
        for (width, height, work, max_pixels, spheres) in [
            (1920, 1080, 1 << 27, 1 << 23, 2),
            (17, 13, 1 << 27, 20, 1),
            (17, 13, 5, 1 << 20, 1),
            (1, 1, 1, 1, 1000),
            (1920, 1, 100, 64, 3),
        ] {
            let pace = Pace::starting_at(work);
            let mut covered = 0;
            let (mut x, mut y) = (0, 0);
            while y < height {
                let tile = pace.tile(
                    width,
                    UVec2::new(width - x, height - y),
                    max_pixels,
                    spheres,
                );
                let pixels = u64::from(tile.x) * u64::from(tile.y);
                assert!(pixels >= 1 && pixels <= max_pixels);
                assert!(x + tile.x <= width && y + tile.y <= height);
                covered += pixels;
                x += tile.x;
                if x == width {
                    (x, y) = (0, y + tile.y);
                }
            }
            assert_eq!(covered, u64::from(width) * u64::from(height));
        }
    }

    #[test]
    fn tiles_keep_a_gpu_busy_however_many_spheres_there_are() {
        let mut pace = Pace::starting_at(1 << 27);
        pace.learn(1 << 20, Duration::from_secs(100));
        let tile = pace.tile(1920, UVec2::new(1920, 1080), 1 << 23, 1 << 32);
        assert!(u64::from(tile.x) * u64::from(tile.y) > MIN_TILE_PIXELS - 1920);
        assert_eq!(pace.spheres(MIN_TILE_PIXELS), 16);
    }

    #[test]
    fn after_a_slow_launch_none_is_larger() {
        for first in [1 << 10, 1 << 20, 1 << 30] {
            let mut pace = Pace::starting_at(first);
            pace.learn(first, Duration::from_secs(7));
            assert!(pace.intersections <= first);
        }
    }

    #[test]
    fn the_pace_settles_at_the_target() {
        for intersections_per_second in [3e8, 2e12] {
            let mut pace = Pace::starting_at(1 << 27);
            let mut took = Duration::ZERO;
            for _ in 0..12 {
                let work = pace.intersections;
                took = Duration::from_secs_f64(work as f64 / intersections_per_second);
                pace.learn(work, took);
            }
            let ratio = took.as_secs_f64() / TARGET.as_secs_f64();
            assert!((0.9..1.1).contains(&ratio), "{ratio}");
        }
    }
}
