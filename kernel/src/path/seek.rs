//! Samples a light: a lamp chosen at random, or the surroundings of the scene. Runs on the GPU and
//! on the CPU.

use glam::Vec3;
// On the CPU, std has these functions.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use super::clear::through_glass;
use super::glass::absorb;
use super::light_path::Path;
use super::place::Place;
use super::random::Numbers;
use super::sampling::{Pair, cone, cone_density, power_heuristic};
use super::scenery::Scenery;
use super::shadow::Shadow;
use super::vertex::{LAMBERT, Vertex};
use crate::accel::traversal::Traversal;
use crate::effects::Effects;
use crate::hit::Hit;
use crate::light::{self, Light, tree};
use crate::surface::unit;

/// The ambient light that arrives at the place from `direction`, times `weight`.
#[inline]
pub(super) fn ambient_light<T: Traversal>(
    scenery: &Scenery<'_, T>,
    place: &Place,
    direction: Vec3,
    weight: Vec3,
) -> Shadow {
    let launch = scenery.launch;
    let light = if launch.has_ambient_sky == 1 {
        launch
            .sky
            .radiance(scenery.effects, direction, scenery.texels)
    } else {
        Vec3::ONE
    };
    Shadow::towards(place, direction)
        .up_to(launch.ambient_distance)
        .carrying(weight * light)
}

/// The light of one lamp, chosen at random, that the vertex scatters into the path.
#[inline]
pub(super) fn light_from_seeking<T: Traversal>(
    scenery: &Scenery<'_, T>,
    path: &Path,
    place: &Place,
    vertex: &Vertex,
    continues: bool,
    numbers: &impl Numbers,
) -> Shadow {
    let mut pair = numbers.towards_light();
    let lamp = if scenery.effects.any(Effects::MANY_LIGHTS) {
        let (point, facing) = (place.surface.point, vertex.facing);
        let u = numbers.others().which_light();
        tree::choose(scenery.lights, point, facing, u)
    } else {
        // What is left of the number is as random: samples are spread over all lamps together.
        let (lamp, left) = light::choose(scenery.lights, pair.u.x);
        pair.u.x = left;
        lamp
    };
    if scenery.effects.any(Effects::AMBIENT_OCCLUSION)
        && (vertex.lobe == LAMBERT) & (lamp.kind == Light::ENVIRONMENT)
    {
        // The ambient light already contains it.
        return Shadow::NONE;
    }
    let found = seek(scenery, &lamp, place.surface.point, path.time, pair);
    let (value, density) = vertex.evaluate(scenery, found.direction);
    let light = value * found.radiance;
    if !((found.density > 0.0) & (light.max_element() > 0.0)) {
        return Shadow::NONE;
    }
    let direction = found.direction;
    let mut shadow = Shadow::towards(place, direction);
    if scenery.effects.any(Effects::SOFT_SHADOWS) && found.is_sphere {
        (shadow.target, shadow.lamp) = (lamp.sphere, lamp.sphere);
    } else {
        shadow = shadow.up_to(found.distance);
    }
    let mut weight = 1.0;
    if continues & !found.is_delta {
        weight = power_heuristic(found.density, density);
    }
    weight *= path.outside_of_glass(scenery);
    if scenery.effects.any(Effects::CLEAR_SHADOWS) & found.is_delta {
        let share = through_glass(scenery, path, place, direction, found.distance);
        return Shadow::certain(path.throughput * (light * share * (weight / found.density)));
    }
    let (is_in_fog, is_in_glass) = (
        path.is_in_fog(scenery.effects),
        path.is_in_glass(scenery.effects),
    );
    // The CPU finds later how far away lamps are, of many rays side by side.
    if cfg!(target_arch = "spirv") || (is_in_fog | is_in_glass) {
        shadow = shadow.up_to_lamp(scenery, path.time);
    }
    if is_in_fog {
        let fog = &scenery.launch.fog;
        weight *= fog.transmittance(place.surface.point, direction, shadow.ray.t_max);
    }
    let mut light = light * (weight / found.density);
    if is_in_glass && shadow.ray.t_max < Hit::NONE_T {
        light *= absorb(path.medium(scenery).absorption, shadow.ray.t_max);
    }
    shadow.carrying(path.throughput * light)
}

/// A sample of a light, seen from a point.
struct Found {
    direction: Vec3,
    /// Radiance; of a light without extent, irradiance at the point.
    radiance: Vec3,
    /// Per solid angle; of a light without extent, the probability of choosing it.
    density: f32,
    distance: f32,
    is_delta: bool,
    is_sphere: bool,
}

/// Samples a direction towards the light.
#[inline]
fn seek<T: Traversal>(
    scenery: &Scenery<'_, T>,
    lamp: &Light,
    point: Vec3,
    time: f32,
    pair: Pair,
) -> Found {
    let (effects, launch) = (scenery.effects, scenery.launch);
    let mut found = Found {
        direction: lamp.position,
        radiance: lamp.color,
        density: lamp.probability,
        distance: Hit::NONE_T,
        is_delta: true,
        is_sphere: false,
    };
    if effects.any(Effects::SOFT_SHADOWS)
        && lamp.kind == Light::SPHERE
        && (lamp.sphere as usize) < scenery.spheres.len()
    {
        let sphere = scenery.sphere(lamp.sphere as usize, time);
        let (direction, density) = light::sample_sphere(sphere, point, pair);
        found.direction = direction;
        found.density *= density;
        found.is_delta = false;
        found.is_sphere = true;
    } else if effects.any(Effects::SOFT_SHADOWS) && lamp.kind == Light::SUN && lamp.height > 0.0 {
        found.direction = cone(lamp.position, lamp.height, pair);
        found.density *= cone_density(lamp.height);
        found.is_delta = false;
    } else if effects.any(Effects::ENVIRONMENT) && lamp.kind == Light::ENVIRONMENT {
        let (tables, texels) = (scenery.tables, scenery.texels);
        let (direction, density, radiance) = launch.sky.sample_environment(pair.u, tables, texels);
        found.direction = direction;
        found.radiance = radiance;
        found.density *= density;
        found.is_delta = false;
    } else if effects.any(Effects::HARD_SHADOWS) && lamp.kind == Light::POINT {
        let towards = lamp.position - point;
        let squared = towards.dot(towards);
        found.direction = unit(towards);
        found.distance = squared.sqrt();
        found.radiance = lamp.color / squared.max(f32::MIN_POSITIVE);
    } else if !(effects.any(Effects::HARD_SHADOWS) && lamp.kind == Light::SUN) {
        found.density = 0.0;
    }
    found
}
