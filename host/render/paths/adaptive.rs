//! [`Adaptive`]: samples where they are needed. The image is divided into tiles, and each takes
//! samples until its noise is low enough.
//!
//! The noise of a tile is the root mean square of its pixels' standard errors, of which
//! [`Accumulator::variance_by_groups`] knows the squares, over a level. The level is the tile's
//! mean luminance, but no less than [`FLOOR`] of what the image typically has. A tile is calm where
//! that is known, after [`FEWEST`] samples at least, and is no more than the target. It stops where
//! no tile around it has more than [`AROUND`] times the target: a tile that has not yet met what is
//! rare there has a neighbour that has. It goes on again if one of them turns out to have more.
//!
//! Samples are looked at after 16, 20, 26, 32, … of them, each time after a quarter more: so no
//! more than that is taken in vain, and looking costs little. Everything is decided by numbers that
//! do not depend on the threads.

use std::ops::{Range, RangeInclusive};
use std::time::{Duration, Instant};

use glam::UVec2;
use rayon::prelude::*;
use spherule_kernel::color::luminance;
use spherule_kernel::film::ADAPTIVE_TILE;
use spherule_kernel::{Accumulator, PathLaunch};

use super::budget::{Budget, GoesOn, StoppedBy};
use crate::error::Result;
use crate::film;
use crate::render::Progress;

/// The fewest samples after which a tile may stop.
const FEWEST: u32 = 16;
/// A tile around one that stops may have the target's noise so many times. At once it would keep
/// its neighbours at work until it is calm itself; what is met rarely is many times the target.
const AROUND: f64 = 3.0;
/// A tile that is darker than this part of the image is measured against this part. Where the image
/// is shown at middle grey, 18 % of white, 2 % of it are 0.00023 of white, and at most 0.75 of 255
/// steps of sRGB, whose slope in the dark is 12.92.
const FLOOR: f64 = 1.0 / 16.0;
/// Pixels of a tile.
pub(super) const PIXELS: usize = (ADAPTIVE_TILE * ADAPTIVE_TILE) as usize;

/// What is known of a tile.
#[derive(Clone, Copy, Debug, Default)]
struct Tile {
    /// Where it stands, in tiles.
    slot: usize,
    /// The samples of each of its pixels.
    samples: u32,
    /// The mean luminance and the mean estimated variance of its pixels.
    mean: f64,
    variance: f64,
    /// Its pixels in the image.
    pixels: f64,
}

/// Some tiles of an image, and their samples.
pub(super) struct Adaptive {
    image_size: UVec2,
    /// The number of the first of them; the others follow.
    first: u32,
    tiles: Vec<Tile>,
    /// The tiles' sums, tile after tile; those that take samples come first.
    sums: Vec<Accumulator>,
    /// The tiles in the order in which they stand.
    order: Vec<usize>,
    /// How many take samples.
    active: usize,
}

/// What follows from a look at the tiles.
struct Decision {
    /// Whether all tiles are calm.
    are_calm: bool,
    /// Whether some stand elsewhere now.
    have_moved: bool,
}

/// What traces the launches: a processor, or a device with memory of its own.
pub(super) trait Tracer {
    /// Adds the samples of `launch` to `sums` for as long as `goes_on`, which is told the share of
    /// them that is done, says so. Returns whether all are done, and how long it took.
    fn pass(
        &mut self,
        launch: &PathLaunch,
        sums: &mut [Accumulator],
        goes_on: GoesOn<'_>,
    ) -> Result<(bool, Duration)>;

    /// Brings the sums of the tiles that take samples here, so that they can be looked at. Each
    /// pixel was to get so many.
    fn fetch(&mut self, adaptive: &mut Adaptive, taken: RangeInclusive<u32>) -> Result<()>;

    /// Takes the sums from here, because they are others or stand elsewhere.
    fn give(&mut self, sums: &[Accumulator]) -> Result<()>;
}

/// How many tiles an image of this size has.
pub(super) fn tiles_of(image_size: UVec2) -> u32 {
    columns(image_size) * image_size.y.div_ceil(ADAPTIVE_TILE)
}

fn columns(image_size: UVec2) -> u32 {
    image_size.x.div_ceil(ADAPTIVE_TILE)
}

