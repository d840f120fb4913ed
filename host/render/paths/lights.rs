//! The lights that paths look for: a list of them by power, or a tree over many.

use std::f32::consts::PI;

use glam::{DVec3, UVec2, Vec3};
use spherule_kernel::color::luminance;
use spherule_kernel::light::sky::Sky;
use spherule_kernel::{Effects, Light, Material};

use crate::scene::{Scene, World};

/// A light in the scene, its power, and a ball around all places that it takes while the shutter is
/// open.
struct Local {
    light: Light,
    power: f64,
    center: DVec3,
    radius: f64,
}

/// The lights with their probabilities, the sky with those of its own, and the factor that makes a
/// sphere's probability out of its radiance and radius.
///
/// The sun, the environment, and all lights in the scene together share the choice evenly; among
/// the last, power decides, or in a tree what each may give.
pub(super) fn lights(
    scene: &Scene,
    world: &World,
    shutter: (f32, f32),
    shown: Effects,
) -> (Vec<Light>, Sky, f32) {
    let local = local_lights(scene, world, shutter);
    let total: f64 = local.iter().map(|local| local.power).sum();
    let (mut sky, far) = sky(scene);
    let groups = far.len() + usize::from(!local.is_empty());
    let share = 1.0 / groups.max(1) as f64;
    let mut cumulative = 0.0;
    let mut with_probability = |light: Light, probability: f64| {
        cumulative += probability;
        Light {
            probability: probability as f32,
            cumulative: cumulative as f32,
            ..light
        }
    };
    let mut lights = if groups == 0 {
        Vec::new()
    } else if shown.any(Effects::MANY_LIGHTS) {
        tree(local, share)
    } else {
        let local = local.into_iter();
        local
            .map(|local| with_probability(local.light, share * local.power / total))
            .collect()
    };
    for light in far {
        lights.push(with_probability(light, share));
        match light.kind {
            Light::SUN => sky.sun_probability = share as f32,
            _ => sky.environment_probability = share as f32,
        }
    }
    let factor = share * 4.0 * f64::from(PI * PI) / total;
    let factor = if total > 0.0 { factor as f32 } else { 0.0 };
    (lights, sky, factor)
}

/// The lights in the scene that shine: points, then spheres in the order of the world.
fn local_lights(scene: &Scene, world: &World, shutter: (f32, f32)) -> Vec<Local> {
    let mut local: Vec<Local> = Vec::new();
    for light in &scene.lights {
        let power = 4.0 * PI * luminance(light.intensity);
        local.push(Local {
            light: Light::point(light.position, light.intensity),
            power: power.into(),
            center: light.position.as_dvec3(),
            radius: 0.0,
        });
    }
    if world.materials.iter().any(|m| m.kind == Material::EMISSIVE) {
        for (index, (sphere, id)) in world.spheres.iter().zip(&world.material_ids).enumerate() {
            let material = world.materials[*id as usize];
            if material.kind == Material::EMISSIVE {
                let r = f64::from(sphere.radius());
                let power =
                    4.0 * f64::from(PI * PI) * f64::from(luminance(material.volume)) * r * r;
                let velocity = world.velocities.get(index).copied().unwrap_or(Vec3::ZERO);
                let at = |time: f32| (sphere.center() + velocity * time).as_dvec3();
                let (open, close) = (at(shutter.0), at(shutter.1));
                local.push(Local {
                    light: Light::sphere(index as u32, material.volume),
                    power,
                    center: 0.5 * (open + close),
                    radius: r.abs() + 0.5 * open.distance(close),
                });
            }
        }
    }
    local.retain(|local| local.power > 0.0);
    local
}

/// The sky, and the lights that are in it.
fn sky(scene: &Scene) -> (Sky, Vec<Light>) {
    let mut sky = Sky {
        horizon: scene.background,
        zenith: scene.background,
        ..Sky::default()
    };
    let mut far = Vec::new();
    if let Some(surroundings) = &scene.sky {
        (sky.horizon, sky.zenith) = (surroundings.horizon, surroundings.zenith);
        if let Some(sun) = surroundings.sun {
            let (height, radiance) = (sun.height(), sun.radiance());
            let color = radiance.unwrap_or(sun.irradiance);
            sky.sun_radiance = radiance.unwrap_or_default();
            (sky.sun_direction, sky.sun_height) = (sun.direction, height);
            if luminance(color) > 0.0 {
                far.push(Light::sun(sun.direction, height, color));
            }
        }
        if let Some(image) = &surroundings.image {
            sky.environment_size = UVec2::new(image.width, image.height);
            sky.environment_turn = (surroundings.rotation / 360.0).rem_euclid(1.0);
            far.push(Light::environment());
        }
    }
    (sky, far)
}

/// The [tree](spherule_kernel::light::tree) over lights, one of which is chosen with the
/// probability `share`.
fn tree(mut local: Vec<Local>, share: f64) -> Vec<Light> {
    let count = local.len();
    let mut tree = vec![Light::default(); (2 * count).max(1)];
    if count > 0 {
        fill(&mut tree, 1, &mut local);
        tree[0].cumulative = share as f32;
    }
    // Which entries are the spheres, in order of index; points come after them.
    let mut order: Vec<(u32, u32)> = (count..2 * count)
        .map(|leaf| (tree[leaf].sphere, leaf as u32))
        .collect();
    order.sort_unstable();
    for (light, (_, leaf)) in tree[count..].iter_mut().zip(order) {
        light.leaf = leaf;
    }
    tree[0].sphere = tree.len() as u32;
    tree
}

