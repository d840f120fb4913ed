//! [`Filter`]: how samples are spread around the middle of a pixel. Runs on the GPU and on the CPU.
//!
//! A pixel is the mean of its samples, each of equal weight, and the filter is the density of their
//! places: filter importance sampling (M. Ernst, M. Stamminger and G. Greiner, Filter Importance
//! Sampling, IEEE Symposium on Interactive Ray Tracing 2006). So a sample belongs to one pixel,
//! also where the filter is wider than that, and tiles do not depend on each other.
//!
//! Filters are separable: along each axis a place is the inverse of the cumulative distribution at
//! a uniform number. With s from −1 to 1 it is s p(w), where w = −ln(1 − s²) and p is a polynomial
//! that was fitted to it; it has this form for the normal distribution (M. Giles, Approximating the
//! erfinv function, GPU Computing Gems Jade Edition, 2012).

use bytemuck::{Pod, Zeroable};
use glam::{UVec2, Vec2};
// On the CPU, std has `f32::ln`.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// A filter.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Filter {
    /// The kind, one of the constants.
    pub kind: u32,
    /// The length, in pixels, of the interval of places along an axis.
    pub width: f32,
    /// Padding for the layout on a GPU.
    pub padding: UVec2,
}

impl Filter {
    /// The same density everywhere.
    pub const BOX: u32 = 0;
    /// A Gaussian of which the standard deviation is a sixth of the width.
    pub const GAUSSIAN: u32 = 1;
    /// The window of four terms of F. J. Harris, On the use of windows for harmonic analysis with
    /// the discrete Fourier transform, Proc. IEEE 66 (1978), with side lobes of −92 dB.
    pub const BLACKMAN_HARRIS: u32 = 2;

    /// Each kind by its name, with the width that it has by default: the pixel; a radius of 1.5
    /// pixels and a standard deviation of half a pixel, as in pbrt-v4; a radius of 1.5 pixels, as
    /// in Cycles.
    #[cfg(not(target_arch = "spirv"))]
    pub const NAMED: [(&'static str, Self); 3] = [
        ("box", Self::new(Self::BOX, 1.0)),
        ("gaussian", Self::new(Self::GAUSSIAN, 3.0)),
        ("blackman-harris", Self::new(Self::BLACKMAN_HARRIS, 3.0)),
    ];

    /// A filter of this kind and this width, in pixels.
    #[must_use]
    pub const fn new(kind: u32, width: f32) -> Self {
        Self {
            kind,
            width,
            padding: UVec2::ZERO,
        }
    }

    /// The place of a sample, in pixels from the upper left corner of its pixel, whose middle is at
    /// ½; `u` is uniform in [0, 1)².
    #[inline]
    #[must_use]
    pub fn place(&self, u: Vec2) -> Vec2 {
        Vec2::new(
            0.5 + 0.5 * self.width * self.inverse(2.0 * u.x - 1.0),
            0.5 + 0.5 * self.width * self.inverse(2.0 * u.y - 1.0),
        )
    }

    /// The place, from −1 to 1, on this side of which there is the share (1 + v) / 2 of the filter.
    /// The share that really is there is off by at most 3e-7 for the Gaussian and 2e-6 for Blackman
    /// and Harris.
    #[inline]
    fn inverse(&self, v: f32) -> f32 {
        if self.kind == Self::GAUSSIAN {
            let s = WITHIN * v;
            s * gaussian(-((1.0 - s) * (1.0 + s)).ln())
        } else if self.kind == Self::BLACKMAN_HARRIS {
            // The least of it is what a number of 24 bits leaves besides zero.
            let rest = ((1.0 - v) * (1.0 + v)).max(1.0 / (1 << 23) as f32);
            v * blackman_harris(-rest.ln())
        } else {
            v
        }
    }
}

/// A box of the pixel's own size.
impl Default for Filter {
    fn default() -> Self {
        Self::new(Self::BOX, 1.0)
    }
}

/// A polynomial of these coefficients, the constant one first, by Horner's rule.
macro_rules! horner {
    ($x:ident, $last:expr) => { $last };
    ($x:ident, $first:expr, $($others:expr),+) => { $first + $x * horner!($x, $($others),+) };
}

/// The share of a Gaussian within three standard deviations.
const WITHIN: f32 = 0.997_300_2;

/// Of √2 erfinv(s) / 3 s, for w = −ln(1 − s²) from 0 to 5.23: interpolated in Chebyshev's nodes.
#[inline]
fn gaussian(w: f32) -> f32 {
    let x = w * (2.0 / 5.23) - 1.0;
    horner!(
        x,
        0.721_114_9,
        0.302_795_26,
        -0.014_800_053,
        -0.009_725_761,
        0.004_717_091_6,
        -0.000_387_000_85,
        -0.000_434_822_7,
        0.000_143_509_33
    )
}

/// The same for the window, for w from 0 to 16: minimax, weighted by the window.
#[inline]
fn blackman_harris(w: f32) -> f32 {
    let x = w * (1.0 / 8.0) - 1.0;
    horner!(
        x,
        0.899_553_8,
        0.263_703_2,
        -0.245_084_79,
        0.120_464_35,
        0.069_533_184,
        -0.097_011_3,
        -0.200_359_54,
        0.010_319_443,
        0.249_762_98,
        0.059_462_942,
        -0.094_261_85,
        -0.036_543_638
    )
}

const _: () = assert!(size_of::<Filter>() == 16);

#[cfg(test)]
mod tests {
    use core::f64::consts::PI;