impl Adaptive {
    /// These tiles of an image of this size, without samples.
    ///
    /// # Errors
    ///
    /// [`OutOfHostMemory`](crate::Error::OutOfHostMemory).
    pub(super) fn new(image_size: UVec2, tiles: Range<u32>) -> Result<Self> {
        let mut sums =
            film::allocate::<Accumulator>(ADAPTIVE_TILE, ADAPTIVE_TILE * tiles.len() as u32)?;
        sums.par_chunks_mut(PIXELS)
            .zip(tiles.clone())
            .for_each(|(sums, tile)| sums.fill(Accumulator::of_tile(tile)));
        Ok(Self {
            image_size,
            first: tiles.start,
            tiles: (0..tiles.len())
                .map(|slot| Tile {
                    slot,
                    ..Tile::default()
                })
                .collect(),
            sums,
            order: (0..tiles.len()).collect(),
            active: tiles.len(),
        })
    }

    /// The sums of the tiles that take samples.
    pub(super) fn active(&mut self) -> &mut [Accumulator] {
        &mut self.sums[..self.active * PIXELS]
    }

    /// The most samples that a pixel of a tile that takes samples has.
    fn most(&self) -> u32 {
        let active = self.order[..self.active].iter();
        active
            .map(|tile| self.tiles[*tile].samples)
            .max()
            .unwrap_or(0)
    }

    /// How many pixels of the tiles that take samples have not so many more than before.
    #[cfg(feature = "gpu")]
    pub(super) fn lacking(&mut self, taken: &RangeInclusive<u32>) -> usize {
        let (size, tiles) = (self.image_size, &self.tiles);
        self.sums[..self.active * PIXELS]
            .par_chunks(PIXELS)
            .zip(&self.order)
            .map(|(sums, tile)| {
                let before = tiles[*tile].samples;
                let is_missing = |(index, sum): &(usize, &Accumulator)| {
                    let found = (sum.samples() as u32).wrapping_sub(before);
                    is_in_image(sum, *index, size) && !taken.contains(&found)
                };
                sums.iter().enumerate().filter(is_missing).count()
            })
            .sum()
    }

    /// Learns what the sums of the tiles that take samples say, of which each pixel has at least so
    /// many more than before.
    fn measure(&mut self, taken: u32) {
        let (size, tiles) = (self.image_size, &self.tiles);
        let measured: Vec<Tile> = self.sums[..self.active * PIXELS]
            .par_chunks(PIXELS)
            .zip(&self.order)
            .map(|(sums, tile)| {
                let before = tiles[*tile];
                Tile {
                    slot: before.slot,
                    samples: before.samples + taken,
                    ..measured(sums, size)
                }
            })
            .collect();
        for (tile, measured) in self.order.iter().zip(measured) {
            self.tiles[*tile] = measured;
        }
    }

    /// The noise of each tile; infinite where it is not known, as in an image that is all black so
    /// far: the first sample that meets light changes all of that.
    fn noise_of_tiles(&self) -> Vec<f64> {
        // The mean of the roots is about what a screen shows, so that a sun in the picture does not
        // make dark of all that is not as bright.
        let (mut roots, mut pixels) = (0.0, 0.0);
        for tile in &self.tiles {
            roots += tile.mean.sqrt() * tile.pixels;
            pixels += tile.pixels;
        }
        let floor = FLOOR * (roots / pixels).powi(2);
        let of = |tile: &Tile| {
            let noise = tile.variance.sqrt() / tile.mean.max(floor);
            if noise.is_finite() {
                noise
            } else {
                f64::INFINITY
            }
        };
        self.tiles.iter().map(of).collect()
    }

    /// The sum over all pixels of the squared noise of their tiles, and the number of pixels.
    pub(super) fn noise(&self) -> (f64, f64) {
        let noise = self.noise_of_tiles();
        let tiles = self.tiles.iter().zip(noise);
        tiles.fold((0.0, 0.0), |(squares, pixels), (tile, noise)| {
            (squares + noise * noise * tile.pixels, pixels + tile.pixels)
        })
    }