/// Fills the entries below `index`, and that itself, with these lights. Returns the power of all,
/// and the box around them.
fn fill(tree: &mut [Light], index: usize, local: &mut [Local]) -> (f64, DVec3, DVec3) {
    if let [of] = local {
        let radius = DVec3::splat(of.radius);
        tree[index] = Light {
            position: of.center.as_vec3(),
            height: of.radius as f32,
            probability: of.power as f32,
            sphere: match of.light.kind {
                Light::SPHERE => of.light.sphere,
                _ => u32::MAX,
            },
            ..of.light
        };
        return (of.power, of.center - radius, of.center + radius);
    }
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for of in &*local {
        (low, high) = (low.min(of.center), high.max(of.center));
    }
    let axis = (high - low).max_position();
    let first = count_of_first(local.len());
    local.select_nth_unstable_by(first, |a, b| a.center[axis].total_cmp(&b.center[axis]));
    let (before, after) = local.split_at_mut(first);
    let before = fill(tree, 2 * index, before);
    let after = fill(tree, 2 * index + 1, after);
    let power = before.0 + after.0;
    let (low, high) = (before.1.min(after.1), before.2.max(after.2));
    tree[index] = Light {
        kind: Light::NODE,
        position: (0.5 * (low + high)).as_vec3(),
        height: (0.5 * low.distance(high)) as f32,
        probability: power as f32,
        ..Light::default()
    };
    (power, low, high)
}

/// How many of the lights below an entry are below its first child, where the entries of a tree are
/// in rows that are full but for the last.
fn count_of_first(count: usize) -> usize {
    let row = 1 << count.ilog2();
    let (half, left) = (row / 2, count - row);
    half + left.min(half)
}

#[cfg(test)]
mod tests {
    use spherule_kernel::Sphere;
    use spherule_kernel::light::tree::{choose, probability_of};

    use super::*;
    use crate::scene::PointLight;

    /// One of them is seen; if each were a light, what they shine on would be twice as bright.
    #[test]
    fn of_equal_spheres_that_glow_one_shines() {
        let mut world = World::default();
        let glow = world.add_material(Material::emissive(Vec3::ONE));
        let grey = world.add_material(Material::diffuse(Vec3::ONE));
        let above = Vec3::new(0.0, 3.0, 0.0);
        world.add(Sphere::new(above, 0.5), glow);
        world.add(Sphere::new(Vec3::ZERO, 1.0), grey);
        world.add(Sphere::new(above, 0.5), glow);
        world.add(Sphere::new(above, 0.25), glow);
        let scene = Scene::new(world);
        let world = scene.world.without_copies().expect("copies");
        let (lights, ..) = lights(&scene, &world, (0.0, 0.0), Effects::SOFT_SHADOWS);
        assert_eq!(lights.len(), 2);
    }

    /// However many lights there are, each is found, and the probabilities of all add up to one.
    #[test]
    fn trees_hold_every_light_once() {
        for count in [0, 1, 2, 3, 5, 8, 13, 100] {
            let mut world = World::default();
            let glow = world.add_material(Material::emissive(Vec3::ONE));
            let grey = world.add_material(Material::diffuse(Vec3::ONE));
            for i in 0..count {
                let at = Vec3::new(i as f32, (7 * i % 5) as f32, (3 * i % 11) as f32);
                world.add(Sphere::new(at, 0.25), if i % 3 == 1 { grey } else { glow });
            }
            let glows = |index: usize| world.material_ids[index] == glow;
            let spheres = (0..count).filter(|index| glows(*index)).count();
            for points in [0, 1, 4] {
                let mut scene = Scene::new(world.clone());
                scene.lights = vec![
                    PointLight {
                        position: Vec3::Y * 9.0,
                        intensity: Vec3::ONE
                    };
                    points
                ];
                let (lights, ..) = lights(&scene, &world, (0.0, 0.0), Effects::MANY_LIGHTS);
                let all = spheres + points;
                assert_eq!(lights.len(), 2 * all);
                let (point, facing) = (Vec3::new(3.0, -2.0, 1.0), Vec3::Y);
                let sum: f32 = (0..count)
                    .map(|index| probability_of(&lights, index as u32, point, facing))
                    .sum();
                let of_points = (0..1000).filter(|i| {
                    let u = (*i as f32 + 0.5) / 1000.0;
                    choose(&lights, point, facing, u).kind == Light::POINT
                });
                let expected = 1.0 - of_points.count() as f32 / 1000.0;
                if all > 0 {
                    assert!((sum - expected).abs() < 0.002, "{count} {points} {sum}");
                }
                for index in 0..count {
                    let is_light = probability_of(&lights, index as u32, point, facing) > 0.0;
                    assert_eq!(is_light, glows(index), "{count} {points} {index}");
                }
            }
        }
    }
}
