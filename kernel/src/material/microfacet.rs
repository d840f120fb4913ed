//! Rough surfaces of tiny mirrors, and rough metal made of them. Runs on the GPU and on the CPU.
//!
//! The mirrors' normals follow the GGX distribution and shadow each other as E. Heitz derives for
//! Smith's model (Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs, J.
//! Comput. Graph. Tech. 3 (2014)). Normals are sampled as they are seen, by spherical caps
//! (J. Dupuy and A. Benyoub, Sampling Visible GGX Normals with Spherical Caps, HPG 2023).
//!
//! Light that meets two mirrors or more is not lost: C. Kulla and A. Conty's diffuse-like term
//! (Revisiting Physically Based Shading at Imageworks, SIGGRAPH 2017) returns what the first
//! bounce leaves, so that a white metal reflects all light, and the function stays reciprocal.
//! It uses a table of the share E that the first bounce returns: [`Shares`].
//!
//! Directions are in the frame of the surface: z is the normal's, and both directions leave.

use core::f32::consts::{FRAC_1_PI, PI};

use glam::{Vec2, Vec3};
// On the CPU, std has these functions.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use crate::arithmetic::elements::read;
use crate::arithmetic::turn::turn;
use crate::path::sampling::{Pair, cosine_density, uniform_sphere};
use crate::surface::unit;

/// Below this α a metal is a mirror: the distribution's peak would leave the range of floats.
pub const SMOOTHEST: f32 = 1e-3;

/// Entries along each side of the table of a share.
pub const ALBEDO_SIDE: usize = 32;
/// Floats of one share in the table: its values at (cos θ, α), a row for each α, followed by the
/// mean for each α.
const SHARE_LEN: usize = ALBEDO_SIDE * ALBEDO_SIDE + ALBEDO_SIDE;
/// Floats in the table, which holds both [`Shares`].
pub const ALBEDO_LEN: usize = 2 * SHARE_LEN;

/// Schlick's approximation of the reflectance of a metal whose colour at normal incidence is
/// `color`.
#[inline]
#[must_use]
pub fn schlick(color: Vec3, cosine: f32) -> Vec3 {
    let m = (1.0 - cosine).clamp(0.0, 1.0);
    let m2 = m * m;
    color + (Vec3::ONE - color) * (m2 * m2 * m)
}

/// The distribution of normals, per solid angle of them and unit of surface.
#[inline]
fn distribution(normal: Vec3, alpha: f32) -> f32 {
    // cos²(α² − 1) + 1 without cancellation.
    let sine2 = normal.x * normal.x + normal.y * normal.y;
    let across = normal.z * alpha;
    let denominator = sine2 + across * across;
    alpha * alpha / (PI * denominator * denominator)
}

/// Smith's Λ: how much of the surface hides itself towards a direction.
#[inline]
fn hidden(z: f32, alpha: f32) -> f32 {
    let z2 = z * z;
    let tangent2 = (1.0 - z2).max(0.0) / z2;
    0.5 * ((1.0 + alpha * alpha * tangent2).sqrt() - 1.0)
}

/// Reflected light of one bounce, over the metal's own reflectance: D G / (4 cos cos) times the
/// cosine of `to`, and the density of sampling `to` by [`sample_visible`].
#[inline]
#[must_use]
pub(super) fn single_bounce(from: Vec3, to: Vec3, alpha: f32) -> (f32, f32) {
    let half = unit(from + to);
    let d = distribution(half, alpha);
    let (hidden_from, hidden_to) = (hidden(from.z, alpha), hidden(to.z, alpha));
    let value = d / (4.0 * from.z * (1.0 + hidden_from + hidden_to));
    let density = d / (4.0 * from.z * (1.0 + hidden_from));
    (value, density)
}

/// Samples a normal among those that are visible from `from`.
#[inline]
#[must_use]
pub fn sample_visible(from: Vec3, alpha: f32, u: Vec2) -> Vec3 {
    let stretched = unit(Vec3::new(from.x * alpha, from.y * alpha, from.z));
    let z = (1.0 - u.y) * (1.0 + stretched.z) - stretched.z;
    let sine = (1.0 - z * z).clamp(0.0, 1.0).sqrt();
    let half = (turn(u.x) * sine).extend(z) + stretched;
    unit(Vec3::new(half.x * alpha, half.y * alpha, half.z.max(0.0)))
}

