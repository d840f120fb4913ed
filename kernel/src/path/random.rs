//! [`Sampler`]: the random numbers of one sample of one pixel. Runs on the GPU and on the CPU.
//!
//! Each number is a function of (seed, pixel, sample, dimension) and of nothing else: the image is
//! the same for any tiling, number of threads and order, and CPU and GPU take the same decisions.
//!
//! Samples of a pixel form an Owen-scrambled Sobol sequence in each pair of dimensions, shuffled
//! anew for each pair (B. Burley, Practical Hash-based Owen Scrambling, J. Comput. Graph. Tech. 9
//! (2020), with N. Vegdahl's constants for the hash of S. Laine and T. Karras). Their error falls
//! faster than that of independent numbers, and each is uniform by itself. How large it is cannot
//! be told from one sequence; where that is asked for, samples take turns between two that are
//! scrambled apart.

use glam::{UVec2, Vec2};

use super::sampling::Pair;
use crate::film::PathLaunch;

/// The random numbers of one sample of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    seed: u32,
    sample: u32,
}

/// The dimensions of random numbers that the camera takes, and that each vertex takes.
const OF_CAMERA: u32 = 3;
const OF_VERTEX: u32 = 8;

/// What changes the seed for the second of two groups: a number that no one takes for the
/// difference of two seeds.
const SECOND_GROUP: u32 = 0x6a09_e667;

/// The random numbers of one vertex of a path. [`VertexNumbers`] computes those that are asked for;
/// on the CPU the most frequent ones are computed ahead.
pub trait Numbers {
    /// For the direction in which the path continues.
    fn direction(&self) -> Pair;
    /// For a direction towards a light, and for the choice of a light among few.
    fn towards_light(&self) -> Pair;
    /// For Russian roulette.
    fn roulette(&self) -> f32;
    /// The numbers that are computed when they are asked for.
    fn others(&self) -> &VertexNumbers;
}

/// The random numbers of one vertex of a path. It holds a copy of the
/// sampler, because SPIR-V has no structs of pointers.
#[derive(Clone, Copy, Debug)]
pub struct VertexNumbers {
    sampler: Sampler,
    first: u32,
}

impl Numbers for VertexNumbers {
    #[inline]
    fn direction(&self) -> Pair {
        Pair::of(self.sampler.pair(self.first))
    }

    #[inline]
    fn towards_light(&self) -> Pair {
        Pair::of(self.sampler.pair(self.first.wrapping_add(1)))
    }

    #[inline]
    fn roulette(&self) -> f32 {
        self.sampler.single(self.first.wrapping_add(6))
    }

    #[inline]
    fn others(&self) -> &VertexNumbers {
        self
    }
}

impl VertexNumbers {
    /// For the choice of a light.
    #[inline]
    #[must_use]
    pub fn which_light(&self) -> f32 {
        self.sampler.single(self.first.wrapping_add(2))
    }

    /// For the choice between two lobes.
    #[inline]
    #[must_use]
    pub fn choice(&self) -> f32 {
        self.sampler.single(self.first.wrapping_add(3))
    }

    /// For the distance to the next scattering in fog.
    #[inline]
    #[must_use]
    pub fn way(&self) -> f32 {
        self.sampler.single(self.first.wrapping_add(4))
    }

    /// For a point of a lamp whose light comes by a sphere.
    #[inline]
    #[must_use]
    pub fn on_lamp(&self) -> Pair {
        Pair::of(self.sampler.pair(self.first.wrapping_add(5)))
    }

    /// For the choice of that sphere.
    #[inline]
    #[must_use]
    pub fn which_sphere(&self) -> f32 {
        self.sampler.single(self.first.wrapping_add(7))
    }
}

impl Sampler {
    /// The numbers of a vertex of the path; vertices count from zero.
    #[inline]
    #[must_use]
    pub fn at_vertex(&self, index: u32) -> VertexNumbers {
        VertexNumbers {
            sampler: *self,
            first: OF_CAMERA.wrapping_add(OF_VERTEX.wrapping_mul(index)),
        }
    }

    /// The numbers of this sample of this pixel of the whole image.
    #[inline]
    #[must_use]
    pub fn new(seed: u32, pixel: UVec2, sample: u32) -> Self {
        Self {
            seed: hash(seed ^ hash(pixel.x ^ hash(pixel.y))),
            sample,
        }
    }

    /// The numbers of this sample of this pixel. If `has_groups` is 1, samples take turns between
    /// two groups, each a sequence of its own: scrambled by another seed, so that the groups are
    /// independent and equally distributed. If it is 0, they are one sequence, as in
    /// [`Sampler::new`].
    #[inline]
    #[must_use]
    pub fn in_groups(seed: u32, has_groups: u32, pixel: UVec2, sample: u32) -> Self {
        let has_groups = has_groups & 1;
        let group = sample & has_groups;
        let seed = seed ^ group.wrapping_mul(SECOND_GROUP);
        Self::new(seed, pixel, sample >> has_groups)
    }

    /// The numbers of this sample of this pixel in a launch.
    #[inline]
    #[must_use]
    pub fn of(launch: &PathLaunch, pixel: UVec2, sample: u32) -> Self {
        Self::in_groups(launch.seed, launch.is_adaptive, pixel, sample)
    }

