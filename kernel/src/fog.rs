//! [`Fog`]: a ball of a homogeneous medium. Runs on the GPU and on the CPU.
//!
//! The distance s that light goes until it is scattered or absorbed has the density σ e^(−σ s).
//! Light is scattered by the phase function of L. G. Henyey and J. L. Greenstein, Diffuse radiation
//! in the galaxy, Astrophys. J. 93 (1941).

use core::f32::consts::FRAC_1_PI;

use bytemuck::{Pod, Zeroable};
use glam::{UVec2, Vec3};
// On the CPU, std has these functions.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use crate::path::sampling::{Pair, tangents, uniform_sphere};
use crate::surface::unit;

/// A ball of fog.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Fog {
    /// The centre of the ball, in scene units.
    pub center: Vec3,
    /// The radius of the ball, in scene units.
    pub radius: f32,
    /// For each channel, the share of the light that is scattered rather than absorbed.
    pub albedo: Vec3,
    /// The extinction coefficient σ: the probability per scene unit that light is scattered or
    /// absorbed.
    pub extinction: f32,
    /// g: the mean cosine of the angle by which light is scattered; 0 scatters equally in all
    /// directions.
    pub anisotropy: f32,
    /// Unused; it keeps what follows at the offset that the GPU's layout requires.
    pub padding: u32,
    /// Unused, as the field above.
    pub padding_end: UVec2,
}

impl Fog {
    /// The interval (from, to) of a ray in the fog, up to `t_max`. The direction must be a unit
    /// vector. The interval is empty if `from` is not below `to`.
    #[inline]
    #[must_use]
    pub fn span(&self, origin: Vec3, direction: Vec3, t_max: f32) -> (f32, f32) {
        let o = origin - self.center;
        let b = o.dot(direction);
        let foot = o - direction * b;
        let discriminant = self.radius * self.radius - foot.dot(foot);
        if discriminant <= 0.0 {
            return (0.0, 0.0);
        }
        let half = discriminant.sqrt();
        ((-b - half).max(0.0), (-b + half).min(t_max))
    }

    /// The share of light that passes through the fog along the ray up to `t_max`.
    #[inline]
    #[must_use]
    pub fn transmittance(&self, origin: Vec3, direction: Vec3, t_max: f32) -> f32 {
        let (from, to) = self.span(origin, direction, t_max);
        (-self.extinction * (to - from).max(0.0)).exp()
    }

    /// Samples how far light goes in the fog until it is scattered or absorbed, in scene units; `u`
    /// is uniform in [0, 1).
    #[inline]
    #[must_use]
    pub fn sample_distance(&self, u: f32) -> f32 {
        -(1.0 - u).ln() / self.extinction
    }

    /// The phase function at this cosine, per steradian. It is also the density of [`Fog::sample`].
    #[inline]
    #[must_use]
    pub fn phase(&self, cosine: f32) -> f32 {
        let g = self.anisotropy;
        let base = (1.0 + g * g - 2.0 * g * cosine).max(1e-12);
        0.25 * FRAC_1_PI * (1.0 - g * g) / (base * base.sqrt())
    }

    /// Samples the direction into which light that travels along `direction` is scattered.
    #[inline]
    #[must_use]
    pub fn sample(&self, direction: Vec3, pair: Pair) -> Vec3 {
        let g = self.anisotropy;
        if g.abs() < 1e-3 {
            return uniform_sphere(pair);
        }
        let ratio = (1.0 - g * g) / (1.0 - g + 2.0 * g * pair.u.x);
        let cosine = ((1.0 + g * g - ratio * ratio) / (2.0 * g)).clamp(-1.0, 1.0);
        let sine = (1.0 - cosine * cosine).sqrt();
        let around = pair.turn * sine;
        let (x, y) = tangents(direction);
        unit(x * around.x + y * around.y + direction * cosine)
    }
}

const _: () = assert!(size_of::<Fog>() == 48);

#[cfg(test)]
mod tests {
    use core::f32::consts::TAU;

    use super::*;

    /// The phase function integrates to one, and its mean cosine is g.
    #[test]
    fn the_phase_function_is_normalised() {
        for anisotropy in [-0.7, 0.0, 0.3, 0.9] {
            let fog = Fog {
                anisotropy,
                ..Fog::default()
            };
            const STEPS: u32 = 100_000;
            let (mut sum, mut mean) = (0.0, 0.0);
            for step in 0..STEPS {
                let cosine = 2.0 * (step as f32 + 0.5) / STEPS as f32 - 1.0;
                let part = f64::from(fog.phase(cosine)) * f64::from(TAU) * 2.0 / f64::from(STEPS);
                sum += part;
                mean += part * f64::from(cosine);
            }
            assert!((sum - 1.0).abs() < 1e-3, "{anisotropy}: {sum}");
            assert!(
                (mean - f64::from(anisotropy)).abs() < 1e-3,
                "{anisotropy}: {mean}"
            );
        }
    }
}
