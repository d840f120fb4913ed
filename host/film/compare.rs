//! [`Comparison`]: how far two images of one scene are apart.

use rayon::prelude::*;
use serde::Serialize;

use super::Image;
use super::encode::Encoder;

/// What two images may differ by and still count as the same.
///
/// Processors may divide and take square roots with different roundings, and may fuse a product
/// with a sum, so a colour can be off by a rounding of its 8-bit form; at a silhouette such a
/// rounding decides between a sphere and what is behind it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Tolerance {
    /// A pixel differs where a channel is off by more than this, in 255ths.
    pub channel: f32,
    /// The share of the pixels that may differ.
    pub share: f64,
}

impl Default for Tolerance {
    /// Two 255ths in 99.9 % of the pixels: the rest is left to silhouettes.
    fn default() -> Self {
        Self {
            channel: 2.0,
            share: 0.001,
        }
    }
}

/// The share of the light paths that a rounding may send elsewhere: of a scene with glass and
/// mirrors, a few in ten thousand were seen to be, on the rung `textbook`.
const PATHS_ELSEWHERE: f64 = 0.001;
/// The most of the pixels that may differ, however many paths each has.
const MOST: f64 = 0.05;

impl Tolerance {
    /// For images of so many light paths a pixel, of which one in a thousand may go elsewhere: a
    /// pixel differs if one of its paths does. More than a twentieth of the pixels never may.
    /// Whether what differs is chance is left to [`Agreement`](super::agreement::Agreement).
    #[must_use]
    pub fn of_paths(samples: u32) -> Self {
        let all_stay = (1.0 - PATHS_ELSEWHERE).powf(f64::from(samples.max(1)));
        Self {
            share: (1.0 - all_stay).min(MOST),
            ..Self::default()
        }
    }
}

/// The difference between two images of the same size and shading.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// The largest difference of a channel, in 255ths of the encoded range.
    pub largest: f32,
    /// The mean difference of a channel, in 255ths.
    pub mean: f64,
    /// How many pixels differ by more than the tolerance, or hit in one image and miss in the
    /// other.
    pub differing: usize,
    /// How many pixels there are.
    pub pixels: usize,
    /// What was tolerated.
    pub tolerance: Tolerance,
}

impl Comparison {
    /// Compares the images as they would be encoded for a screen, before rounding to 8 bits;
    /// depth images share one range.
    ///
    /// `None` if they differ in size or in shading.
    #[must_use]
    pub fn of(first: &Image, second: &Image, tolerance: Tolerance) -> Option<Self> {
        if (first.width, first.height, first.shading)
            != (second.width, second.height, second.shading)
        {
            return None;
        }
        let encoder = Encoder::of_both(first, second);
        let (largest, sum, differing) = first
            .pixels
            .par_iter()
            .zip(&second.pixels)
            .enumerate()
            .map(|(index, (a, b))| {
                let (a_hits, b_hits) = (a.is_hit(), b.is_hit());
                let (a, b) = (encoder.encode(a), encoder.encode(b));
                let differences = [0, 1, 2].map(|channel| (a[channel] - b[channel]).abs() * 255.0);
                let largest = differences.into_iter().fold(0.0, f32::max);
                let sum: f64 = differences.into_iter().map(f64::from).sum();
                // Written so that a NaN differs.
                let same_color = differences
                    .iter()
                    .all(|difference| *difference <= tolerance.channel);
                let opacity = first.opacity(index) - second.opacity(index);
                let same_opacity = opacity.abs() * 255.0 <= tolerance.channel;
                let same = same_color && same_opacity && a_hits == b_hits;
                (largest, sum, usize::from(!same))
            })
            .reduce(
                || (0.0, 0.0, 0),
                |a, b| (a.0.max(b.0), a.1 + b.1, a.2 + b.2),
            );
        Some(Self {
            largest,
            mean: sum / (3 * first.pixels.len()) as f64,
            differing,
            pixels: first.pixels.len(),
            tolerance,
        })
    }

    /// Whether the images agree within the tolerance.
    #[must_use]
    pub fn is_within(&self) -> bool {
        self.differing as f64 <= self.tolerance.share * self.pixels as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use spherule_kernel::{Pixel, Shading};

    fn image(colors: &[Vec3]) -> Image {
        let pixels = colors.iter().map(|c| Pixel::new(*c, 1.0)).collect();
        Image::new(colors.len() as u32, 1, Shading::Flat, pixels).expect("an image")
    }

    #[test]
    fn equal_images_agree_and_others_are_measured() {
        let a = image(&[Vec3::ZERO, Vec3::ONE, Vec3::splat(0.5)]);
        let b = image(&[Vec3::ZERO, Vec3::ONE, Vec3::new(0.5, 0.6, 0.5)]);
        let same = Comparison::of(&a, &a, Tolerance::default()).expect("comparable");
        assert!(same.is_within() && same.largest == 0.0);
        let other = Comparison::of(&a, &b, Tolerance::default()).expect("comparable");
        assert!(!other.is_within());
        assert_eq!(other.differing, 1);
        assert!((other.largest - 25.5).abs() < 1e-3);
        assert!((other.mean - 25.5 / 9.0).abs() < 1e-3);
    }

    #[test]
    fn a_nan_differs() {
        let a = image(&[Vec3::ZERO]);
        let b = image(&[Vec3::NAN]);
        let compared = Comparison::of(&a, &b, Tolerance::default()).expect("comparable");
        assert_eq!(compared.differing, 1);
    }

    #[test]
    fn other_sizes_do_not_compare() {
        let (a, b) = (image(&[Vec3::ZERO]), image(&[Vec3::ZERO, Vec3::ZERO]));
        assert!(Comparison::of(&a, &b, Tolerance::default()).is_none());
    }
}