    use super::*;
    use crate::path::random::Sampler;

    /// The share of a filter below a place from −1 to 1.
    fn share_below(kind: u32, place: f64) -> f64 {
        match kind {
            Filter::GAUSSIAN => {
                // By Simpson's rule.
                const STEPS: u32 = 400;
                let half = |end: f64| {
                    let at = |step: u32| {
                        let z = 3.0 * end * f64::from(step) / f64::from(STEPS);
                        let weight = match step {
                            0 | STEPS => 1.0,
                            _ if step % 2 == 1 => 4.0,
                            _ => 2.0,
                        };
                        weight * (-0.5 * z * z).exp()
                    };
                    (0..=STEPS).map(at).sum::<f64>() * end
                };
                0.5 + 0.5 * half(place) / half(1.0)
            }
            Filter::BLACKMAN_HARRIS => {
                let terms = [(1.0, 0.48829), (2.0, 0.14128), (3.0, 0.01168)];
                let waves = terms.map(|(n, a)| a / (n * PI) * (n * PI * place).sin());
                0.5 + 0.5 * (place + waves.iter().sum::<f64>() / 0.35875)
            }
            _ => 0.5 + 0.5 * place,
        }
    }

    /// The places are the inverse of the distribution, to within what is said of them.
    #[test]
    fn places_are_those_of_the_filter() {
        for (name, filter) in Filter::NAMED {
            let off = match filter.kind {
                Filter::GAUSSIAN => 3e-7,
                Filter::BLACKMAN_HARRIS => 2e-6,
                _ => 1e-7,
            };
            let mut before = f32::MIN;
            for step in 0..1 << 16 {
                // Denser towards both ends.
                let near = (f64::from(step) / 65_536.0 * PI).cos();
                let u = ((0.5 - 0.5 * near) as f32).min(1.0 - 0.5 * f32::EPSILON);
                let place = filter.inverse(2.0 * u - 1.0);
                let share = share_below(filter.kind, f64::from(place).clamp(-1.0, 1.0));
                assert!(
                    (share - f64::from(u)).abs() < off,
                    "{name}, {u}: {place} {share}"
                );
                assert!(place.abs() < 1.000_2, "{name}, {u}: {place}");
                assert!(place >= before - 1e-6, "{name}, {u}: {place} {before}");
                before = place;
            }
        }
    }

    /// Of the places of many pixels' samples, cells of a square hold as many as the filter says:
    /// Pearson's χ².
    #[test]
    fn samples_are_distributed_as_the_filter() {
        const CELLS: usize = 12;
        const COUNT: u32 = 1 << 18;
        for (name, filter) in Filter::NAMED {
            let mut found = [[0_u32; CELLS]; CELLS];
            for pixel in 0..COUNT {
                // One sample each: those of one pixel are not independent.
                let at = UVec2::new(pixel % 512, pixel / 512);
                let place = filter.place(Sampler::new(7, at, 0).pair(0));
                let cell = |place: f32| {
                    let across = (place - 0.5) / filter.width + 0.5;
                    ((across * CELLS as f32) as usize).min(CELLS - 1)
                };
                found[cell(place.y)][cell(place.x)] += 1;
            }
            let share = |cell: usize| {
                let edge = |cell: usize| 2.0 * cell as f64 / CELLS as f64 - 1.0;
                share_below(filter.kind, edge(cell + 1)) - share_below(filter.kind, edge(cell))
            };
            let (mut sum, mut cells, mut rare) = (0.0, 0.0, (0.0, 0.0));
            let mut add = |found: f64, expected: f64| {
                sum += (found - expected).powi(2) / expected;
                cells += 1.0;
            };
            for (y, row) in found.iter().enumerate() {
                for (x, found) in row.iter().enumerate() {
                    let expected = share(x) * share(y) * f64::from(COUNT);
                    if expected < 10.0 {
                        rare = (rare.0 + f64::from(*found), rare.1 + expected);
                    } else {
                        add(f64::from(*found), expected);
                    }
                }
            }
            if rare.1 > 0.0 {
                add(rare.0, rare.1);
            }
            // Five standard deviations of χ², one degree of freedom less than cells.
            let most = (cells - 1.0) + 5.0 * (2.0 * (cells - 1.0_f64)).sqrt();
            assert!(sum < most, "{name}: χ² is {sum} for {cells} cells");
        }
    }
}
