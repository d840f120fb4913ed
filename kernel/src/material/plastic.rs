//! Glossy plastic: a diffuse base under a coat of a clear dielectric. Runs on the GPU and on the
//! CPU.
//!
//! The coat is a rough boundary with the [`microfacet`](super::microfacet)'s distribution and
//! Schlick's reflectance. Its first bounce returns the share E(cos θ). What it does not return
//! reaches the base, is scattered there by Lambert's law, and leaves through the coat again:
//!
//! > f = f_coat + (1 − E(θ_in)) (1 − E(θ_out)) / (π (1 − Ē)) · c (1 − R) / (1 − c R)
//!
//! with c the base's reflectance, Ē the mean of E over the cosine-weighted hemisphere, and
//! R = 1 − (1 − Ē)/n² the share of diffuse light that the coat reflects back to the base from
//! inside, n the refractive index (the coupling is that of C. Kelemen and L. Szirmay-Kalos, A
//! Microfacet Based Coupled Specular-Matte BRDF Model with Importance Sampling, Eurographics 2001;
//! R follows from reciprocity). The function is reciprocal, and where c is one all light is
//! reflected, whatever the index and the roughness.
//!
//! With Schlick's reflectance F = F₀ + (1 − F₀) (1 − cos)⁵, E = F₀ (A − B) + B: A is the share that
//! a coat of reflectance one returns, B that of a reflectance of (1 − cos)⁵. [`Shares`] tells both,
//! whatever the index.
//!
//! Directions are in the frame of the surface: z is the normal's, and both directions leave.

use core::f32::consts::FRAC_1_PI;

use glam::{Vec2, Vec3};

use super::microfacet::{SMOOTHEST, Shares, mixed_density, sample_mixed, schlick, single_bounce};
use crate::surface::unit;

/// Plastic seen from a direction.
#[derive(Clone, Copy, Debug)]
pub struct Plastic {
    /// F₀.
    straight_on: f32,
    alpha: f32,
    from: Vec3,
    /// The factors of the diffuse term that do not depend on the other direction.
    base: Vec3,
    /// The chance of sampling the coat rather than the base.
    chance: f32,
}

impl Plastic {
    /// Black plastic, for vertices of other materials.
    pub(crate) const NONE: Self = Self {
        straight_on: 0.0,
        alpha: 1.0,
        from: Vec3::ZERO,
        base: Vec3::ZERO,
        chance: 0.0,
    };

    /// Plastic whose base has the reflectance `color` under a coat of this refractive index and
    /// this α, seen from `from`. [`Albedo`](super::microfacet::Albedo) makes the table.
    #[inline]
    #[must_use]
    pub fn new(color: Vec3, index: f32, alpha: f32, from: Vec3, table: &[f32]) -> Self {
        let alpha = alpha.max(SMOOTHEST);
        let ratio = (index - 1.0) / (index + 1.0);
        let straight_on = ratio * ratio;
        let coat = Shares::towards(table, from.z, alpha).of(straight_on);
        let mean = Shares::mean(table, alpha).of(straight_on);
        let back = 1.0 - (1.0 - mean) / (index * index);
        let base = color * (1.0 - back) / (Vec3::ONE - color * back).max(Vec3::splat(1e-6))
            * ((1.0 - coat) / (1.0 - mean).max(1e-6));
        let from_base = base.max_element() * (1.0 - mean);
        Self {
            straight_on,
            alpha,
            from,
            base,
            chance: coat / (coat + from_base).max(1e-6),
        }
    }

