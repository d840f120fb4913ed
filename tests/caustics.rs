//! Light by one sphere, found exactly, against light that is found by chance and against closed
//! forms, on the CPU and on every GPU adapter.

mod common;

use common::devices;
use glam::Vec3;
use spherule::kernel::color::luminance;
use spherule::kernel::{Effects, Material, Sphere};
use spherule::render::{QUIET, Settings, render};
use spherule::scene::surroundings::{PointLight, Sun, Surroundings};
use spherule::scene::{FogBall, View, World};
use spherule::{Device, Scene};
use std::f64::consts::PI;

/// Luminances of the pixels of an image.
fn luminances(scene: &Scene, device: &Device) -> Vec<f64> {
    let rendered = render(scene, Settings::default(), device, QUIET).expect("the scene renders");
    let pixels = rendered.image.pixels().iter();
    pixels
        .map(|pixel| f64::from(luminance(pixel.color())))
        .collect()
}

/// The mean luminance over images of several seeds, and its standard error.
fn mean(scene: &Scene, device: &Device) -> (f64, f64) {
    const SEEDS: u32 = 8;
    let mut scene = scene.clone();
    let means: Vec<f64> = (0..SEEDS)
        .map(|seed| {
            scene.sampling.seed = 100 * u32::from(scene.sampling.caustics) + seed;
            let values = luminances(&scene, device);
            values.iter().sum::<f64>() / values.len() as f64
        })
        .collect();
    let count = f64::from(SEEDS);
    let mean = means.iter().sum::<f64>() / count;
    let variance = means.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}

/// The ground, which is 1.5 below the origin; its material is the first.
fn ground(material: Material) -> World {
    let mut world = World::default();
    let id = world.add_material(material);
    world.add(Sphere::new(Vec3::Y * -101.5, 100.0), id);
    world
}

/// Looks from the side at the ground about `target`, in a dark scene.
fn seen(world: World, target: Vec3, fov: f64) -> Scene {
    let mut scene = Scene::new(world);
    (scene.width, scene.height) = (16, 16);
    scene.background = Vec3::ZERO;
    scene.sampling.samples = Some(256);
    scene.sampling.max_bounces = 4;
    scene.view = Some(View {
        eye: target + Vec3::new(3.0, 2.0, 2.0),
        target,
        up: Vec3::Y,
        vertical_fov: fov,
    });
    scene
}

/// The ground under a lamp of this radius and these spheres.
fn lit(material: Material, radius: f32, spheres: &[(Sphere, Material)]) -> Scene {
    let mut world = ground(material);
    let glow = world.add_material(Material::emissive(Vec3::splat(9.0) / (radius * radius)));
    world.add(Sphere::new(Vec3::new(0.5, 4.0, 0.2), radius), glow);
    for (sphere, material) in spheres {
        let id = world.add_material(*material);
        world.add(*sphere, id);
    }
    seen(world, Vec3::new(-0.2, -1.5, 0.0), 24.0)
}

/// A name, the material of the ground, and the spheres above it.
type Case<'a> = (&'static str, Material, &'a [(Sphere, Material)]);

const GREY: Material = Material::diffuse(Vec3::splat(0.8));
const CLEAR: Material = Material::glass(1.5, Vec3::ZERO);
const BALL: Sphere = Sphere::new(Vec3::ZERO, 1.0);

/// Asserts that an image is as bright with caustics as it is without, on each device. By chance it
/// is found on the CPU, with as many times the samples.
fn assert_same(name: &str, scene: &Scene, times: u32) {
    let mut by_chance = scene.clone();
    let samples = scene.sampling.samples.expect("a number") * times;
    by_chance.sampling.samples = Some(samples);
    let expected = mean(&by_chance, &Device::Cpu);
    let mut scene = scene.clone();
    scene.sampling.caustics = true;
    assert!(scene.effects().any(Effects::CAUSTICS), "{name}");
    for (device_name, device) in devices() {
        let found = mean(&scene, device);
        println!("{name} on {device_name}: {found:?}, by chance {expected:?}");
        let error = found.1.hypot(expected.1);
        assert!(error < 0.02 * expected.0, "{name}: too noisy to tell");
        assert!(
            (found.0 - expected.0).abs() < 4.0 * error + 5e-4 * expected.0,
            "{name} on {device_name}"
        );
    }
}

