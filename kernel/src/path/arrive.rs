//! Light that a path meets by chance. Runs on the GPU and on the CPU.

use glam::Vec3;

use super::light_path::Path;
use super::sampling::power_heuristic;
use super::scenery::Scenery;
use crate::accel::traversal::Traversal;
use crate::color::luminance;
use crate::effects::Effects;
use crate::light;
use crate::sphere::Sphere;

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
    let mut light = sky.radiance(effects, path.direction, scenery.tables) * weight;
    if effects.any(Effects::SUN) && sky.is_sun(path.direction) {
        let mut weight = 1.0;
        if effects.any(Effects::SOFT_SHADOWS) && path.density > 0.0 {
            let other = sky.sun_probability / light::solid_angle(sky.sun_height);
            weight = power_heuristic(path.density, other);
        }
        light += sky.sun_radiance * weight;
    }
    path.radiance += path.throughput * light * path.outside_of_glass(scenery);
}

/// Adds the light of an emissive sphere, for a path that meets one.
#[inline]
pub(super) fn arrive_at_lamp<T: Traversal>(
    scenery: &Scenery<'_, T>,
    path: &mut Path,
    sphere: Sphere,
    radiance: Vec3,
) {
    let mut weight = 1.0;
    if scenery.effects.any(Effects::SOFT_SHADOWS) && path.density > 0.0 {
        let power = luminance(radiance) * sphere.radius() * sphere.radius();
        let chosen = power * scenery.launch.sphere_light_probability;
        let other = chosen * light::sphere_density(sphere, path.origin);
        weight = power_heuristic(path.density, other);
    }
    path.radiance += path.throughput * radiance * (weight * path.outside_of_glass(scenery));
}