    /// Two numbers from 0 up to, but not including, 1, for this pair of dimensions.
    #[inline]
    #[must_use]
    pub fn pair(&self, dimension: u32) -> Vec2 {
        let seed = hash(self.seed ^ dimension.wrapping_mul(0x9e37_79b9));
        let index = scramble(self.sample.reverse_bits(), seed).reverse_bits();
        let first = scramble(index, hash(seed ^ 1));
        let second = scramble(pascal(index), hash(seed ^ 2));
        Vec2::new(
            to_unit(first.reverse_bits()),
            to_unit(second.reverse_bits()),
        )
    }

    /// One number from 0 up to, but not including, 1, for this dimension.
    #[inline]
    #[must_use]
    pub fn single(&self, dimension: u32) -> f32 {
        let seed = hash(self.seed ^ dimension.wrapping_mul(0x9e37_79b9));
        let index = scramble(self.sample.reverse_bits(), seed).reverse_bits();
        to_unit(scramble(index, hash(seed ^ 1)).reverse_bits())
    }
}

/// C. Wellons' `lowbias32`, found by search (2018).
#[inline]
fn hash(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// A random permutation in which each bit depends on those below it only: an Owen scramble of a
/// number whose bits are reversed.
#[inline]
fn scramble(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// The second dimension of Sobol's sequence with its bits reversed: the index times Pascal's
/// triangle modulo two, which is a Kronecker power and so takes five steps.
#[inline]
fn pascal(mut x: u32) -> u32 {
    x ^= (x & 0xaaaa_aaaa) >> 1;
    x ^= (x & 0xcccc_cccc) >> 2;
    x ^= (x & 0xf0f0_f0f0) >> 4;
    x ^= (x & 0xff00_ff00) >> 8;
    x ^ ((x & 0xffff_0000) >> 16)
}

/// The upper 24 bits as a number from 0 up to 1.
#[inline]
fn to_unit(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / (1 << 24) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The direction numbers of Sobol's second dimension: each the one before, xor half of it.
    #[test]
    fn pascals_triangle_is_sobols_second_dimension() {
        for index in [0_u32, 1, 2, 3, 7, 1000, 0xdead_beef] {
            let (mut sobol, mut direction) = (0, 1_u32 << 31);
            for bit in 0..32 {
                if index >> bit & 1 == 1 {
                    sobol ^= direction;
                }
                direction ^= direction >> 1;
            }
            assert_eq!(pascal(index).reverse_bits(), sobol, "{index}");
        }
    }

    /// 256 points have one in each cell of every grid of 2ⁿ × 2⁸⁻ⁿ: a (0, 8, 2)-net, which is what
    /// makes the error fall faster. (Owen scrambling keeps it; a mistake in either does not.)
    #[test]
    fn pairs_are_nets() {
        for dimension in [0, 5, 77] {
            for n in 0..=8 {
                let mut seen = [false; 256];
                for sample in 0..256 {
                    let point = Sampler::new(3, UVec2::new(17, 5), sample).pair(dimension);
                    let x = (point.x * (1 << n) as f32) as usize;
                    let y = (point.y * (1 << (8 - n)) as f32) as usize;
                    let cell = x << (8 - n) | y;
                    assert!(!seen[cell], "dimension {dimension}, {n}: two in a cell");
                    seen[cell] = true;
                }
            }
        }
    }

    /// Each of two groups is stratified in itself: 256 of its points have one in each of 256 cells.
    #[test]
    fn each_group_is_a_net() {
        for group in [0, 1] {
            let mut seen = [false; 256];
            for sample in 0..256 {
                let sampler = Sampler::in_groups(3, 1, UVec2::new(17, 5), 2 * sample + group);
                let point = sampler.pair(4);
                let cell = (point.x * 16.0) as usize * 16 + (point.y * 16.0) as usize;
                assert!(!seen[cell], "group {group}: two in a cell");
                seen[cell] = true;
            }
        }
    }

    /// Between pixels, dimensions and groups there is no correlation to speak of.
    #[test]
    fn pixels_dimensions_and_groups_are_independent() {
        const COUNT: u32 = 65_536;
        let correlation = |f: &dyn Fn(u32) -> (f32, f32)| {
            let sum: f64 = (0..COUNT)
                .map(|i| {
                    let (a, b) = f(i);
                    f64::from(a - 0.5) * f64::from(b - 0.5)
                })
                .sum();
            12.0 * sum / f64::from(COUNT)
        };
        let at =
            |x, y, sample, dimension| Sampler::new(1, UVec2::new(x, y), sample).single(dimension);
        let in_groups = |x, sample| {
            let sampler = Sampler::in_groups(1, 1, UVec2::new(x, 0), sample);
            sampler.single(0)
        };
        let pairs: [&dyn Fn(u32) -> (f32, f32); 5] = [
            &|i| (at(i, 0, 0, 0), at(i + 1, 0, 0, 0)),
            &|i| (at(i, 0, 0, 0), at(i, 1, 0, 0)),
            &|i| (at(i, 0, 0, 0), at(i, 0, 0, 1)),
            &|i| (at(i, 0, 3, 0), at(i, 0, 4, 2)),
            // The same sample of each group.
            &|i| (in_groups(i, 6), in_groups(i, 7)),
        ];
        for pair in pairs {
            // Five standard deviations of independent numbers.
            assert!(correlation(pair).abs() < 5.0 / f64::from(COUNT).sqrt());
        }
    }
}
