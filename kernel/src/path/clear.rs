//! Shadows that glass casts on request: light that is sampled passes through glass without
//! bending. Runs on the GPU and on the CPU.
//!
//! A light without extent is met by no path, so behind glass it gives no light. Where a scene asks
//! for it, the ray towards such a light goes straight on through glass instead, with what Beer's
//! law and Fresnel's equations leave of the light. That is biased: caustics are missing, and
//! shadows lie where refracted light would not.

use glam::Vec3;

use super::glass::{absorb, boundary, passes_covered_glass};
use super::light_path::Path;
use super::place::Place;
use super::scenery::Scenery;
use crate::accel::traversal::Traversal;
use crate::effects::Effects;
use crate::hit::Hit;
use crate::material::Material;

/// The most surfaces that a ray passes: beyond, nothing is left of the light.
const MOST_SURFACES: u32 = 1 << 10;

/// The share of light that arrives at a place from `direction`, from so far away, through all the
/// glass in the way; zero if anything else is in the way.
///
/// Fog counts along what of the way it fills.
///
/// On the CPU it stands by itself, so that paths that do not call for it are none the slower.
#[cfg_attr(target_arch = "spirv", inline)]
#[cfg_attr(not(target_arch = "spirv"), inline(never))]
pub(super) fn through_glass<T: Traversal>(
    scenery: &Scenery<'_, T>,
    path: &Path,
    place: &Place,
    direction: Vec3,
    distance: f32,
) -> Vec3 {
    let mut shadow = *path;
    shadow.throughput = Vec3::ONE;
    shadow.leave(place, direction, 0.0);
    // Surfaces that smaller glass covers are counted here, and not as those of the path.
    shadow.events = 0;
    let mut left = distance;
    let mut surfaces = 0;
    while surfaces < MOST_SURFACES {
        let ray = shadow.ray_up_to(left);
        let hit = shadow.or_exit(scenery.nearest_hit(&ray, shadow.left, shadow.time));
        let arrives = !hit.is_some() | (hit.t >= left);
        let way = if arrives { left } else { hit.t };
        travel(scenery, &mut shadow, way);
        if arrives {
            return shadow.throughput;
        }
        left -= hit.t;
        let met = scenery.place(&ray, hit, shadow.time);
        if !pass(scenery, &mut shadow, &met) {
            return Vec3::ZERO;
        }
        surfaces += 1;
    }
    Vec3::ZERO
}

/// Takes from the light what the medium does along the next part of the way.
#[inline]
fn travel<T: Traversal>(scenery: &Scenery<'_, T>, shadow: &mut Path, way: f32) {
    if shadow.is_in_fog(scenery.effects) {
        let fog = &scenery.launch.fog;
        shadow.throughput *= fog.transmittance(shadow.origin, shadow.direction, way);
    }
    let absorption = shadow.medium(scenery).absorption;
    // Without an end, nothing absorbs but what rounding left the ray in.
    if way < Hit::NONE_T {
        shadow.throughput *= absorb(absorption, way);
    }
}

/// Takes the light straight through a surface, and returns whether it is one of glass.
///
/// Fresnel's equations are asked for the angle on the side of the lower index, on whichever side
/// the light comes from. Refracted light leaves a sphere under the angle under which it has entered
/// it, and so both surfaces reflect the same share of it.
#[inline]
fn pass<T: Traversal>(scenery: &Scenery<'_, T>, shadow: &mut Path, met: &Place) -> bool {
    let kind = met.material.kind;
    if !((kind == Material::GLASS) | (kind == Material::BUBBLE)) {
        return false;
    }
    let mut media = shadow.media;
    if scenery.effects.any(Effects::NESTED_GLASS) {
        media = shadow.media_beyond(scenery, met);
        if passes_covered_glass(shadow, met, media) {
            return true;
        }
    }
    let mut boundary = boundary(scenery, shadow, met, media);
    if boundary.incidence.eta > 1.0 {
        boundary.incidence.eta = 1.0 / boundary.incidence.eta;
    }
    shadow.throughput *= 1.0 - boundary.incidence.fresnel().reflectance;
    boundary.cross(shadow);
    let direction = shadow.direction;
    shadow.leave(met, direction, 0.0);
    true
}