#[test]
fn glass_and_mirrors_throw_as_much_light_as_by_chance() {
    let hollow = Sphere::new(Vec3::ZERO, 0.8);
    let green = Vec3::new(0.9, 0.2, 0.6);
    let silver = Material::metal(Vec3::new(0.9, 0.7, 0.5), 0.0);
    let cases: [Case<'_>; 7] = [
        ("solid", GREY, &[(BALL, CLEAR)]),
        ("green", GREY, &[(BALL, Material::glass(1.5, green))]),
        (
            "hollow",
            GREY,
            &[
                (BALL, Material::glass(1.5, green)),
                (hollow, Material::bubble(1.5, green)),
            ],
        ),
        (
            "thick",
            GREY,
            &[
                (BALL, Material::glass(1.4, green)),
                (Sphere::new(Vec3::ZERO, 0.3), Material::bubble(1.4, green)),
            ],
        ),
        (
            "mirror",
            GREY,
            &[(Sphere::new(Vec3::new(-1.5, -0.5, 0.0), 1.0), silver)],
        ),
        (
            "plastic",
            Material::plastic(Vec3::splat(0.8), 0.4, 1.5),
            &[(BALL, CLEAR)],
        ),
        (
            "rough metal",
            Material::metal(Vec3::splat(0.8), 0.7),
            &[(BALL, CLEAR)],
        ),
    ];
    for (name, material, spheres) in cases {
        assert_same(name, &lit(material, 0.6, spheres), 4);
    }
}

/// Several spheres share the choice; some of them are in each other's way, one has an opaque ball
/// in it, and two that overlap are left to chance.
#[test]
fn many_spheres_throw_as_much_light_as_by_chance() {
    let small = |x: f32, y: f32, z: f32| Sphere::new(Vec3::new(x, y, z), 0.5);
    let silver = Material::metal(Vec3::splat(0.9), 0.0);
    let spheres = [
        (small(0.0, 0.0, 0.0), CLEAR),
        (small(-0.9, -0.8, 0.3), silver),
        (small(0.4, -0.9, 0.7), Material::glass(2.0, Vec3::ZERO)),
        (Sphere::new(Vec3::new(0.4, -0.9, 0.7), 0.2), GREY),
        (small(-0.3, -0.9, -0.8), CLEAR),
        (small(-0.5, -0.7, -1.0), CLEAR),
        (Sphere::new(Vec3::new(0.1, 0.9, 0.3), 0.3), silver),
    ];
    let mut scene = lit(GREY, 0.6, &spheres);
    assert_same("many", &scene, 8);
    for max_bounces in [1, 2, 3] {
        scene.sampling.max_bounces = max_bounces;
        assert_same(&format!("{max_bounces} bounces"), &scene, 8);
    }
}

#[test]
fn suns_and_fog_throw_as_much_light_as_by_chance() {
    let mut scene = seen(ground(GREY), Vec3::new(0.4, -1.5, 0.1), 24.0);
    let clear = scene.world.add_material(CLEAR);
    scene.world.add(BALL, clear);
    scene.sky = Some(Surroundings {
        horizon: Vec3::ZERO,
        zenith: Vec3::ZERO,
        sun: Some(Sun {
            direction: Vec3::new(-0.3, 1.0, 0.1).normalize(),
            size: 12.0,
            irradiance: Vec3::splat(3.0),
        }),
        rotation: 0.0,
        image: None,
    });
    assert_same("sun", &scene, 4);
    let mut scene = lit(GREY, 0.6, &[(BALL, CLEAR)]);
    let mut medium = spherule::kernel::fog::Fog {
        albedo: Vec3::splat(0.8),
        extinction: 0.15,
        anisotropy: 0.3,
        ..Default::default()
    };
    medium.radius = 8.0;
    scene.fog = Some(FogBall { medium });
    assert_same("fog", &scene, 8);
}

