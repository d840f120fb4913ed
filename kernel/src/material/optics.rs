//! What happens to light where two transparent media meet: Snell's law and Fresnel's. Runs on
//! the GPU and on the CPU.
//!
//! η is the refractive index on the side that the light comes from over that on the other side, cos
//! θ the cosine between the direction back and the normal. Snell's law makes the cosine on the
//! other side √κ with κ = 1 − η²(1 − cos²θ) = (1 − η)(1 + η) + (η cos θ)²; where κ < 0 all light is
//! reflected. In floats the second form is off by at most 6u of its terms, u = 2⁻²⁴. Where they
//! cancel further than that, next to the critical angle, κ is computed in pairs of floats, off by
//! 2⁻⁴² of the terms, so that the choice between the two sides is that of exact arithmetic.
//!
//! Fresnel's equations for unpolarised light are those of M. Born and E. Wolf, Principles of
//! Optics, 7th ed., § 1.5.2.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
// On the CPU, std has `f32::sqrt`.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use crate::arithmetic::DoubleSingle;

/// Light that arrives at a boundary.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Incidence {
    /// The cosine between the direction that the light comes from and the normal on that side,
    /// between 0 and 1.
    pub cosine: f32,
    /// The refractive index on that side over the index on the other.
    pub eta: f32,
}

/// What becomes of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Fresnel {
    /// The share that is reflected, between 0 and 1; the rest is transmitted.
    pub reflectance: f32,
    /// The cosine between the transmitted direction and the normal, not negative. Zero where
    /// nothing is transmitted.
    pub cosine_transmitted: f32,
}

/// Below this share of its terms, κ is not left to floats: ten times 6u.
const CRITICAL: f32 = 1.0 / (1 << 18) as f32;

impl Incidence {
    /// κ, the square of the cosine on the other side; negative in total reflection.
    #[inline]
    #[must_use]
    pub fn squared_cosine_transmitted(self) -> f32 {
        let Self { cosine, eta } = self;
        let step = (1.0 - eta) * (1.0 + eta);
        let across = eta * cosine;
        let kappa = step + across * across;
        if kappa.abs() > CRITICAL * (step.abs() + across * across) {
            return kappa;
        }
        let step = DoubleSingle::difference(1.0, eta).times(DoubleSingle::total(1.0, eta));
        let across = DoubleSingle::product(eta, cosine);
        step.plus(across.times(across)).high
    }

    /// How much is reflected, and the cosine of what is not.
    #[inline]
    #[must_use]
    pub fn fresnel(self) -> Fresnel {
        let Self { cosine, eta } = self;
        if eta == 1.0 {
            // No boundary. At grazing angles, where cos² underflows, the formulas would not see it.
            return Fresnel {
                reflectance: 0.0,
                cosine_transmitted: cosine,
            };
        }
        let kappa = self.squared_cosine_transmitted();
        if kappa < 0.0 {
            return Fresnel {
                reflectance: 1.0,
                cosine_transmitted: 0.0,
            };
        }
        let transmitted = kappa.sqrt();
        let across = eta * cosine + transmitted;
        let along = cosine + eta * transmitted;
        // Both are zero only where both cosines are, and then all light goes on along the boundary.
        let reflectance = if (across > 0.0) & (along > 0.0) {
            let s = (eta * cosine - transmitted) / across;
            let p = (cosine - eta * transmitted) / along;
            (0.5 * (s * s + p * p)).min(1.0)
        } else {
            1.0
        };
        Fresnel {
            reflectance,
            cosine_transmitted: transmitted,
        }
    }
}

impl Fresnel {
    /// The transmitted direction: `direction` is the unit vector along which the light travels,
    /// `normal` the unit normal on the side that it comes from. A unit vector up to rounding.
    #[inline]
    #[must_use]
    pub fn refract(self, incidence: Incidence, direction: Vec3, normal: Vec3) -> Vec3 {
        direction * incidence.eta
            + normal * (incidence.eta * incidence.cosine - self.cosine_transmitted)
    }
}

/// The direction mirrored at a surface with this unit normal.
#[inline]
#[must_use]
pub fn reflect(direction: Vec3, normal: Vec3) -> Vec3 {
    direction - normal * (2.0 * direction.dot(normal))
}

const _: () = {
    assert!(size_of::<Incidence>() == 8);
    assert!(size_of::<Fresnel>() == 8);
};