/// Samples a first bounce with this chance, or else a direction with the density cos θ / π. The
/// direction may be below the surface.
#[inline]
#[must_use]
pub(super) fn sample_mixed(chance: f32, from: Vec3, alpha: f32, u: Vec2, choice: f32) -> Vec3 {
    if choice < chance {
        let normal = sample_visible(from, alpha, u);
        normal * (2.0 * from.dot(normal)) - from
    } else {
        unit(Vec3::Z + uniform_sphere(Pair::of(u)))
    }
}

/// The density of [`sample_mixed`] in a direction of this cosine, in which a first bounce has the
/// density `first`.
#[inline]
#[must_use]
pub(super) fn mixed_density(chance: f32, first: f32, cosine: f32) -> f32 {
    chance * first + (1.0 - chance) * cosine_density(cosine)
}

/// A rough metal seen from a direction.
#[derive(Clone, Copy, Debug)]
pub struct RoughMetal {
    color: Vec3,
    alpha: f32,
    from: Vec3,
    /// E towards the viewer: also the chance of sampling the first bounce rather than the others.
    albedo: f32,
    mean: f32,
}

impl RoughMetal {
    /// Where there is no metal.
    pub(crate) const NONE: Self = Self {
        color: Vec3::ZERO,
        alpha: 1.0,
        from: Vec3::Z,
        albedo: 0.0,
        mean: 0.0,
    };

    /// The metal of this colour and this α seen along `from`; `table` is what
    /// [`Albedo::table`] makes.
    #[inline]
    #[must_use]
    pub fn new(color: Vec3, alpha: f32, from: Vec3, table: &[f32]) -> Self {
        // Smoother metals are mirrors.
        let alpha = alpha.max(SMOOTHEST);
        Self {
            color,
            alpha,
            from,
            albedo: Shares::towards(table, from.z, alpha).all,
            mean: Shares::mean(table, alpha).all,
        }
    }

    /// The reflected light times the cosine of `to`, and the density of [`RoughMetal::sample`].
    #[inline]
    #[must_use]
    pub fn evaluate(&self, to: Vec3, table: &[f32]) -> (Vec3, f32) {
        if (to.z <= 0.0) | (self.from.z <= 0.0) {
            return (Vec3::ZERO, 0.0);
        }
        let half = unit(self.from + to);
        let (value, density) = single_bounce(self.from, to, self.alpha);
        let first = schlick(self.color, half.dot(to)) * value;
        let left = (1.0 - self.albedo) * (1.0 - Shares::towards(table, to.z, self.alpha).all);
        let others = left / (1.0 - self.mean).max(1e-6) * FRAC_1_PI * to.z;
        // The mean of Schlick's curve. Light that bounces n times is coloured n times.
        let fresnel = (self.color * 20.0 + Vec3::ONE) * (1.0 / 21.0);
        let tint = fresnel * fresnel * self.mean / (Vec3::ONE - fresnel * (1.0 - self.mean));
        (
            first + tint * others,
            mixed_density(self.albedo, density, to.z),
        )
    }

    /// A direction, chosen by `u`; `choice` decides between the first bounce and the others. May be
    /// below the surface, where [`RoughMetal::evaluate`] is zero.
    #[inline]
    #[must_use]
    pub fn sample(&self, u: Vec2, choice: f32) -> Vec3 {
        sample_mixed(self.albedo, self.from, self.alpha, u, choice)
    }
}

/// The shares of light that the first bounce returns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shares {
    /// Where the reflectance is one: E of a white metal.
    pub all: f32,
    /// Where it is (1 − cos)⁵, cos between the light and the tiny mirror's normal.
    pub grazing: f32,
}

impl Shares {
    /// All light.
    const ALL: Self = Self {
        all: 1.0,
        grazing: 0.0,
    };

    /// The shares towards a direction, interpolated in the table. Without a table, all light.
    #[inline]
    #[must_use]
    pub fn towards(table: &[f32], cosine: f32, alpha: f32) -> Self {
        if table.len() < ALBEDO_LEN {
            return Self::ALL;
        }
        let last = (ALBEDO_SIDE - 1) as f32;
        let x = (cosine * last).clamp(0.0, last);
        let y = (alpha * last).clamp(0.0, last);
        Self {
            all: between(table, 0, x, y),
            grazing: between(table, SHARE_LEN, x, y),
        }
    }