    /// The reflected light times the cosine of `to`, and the density of [`Plastic::sample`].
    #[inline]
    #[must_use]
    pub fn evaluate(&self, to: Vec3, table: &[f32]) -> (Vec3, f32) {
        if (to.z <= 0.0) | (self.from.z <= 0.0) {
            return (Vec3::ZERO, 0.0);
        }
        let half = unit(self.from + to);
        let (value, density) = single_bounce(self.from, to, self.alpha);
        let coat = schlick(Vec3::splat(self.straight_on), half.dot(to)) * value;
        let through = 1.0 - Shares::towards(table, to.z, self.alpha).of(self.straight_on);
        let base = self.base * (through * FRAC_1_PI * to.z);
        (coat + base, mixed_density(self.chance, density, to.z))
    }

    /// A direction, chosen by `u`; `choice` decides between the coat and the base. May be below
    /// the surface, where [`Plastic::evaluate`] is zero.
    #[inline]
    #[must_use]
    pub fn sample(&self, u: Vec2, choice: f32) -> Vec3 {
        sample_mixed(self.chance, self.from, self.alpha, u, choice)
    }
}

#[cfg(test)]
mod tests {
    use super::super::microfacet::Albedo;
    use super::super::microfacet::tests::{direction, integrate};
    use super::*;

    const COATS: [(f32, f32); 5] = [(1.5, 0.05), (1.5, 0.3), (1.3, 0.5), (2.4, 0.2), (1.5, 1.0)];

    /// Light takes the same way back: f(a, b) = f(b, a).
    #[test]
    fn plastic_is_reciprocal() {
        let table = Albedo::table();
        let color = Vec3::new(0.9, 0.5, 0.2);
        for (index, alpha) in COATS {
            for (a, b) in [(0.9, 0.3), (0.5, 0.6), (0.1, 0.95)] {
                let (a, b) = (direction(a, 0.3), direction(b, 2.0));
                let of = |from, to: Vec3| {
                    let plastic = Plastic::new(color, index, alpha, from, &table);
                    plastic.evaluate(to, &table).0 / to.z
                };
                let (there, back) = (of(a, b), of(b, a));
                let size = there.max_element().max(1e-6);
                assert!(
                    (there - back).abs().max_element() < 1e-4 * size,
                    "{there} {back}"
                );
            }
        }
    }

    /// Plastic with a white base reflects all light; any other base absorbs, and no more than it
    /// would without the coat.
    #[test]
    fn white_plastic_loses_nothing() {
        let table = Albedo::table();
        for (index, alpha) in &COATS[1..] {
            for cosine in [0.95, 0.6, 0.3] {
                let reflected = |color: f32| {
                    let from = direction(cosine, 0.0);
                    let plastic = Plastic::new(Vec3::splat(color), *index, *alpha, from, &table);
                    integrate(|to| f64::from(plastic.evaluate(to, &table).0.x))
                };
                let white = reflected(1.0);
                assert!(
                    (white - 1.0).abs() < 6e-3,
                    "{index} {alpha} {cosine}: {white}"
                );
                let (grey, black) = (reflected(0.5), reflected(0.0));
                assert!(black > 0.0 && black < grey && grey < white);
            }
        }
    }

    /// The density integrates to the share of samples that leave upwards; the rest went below.
    #[test]
    fn the_density_is_that_of_the_samples() {
        let table = Albedo::table();
        for (index, alpha) in &COATS[1..] {
            for cosine in [0.95, 0.4] {
                let from = direction(cosine, 0.0);
                let plastic = Plastic::new(Vec3::splat(0.5), *index, *alpha, from, &table);
                let integral = integrate(|to| f64::from(plastic.evaluate(to, &table).1));
                let mut above = 0;
                const COUNT: u32 = 20_000;
                for sample in 0..COUNT {
                    let sampler = crate::path::random::Sampler::new(5, glam::UVec2::ZERO, sample);
                    let to = plastic.sample(sampler.pair(0), sampler.single(1));
                    above += u32::from(to.z > 0.0);
                }
                let share = f64::from(above) / f64::from(COUNT);
                assert!(
                    (integral - share).abs() < 0.01,
                    "{index} {alpha} {cosine}: {integral} {share}"
                );
            }
        }
    }
}
