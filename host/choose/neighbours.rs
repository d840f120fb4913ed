//! [`Neighbours`]: for each sphere, the larger ones whose surfaces it may meet at a small angle.

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};

use glam::DVec3;
use rayon::prelude::*;

use crate::memory;
use crate::scene::world::GRAIN;

/// So many tests of two spheres are made, for all spheres together.
const MOST_TESTS: usize = 200_000_000;
/// And for each sphere at least so many.
const FEWEST_TESTS: usize = 256;
/// The powers of two of radii are from here on.
const SMALLEST: i32 = -150;
/// And so many.
const SIZES: usize = 280;
/// Cells are so many times as wide as the distance of what is looked for, if that is more.
const REACHES: f64 = 8.0;
/// Where few smaller spheres are sought among them, cells are at least this share of the largest
/// radius.
const NARROWEST: f64 = 0.25;

/// Spheres that are looked for.
pub(super) trait Bodies: Sync {
    fn count(&self) -> usize;
    fn center(&self, index: usize) -> DVec3;
    fn radius(&self, index: usize) -> f64;
    /// How far the surface may be from where these say.
    fn margin(&self, index: usize) -> f64;

    /// The power of two of the radius, counted from the smallest; `None` for no sphere.
    fn size(&self, index: usize) -> Option<usize> {
        let radius = self.radius(index);
        let exponent = (radius.to_bits() >> 52) as usize;
        let size = exponent.wrapping_sub((f64::MAX_EXP - 1 + SMALLEST) as usize);
        let is_one = radius > 0.0 && size < SIZES && self.center(index).is_finite();
        is_one.then_some(size)
    }
}

/// The largest distance of the centres of spheres of these radii whose surfaces may meet at a
/// small angle θ, by the triangle of the radii and the angle; `slant` is 1 − cos θ.
fn reach(one: f64, other: f64, slant: f64) -> f64 {
    let difference = one - other;
    (difference * difference + 2.0 * one * other * slant).sqrt()
}

/// Spheres in grids, one for each power of two of their radii.
pub(super) struct Neighbours<'a, B> {
    /// The smallest spheres first.
    grids: Vec<Grid>,
    /// For each size, which of these it is.
    of_size: [usize; SIZES],
    bodies: &'a B,
    slant: f64,
    /// For each sphere.
    most_tests: usize,
}

/// What is known of the spheres of one size before they are sorted.
#[derive(Clone, Copy)]
struct Extent {
    count: usize,
    smallest: f64,
    largest: f64,
    margin: f64,
}

impl Extent {
    const NONE: Self = Self {
        count: 0,
        smallest: f64::INFINITY,
        largest: 0.0,
        margin: 0.0,
    };

    fn and(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            smallest: self.smallest.min(other.smallest),
            largest: self.largest.max(other.largest),
            margin: self.margin.max(other.margin),
        }
    }
}

/// The spheres of one size, sorted by the cells that their centres are in.
struct Grid {
    extent: Extent,
    cells_a_unit: f64,
    /// For each place in the table, where the indices of its spheres end; they begin where those
    /// of the place before end. Cells share a place where their hashes are the same.
    ends: Vec<AtomicU32>,
    /// Indices, with a mark of the cell in the upper half.
    marked: Vec<AtomicU64>,
}

/// A cell of a grid.
#[derive(Clone, Copy)]
struct Cell {
    /// In the table.
    place: usize,
    /// Tells most cells of a place apart.
    mark: u32,
}

impl Grid {
    fn cell(&self, point: DVec3) -> [i64; 3] {
        let cell = |x: f64| {
            let x = x * self.cells_a_unit;
            // Saturates.
            let towards_zero = x as i64;
            towards_zero.saturating_sub(i64::from(x < towards_zero as f64))
        };
        [cell(point.x), cell(point.y), cell(point.z)]
    }

    /// Cells of a block of 8 × 8 × 8 are together in the table, since spheres that follow each
    /// other are often near each other.
    fn hash(&self, [x, y, z]: [i64; 3]) -> Cell {
        let block = (x >> 3)
            .wrapping_mul(83_492_791)
            .wrapping_add((y >> 3).wrapping_mul(73_856_093))
            .wrapping_add((z >> 3).wrapping_mul(19_349_663));
        let hash = block << 9 | (x & 7) | (y & 7) << 3 | (z & 7) << 6;
        let mark = x ^ y.wrapping_mul(0x9e37_79b1) ^ z.wrapping_mul(0x85eb_ca77);
        Cell {
            place: hash as usize & (self.ends.len() - 1),
            mark: (mark ^ mark >> 32) as u32,
        }
    }

    /// The indices of the spheres of a cell, and perhaps of another one.
    fn at(&self, cell: [i64; 3]) -> impl ExactSizeIterator<Item = Option<usize>> {
        let Cell { place, mark } = self.hash(cell);
        let end = |place: usize| self.ends[place].load(Relaxed) as usize;
        let start = if place == 0 { 0 } else { end(place - 1) };
        self.marked[start..end(place)].iter().map(move |marked| {
            let marked = marked.load(Relaxed);
            ((marked >> 32) as u32 == mark).then_some(marked as u32 as usize)
        })
    }
}

