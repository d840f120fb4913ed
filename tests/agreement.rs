//! `--check` of light paths: images of one scene agree on every device, whatever the number of
//! samples is, and images of a scene that is a little wrong do not.

mod common;

use std::path::Path;

use common::{all_adapters, device};
use glam::Vec3;
use spherule::film::agreement::Agreement;
use spherule::film::compare::{Comparison, Tolerance};
use spherule::kernel::{Material, Sphere};
use spherule::render::{QUIET, Settings, render};
use spherule::scene::surroundings::PointLight;
use spherule::scene::{View, World};
use spherule::{Device, Image, Scene};

fn gallery(name: &str, samples: u32) -> Scene {
    let mut scene = Scene::load(Path::new(&format!("scenes/{name}.toml"))).expect("a scene");
    (scene.width, scene.height) = (160, 120);
    scene.sampling.samples = Some(samples);
    scene
}

fn image(scene: &Scene, device: &Device) -> Image {
    let rendered = render(scene, Settings::default(), device, QUIET);
    rendered.expect("an image").image
}

/// Every adapter, or the CPU where there is none.
fn others() -> Vec<Device> {
    let adapters = all_adapters();
    if adapters.is_empty() {
        vec![Device::Cpu]
    } else {
        adapters.iter().map(device).collect()
    }
}

/// Compares as `--check` does.
fn compare(first: &Image, second: &Image, samples: u32) -> (Comparison, Agreement) {
    let tolerance = Tolerance::of_paths(samples);
    let compared = Comparison::of(first, second, tolerance).expect("comparable");
    (compared, Agreement::of(first, second).expect("comparable"))
}

#[test]
fn devices_agree_at_any_number_of_samples() {
    for name in ["box", "glass-marble", "fog"] {
        for samples in [1, 4, 16] {
            let scene = gallery(name, samples);
            let cpu = image(&scene, &Device::Cpu);
            for other in others() {
                let (compared, agreement) = compare(&cpu, &image(&scene, &other), samples);
                let is_within = compared.is_within() && agreement.is_within();
                assert!(is_within, "{name}, {samples}: {compared:?} {agreement:?}");
            }
        }
    }
}

/// A white floor under a lamp, with a small ball beside the view that throws a shadow into it.
fn shadow_of_a_ball(has_ball: bool, samples: u32) -> Scene {
    let mut world = World::default();
    let white = world.add_material(Material::diffuse(Vec3::splat(0.7)));
    world.add(Sphere::new(Vec3::new(0.0, -1000.0, 0.0), 1000.0), white);
    let radius = if has_ball { 0.1 } else { 0.001 };
    world.add(Sphere::new(Vec3::new(2.5, 4.0, 0.0), radius), white);
    let mut scene = Scene::new(world);
    (scene.width, scene.height) = (160, 120);
    scene.background = Vec3::ZERO;
    scene.sampling.samples = Some(samples);
    scene.lights.push(PointLight {
        position: Vec3::new(5.0, 8.0, 0.0),
        intensity: Vec3::splat(100.0),
    });
    scene.view = Some(View {
        eye: Vec3::new(0.0, 5.0, 0.0),
        target: Vec3::ZERO,
        up: Vec3::Z,
        vertical_fov: 40.0,
    });
    scene
}

/// Asserts that a scene does not agree with what it should be, on any device.
fn assert_found(what: &str, right: &Scene, wrong: &Scene, samples: u32) {
    let cpu = image(wrong, &Device::Cpu);
    for other in others() {
        let (compared, agreement) = compare(&cpu, &image(right, &other), samples);
        println!("{what}, {samples}: {compared:?} {agreement:?}");
        let is_found = !compared.is_within() || !agreement.is_within();
        assert!(is_found, "{what}, {samples}: {compared:?} {agreement:?}");
    }
}

#[test]
fn a_scene_that_is_a_little_wrong_does_not_agree() {
    for samples in [1, 4, 16] {
        let right = gallery("box", samples);
        let mut wrong = right.clone();
        let red = Vec3::new(0.63, 0.06, 0.05);
        let of_red = wrong
            .world
            .materials
            .iter()
            .position(|m| *m == Material::diffuse(red));
        wrong.world.materials[of_red.expect("a red wall")] = Material::diffuse(1.02 * red);
        assert_found("a color off by 2 %", &right, &wrong, samples);

        let mut wrong = right.clone();
        let materials = wrong.world.materials.iter_mut();
        let lamp = materials.filter(|material| material.kind == Material::EMISSIVE);
        lamp.for_each(|lamp| lamp.volume *= 1.01);
        assert_ne!(right.world.materials, wrong.world.materials);
        assert_found("a light off by 1 %", &right, &wrong, samples);

        let mut wrong = right.clone();
        let view = wrong.view.as_mut().expect("a view");
        let half_a_pixel = Vec3::X * (3.6 * 19.0_f32.to_radians().tan() / 120.0);
        view.eye += half_a_pixel;
        view.target += half_a_pixel;
        assert_found("half a pixel", &right, &wrong, samples);

        let (right, wrong) = (
            shadow_of_a_ball(true, samples),
            shadow_of_a_ball(false, samples),
        );
        assert_found("a shadow", &right, &wrong, samples);
    }
}
