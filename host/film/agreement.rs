//! [`Agreement`]: whether two images of random light paths differ by no more than chance.
//!
//! Two processors that draw the same random numbers trace the same paths, except for those that a
//! rounding sends elsewhere. What such a path adds is another sample of the same light. So of a
//! pixel that differs either image may be the brighter one, with the same probability, and whatever
//! the differences are, their signs are random and independent. Then
//!
//! P(|Σd| ≥ t √Σd²) ≤ 2 exp(−t² / 2)
//!
//! for the differences d of any pixels (W. Hoeffding, Probability inequalities for sums of bounded
//! random variables, J. Am. Stat. Assoc. 58 (1963), theorem 2, for given |d|). Here t counts
//! standard errors: √Σd² / n is the standard error of the mean difference of n pixels, estimated
//! from the pixels' own spread, as in Student's t. Nothing is assumed of how the differences are
//! distributed, and a region has one error where a single pixel differs, by however much.
//!
//! Two sums are made of each region and each channel. That of the differences finds a region whose
//! light is wrong on the whole; few paths of much light hide what is smaller. That of the signs, of
//! all pixels that differ by more than `ROUNDING`, finds many pixels that are wrong by little.
//! The regions are tiles of the image, and squares of two by two, four by four, … of them, up to
//! the whole. The limit is such that images that agree fail with a probability of at most
//! `CHANCE`, whatever the number of regions is (C. Bonferroni).
//!
//! A fault in n pixels makes √n errors at most: one in fewer than about forty is found only if it
//! makes too many pixels differ, which [`Comparison`](super::compare::Comparison) counts.

use rayon::prelude::*;
use serde::Serialize;

use super::Image;

/// The side of a tile, in pixels, or a little more.
const SIDE: u32 = 16;
/// The relative difference that roundings may make: of a pixel, and of the mean of a region.
const ROUNDING: f64 = 1e-3;
/// The probability with which images that agree are said not to.
const CHANCE: f64 = 1e-4;
const CHANNELS: [Channel; 3] = [Channel::Red, Channel::Green, Channel::Blue];

/// A component of a colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Channel {
    /// The first.
    Red,
    /// The second.
    Green,
    /// The third.
    Blue,
}

impl Channel {
    /// Its name, as messages have it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Red => "red",
            Self::Green => "green",
            Self::Blue => "blue",
        }
    }
}

/// What is compared in a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Compared {
    /// The mean of the light.
    Mean,
    /// In how many of the pixels that differ each image is the brighter one.
    Brighter,
}

/// The region that differs most.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Worst {
    /// Its upper left pixel.
    pub x: u32,
    /// See `x`.
    pub y: u32,
    /// Its width and height, in pixels.
    pub width: u32,
    /// See `width`.
    pub height: u32,
    /// The channel in which it differs most.
    pub channel: Channel,
    /// What of it differs.
    pub compared: Compared,
    /// By how many standard errors.
    pub errors: f64,
}

/// Whether two images of random light paths differ by no more than chance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Agreement {
    /// The region that differs most.
    pub worst: Worst,
    /// By how many standard errors none may differ.
    pub limit: f64,
    /// How many regions were compared.
    pub regions: usize,
}

/// What the differences of a channel in a region add up to.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    /// Of the differences, and of their squares.
    differences: f64,
    squares: f64,
    /// Of the light of both images, halved.
    light: f64,
    /// In how many pixels the first image is brighter, and in how many the second.
    brighter: f64,
    darker: f64,
}

impl Sums {
    fn add(&mut self, first: f64, second: f64) {
        let difference = first - second;
        // What is no number is left to the other comparison.
        if !difference.is_finite() {
            return;
        }
        self.differences += difference;
        self.squares += difference * difference;
        self.light += 0.5 * (first.abs() + second.abs());
        if difference.abs() > ROUNDING * first.abs().max(second.abs()) {
            if difference > 0.0 {
                self.brighter += 1.0;
            } else {
                self.darker += 1.0;
            }
        }
    }

    fn and(self, other: Self) -> Self {
        Self {
            differences: self.differences + other.differences,
            squares: self.squares + other.squares,
            light: self.light + other.light,
            brighter: self.brighter + other.brighter,
            darker: self.darker + other.darker,
        }
    }

