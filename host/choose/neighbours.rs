//! [`Neighbours`]: for each sphere, the larger ones whose surfaces it may meet at a small angle.

use std::sync::atomic::{AtomicU32, AtomicU64, AtomicUsize, Ordering::Relaxed};

use glam::DVec3;
use rayon::prelude::*;

use crate::memory;
use crate::scene::world::GRAIN;

/// So many tests of two spheres are made, for all spheres together.
pub(super) const MOST_TESTS: usize = 200_000_000;
/// Spheres with fewer tests are not counted.
const FEW_TESTS: usize = 64;
/// The powers of two of radii are from here on.
const SMALLEST: i32 = -150;
/// And so many.
const SIZES: usize = 280;
/// Cells are so many times as wide as the distance of what is looked for, if that is more.
const REACHES: f64 = 8.0;
/// Cells of the smallest spheres are at least this share of the largest of them. Those of larger
/// ones are as wide as these, because smaller ones look for them as far away as that.
const NARROWEST: f64 = 0.25;

/// Spheres that are looked for.
pub(super) trait Bodies: Sync {
    fn count(&self) -> usize;
    fn center(&self, index: usize) -> DVec3;
    fn radius(&self, index: usize) -> f64;
    /// How far the sphere may move from there.
    fn motion(&self, index: usize) -> f64;
    /// How far its surface and that of a sphere next to it may be apart and yet meet.
    fn thickness(&self, index: usize) -> f64;
    /// Whether the sphere is too small to be looked for.
    fn is_speck(&self, index: usize) -> bool;

    /// The power of two of the radius, counted from the smallest; `None` for no sphere.
    fn size(&self, index: usize) -> Option<usize> {
        let radius = self.radius(index);
        let exponent = (radius.to_bits() >> 52) as usize;
        let size = exponent.wrapping_sub((f64::MAX_EXP - 1 + SMALLEST) as usize);
        let is_one = radius > 0.0 && size < SIZES && self.center(index).is_finite();
        (is_one && !self.is_speck(index)).then_some(size)
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
}

/// What is known of the spheres of one size before they are sorted.
#[derive(Clone, Copy)]
struct Extent {
    count: usize,
    smallest: f64,
    largest: f64,
    /// The largest motion.
    motion: f64,
    /// The sum of what is added to reaches.
    margins: f64,
}

impl Extent {
    const NONE: Self = Self {
        count: 0,
        smallest: f64::INFINITY,
        largest: 0.0,
        motion: 0.0,
        margins: 0.0,
    };

    fn and(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            smallest: self.smallest.min(other.smallest),
            largest: self.largest.max(other.largest),
            motion: self.motion.max(other.motion),
            margins: self.margins + other.margins,
        }
    }
}