    /// Decides which tiles go on: those that have fewer than so many samples and are not calm, or
    /// have a neighbour that is far from it.
    fn decide(&mut self, target: f64, samples: u32) -> Decision {
        let noise: Vec<f64> = self
            .tiles
            .iter()
            .zip(self.noise_of_tiles())
            .map(|(tile, noise)| {
                if tile.samples < FEWEST {
                    f64::INFINITY
                } else {
                    noise
                }
            })
            .collect();
        // What is not known is above every target, and no noise is below one that is no number.
        let is_within = |noise: f64, limit: f64| noise.is_finite() && noise <= limit;
        let is_done = |tile: usize| {
            is_within(noise[tile], target)
                && self
                    .around(tile)
                    .all(|other| is_within(noise[other], AROUND * target))
        };
        let goes_on: Vec<bool> = (0..self.tiles.len())
            .map(|tile| self.tiles[tile].samples < samples && !is_done(tile))
            .collect();
        Decision {
            are_calm: noise.iter().all(|noise| is_within(*noise, target)),
            have_moved: self.bring_forward(&goes_on),
        }
    }

    /// The tiles around this one.
    fn around(&self, tile: usize) -> impl Iterator<Item = usize> {
        let columns = i64::from(columns(self.image_size));
        let (tile, all) = (tile as i64, self.tiles.len() as i64);
        let column = (i64::from(self.first) + tile) % columns;
        (-1..=1)
            .flat_map(|down| (-1..=1).map(move |right| (right, down)))
            .filter(move |(right, _)| (0..columns).contains(&(column + right)))
            .map(move |(right, down)| tile + down * columns + right)
            .filter(move |other| (0..all).contains(other) && *other != tile)
            .map(|other| other as usize)
    }

    /// Moves the tiles that go on before the others. Returns whether any had to move.
    fn bring_forward(&mut self, goes_on: &[bool]) -> bool {
        let (mut front, mut back) = (0, self.order.len());
        let mut has_moved = false;
        loop {
            while front < back && goes_on[self.order[front]] {
                front += 1;
            }
            while front < back && !goes_on[self.order[back - 1]] {
                back -= 1;
            }
            if front == back {
                break;
            }
            let (left, right) = self.sums.split_at_mut((back - 1) * PIXELS);
            left[front * PIXELS..][..PIXELS].swap_with_slice(&mut right[..PIXELS]);
            self.order.swap(front, back - 1);
            has_moved = true;
        }
        self.active = front;
        for (slot, tile) in self.order.iter().enumerate() {
            self.tiles[*tile].slot = slot;
        }
        has_moved
    }

    /// Puts the sums where they are in the image.
    pub(super) fn put_into(&self, image: &mut [Accumulator]) {
        let size = self.image_size;
        let columns = columns(size) as usize;
        let side = ADAPTIVE_TILE as usize;
        image
            .par_chunks_mut(size.x as usize * side)
            .enumerate()
            .for_each(|(row, image)| {
                let first = (row * columns).max(self.first as usize);
                let end = ((row + 1) * columns).min(self.first as usize + self.tiles.len());
                for number in first..end {
                    let slot = self.tiles[number - self.first as usize].slot;
                    let sums = &self.sums[slot * PIXELS..][..PIXELS];
                    let left = (number % columns) * side;
                    let width = side.min(size.x as usize - left);
                    for (line, sums) in image
                        .chunks_mut(size.x as usize)
                        .zip(sums.chunks_exact(side))
                    {
                        line[left..left + width].copy_from_slice(&sums[..width]);
                    }
                }
            });
    }
}

/// What the sums of a tile's pixels say of it.
fn measured(sums: &[Accumulator], image_size: UVec2) -> Tile {
    let mut tile = Tile::default();
    for (index, sum) in sums.iter().enumerate() {
        if !is_in_image(sum, index, image_size) {
            continue;
        }
        let is_known = sum.samples() > 1.0;
        tile.pixels += 1.0;
        tile.mean += f64::from(luminance(sum.color()));
        tile.variance += if is_known {
            f64::from(sum.variance_by_groups())
        } else {
            f64::INFINITY
        };
    }
    tile.mean /= tile.pixels;
    tile.variance /= tile.pixels;
    tile
}

/// Whether the sum at this place in its tile is that of a pixel of the image.
fn is_in_image(sum: &Accumulator, index: usize, image_size: UVec2) -> bool {
    let index = index as u32;
    let slot = UVec2::new(index % ADAPTIVE_TILE, index / ADAPTIVE_TILE);
    sum.pixel_at(slot, image_size).cmplt(image_size).all()
}

/// After how many samples they are looked at next, if so many are taken: an even number, so that
/// both groups have as many.
fn next_look(taken: u32) -> u32 {
    (taken + taken / 4).next_multiple_of(2).max(FEWEST)
}