/// So many zeros, if there is memory for them.
fn zeros<T: Default>(count: usize) -> Option<Vec<T>> {
    let mut zeros = memory::room(count as u64, "the spheres that meet").ok()?;
    zeros.resize_with(count, T::default);
    Some(zeros)
}

impl<'a, B: Bodies> Neighbours<'a, B> {
    /// `None` without the memory for it. `slant` is 1 − cos θ of the largest angle θ between
    /// surfaces that are looked for.
    pub(super) fn of(bodies: &'a B, slant: f64) -> Option<Self> {
        let all = || (0..bodies.count()).into_par_iter().with_min_len(GRAIN);
        let none = || vec![Extent::NONE; SIZES];
        let extents = all()
            .fold(none, |mut extents, index| {
                if let Some(size) = bodies.size(index) {
                    let radius = bodies.radius(index);
                    extents[size] = extents[size].and(Extent {
                        count: 1,
                        smallest: radius,
                        largest: radius,
                        margin: bodies.margin(index),
                    });
                }
                extents
            })
            .reduce(none, |one, other| {
                one.into_iter().zip(other).map(|(a, b)| a.and(b)).collect()
            });
        let mut grids = Vec::new();
        // For each size, which grid it is.
        let mut of_size = [usize::MAX; SIZES];
        let mut smaller = 0;
        for (size, extent) in extents.into_iter().enumerate() {
            if extent.count == 0 {
                continue;
            }
            let reach = reach(extent.smallest, extent.largest, slant) + 2.0 * extent.margin;
            let narrowest = if smaller > extent.count {
                2.0
            } else {
                NARROWEST
            };
            of_size[size] = grids.len();
            grids.push(Grid {
                extent,
                cells_a_unit: 1.0 / (REACHES * reach).max(narrowest * extent.largest),
                ends: zeros(extent.count.next_power_of_two())?,
                marked: zeros(extent.count)?,
            });
            smaller += extent.count;
        }
        // Sorted by counting: the ends of places are first their counts, then their beginnings.
        let cell_of = |index: usize| -> Option<(&Grid, Cell)> {
            let grid: &Grid = &grids[of_size[bodies.size(index)?]];
            Some((grid, grid.hash(grid.cell(bodies.center(index)))))
        };
        all().for_each(|index| {
            if let Some((grid, cell)) = cell_of(index) {
                grid.ends[cell.place].fetch_add(1, Relaxed);
            }
        });
        for grid in &grids {
            let mut start = 0;
            for end in &grid.ends {
                start += end.swap(start, Relaxed);
            }
        }
        all().for_each(|index| {
            if let Some((grid, cell)) = cell_of(index) {
                let end = grid.ends[cell.place].fetch_add(1, Relaxed);
                let marked = u64::from(cell.mark) << 32 | index as u64;
                grid.marked[end as usize].store(marked, Relaxed);
            }
        });
        Some(Self {
            grids,
            of_size,
            bodies,
            slant,
            most_tests: (MOST_TESTS / bodies.count().max(1)).max(FEWEST_TESTS),
        })
    }

    /// The largest of what `value` gives for two spheres that may meet at a small angle, the
    /// smaller one first, and zero; `None` where too many are too close.
    pub(super) fn largest(&self, value: impl Fn(usize, usize) -> f64 + Sync) -> Option<f64> {
        (0..self.bodies.count())
            .into_par_iter()
            .with_min_len(GRAIN)
            .map(|index| match self.bodies.size(index) {
                Some(size) => self.largest_of(self.of_size[size], index, &value),
                None => Some(0.0),
            })
            .try_reduce(|| 0.0, |one, other| Some(one.max(other)))
    }

    /// The same for one sphere and those that are larger, or equal and of a larger index.
    fn largest_of(
        &self,
        number: usize,
        index: usize,
        value: impl Fn(usize, usize) -> f64,
    ) -> Option<f64> {
        let (center, radius) = (self.bodies.center(index), self.bodies.radius(index));
        let margin = self.bodies.margin(index);
        let mut largest = 0.0_f64;
        let mut tests = 0;
        for grid in &self.grids[number..] {
            let margin = margin + grid.extent.margin;
            let reach_to = |other: f64| reach(radius, other, self.slant) + margin;
            let reach = DVec3::splat(reach_to(grid.extent.largest));
            let from = grid.cell(center - reach);
            let to = grid.cell(center + reach);
            for z in from[2]..=to[2] {
                for y in from[1]..=to[1] {
                    for x in from[0]..=to[0] {
                        let others = grid.at([x, y, z]);
                        tests += others.len();
                        if tests > self.most_tests {
                            return None;
                        }
                        for other in others.flatten() {
                            let (apart, larger) = (
                                center.distance_squared(self.bodies.center(other)),
                                self.bodies.radius(other),
                            );
                            if (larger, other) > (radius, index)
                                && apart <= reach_to(larger).powi(2)
                            {
                                largest = largest.max(value(index, other));
                            }
                        }
                    }
                }
            }
        }
        Some(largest)
    }
}