/// The spheres of one size, sorted by the cells that their centres are in.
struct Grid {
    /// The largest radius.
    largest: f64,
    /// The largest motion.
    motion: f64,
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
    fn at(&self, cell: [i64; 3]) -> impl Iterator<Item = usize> {
        let Cell { place, mark } = self.hash(cell);
        let end = |place: usize| self.ends[place].load(Relaxed) as usize;
        let start = if place == 0 { 0 } else { end(place - 1) };
        self.marked[start..end(place)]
            .iter()
            .filter_map(move |marked| {
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
                    let (radius, motion) = (bodies.radius(index), bodies.motion(index));
                    extents[size] = extents[size].and(Extent {
                        count: 1,
                        smallest: radius,
                        largest: radius,
                        motion,
                        margins: motion + bodies.thickness(index),
                    });
                }
                extents
            })
            .reduce(none, |one, other| {
                one.into_iter().zip(other).map(|(a, b)| a.and(b)).collect()
            });
        let mut grids = Vec::new();
        let mut of_size = [usize::MAX; SIZES];
        for (size, extent) in extents.into_iter().enumerate() {
            if extent.count == 0 {
                continue;
            }
            let margin = extent.margins / extent.count as f64 + extent.motion;
            let reach = reach(extent.smallest, extent.largest, slant) + margin;
            let narrowest = if grids.is_empty() { NARROWEST } else { 2.0 };
            of_size[size] = grids.len();
            grids.push(Grid {
                largest: extent.largest,
                motion: extent.motion,
                cells_a_unit: 1.0 / (REACHES * reach).max(narrowest * extent.largest),
                ends: zeros(extent.count.next_power_of_two())?,
                marked: zeros(extent.count)?,
            });
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
        })
    }

    /// The largest of what `value` gives for two spheres that may meet at a small angle, the
    /// smaller one first, and zero; `None` where too many are too close.
    pub(super) fn largest(&self, value: impl Fn(usize, usize) -> f64 + Sync) -> Option<f64> {
        let all_tests = AtomicUsize::new(0);
        (0..self.bodies.count())
            .into_par_iter()
            .with_min_len(GRAIN)
            .map(|index| {
                let mut largest = 0.0_f64;
                let mut tests = 0;
                let are_few = |tests: usize| {
                    tests <= FEW_TESTS || all_tests.load(Relaxed) + tests <= MOST_TESTS
                };
                let are_all = self.visit(index, |other| {
                    tests += 1;
                    if let Some(other) = other {
                        largest = largest.max(value(index, other));
                    }
                    are_few(tests)
                });
                if tests > FEW_TESTS {
                    all_tests.fetch_add(tests, Relaxed);
                }
                are_all.then_some(largest)
            })
            .try_reduce(|| 0.0, |one, other| Some(one.max(other)))
    }

    /// Calls `visit` for each sphere that is looked at, until that says no: with the sphere, if it
    /// is larger, or equal and of a larger index, and within reach. Says whether it never did.
    fn visit(&self, index: usize, mut visit: impl FnMut(Option<usize>) -> bool) -> bool {
        let Some(size) = self.bodies.size(index) else {
            return true;
        };
        let (center, radius) = (self.bodies.center(index), self.bodies.radius(index));
        let margin = self.bodies.motion(index) + self.bodies.thickness(index);
        for grid in &self.grids[self.of_size[size]..] {
            let reach_to = |other: f64| reach(radius, other, self.slant) + margin + grid.motion;
            let mut look_at = |other: usize| {
                let apart = center.distance_squared(self.bodies.center(other));
                let larger = self.bodies.radius(other);
                let is_near =
                    (larger, other) > (radius, index) && apart <= reach_to(larger).powi(2);
                visit(is_near.then_some(other))
            };
            let reach = DVec3::splat(reach_to(grid.largest));
            let (from, to) = (grid.cell(center - reach), grid.cell(center + reach));
            let along = |axis: usize| (to[axis] as f64 - from[axis] as f64) + 1.0;
            let goes_on = if along(0) * along(1) * along(2) > grid.marked.len() as f64 {
                let mut all = grid.marked.iter();
                all.all(|marked| look_at(marked.load(Relaxed) as u32 as usize))
            } else {
                (from[2]..=to[2]).all(|z| {
                    (from[1]..=to[1])
                        .all(|y| (from[0]..=to[0]).all(|x| grid.at([x, y, z]).all(&mut look_at)))
                })
            };
            if !goes_on {
                return false;
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;
    use crate::random::Random;

    const THICKNESS: f64 = 1e-3;

    /// Centres, radii, and how far they move.
    struct Balls(Vec<(DVec3, f64, f64)>);

    impl Bodies for Balls {
        fn count(&self) -> usize {
            self.0.len()
        }

        fn center(&self, index: usize) -> DVec3 {
            self.0[index].0
        }

        fn radius(&self, index: usize) -> f64 {
            self.0[index].1
        }

        fn motion(&self, index: usize) -> f64 {
            self.0[index].2
        }

        fn thickness(&self, _: usize) -> f64 {
            THICKNESS
        }

        fn is_speck(&self, _: usize) -> bool {
            false
        }
    }

    /// Every pair within reach is visited, the smaller one first, in worlds of one size and of
    /// many, sparse and crowded.
    #[test]
    fn all_pairs_within_reach_are_visited() {
        let mut random = Random::new(3);
        for round in 0..60 {
            let sizes = [1.0, 1.5, 30.0, 1e6][round % 4];
            let spread = random.log_within(1.0, 40.0);
            let offset = random.vec3(-1e3, 1e3).as_dvec3();
            let slant = f64::from(random.log_within(1e-4, 1.0));
            let balls = (0..400).map(|index| {
                let center = offset + random.vec3(-spread, spread).as_dvec3();
                // One flies through all others.
                let motion = if round % 3 == 0 && index == 7 {
                    1e3
                } else {
                    0.0
                };
                (center, f64::from(random.log_within(1.0, sizes)), motion)
            });
            let balls = Balls(balls.collect());
            let mut expected = Vec::new();
            for (one, (center, radius, motion)) in balls.0.iter().enumerate() {
                for (other, (there, larger, moves)) in balls.0.iter().enumerate() {
                    let within = reach(*radius, *larger, slant) + motion + moves + THICKNESS;
                    if (larger, other) > (radius, one) && center.distance(*there) < within {
                        expected.push((one, other));
                    }
                }
            }
            let visited = Mutex::new(Vec::new());
            let neighbours = Neighbours::of(&balls, slant).expect("memory");
            let largest = neighbours.largest(|one, other| {
                visited.lock().expect("no panic").push((one, other));
                (one * 400 + other) as f64
            });
            let mut visited = visited.into_inner().expect("no panic");
            visited.sort_unstable();
            visited.dedup();
            let is_missed = |pair: &&(usize, usize)| visited.binary_search(pair).is_err();
            assert_eq!(expected.iter().find(is_missed), None, "round {round}");
            let of_last = visited.iter().map(|(one, other)| one * 400 + other).max();
            assert_eq!(largest, Some(of_last.unwrap_or(0) as f64), "round {round}");
        }
    }

    #[test]
    fn too_many_in_one_place_are_too_many() {
        let balls = Balls(vec![(DVec3::ZERO, 1.0, 0.0); 40_000]);
        let neighbours = Neighbours::of(&balls, 0.1).expect("memory");
        assert_eq!(neighbours.largest(|_, _| 0.0), None);
    }

    #[test]
    fn odd_spheres_have_no_neighbours() {
        let odd = [f64::NAN, f64::INFINITY, 0.0, -1.0];
        let mut balls: Vec<_> = odd.map(|radius| (DVec3::ZERO, radius, 0.0)).into();
        balls.extend(odd[..2].iter().map(|x| (DVec3::splat(*x), 1.0, 0.0)));
        balls.push((DVec3::splat(1e300), 1e-30, 0.0));
        let neighbours = Balls(balls);
        let neighbours = Neighbours::of(&neighbours, 0.1).expect("memory");
        assert_eq!(neighbours.largest(|_, _| 1.0), Some(0.0));
    }
}