/// Walls are seen from inside, where rays cross the room.
#[test]
fn a_room_is_as_bright_as_by_chance() {
    let ball = Sphere::new(Vec3::Y * -0.5, 0.5);
    let mut scene = lit(GREY, 0.6, &[(ball, CLEAR)]);
    // The ground becomes a room.
    scene.world.spheres[0] = Sphere::new(Vec3::Y * 3.5, 5.0);
    assert_same("a room", &scene, 4);
}

/// The irradiance on the axis is that of a thin lens whose focal length is nr / 2(n − 1) and whose
/// planes are at the centre (M. Born and E. Wolf, Principles of Optics, § 4.4): rays that spread by
/// a solid angle dΩ pass through dy² dΩ of it, and dx beyond have spread by (1 − dx (1/f − 1/dy))².
#[test]
fn a_point_behind_a_ball_gives_the_closed_form() {
    for (index, height) in [(1.5_f64, 3.0_f64), (1.5, 8.0), (2.0, 6.0), (1.0, 3.0)] {
        for absorption in [0.0, 0.5_f32] {
            let mut world = ground(Material::diffuse(Vec3::ONE));
            let glass = Material::glass(index as f32, Vec3::splat(absorption));
            let id = world.add_material(glass);
            world.add(Sphere::new(Vec3::ZERO, 0.5), id);
            let mut scene = seen(world, Vec3::Y * -1.5, 0.05);
            scene.lights.push(PointLight {
                position: Vec3::Y * height as f32,
                intensity: Vec3::splat(10.0),
            });
            scene.sampling.max_bounces = 2;
            let (below, radius) = (1.5, 0.5);
            let power = 2.0 * (index - 1.0) / (index * radius);
            let width = height * below * (power - 1.0 / below - 1.0 / height);
            let reflected = ((index - 1.0) / (index + 1.0)).powi(2);
            let through = (1.0 - reflected).powi(2) * (-2.0 * radius * f64::from(absorption)).exp();
            let expected = 10.0 / PI * through / (width * width);
            for (name, device) in devices() {
                // Some light comes from the ground by the ball, by chance.
                scene.sampling.caustics = false;
                let (other, _) = mean(&scene, device);
                scene.sampling.caustics = true;
                let (found, error) = mean(&scene, device);
                let found = found - other;
                println!("{index} {absorption} on {name}: {found} ± {error}, expected {expected}");
                assert!((found / expected - 1.0).abs() < 2e-3, "{index} on {name}");
            }
        }
    }
}

/// With a small lamp, the variance of a sample falls.
#[test]
fn small_lamps_are_less_noisy() {
    let silver = Material::metal(Vec3::splat(0.9), 0.0);
    let beside = Sphere::new(Vec3::new(-1.5, -0.5, 0.0), 1.0);
    // By chance a mirror shows a lamp as small as the first too seldom for its variance to be seen.
    let cases = [
        ("glass", 0.02, [(BALL, CLEAR)]),
        ("mirror", 0.2, [(beside, silver)]),
    ];
    for (name, radius, spheres) in cases {
        let mut scene = lit(GREY, radius, &spheres);
        scene.sampling.max_bounces = 2;
        let mut variance = |caustics: bool| {
            scene.sampling.caustics = caustics;
            let mut image = |seed: u32| {
                scene.sampling.seed = seed;
                luminances(&scene, &Device::Cpu)
            };
            let (first, second) = (image(1), image(2));
            let pairs = first.iter().zip(&second);
            let squares: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
            squares / (2.0 * first.len() as f64)
        };
        let (with, without) = (variance(true), variance(false));
        println!("{name}: variance {with:e} with caustics, {without:e} without");
        assert!(with * 10.0 < without, "{name}");
    }
}

#[test]
fn caustics_are_called_for_by_their_key() {
    let mut scene = lit(GREY, 0.5, &[(BALL, CLEAR)]);
    assert!(!scene.effects().any(Effects::CAUSTICS));
    scene.sampling.caustics = true;
    assert!(scene.effects().any(Effects::CAUSTICS));
    let mut dark = lit(GREY, 0.5, &[(BALL, GREY)]);
    dark.sampling.caustics = true;
    assert!(!dark.effects().any(Effects::CAUSTICS));
    scene.sampling.max_bounces = 0;
    assert!(!scene.effects().any(Effects::CAUSTICS));
}