    /// By how many standard errors the means differ, and the numbers of brighter pixels.
    fn errors(&self) -> [(Compared, f64); 2] {
        let of = |sum: f64, squares: f64| if sum > 0.0 { sum / squares.sqrt() } else { 0.0 };
        let beyond_rounding = self.differences.abs() - ROUNDING * self.light;
        let more = (self.brighter - self.darker).abs();
        [
            (Compared::Mean, of(beyond_rounding, self.squares)),
            (Compared::Brighter, of(more, self.brighter + self.darker)),
        ]
    }
}

/// A grid of regions.
struct Grid {
    /// Where its columns and its rows begin, and where the last ends.
    columns: Vec<u32>,
    rows: Vec<u32>,
    /// Row by row, each channel.
    sums: Vec<[Sums; 3]>,
}

impl Grid {
    /// The tiles of two images of the same size.
    fn tiles(first: &Image, second: &Image) -> Self {
        let cuts = |pixels: u32| -> Vec<u32> {
            let count = (pixels / SIDE).max(1);
            let cut = |index: u32| u64::from(index) * u64::from(pixels) / u64::from(count);
            (0..=count).map(|index| cut(index) as u32).collect()
        };
        let (columns, rows) = (cuts(first.width), cuts(first.height));
        let sums = rows
            .par_windows(2)
            .flat_map_iter(|row| {
                columns
                    .windows(2)
                    .map(move |column| sums_of(first, second, column, row))
            })
            .collect();
        Self {
            columns,
            rows,
            sums,
        }
    }

    /// Each of its regions with the other three of its square; `None` of a single region.
    fn coarser(&self) -> Option<Self> {
        let (width, height) = (self.columns.len() - 1, self.rows.len() - 1);
        if width * height <= 1 {
            return None;
        }
        let half = |cuts: &[u32]| -> Vec<u32> {
            let (last, others) = cuts
                .split_last()
                .map_or((0, cuts), |(last, others)| (*last, others));
            others.iter().copied().step_by(2).chain([last]).collect()
        };
        let (columns, rows) = (half(&self.columns), half(&self.rows));
        let half_width = columns.len() - 1;
        let mut sums = vec![[Sums::default(); 3]; half_width * (rows.len() - 1)];
        for (index, of_region) in self.sums.iter().enumerate() {
            let (column, row) = (index % width / 2, index / width / 2);
            for (into, from) in sums[row * half_width + column].iter_mut().zip(of_region) {
                *into = into.and(*from);
            }
        }
        Some(Self {
            columns,
            rows,
            sums,
        })
    }

    /// The region that differs most.
    fn worst(&self) -> Option<Worst> {
        let width = self.columns.len() - 1;
        let regions = self.sums.iter().enumerate().flat_map(|(index, channels)| {
            let (column, row) = (index % width, index / width);
            channels
                .iter()
                .zip(CHANNELS)
                .flat_map(move |(sums, channel)| {
                    sums.errors().map(|(compared, errors)| Worst {
                        x: self.columns[column],
                        y: self.rows[row],
                        width: self.columns[column + 1] - self.columns[column],
                        height: self.rows[row + 1] - self.rows[row],
                        channel,
                        compared,
                        errors,
                    })
                })
        });
        regions.max_by(|a, b| a.errors.total_cmp(&b.errors))
    }
}

/// What the differences in a region add up to, from and to these columns and rows.
fn sums_of(first: &Image, second: &Image, columns: &[u32], rows: &[u32]) -> [Sums; 3] {
    let mut sums = [Sums::default(); 3];
    for y in rows[0]..rows[1] {
        for x in columns[0]..columns[1] {
            let index = y as usize * first.width as usize + x as usize;
            let color = |image: &Image| image.pixels[index].color().to_array();
            for ((sums, a), b) in sums.iter_mut().zip(color(first)).zip(color(second)) {
                sums.add(a.into(), b.into());
            }
        }
    }
    sums
}

impl Agreement {
    /// Compares two images of the same random light paths.
    ///
    /// `None` if they differ in size, or have no pixels.
    #[must_use]
    pub fn of(first: &Image, second: &Image) -> Option<Self> {
        if (first.width, first.height) != (second.width, second.height) || first.pixels.is_empty() {
            return None;
        }
        let grids = std::iter::successors(Some(Grid::tiles(first, second)), Grid::coarser);
        let (mut regions, mut worst): (usize, Option<Worst>) = (0, None);
        for grid in grids {
            regions += grid.sums.len();
            worst = worst
                .into_iter()
                .chain(grid.worst())
                .max_by(|a, b| a.errors.total_cmp(&b.errors));
        }
        let comparisons = (regions * CHANNELS.len() * 2) as f64;
        worst.map(|worst| Self {
            worst,
            limit: (2.0 * (2.0 * comparisons / CHANCE).ln()).sqrt(),
            regions,
        })
    }

