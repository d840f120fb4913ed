//! Light that a path meets by chance. Runs on the GPU and on the CPU.

use glam::Vec3;

use super::caustic::weight::{weight_at_lamp, weight_at_sun};
use super::light_path::Path;
use super::place::Place;
use super::sampling::power_heuristic;
use super::scenery::Scenery;
use crate::accel::traversal::Traversal;
use crate::color::luminance;
use crate::effects::Effects;
use crate::light::{self, tree};

/// Adds the light of the sky, for a path that meets nothing.
#[inline]
pub(super) fn arrive_at_sky<T: Traversal>(scenery: &Scenery<'_, T>, path: &mut Path) {
    let (effects, sky) = (scenery.effects, &scenery.launch.sky);
    if effects.any(Effects::TRANSPARENT_BACKGROUND) && path.bounces() == 0 {
        path.alpha = 0.0;
        return;
    }
    let mut weight = 1.0;
    if effects.any(Effects::ENVIRONMENT) && path.density > 0.0 {
        let other =
            sky.environment_probability * sky.environment_density(path.direction, scenery.tables);
        weight = power_heuristic(path.density, other);
    }
    let mut light = sky.radiance(effects, path.direction, scenery.texels) * weight;
    if effects.any(Effects::SUN) && sky.is_sun(path.direction) {
        let mut weight = 1.0;
        if effects.any(Effects::SOFT_SHADOWS) && path.density > 0.0 {
            let other = sky.sun_probability / light::solid_angle(sky.sun_height);
            weight = power_heuristic(path.density, other);
        }
        if effects.any(Effects::CAUSTICS) {
            weight *= weight_at_sun(scenery, path);
        }
        light += sky.sun_radiance * weight;
    }
    let light = path.throughput * light * path.outside_of_glass(scenery);
    path.receive(effects, light, path.bounces());
}

/// Adds the light of the emissive sphere that a path meets at `place`.
#[inline]
pub(super) fn arrive_at_lamp<T: Traversal>(
    scenery: &Scenery<'_, T>,
    path: &mut Path,
    place: &Place,
    radiance: Vec3,
) {
    let effects = scenery.effects;
    let mut weight = 1.0;
    // Other shapes are not looked for: paths find them by chance.
    let is_sphere = !scenery.shapes.have(place.sphere);
    let sphere = scenery.sphere(place.sphere as usize, path.time);
    let power = luminance(radiance) * sphere.radius() * sphere.radius();
    let by_power = power * scenery.launch.sphere_light_probability;
    if is_sphere && effects.any(Effects::SOFT_SHADOWS) && path.density > 0.0 {
        let chosen = if effects.any(Effects::MANY_LIGHTS) {
            let (point, facing) = (path.origin, path.facing);
            tree::probability_of(scenery.lights, place.sphere, point, facing)
        } else {
            by_power
        };
        let other = chosen * light::sphere_density(sphere, path.origin);
        weight = power_heuristic(path.density, other);
    }
    if is_sphere && effects.any(Effects::CAUSTICS) {
        weight *= weight_at_lamp(scenery, path, sphere, &place.surface, by_power);
    }
    let light = path.throughput * radiance * (weight * path.outside_of_glass(scenery));
    path.receive(effects, light, path.bounces());
}
