//! A path at glass and in it. Runs on the GPU and on the CPU.

use glam::Vec3;
// On the CPU, std has these functions.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use super::light_path::Path;
use crate::material::Material;
use crate::material::optics::{Incidence, reflect};
use crate::surface::{Surface, unit};

/// Reflects or refracts a path at glass, by chance: the probabilities are those of Fresnel's
/// equations.
#[inline]
pub(super) fn cross_glass(path: &mut Path, surface: &Surface, material: &Material, u: f32) {
    let cosine = surface.normal.dot(path.direction);
    let enters = cosine < 0.0;
    let (normal, eta) = if enters {
        (surface.normal, 1.0 / material.parameter)
    } else {
        (-surface.normal, material.parameter)
    };
    let incidence = Incidence {
        cosine: cosine.abs().min(1.0),
        eta,
    };
    let fresnel = incidence.fresnel();
    let direction = if u < fresnel.reflectance {
        reflect(path.direction, normal)
    } else {
        // The glass, which absorbs, is inside of a sphere of glass and outside of a hollow.
        path.absorption = if enters == (material.kind == Material::GLASS) {
            material.volume
        } else {
            Vec3::ZERO
        };
        fresnel.refract(incidence, path.direction, normal)
    };
    path.leave(surface, unit(direction), 0.0);
}

/// The share of light that is left after this distance, by Beer's law.
#[inline]
pub(super) fn absorb(absorption: Vec3, distance: f32) -> Vec3 {
    Vec3::new(
        (-absorption.x * distance).exp(),
        (-absorption.y * distance).exp(),
        (-absorption.z * distance).exp(),
    )
}
