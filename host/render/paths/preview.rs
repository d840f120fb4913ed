//! [`Preview`]: a coarse image, for pixels that have no sample when the time is up.
//!
//! Where there is a time limit it is rendered first: a sample for each square of eight by eight
//! pixels, or of more in large images, so that it takes a small part of a second. Where light paths
//! are long that may be longer than the limit. Ever finer previews are therefore rendered, from a
//! single pixel on, and the last that was done is kept.

use std::time::{Duration, Instant};

use glam::UVec2;
use rayon::prelude::*;
use spherule_kernel::{Accumulator, PathLaunch};

use crate::error::Result;
use crate::film;

/// Pixels along the side of a square that one sample is for.
const SIDE: u32 = 8;
/// The most samples.
const MAX_PIXELS: usize = 1 << 14;
/// The most samples of each preview; all of those before the last take a tenth of what that takes.
const LEVELS: [usize; 5] = [1, 1 << 4, 1 << 8, 1 << 12, MAX_PIXELS];
/// The part of the time there is that previews may take.
const SHARE: f64 = 0.5;

/// A coarse image.
pub(super) struct Preview {
    /// What renders it.
    pub(super) launch: PathLaunch,
    /// Its samples, one each.
    pub(super) sums: Vec<Accumulator>,
}

impl Preview {
    /// The finest preview of the image that `whole` covers, in no more than `max_pixels` pixels,
    /// that is done in its part of `limit`. `pass` traces the pixels of one for as long as it is
    /// told to go on, and says whether that are all. The first is not cut: it is one pixel.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfHostMemory`](crate::Error::OutOfHostMemory), and those of `pass`.
    pub(super) fn finest(
        whole: &PathLaunch,
        max_pixels: usize,
        limit: Duration,
        mut pass: impl FnMut(&mut Self, &(dyn Fn() -> bool + Sync)) -> Result<bool>,
    ) -> Result<Option<Self>> {
        let started = Instant::now();
        let mut finest: Option<Self> = None;
        for most in LEVELS {
            let mut next = Self::of(whole, most.min(max_pixels))?;
            let goes_on: &(dyn Fn() -> bool + Sync) = match &finest {
                Some(finest) if finest.launch.image_size == next.launch.image_size => continue,
                Some(_) => &|| started.elapsed().as_secs_f64() < SHARE * limit.as_secs_f64(),
                None => &|| true,
            };
            if !pass(&mut next, goes_on)? {
                break;
            }
            finest = Some(next);
        }
        Ok(finest)
    }

    /// Of the image that `whole` covers, in no more than `max_pixels` pixels; nothing is rendered
    /// yet.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfHostMemory`](crate::Error::OutOfHostMemory).
    fn of(whole: &PathLaunch, max_pixels: usize) -> Result<Self> {
        let fits = |size: UVec2| size.x as usize * size.y as usize <= max_pixels.min(MAX_PIXELS);
        let coarse = |side: u32| {
            let of = |pixels: u32| pixels.div_ceil(side);
            UVec2::new(of(whole.image_size.x), of(whole.image_size.y))
        };
        let mut side = SIDE;
        while !fits(coarse(side)) && side < 1 << 16 {
            side *= 2;
        }
        let size = coarse(side);
        Ok(Self {
            launch: PathLaunch {
                image_size: size,
                tile_origin: UVec2::ZERO,
                tile_size: size,
                first_sample: 0,
                sample_count: 1,
                ..*whole
            },
            sums: film::allocate(size.x, size.y)?,
        })
    }

    /// Gives the pixels without a sample, of an image of this width, what the preview shows there.
    pub(super) fn fill(&self, width: u32, sums: &mut [Accumulator]) {
        let coarse = self.launch.image_size;
        let height = sums.len() / width as usize;
        let of = |at: usize, all: usize, coarse: u32| at * coarse as usize / all;
        sums.par_chunks_mut(width as usize)
            .enumerate()
            .for_each(|(y, row)| {
                let first = of(y, height, coarse.y) * coarse.x as usize;
                for (x, sum) in row.iter_mut().enumerate() {
                    if sum.samples() == 0.0 {
                        *sum = self.sums[first + of(x, width as usize, coarse.x)];
                    }
                }
            });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_pixel_finds_its_square() {
        let whole = PathLaunch {
            image_size: UVec2::new(17, 9),
            ..PathLaunch::default()
        };
        let mut preview = Preview::of(&whole, 1 << 20).expect("memory");
        assert_eq!(preview.launch.image_size, UVec2::new(3, 2));
        for (index, sum) in preview.sums.iter_mut().enumerate() {
            sum.add(glam::Vec3::splat(index as f32), 1.0, 1.0);
        }
        let mut sums = vec![Accumulator::default(); 17 * 9];
        sums[1].add(glam::Vec3::splat(9.0), 1.0, 1.0);
        preview.fill(17, &mut sums);
        assert_eq!(sums[0].color().x, 0.0);
        assert_eq!(sums[1].color().x, 9.0);
        assert_eq!(sums[16].color().x, 2.0);
        assert_eq!(sums[17 * 9 - 1].color().x, 5.0);
        // Where it must be smaller, it is.
        let preview = Preview::of(&whole, 1).expect("memory");
        assert_eq!(preview.launch.image_size, UVec2::ONE);
    }

    /// However little time there is, there is a preview; it is finer where there is more.
    #[test]
    fn the_finest_that_is_done_in_time_is_kept() {
        let whole = PathLaunch {
            image_size: UVec2::new(1024, 512),
            ..PathLaunch::default()
        };
        let finest = |limit: Duration, level_takes: Duration| {
            let mut passes = 0;
            let preview = Preview::finest(&whole, 1 << 20, limit, |_, goes_on| {
                passes += 1;
                let is_begun = goes_on();
                std::thread::sleep(level_takes);
                Ok(is_begun && goes_on())
            });
            let preview = preview.expect("memory").expect("a preview");
            (preview.launch.image_size, passes)
        };
        let whole_day = Duration::from_secs(86_400);
        assert_eq!(
            finest(whole_day, Duration::ZERO),
            (UVec2::new(128, 64), LEVELS.len())
        );
        assert_eq!(finest(Duration::ZERO, Duration::ZERO), (UVec2::ONE, 2));
        let (size, _) = finest(Duration::from_millis(20), Duration::from_millis(20));
        assert_eq!(size, UVec2::ONE);
    }
}
