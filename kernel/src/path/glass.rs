//! A path at glass and in it. Runs on the GPU and on the CPU.

use glam::Vec3;
// On the CPU, std has these functions.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use super::caustic::chain::Chain;
use super::light_path::Path;
use super::media::{Media, Medium};
use super::place::Place;
use super::scenery::Scenery;
use crate::accel::traversal::Traversal;
use crate::effects::Effects;
use crate::material::Material;
use crate::material::optics::{Incidence, reflect};
use crate::surface::unit;

/// Takes a path through the surface of a glass sphere, beyond which it is in `beyond`, if a smaller
/// sphere covers the surface. Returns whether it does.
#[inline]
pub(super) fn passes_covered_glass(path: &mut Path, place: &Place, beyond: Media) -> bool {
    let passes = (beyond.0.x == path.media.0.x) && path.passes(place);
    if passes {
        path.media = beyond;
    }
    passes
}

/// A boundary of glass that a path has met.
pub(super) struct Boundary {
    pub(super) incidence: Incidence,
    /// What is beyond it, if no glass is nested.
    medium: Medium,
    /// What is beyond it, if glass may be nested.
    media: Media,
    is_in_glass: u32,
    /// Whether it is met from outside of the sphere.
    enters: bool,
}

impl Boundary {
    /// Takes a path to the other side.
    #[inline]
    pub(super) fn cross(&self, path: &mut Path) {
        path.medium = self.medium;
        path.media = self.media;
        path.is_in_glass = self.is_in_glass;
    }
}

/// The boundary at a place on glass. `media` is what is beyond it, where glass is nested.
#[inline]
pub(super) fn boundary<T: Traversal>(
    scenery: &Scenery<'_, T>,
    path: &Path,
    place: &Place,
    media: Media,
) -> Boundary {
    let cosine = place.surface.normal.dot(path.direction);
    let enters = cosine < 0.0;
    let mut medium = path.medium;
    let eta;
    if scenery.effects.any(Effects::NESTED_GLASS) {
        eta = path.media.medium(scenery).index / media.medium(scenery).index;
    } else {
        let material = &place.material;
        eta = if enters {
            1.0 / material.parameter
        } else {
            material.parameter
        };
        // Glass is inside of a sphere of glass and outside of a hollow.
        let is_glass = enters == (material.kind == Material::GLASS);
        medium.index = path.medium.index / eta;
        medium.absorption = if is_glass {
            material.volume
        } else {
            Vec3::ZERO
        };
    }
    // Of spheres that are not nested, only the outside of one of glass is outside of glass.
    let is_in_glass = enters | (place.material.kind != Material::GLASS);
    Boundary {
        incidence: Incidence {
            cosine: cosine.abs().min(1.0),
            eta,
        },
        medium,
        media,
        is_in_glass: u32::from(is_in_glass),
        enters,
    }
}

/// Reflects or refracts a path at glass, by chance: the probabilities are those of Fresnel's
/// equations. `media` is what is beyond the surface, where glass is nested.
#[inline]
pub(super) fn cross_glass<T: Traversal>(
    scenery: &Scenery<'_, T>,
    path: &mut Path,
    place: &Place,
    media: Media,
    u: f32,
) {
    let boundary = boundary(scenery, path, place, media);
    let normal = if boundary.enters {
        place.surface.normal
    } else {
        -place.surface.normal
    };
    let incidence = boundary.incidence;
    let fresnel = incidence.fresnel();
    let is_outside = !path.is_in_glass(scenery.effects);
    let direction = if u < fresnel.reflectance {
        if scenery.effects.any(Effects::CAUSTICS) {
            path.chain = Chain::LOST;
        }
        reflect(path.direction, normal)
    } else {
        if scenery.effects.any(Effects::CAUSTICS) {
            let share = 1.0 - fresnel.reflectance;
            path.chain.refract(place.sphere, is_outside, share);
        }
        boundary.cross(path);
        fresnel.refract(incidence, path.direction, normal)
    };
    path.leave(place, unit(direction), 0.0);
}

/// The share of light that is left after this distance, by Beer's law.
#[inline]
pub(super) fn absorb(absorption: Vec3, distance: f32) -> Vec3 {
    // Most glass is clear; a GPU's threads would wait for those in other glass.
    if !cfg!(target_arch = "spirv") && absorption == Vec3::ZERO {
        return Vec3::ONE;
    }
    Vec3::new(
        (-absorption.x * distance).exp(),
        (-absorption.y * distance).exp(),
        (-absorption.z * distance).exp(),
    )
}