    /// The means over the cosine-weighted hemisphere. Without a table, all light.
    #[inline]
    #[must_use]
    pub fn mean(table: &[f32], alpha: f32) -> Self {
        if table.len() < ALBEDO_LEN {
            return Self::ALL;
        }
        let last = (ALBEDO_SIDE - 1) as f32;
        let y = (alpha * last).clamp(0.0, last);
        Self {
            all: mean_between(table, 0, y),
            grazing: mean_between(table, SHARE_LEN, y),
        }
    }

    /// The share that a boundary returns whose reflectance at normal incidence is `straight_on`, by
    /// Schlick's curve.
    #[inline]
    #[must_use]
    pub fn of(self, straight_on: f32) -> f32 {
        straight_on * (self.all - self.grazing) + self.grazing
    }
}

/// Interpolates the share that begins at `first`; x and y count columns and rows.
#[inline]
fn between(table: &[f32], first: usize, x: f32, y: f32) -> f32 {
    let (x0, y0) = (
        (x as usize).min(ALBEDO_SIDE - 2),
        (y as usize).min(ALBEDO_SIDE - 2),
    );
    let (x1, y1) = (x - x0 as f32, y - y0 as f32);
    let at = first + y0 * ALBEDO_SIDE + x0;
    let (a, b) = (read(table, at), read(table, at + 1));
    let (c, d) = (
        read(table, at + ALBEDO_SIDE),
        read(table, at + ALBEDO_SIDE + 1),
    );
    let low = a + (b - a) * x1;
    low + (c + (d - c) * x1 - low) * y1
}

/// Interpolates the means of the share that begins at `first`; y counts rows.
#[inline]
fn mean_between(table: &[f32], first: usize, y: f32) -> f32 {
    let y0 = (y as usize).min(ALBEDO_SIDE - 2);
    let at = first + ALBEDO_SIDE * ALBEDO_SIDE + y0;
    let (a, b) = (read(table, at), read(table, at + 1));
    a + (b - a) * (y - y0 as f32)
}

/// Making the table; for the host.
#[cfg(not(target_arch = "spirv"))]
mod albedo {
    use glam::{Vec2, Vec3};

    use super::{ALBEDO_LEN, ALBEDO_SIDE, SHARE_LEN, Shares, hidden, sample_visible, schlick};

    /// Makes the table of [`Shares`].
    #[derive(Clone, Copy, Debug)]
    pub struct Albedo;

    impl Albedo {
        /// The table that [`Shares`] are read from, [`ALBEDO_LEN`] long.
        #[must_use]
        pub fn table() -> [f32; ALBEDO_LEN] {
            let mut table = [0.0; ALBEDO_LEN];
            let at = |index: usize| index as f32 / (ALBEDO_SIDE - 1) as f32;
            for row in 0..ALBEDO_SIDE {
                for column in 0..ALBEDO_SIDE {
                    let Shares { all, grazing } = Self::of(at(column), at(row));
                    table[row * ALBEDO_SIDE + column] = all;
                    table[SHARE_LEN + row * ALBEDO_SIDE + column] = grazing;
                }
            }
            let (all, grazing) = table.split_at_mut(SHARE_LEN);
            put_means(all);
            put_means(grazing);
            table
        }

        /// Both shares for one direction and one α, as means of G₂/G₁ over a grid of visible
        /// normals.
        #[must_use]
        pub fn of(cosine: f32, alpha: f32) -> Shares {
            const SIDE: u16 = 48;
            let z = cosine.clamp(1e-4, 1.0);
            let alpha = alpha.max(super::SMOOTHEST);
            let from = Vec3::new((1.0 - z * z).sqrt(), 0.0, z);
            let (mut all, mut grazing) = (0.0, 0.0);
            for i in 0..SIDE {
                for j in 0..SIDE {
                    let middle = |k: u16| (f32::from(k) + 0.5) / f32::from(SIDE);
                    let normal = sample_visible(from, alpha, Vec2::new(middle(i), middle(j)));
                    let to = normal * (2.0 * from.dot(normal)) - from;
                    if to.z > 0.0 {
                        let (a, b) = (hidden(from.z, alpha), hidden(to.z, alpha));
                        let share = f64::from((1.0 + a) / (1.0 + a + b));
                        all += share;
                        grazing += share * f64::from(schlick(Vec3::ZERO, normal.dot(to)).x);
                    }
                }
            }
            let samples = f64::from(SIDE).powi(2);
            Shares {
                all: (all / samples) as f32,
                grazing: (grazing / samples) as f32,
            }
        }
    }

