//! Samples a light: a lamp chosen at random, or the surroundings of the scene. Runs on the GPU and
//! on the CPU.

use glam::{Vec2, Vec3};
// On the CPU, std has these functions.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use super::glass::absorb;
use super::light_path::Path;
use super::random::VertexNumbers;
use super::sampling::{cone, cone_density, power_heuristic};
use super::scenery::Scenery;
use super::vertex::{LAMBERT, Vertex};
use crate::accel::traversal::Traversal;
use crate::effects::Effects;
use crate::hit::Hit;
use crate::light::{self, Light};
use crate::precision::intersect;
use crate::surface::{Surface, unit};

/// The ambient light that arrives at the surface from `direction`.
#[inline]
pub(super) fn ambient_light<T: Traversal>(
    scenery: &Scenery<'_, T>,
    time: f32,
    surface: &Surface,
    direction: Vec3,
) -> Vec3 {
    let (effects, launch) = (scenery.effects, scenery.launch);
    let mut ray = surface.leave(direction);
    ray.t_max = launch.ambient_distance;
    if scenery.is_occluded(&ray, time) {
        Vec3::ZERO
    } else if launch.has_ambient_sky == 1 {
        launch.sky.radiance(effects, direction, scenery.tables)
    } else {
        Vec3::ONE
    }
}

/// The light of one lamp, chosen at random, that the vertex scatters into the path.
#[inline]
pub(super) fn light_from_seeking<T: Traversal>(
    scenery: &Scenery<'_, T>,
    path: &Path,
    surface: &Surface,
    vertex: &Vertex,
    continues: bool,
    numbers: &VertexNumbers,
) -> Vec3 {
    let lamp = light::choose(scenery.lights, numbers.which_light());
    if scenery.effects.any(Effects::AMBIENT_OCCLUSION)
        && (vertex.lobe == LAMBERT) & (lamp.kind == Light::ENVIRONMENT)
    {
        // The ambient light already contains it.
        return Vec3::ZERO;
    }
    let found = seek(
        scenery,
        &lamp,
        surface.point,
        path.time,
        numbers.towards_light(),
    );
    let (value, density) = vertex.evaluate(scenery, found.direction);
    let light = value * found.radiance;
    if !((found.density > 0.0) & (light.max_element() > 0.0)) {
        return Vec3::ZERO;
    }
    let mut shadow = surface.leave(found.direction);
    shadow.t_max = found.distance;
    if scenery.effects.any(Effects::SOFT_SHADOWS) && found.is_sphere {
        // Up to where the sphere itself begins: the interval is half-open.
        let lamp = scenery.sphere(lamp.sphere as usize, path.time);
        shadow.t_max = intersect(scenery.rung, lamp, &shadow);
        if shadow.t_max >= Hit::NONE_T {
            return Vec3::ZERO;
        }
    }
    if scenery.is_occluded(&shadow, path.time) {
        return Vec3::ZERO;
    }
    let mut weight = 1.0;
    if continues & !found.is_delta {
        weight = power_heuristic(found.density, density);
    }
    if scenery.effects.any(Effects::FOG) {
        let fog = &scenery.launch.fog;
        weight *= fog.transmittance(shadow.origin, shadow.direction, shadow.t_max);
    }
    let mut light = light * (weight / found.density);
    if scenery.effects.any(Effects::GLASS) && shadow.t_max < Hit::NONE_T {
        light *= absorb(path.absorption, shadow.t_max);
    }
    light
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
    u: Vec2,
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
        let (direction, density) = light::sample_sphere(sphere, point, u);
        found.direction = direction;
        found.density *= density;
        found.is_delta = false;
        found.is_sphere = true;
    } else if effects.any(Effects::SOFT_SHADOWS) && lamp.kind == Light::SUN && lamp.height > 0.0 {
        found.direction = cone(lamp.position, lamp.height, u);
        found.density *= cone_density(lamp.height);
        found.is_delta = false;
    } else if effects.any(Effects::ENVIRONMENT) && lamp.kind == Light::ENVIRONMENT {
        let (direction, density, radiance) = launch.sky.sample_environment(u, scenery.tables);
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