    /// Whether no region differs by more than chance.
    #[must_use]
    pub fn is_within(&self) -> bool {
        self.worst.errors <= self.limit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use glam::Vec3;
    use spherule_kernel::{Pixel, Shading};

    const SIZE: (u32, u32) = (150, 70);

    /// An image of grey, in which each pixel is what `of` makes of its place.
    fn image(mut of: impl FnMut(u32, u32) -> f32) -> Image {
        let places = (0..SIZE.0 * SIZE.1).map(|index| (index % SIZE.0, index / SIZE.0));
        let pixels = places.map(|(x, y)| Pixel::new(Vec3::splat(of(x, y)), 1.0));
        Image::new(SIZE.0, SIZE.1, Shading::Lit, pixels.collect()).expect("an image")
    }

    /// The agreement of two images whose light differs from pixel to pixel, for this share of the
    /// pixels also between the images; `fault` makes of the second's light what it is.
    fn agreement(share: f32, seed: u64, fault: impl Fn(u32, u32, f32) -> f32) -> Agreement {
        let noisy = |own_seed: u64| {
            let (mut common, mut own) = (Random::new(seed), Random::new(own_seed));
            // Few paths have much light.
            let light = |random: &mut Random| 0.1 + 5.0 * random.within(0.0, 1.0).powi(4);
            image(|x, y| {
                let (of_both, of_one) = (light(&mut common), light(&mut own));
                let is_elsewhere = common.within(0.0, 1.0) < share;
                let light = if is_elsewhere { of_one } else { of_both };
                if own_seed == 0 {
                    light
                } else {
                    fault(x, y, light)
                }
            })
        };
        Agreement::of(&noisy(0), &noisy(seed + 1)).expect("images of one size")
    }

    /// Whatever the share of the pixels is that differ.
    #[test]
    fn chance_is_chance() {
        for share in [0.0, 0.001, 0.03, 0.3, 1.0] {
            for seed in 0..20 {
                let found = agreement(share, seed, |_, _, light| light * (1.0 + 1e-6));
                assert!(found.is_within(), "{share}: {found:?}");
            }
        }
    }

    #[test]
    fn what_is_wrong_is_found_where_it_is() {
        let all = |_, _, light| light * 1.01;
        let disc = |x: u32, y: u32, light| {
            let (x, y) = (f64::from(x) - 90.0, f64::from(y) - 40.0);
            light * if x.hypot(y) < 5.0 { 1.02 } else { 1.0 }
        };
        for share in [0.0, 0.001, 0.03] {
            let found = agreement(share, 1, all);
            assert!(!found.is_within(), "{share}: {found:?}");
            let found = agreement(share, 1, disc);
            let worst = found.worst;
            assert!(!found.is_within(), "{share}: {found:?}");
            assert!((worst.x..worst.x + worst.width).contains(&90), "{worst:?}");
            assert!((worst.y..worst.y + worst.height).contains(&40), "{worst:?}");
        }
        // Few that are wrong by much, among many that are not.
        let rare =
            |x: u32, y: u32, light| light + if (x + y).is_multiple_of(4) { 50.0 } else { 0.0 };
        let found = agreement(1.0, 1, rare);
        assert!(!found.is_within(), "{found:?}");
    }

    #[test]
    fn tiles_cover_every_pixel_once_at_every_scale() {
        let one = image(|_, _| 1.0);
        let none = image(|_, _| 0.0);
        let mut grid = Some(Grid::tiles(&one, &none));
        let mut scales = 0;
        while let Some(found) = grid {
            let pixels: f64 = found.sums.iter().map(|sums| sums[0].differences).sum();
            assert_eq!(pixels, f64::from(SIZE.0 * SIZE.1));
            assert_eq!(
                found.sums.len(),
                (found.columns.len() - 1) * (found.rows.len() - 1)
            );
            scales += 1;
            grid = found.coarser();
        }
        // 9 × 4 tiles, 5 × 2, 3 × 1, 2 × 1, 1.
        assert_eq!(scales, 5);
    }

    #[test]
    fn other_sizes_do_not_compare() {
        let other = Image::new(1, 1, Shading::Lit, vec![Pixel::new(Vec3::ONE, 1.0)]);
        assert_eq!(
            Agreement::of(&image(|_, _| 1.0), &other.expect("an image")),
            None
        );
    }
}