    /// Puts the mean of each row behind the rows: ∫ 2 E(μ) μ dμ, exact for the straight lines
    /// between the entries.
    fn put_means(share: &mut [f32]) {
        let step = 1.0 / (ALBEDO_SIDE - 1) as f64;
        for row in 0..ALBEDO_SIDE {
            let mean: f64 = (0..ALBEDO_SIDE - 1)
                .map(|column| {
                    let (low, high) = (
                        f64::from(share[row * ALBEDO_SIDE + column]),
                        f64::from(share[row * ALBEDO_SIDE + column + 1]),
                    );
                    let x = column as f64 * step;
                    2.0 * step * (low * (x / 2.0 + step / 6.0) + high * (x / 2.0 + step / 3.0))
                })
                .sum();
            share[ALBEDO_SIDE * ALBEDO_SIDE + row] = mean as f32;
        }
    }
}

#[cfg(not(target_arch = "spirv"))]
pub use albedo::Albedo;

#[cfg(test)]
pub(super) mod tests {
    use core::f32::consts::TAU;

    use super::*;

    const ALPHAS: [f32; 4] = [0.05, 0.2, 0.5, 1.0];

    pub fn direction(cosine: f32, angle: f32) -> Vec3 {
        let sine = (1.0 - cosine * cosine).sqrt();
        Vec3::new(sine * angle.cos(), sine * angle.sin(), cosine)
    }

    /// The integral over the upper hemisphere, on a grid that is fine where a lobe may be.
    pub fn integrate(f: impl Fn(Vec3) -> f64) -> f64 {
        const ROWS: u32 = 600;
        const COLUMNS: u32 = 600;
        let mut sum = 0.0;
        for row in 0..ROWS {
            for column in 0..COLUMNS {
                let cosine = (row as f32 + 0.5) / ROWS as f32;
                let angle = TAU * (column as f32 + 0.5) / COLUMNS as f32;
                sum += f(direction(cosine, angle));
            }
        }
        sum * f64::from(TAU) / f64::from(ROWS * COLUMNS)
    }

    /// Light takes the same way back: f(a, b) = f(b, a).
    #[test]
    fn rough_metal_is_reciprocal() {
        let table = Albedo::table();
        let color = Vec3::new(0.9, 0.5, 0.2);
        for alpha in ALPHAS {
            for (a, b) in [(0.9, 0.3), (0.5, 0.6), (0.1, 0.95)] {
                let (a, b) = (direction(a, 0.3), direction(b, 2.0));
                let there = RoughMetal::new(color, alpha, a, &table)
                    .evaluate(b, &table)
                    .0
                    / b.z;
                let back = RoughMetal::new(color, alpha, b, &table)
                    .evaluate(a, &table)
                    .0
                    / a.z;
                let size = there.max_element().max(1e-6);
                assert!(
                    (there - back).abs().max_element() < 1e-4 * size,
                    "{there} {back}"
                );
            }
        }
    }

    /// The density integrates to the share of samples that leave upwards; the rest went below.
    #[test]
    fn the_density_is_that_of_the_samples() {
        let table = Albedo::table();
        for alpha in &ALPHAS[1..] {
            for cosine in [0.95, 0.4] {
                let metal = RoughMetal::new(Vec3::ONE, *alpha, direction(cosine, 0.0), &table);
                let integral = integrate(|to| f64::from(metal.evaluate(to, &table).1));
                let mut above = 0;
                const COUNT: u32 = 20_000;
                for sample in 0..COUNT {
                    let sampler = crate::path::random::Sampler::new(5, glam::UVec2::ZERO, sample);
                    let to = metal.sample(sampler.pair(0), sampler.single(1));
                    above += u32::from(to.z > 0.0);
                }
                let share = f64::from(above) / f64::from(COUNT);
                assert!(
                    (integral - share).abs() < 0.01,
                    "{alpha} {cosine}: {integral} {share}"
                );
            }
        }
    }

    /// White metal reflects all light, by quadrature.
    #[test]
    fn white_metal_loses_nothing() {
        let table = Albedo::table();
        for alpha in &ALPHAS[1..] {
            for cosine in [0.95, 0.6, 0.3] {
                let metal = RoughMetal::new(Vec3::ONE, *alpha, direction(cosine, 0.0), &table);
                let reflected = integrate(|to| f64::from(metal.evaluate(to, &table).0.x));
                assert!(
                    (reflected - 1.0).abs() < 6e-3,
                    "{alpha} {cosine}: {reflected}"
                );
            }
        }
    }
}