/// What the samples are taken for.
pub(super) struct Goal {
    /// The noise that each tile may have.
    pub(super) target: f64,
    /// The most samples of a pixel.
    pub(super) samples: u32,
    /// The most samples of a launch.
    pub(super) of_launch: u32,
    /// When the time is up.
    pub(super) deadline: Option<Instant>,
}

/// Takes samples of the tiles until `goal` or `progress`, which is told the share of the samples
/// that are taken, ends that. Says which did.
pub(super) fn take_samples(
    adaptive: &mut Adaptive,
    launch: &PathLaunch,
    goal: &Goal,
    progress: Progress<'_>,
    tracer: &mut impl Tracer,
) -> Result<StoppedBy> {
    tracer.give(&adaptive.sums)?;
    let mut budget = Budget::new(0, goal.deadline).with_at_most(goal.of_launch);
    loop {
        let most = adaptive.most();
        let round = next_look(most).min(goal.samples) - most;
        let whole = f64::from(goal.samples);
        let progress = |share: f64| progress((f64::from(most) + share * f64::from(round)) / whole);
        let launch = PathLaunch {
            tile_origin: UVec2::ZERO,
            tile_size: UVec2::new(ADAPTIVE_TILE, ADAPTIVE_TILE * adaptive.active as u32),
            is_adaptive: 1,
            ..*launch
        };
        let by = budget.again(round).spend(&progress, |_, count, goes_on| {
            let launch = PathLaunch {
                sample_count: count,
                ..launch
            };
            tracer.pass(&launch, adaptive.active(), goes_on)
        })?;
        tracer.fetch(adaptive, budget.taken())?;
        adaptive.measure(budget.done());
        if by != StoppedBy::Samples {
            return Ok(by);
        }
        let Decision {
            are_calm,
            have_moved,
        } = adaptive.decide(goal.target, goal.samples);
        if adaptive.active == 0 {
            return Ok(if are_calm {
                StoppedBy::Noise
            } else {
                StoppedBy::Samples
            });
        }
        if have_moved {
            tracer.give(adaptive.active())?;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::QUIET;
    use glam::Vec3;

    /// Three and a half by two and a half tiles.
    const SIZE: UVec2 = UVec2::new(56, 40);

    /// Gives each sample the light that a function of the pixel and the sample says.
    struct Pretended<F>(F);

    impl<F: Fn(UVec2, u32) -> f32> Tracer for Pretended<F> {
        fn pass(
            &mut self,
            launch: &PathLaunch,
            sums: &mut [Accumulator],
            goes_on: GoesOn<'_>,
        ) -> Result<(bool, Duration)> {
            assert_eq!(launch.tile_size.y as usize * 16, sums.len());
            for (index, sum) in sums.iter_mut().enumerate() {
                let slot = UVec2::new(index as u32 % 16, index as u32 / 16);
                let pixel = sum.pixel_at(slot, launch.image_size);
                for _ in 0..launch.sample_count {
                    let sample = sum.samples() as u32;
                    let light = Vec3::splat((self.0)(pixel, sample));
                    if pixel.cmplt(launch.image_size).all() {
                        sum.add_to_group(light, 1.0, 1.0, sample);
                    }
                }
            }
            Ok((goes_on(1.0), Duration::ZERO))
        }

        fn fetch(&mut self, _: &mut Adaptive, _: RangeInclusive<u32>) -> Result<()> {
            Ok(())
        }

        fn give(&mut self, _: &[Accumulator]) -> Result<()> {
            Ok(())
        }
    }

    /// The image of this light at a target of 1 %, and what ended it.
    fn image(samples: u32, light: impl Fn(UVec2, u32) -> f32) -> (Vec<Accumulator>, StoppedBy) {
        let launch = PathLaunch {
            image_size: SIZE,
            ..PathLaunch::default()
        };
        let goal = Goal {
            target: 0.01,
            samples,
            of_launch: 7,
            deadline: None,
        };
        let mut adaptive = Adaptive::new(SIZE, 0..tiles_of(SIZE)).expect("memory");
        let by = take_samples(&mut adaptive, &launch, &goal, QUIET, &mut Pretended(light));
        let mut image = vec![Accumulator::default(); (SIZE.x * SIZE.y) as usize];
        adaptive.put_into(&mut image);
        (image, by.expect("no error"))
    }

    fn at(image: &[Accumulator], x: u32, y: u32) -> Accumulator {
        image[(y * SIZE.x + x) as usize]
    }

    /// Light in which the groups differ by this much at every sample.
    fn rough(sample: u32, by: f32) -> f32 {
        1.0 + if sample.is_multiple_of(2) { by } else { -by }
    }

    #[test]
    fn each_pixel_stands_where_it_belongs() {
        // The tile in the middle is never calm, so that tiles change places.
        let light = |pixel: UVec2, sample| {
            let own = (1000 + pixel.y * SIZE.x + pixel.x) as f32;
            let is_rough = pixel / 16 == UVec2::splat(1);
            own * if is_rough { rough(sample, 0.5) } else { 1.0 }
        };
        let (image, by) = image(100, light);
        assert_eq!(by, StoppedBy::Samples);
        for (index, sum) in image.iter().enumerate() {
            let expected = (1000 + index) as f32;
            assert!((sum.color().x / expected - 1.0).abs() < 1e-5, "{index}");
        }
    }

    #[test]
    fn a_tile_that_is_not_calm_keeps_its_neighbours_going_and_no_others() {
        let light = |pixel: UVec2, sample| {
            if pixel / 16 == UVec2::ZERO {
                rough(sample, 0.5)
            } else {
                1.0
            }
        };
        let (image, by) = image(100, light);
        assert_eq!(by, StoppedBy::Samples);
        assert_eq!(at(&image, 0, 0).samples(), 100.0);
        assert_eq!(at(&image, 31, 31).samples(), 100.0);
        assert_eq!(at(&image, 32, 31).samples(), 16.0);
        assert_eq!(at(&image, 31, 32).samples(), 16.0);
        assert_eq!(at(&image, 55, 39).samples(), 16.0);
    }

    /// What is rare is met late, by a tile that goes on because of its neighbour; then the tiles on
    /// its other side go on again.
    #[test]
    fn a_tile_goes_on_again_when_its_neighbour_is_not_calm() {
        let light = |pixel: UVec2, sample| match pixel.x / 16 {
            0 if sample < 40 => rough(sample, 0.5),
            1 if sample == 30 => 1000.0,
            _ => 1.0,
        };
        let (image, by) = image(200, light);
        assert_eq!(by, StoppedBy::Samples);
        assert_eq!(at(&image, 16, 0).samples(), 200.0);
        assert_eq!(at(&image, 32, 0).samples(), 200.0);
        assert_eq!(at(&image, 48, 0).samples(), 16.0);
    }

    #[test]
    fn a_black_corner_is_done_and_a_black_image_is_not() {
        let (all, by) = image(30, |_, _| 0.0);
        assert_eq!(by, StoppedBy::Samples);
        assert!(all.iter().all(|sum| sum.samples() == 30.0));
        let (part, by) = image(30, |pixel, _| if pixel.x < 16 { 0.0 } else { 1.0 });
        assert_eq!(by, StoppedBy::Noise);
        assert!(part.iter().all(|sum| sum.samples() == 16.0));
    }

    /// A tile that is a thousandth as bright as the others is measured against a sixteenth of them;
    /// a pixel that is a hundred thousand times as bright makes nothing dark of the others.
    #[test]
    fn dark_tiles_are_measured_against_what_the_image_typically_has() {
        let dark = |by: f32| {
            let light = move |pixel: UVec2, sample| match pixel.x {
                0..16 => 1e-3 * rough(sample, by),
                _ => 1.0,
            };
            image(40, light).1
        };
        // By a fifth of it is 0.6 % of a sixteenth.
        assert_eq!(dark(0.2), StoppedBy::Noise);
        assert_eq!(dark(0.5), StoppedBy::Samples);
        let beside_a_sun = |pixel: UVec2, sample| match pixel {
            UVec2 { x: 0, y: 0 } => 1e5,
            _ => rough(sample, 0.02),
        };
        assert_eq!(image(40, beside_a_sun).1, StoppedBy::Samples);
    }

    #[test]
    fn groups_have_as_many_samples_at_each_look() {
        let mut taken = 0;
        let mut looks = Vec::new();
        while taken < 100 {
            taken = next_look(taken);
            looks.push(taken);
        }
        assert_eq!(looks, [16, 20, 26, 32, 40, 50, 62, 78, 98, 122]);
    }
}
