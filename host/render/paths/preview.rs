//! [`Preview`]: a coarse image, for pixels that have no sample when the time is up.
//!
//! Where there is a time limit it is rendered first: a sample for each square of eight by eight pixels, or of more in large images, so that it
//! takes a small part of a second.

use glam::UVec2;
use rayon::prelude::*;
use spherule_kernel::{Accumulator, PathLaunch};

use crate::error::Result;
use crate::film;

/// Pixels along the side of a square that one sample is for.
const SIDE: u32 = 8;
/// The most samples.
const MAX_PIXELS: usize = 1 << 14;

/// A coarse image.
pub(super) struct Preview {
    /// What renders it.
    pub(super) launch: PathLaunch,
    /// Its samples, one each.
    pub(super) sums: Vec<Accumulator>,
}

impl Preview {
    /// Of the image that `whole` covers, in no more than `max_pixels` pixels; nothing is rendered yet.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfHostMemory`](crate::Error::OutOfHostMemory).
    pub(super) fn of(whole: &PathLaunch, max_pixels: usize) -> Result<Self> {
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
}
