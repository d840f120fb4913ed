//! The effects, compared with closed forms, with each other, and between CPU and GPU.

mod common;

use std::path::Path;

use common::{all_adapters, device, in_furnace, open_with_limits, skips};
use glam::Vec3;
use spherule::film::compare::{Comparison, Tolerance};
use spherule::kernel::color::luminance;
use spherule::kernel::{Effects, Material, Rung, Sphere};
use spherule::render::EffectChoice;
use spherule::render::paths::StoppedBy;
use spherule::render::{QUIET, Settings, render};
use spherule::scene::limits::MAX_SAMPLES;
use spherule::scene::surroundings::{EnvironmentImage, PointLight, Sun, Surroundings, Tonemap};
use spherule::scene::{View, World};
use spherule::{Device, Image, Scene};

/// The scenes of the gallery.
const GALLERY: [&str; 8] = [
    "one-weekend",
    "glass-marble",
    "box",
    "in-motion",
    "fog",
    "soft-light",
    "ambient-occlusion",
    "caustic",
];

fn gallery(name: &str, width: u32, height: u32, samples: u32) -> Scene {
    let mut scene = Scene::load(format!("scenes/{name}.toml")).expect(name);
    (scene.width, scene.height) = (width, height);
    scene.sampling.samples = Some(samples);
    scene
}

fn image(scene: &Scene, settings: Settings, device: &Device) -> Image {
    render(scene, settings, device, QUIET)
        .expect("the scene renders")
        .image
}

fn on_cpu(scene: &Scene) -> Image {
    image(scene, Settings::default(), &Device::Cpu)
}

/// The mean luminance of the pixels that show a sphere, and its standard error.
fn mean(image: &Image) -> (f64, f64) {
    let values: Vec<f64> = image
        .pixels()
        .iter()
        .filter(|pixel| pixel.is_hit())
        .map(|pixel| f64::from(luminance(pixel.color())))
        .collect();
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
    (mean, (variance / count).sqrt())
}

/// A scene with one sphere of this material, in surroundings of radiance one.
fn furnace(material: Material) -> Scene {
    let mut world = World::default();
    let id = world.add_material(material);
    world.add(Sphere::new(Vec3::ZERO, 1.0), id);
    let mut scene = in_furnace(world);
    (scene.width, scene.height) = (64, 64);
    scene.sampling.samples = Some(64);
    scene.sampling.max_bounces = 200;
    scene
}

/// A sphere that reflects or transmits all light is invisible if the light is the same from every
/// direction.
#[test]
fn white_materials_vanish_in_a_furnace() {
    let mut materials = vec![
        ("diffuse".to_owned(), Material::diffuse(Vec3::ONE)),
        ("mirror".to_owned(), Material::metal(Vec3::ONE, 0.0)),
    ];
    for roughness in [0.1, 0.25, 0.5, 0.75, 1.0] {
        let metal = Material::metal(Vec3::ONE, roughness);
        materials.push((format!("metal of roughness {roughness}"), metal));
    }
    for (roughness, index) in [(0.0, 1.5), (0.2, 1.5), (0.5, 2.4), (1.0, 1.3)] {
        let plastic = Material::plastic(Vec3::ONE, roughness, index);
        materials.push((format!("plastic of roughness {roughness}"), plastic));
    }
    for index in [0.6, 1.1, 1.5, 2.4] {
        let glass = Material::glass(index, Vec3::ZERO);
        materials.push((format!("glass of index {index}"), glass));
        let bubble = Material::bubble(index, Vec3::ZERO);
        materials.push((format!("bubble in glass of index {index}"), bubble));
    }
    for (name, material) in materials {
        let (mean, error) = mean(&on_cpu(&furnace(material)));
        // The table for rough surfaces is interpolated linearly, which is off by up to 0.003.
        let bias = if name.starts_with("metal") || name.starts_with("plastic") {
            3e-3
        } else {
            1e-5
        };
        assert!(
            (mean - 1.0).abs() <= 4.0 * error + bias,
            "{name}: {mean} ± {error}"
        );
    }
    // The check can fail: a sphere that reflects nine tenths is visible.
    let grey = Material::metal(Vec3::splat(0.9), 0.5);
    let (mean, error) = mean(&on_cpu(&furnace(grey)));
    assert!(mean < 0.97 && error < 0.01, "{mean} ± {error}");
}

/// A patch of white floor, with a spherical light of this radius at this height above it.
fn floor_under_lamp(radius: f32, height: f32) -> Scene {
    let mut world = World::default();
    let white = world.add_material(Material::diffuse(Vec3::ONE));
    let lamp = world.add_material(Material::emissive(Vec3::ONE));
    world.add(Sphere::new(Vec3::NEG_Y * 100.0, 100.0), white);
    world.add(Sphere::new(Vec3::Y * height, radius), lamp);
    let mut scene = Scene::new(world);
    (scene.width, scene.height) = (32, 32);
    // The camera is under the lamp, so that the lamp does not hide the floor.
    scene.view = Some(View {
        eye: Vec3::new(0.02, 0.02, 0.0),
        target: Vec3::ZERO,
        up: Vec3::Z,
        vertical_fov: 1.0,
    });
    scene.background = Vec3::ZERO;
    scene.sampling.samples = Some(256);
    scene.sampling.max_bounces = 1;
    scene
}

/// E = π L (r / d)² for a sphere wholly above the horizon (J. R. Howell, A catalog of radiation
/// heat transfer configuration factors, B-11), so that a white floor has the radiance (r / d)².
/// Sampling the lamp, meeting it by chance, and both together give the same.
#[test]
fn a_spherical_light_gives_its_closed_form() {
    for (radius, height) in [(0.5, 2.0), (0.05, 3.0), (1.9, 2.0), (100.0, 350.0)] {
        let mut scene = floor_under_lamp(radius, height);
        let expected = f64::from(radius / height).powi(2);
        let both = EffectChoice::Auto;
        let by_chance = EffectChoice::Only(Effects::ALL.without(Effects::SOFT_SHADOWS));
        let sampled = EffectChoice::Only(Effects::ALL.without(Effects::INTERREFLECTION));
        let is_small = expected < 0.01;
        for (name, effects) in [("both", both), ("chance", by_chance), ("sampled", sampled)] {
            // Paths seldom meet a small lamp by chance: it takes more samples, and the smallest
            // lamps are left out.
            scene.sampling.samples = Some(if name == "chance" { 4096 } else { 256 });
            if name == "chance" && is_small {
                continue;
            }
            let settings = Settings::default()
                .effects(effects)
                // The lower rungs lose the floor's curvature.
                .rung(Rung::Double);
            let (mean, error) = mean(&image(&scene, settings, &Device::Cpu));
            assert!(
                (mean - expected).abs() <= 4.0 * error + 1e-4 * expected,
                "radius {radius}, height {height}, {name}: {mean} ± {error}, expected {expected}"
            );
        }
    }
}

/// A gradient sky gives an upward floor the cosine-weighted mean of the gradient, horizon +
/// ⅔ (zenith − horizon).
#[test]
fn a_gradient_gives_its_closed_form() {
    let mut scene = floor_under_lamp(1e-3, 1e3);
    scene.world.spheres.truncate(1);
    scene.world.material_ids.truncate(1);
    let (horizon, zenith) = (Vec3::splat(0.2), Vec3::splat(1.4));
    scene.sky = Some(Surroundings {
        horizon,
        zenith,
        sun: None,
        rotation: 0.0,
        image: None,
    });
    scene.sampling.samples = Some(1024);
    let expected = 0.2 + 1.2 * 2.0 / 3.0;
    let (mean, error) = mean(&on_cpu(&scene));
    assert!(
        (mean - expected).abs() <= 4.0 * error + 1e-4,
        "{mean} ± {error}, {expected}"
    );
}

/// A white floor, seen from above, without a light.
fn floor() -> Scene {
    let mut scene = floor_under_lamp(1e-3, 1e3);
    scene.world.spheres.truncate(1);
    scene.world.material_ids.truncate(1);
    scene
}

/// A sun of irradiance E at the angle θ from the zenith gives E cos θ, a point of intensity I at
/// the distance d gives I cos θ / d²; both for lights with and without extent.
#[test]
fn suns_and_points_give_their_closed_forms() {
    let direction = Vec3::new(0.3, 0.8, -0.5).normalize();
    for size in [0.0, 0.5, 20.0] {
        let mut scene = floor();
        scene.sky = Some(Surroundings {
            horizon: Vec3::ZERO,
            zenith: Vec3::ZERO,
            sun: Some(Sun {
                direction,
                size,
                irradiance: Vec3::splat(2.0),
            }),
            rotation: 0.0,
            image: None,
        });
        let expected = 2.0 * f64::from(direction.y) / std::f64::consts::PI;
        let (mean, error) = mean(&on_cpu(&scene));
        assert!(
            (mean - expected).abs() <= 4.0 * error + 2e-4,
            "{size}: {mean} ± {error}, {expected}"
        );
    }
    let mut scene = floor();
    scene.lights.push(PointLight {
        position: direction * 3.0,
        intensity: Vec3::splat(5.0),
    });
    scene.lights.push(PointLight {
        position: Vec3::Y * 2.0,
        intensity: Vec3::splat(0.5),
    });
    let expected = (5.0 * f64::from(direction.y) / 9.0 + 0.125) / std::f64::consts::PI;
    let (mean, error) = mean(&on_cpu(&scene));
    assert!(
        (mean - expected).abs() <= 4.0 * error + 1e-4,
        "{mean} ± {error}, {expected}"
    );
}

/// One texel of light in a dark image gives the floor the integral of the cosine over it.
#[test]
fn an_environment_gives_its_closed_form() {
    let (width, height) = (64_u32, 32_u32);
    for (row, column) in [(3, 10), (9, 63), (14, 31)] {
        let mut texels = vec![Vec3::ZERO; (width * height) as usize];
        texels[(row * width + column) as usize] = Vec3::splat(100.0);
        let mut scene = floor();
        scene.sky = Some(Surroundings {
            horizon: Vec3::ZERO,
            zenith: Vec3::ZERO,
            sun: None,
            rotation: 0.0,
            image: Some(EnvironmentImage {
                width,
                height,
                texels,
            }),
        });
        scene.sampling.samples = Some(1024);
        // The image is linear between the middles of texels: one texel is a tent, twice as wide and
        // twice as high, whose integral over the columns is the width of one.
        let steps = 10_000;
        let angle = |v: f64| std::f64::consts::PI * v / f64::from(height);
        let integral: f64 = (0..2 * steps)
            .map(|step| {
                let down = (f64::from(step) + 0.5) / f64::from(steps) - 1.0;
                let polar = angle(f64::from(row) + 0.5 + down);
                (1.0 - down.abs()) * polar.cos().max(0.0) * polar.sin()
            })
            .sum::<f64>()
            * angle(1.0 / f64::from(steps))
            * 2.0
            * std::f64::consts::PI
            / f64::from(width);
        let expected = 100.0 * integral / std::f64::consts::PI;
        let (mean, error) = mean(&on_cpu(&scene));
        assert!(
            (mean - expected).abs() <= 4.0 * error + 2e-3 * expected,
            "{row} {column}: {mean} ± {error}, {expected}"
        );
    }
}

/// An environment image is read from a file, and each texel is seen in its direction.
#[test]
fn an_environment_is_read_and_seen_in_the_right_directions() {
    let directory = tempfile::tempdir().expect("a directory");
    let mut pixels = image::Rgb32FImage::from_pixel(8, 4, image::Rgb([0.25, 0.25, 0.25]));
    // The image's middle, just below the horizon, is −z. To the right of it is +x. Colours are
    // those of the texels where four equal ones meet.
    for (x, y) in [(3, 2), (4, 2), (3, 3), (4, 3)] {
        pixels.put_pixel(x, y, image::Rgb([4.0, 0.0, 0.0]));
        pixels.put_pixel(x + 2, y, image::Rgb([0.0, 4.0, 0.0]));
    }
    let path = directory.path().join("sky.exr");
    pixels.save(&path).expect("an image");
    let text = "[image]\nwidth = 9\nheight = 9\nsamples = 1\n[sky]\nimage = \"sky.exr\"\nstrength = 0.5\n\
        [[sphere]]\ncenter = [0, 50, 0]\nradius = 1\n";
    for (rotation, target, color) in [
        (0, "[0, -1, -1]", Vec3::new(2.0, 0.0, 0.0)),
        (0, "[1, -1, 0]", Vec3::new(0.0, 2.0, 0.0)),
        (0, "[0, 1, -1]", Vec3::splat(0.125)),
        (90, "[1, -1, 0]", Vec3::new(2.0, 0.0, 0.0)),
        (-90, "[0, -1, -1]", Vec3::new(0.0, 2.0, 0.0)),
        (180, "[0, -1, 1]", Vec3::new(2.0, 0.0, 0.0)),
        (-360, "[0, -1, -1]", Vec3::new(2.0, 0.0, 0.0)),
    ] {
        let text = text.replace("strength", &format!("rotation = {rotation}\nstrength"));
        let text =
            format!("{text}[camera]\neye = [0, 0, 0]\ntarget = {target}\nvertical_fov = 0.1\n");
        let scene = spherule::read::toml::parse(&directory.path().join("s.toml"), text);
        let image = on_cpu(&scene.expect("a scene"));
        let seen = image.pixel(4, 4).expect("a pixel").color();
        assert!(
            (seen - color).abs().max_element() < 1e-5,
            "{rotation}, {target}: {seen}"
        );
    }
    image::RgbImage::new(8, 4)
        .save(directory.path().join("sky.png"))
        .expect("an image");
    let text = "[sky]\nimage = \"sky.png\"\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n";
    let refused = spherule::read::toml::parse(&directory.path().join("s.toml"), text.into());
    assert!(
        refused
            .expect_err("8 bits")
            .to_string()
            .contains("not an image that spherule reads")
    );
}

/// A glowing sphere that crosses the view covers a pixel for a share of the time.
#[test]
fn motion_blur_is_the_share_of_the_time() {
    let mut scene = furnace(Material::emissive(Vec3::ONE));
    scene.sky = None;
    scene.background = Vec3::ZERO;
    // The sphere moves from −4 to 4 while the shutter is open. It covers the middle while it is
    // within ±1.
    scene.world.spheres.clear();
    scene.world.material_ids.clear();
    scene
        .world
        .add_moving(Sphere::new(Vec3::ZERO, 1.0), 0, Vec3::X * 8.0);
    scene.lens.shutter = (-0.5, 0.5);
    scene.sampling.samples = Some(1024);
    (scene.width, scene.height) = (3, 3);
    scene.view = scene.view.map(|view| View {
        vertical_fov: 0.01,
        ..view
    });
    let image = on_cpu(&scene);
    let middle = f64::from(image.pixel(1, 1).expect("a pixel").color().x);
    assert!((middle - 0.25).abs() < 0.005, "{middle}");
}

/// A sphere in focus stays sharp; a sphere out of focus is spread over its circle of confusion.
#[test]
fn a_lens_blurs_what_is_out_of_focus() {
    let mut scene = furnace(Material::emissive(Vec3::ONE));
    scene.sky = None;
    scene.background = Vec3::ZERO;
    scene.world.spheres = vec![Sphere::new(Vec3::ZERO, 0.01)];
    scene.lens.aperture = 1.0;
    scene.sampling.samples = Some(4096);
    (scene.width, scene.height) = (1, 1);
    scene.view = scene.view.map(|view| View {
        vertical_fov: 0.01,
        ..view
    });
    let seen = |focus| {
        let mut scene = scene.clone();
        scene.lens.focus_distance = Some(focus);
        f64::from(on_cpu(&scene).pixels()[0].color().x)
    };
    assert_eq!(seen(5.0), 1.0);
    // With the focus at twice the ball's distance, the ball is seen through a share of the lens's
    // area: that of the ball's cone, twice as wide, which is (0.01 · 2)² of 0.5².
    let expected = (0.02_f64 / 0.5).powi(2);
    assert!(
        (seen(10.0) - expected).abs() < 0.2 * expected,
        "{}",
        seen(10.0)
    );
}

/// A glass ball lets a share e^(−σ 2r) of the light through its middle, times what its two
/// boundaries let through: T² / (1 − R² e^(−2σ 2r)), counting all reflections inside.
#[test]
fn absorption_follows_beers_law() {
    let sigma = 0.7;
    let mut scene = furnace(Material::glass(1.5, Vec3::splat(sigma)));
    scene.view = scene.view.map(|view| View {
        vertical_fov: 0.01,
        ..view
    });
    scene.sampling.samples = Some(4096);
    (scene.width, scene.height) = (8, 8);
    let (mean, error) = mean(&on_cpu(&scene));
    // Straight through: R = 0.04 at each boundary.
    let r = 0.04_f64;
    let through = (-f64::from(sigma) * 2.0).exp();
    let expected = r + (1.0 - r).powi(2) * through / (1.0 - r * through);
    assert!(
        (mean - expected).abs() <= 4.0 * error + 1e-4,
        "{mean} ± {error}, {expected}"
    );
}

/// Fog that only absorbs dims what is behind it by e^(−σ s).
#[test]
fn absorbing_fog_follows_beers_law() {
    let mut scene = furnace(Material::emissive(Vec3::ONE));
    scene.sky = None;
    scene.fog = Some(spherule::scene::FogBall {
        medium: spherule::kernel::fog::Fog {
            center: Vec3::new(0.0, 0.0, 3.0),
            radius: 1.0,
            extinction: 0.8,
            ..Default::default()
        },
    });
    scene.view = scene.view.map(|view| View {
        vertical_fov: 0.1,
        ..view
    });
    scene.sampling.samples = Some(1024);
    let (mean, error) = mean(&on_cpu(&scene));
    let expected = (-1.6_f64).exp();
    assert!(
        (mean - expected).abs() <= 4.0 * error + 1e-4,
        "{mean} ± {error}, {expected}"
    );
}

/// White fog in a furnace is invisible, too, whatever its anisotropy.
#[test]
fn white_fog_vanishes_in_a_furnace() {
    for anisotropy in [-0.6, 0.0, 0.8] {
        let mut scene = furnace(Material::diffuse(Vec3::ONE));
        scene.fog = Some(spherule::scene::FogBall {
            medium: spherule::kernel::fog::Fog {
                radius: 2.0,
                extinction: 1.5,
                albedo: Vec3::ONE,
                anisotropy,
                ..Default::default()
            },
        });
        let (mean, error) = mean(&on_cpu(&scene));
        assert!(
            (mean - 1.0).abs() <= 4.0 * error + 1e-4,
            "{anisotropy}: {mean} ± {error}"
        );
    }
}

/// The root mean square error against an image of many samples falls at least as fast as 1 / √N.
#[test]
fn the_error_falls_with_the_samples() {
    for name in ["soft-light", "one-weekend"] {
        let mut reference = gallery(name, 48, 32, 4096);
        reference.sampling.seed = 99;
        let reference = on_cpu(&reference);
        let error = |samples| {
            let found = on_cpu(&gallery(name, 48, 32, samples));
            let sum: f64 = found
                .pixels()
                .iter()
                .zip(reference.pixels())
                .map(|(a, b)| f64::from(luminance(a.color() - b.color())).powi(2))
                .sum();
            (sum / found.pixels().len() as f64).sqrt()
        };
        let (few, many) = (error(8), error(128));
        // √16 = 4, minus what the reference's own noise takes away.
        assert!(
            few > 3.0 * many,
            "{name}: {few} with 8 samples, {many} with 128"
        );
    }
}

/// A pipeline with every effect renders the same bits as a pipeline with only the scene's effects.
#[test]
fn effects_that_are_not_called_for_change_nothing() {
    for name in GALLERY {
        let scene = gallery(name, 40, 24, 4);
        let with = |effects| Settings::default().effects(effects);
        let own = image(&scene, with(EffectChoice::Auto), &Device::Cpu);
        let all = image(&scene, with(EffectChoice::All), &Device::Cpu);
        assert!(own.pixels() == all.pixels(), "{name}");
        // The check can fail: leaving out an effect that is called for changes the image.
        let fewer = scene
            .effects()
            .without(Effects::INTERREFLECTION.and(Effects::AMBIENT_OCCLUSION));
        let without = image(&scene, with(EffectChoice::Only(fewer)), &Device::Cpu);
        assert!(own.pixels() != without.pixels(), "{name}");
    }
}

/// A scene that calls for no effect is rendered with one ray a pixel, whatever effects are asked
/// for.
#[test]
fn a_plain_scene_stays_plain() {
    let mut scene = Scene::load("scenes/two-spheres.toml").expect("a scene");
    (scene.width, scene.height) = (40, 24);
    let all = Settings::default().effects(EffectChoice::All);
    let own = on_cpu(&scene);
    assert!(own.pixels() == image(&scene, all, &Device::Cpu).pixels());
    assert!(
        own.pixels()
            .iter()
            .any(|pixel| pixel.color().max_element() > 0.1)
    );
    // Exposure applies to it as to any other image.
    scene.develop.exposure = -3.0;
    assert_ne!(own.to_rgb8(), on_cpu(&scene).to_rgb8());
}

/// If effects are left out, the image stays finite: smooth metal without mirrors, moving spheres
/// without motion blur.
#[test]
fn images_without_some_effects_are_finite() {
    for name in GALLERY {
        let scene = gallery(name, 32, 20, 4);
        for (effect, _) in Effects::NAMED {
            let settings =
                Settings::default().effects(EffectChoice::Only(scene.effects().without(*effect)));
            let image = image(&scene, settings, &Device::Cpu);
            assert!(
                image.pixels().iter().all(|pixel| pixel.color().is_finite()),
                "{name}"
            );
        }
    }
}

/// Ambient light comes from the sky, counted once: a white floor has the sky's radiance.
#[test]
fn ambient_light_comes_from_the_sky() {
    let uniform = |light: f32, image| Surroundings {
        rotation: 0.0,
        horizon: Vec3::splat(light),
        zenith: Vec3::splat(light),
        sun: None,
        image,
    };
    let map = EnvironmentImage {
        width: 8,
        height: 4,
        texels: vec![Vec3::splat(0.3); 32],
    };
    for (sky, expected) in [
        (None, 1.0),
        (Some(uniform(0.3, None)), 0.3),
        (Some(uniform(0.9, Some(map))), 0.3),
    ] {
        let mut scene = floor();
        scene.sky = sky;
        scene.sampling.ambient_occlusion = Some(1.0);
        let (mean, error) = mean(&on_cpu(&scene));
        assert!(
            (mean - expected).abs() <= 4.0 * error + 1e-3,
            "{mean} ± {error}, {expected}"
        );
    }
}

/// CPU and GPU decide alike: the same seed gives the same image, except for paths that a rounding
/// sends elsewhere.
#[test]
fn gpus_render_what_the_cpu_renders() {
    if skips("gpus_render_what_the_cpu_renders") {
        return;
    }
    for name in GALLERY {
        let scene = gallery(name, 64, 40, 8);
        let cpu = on_cpu(&scene);
        let mut other = scene.clone();
        other.sampling.seed += 1;
        // 0.1 % of 2560 pixels are two; a path may go elsewhere in a few more.
        let tolerance = Tolerance {
            channel: 2.0,
            share: 0.01,
        };
        for adapter in all_adapters() {
            let device = device(adapter);
            for effects in [EffectChoice::Auto, EffectChoice::All] {
                let settings = Settings::default().effects(effects);
                let compared = Comparison::of(&image(&scene, settings, &device), &cpu, tolerance);
                assert!(
                    compared.expect("comparable").is_within(),
                    "{name}: {compared:?}"
                );
            }
            // The check can fail: another seed gives another image.
            let seeded = image(&other, Settings::default(), &device);
            let compared = Comparison::of(&seeded, &cpu, tolerance).expect("comparable");
            assert!(!compared.is_within(), "{name}: {compared:?}");
        }
    }
}

/// The same seed gives the same image, byte for byte, whatever the number of threads, the tiles of
/// the image and the launches of the samples.
#[test]
fn images_do_not_depend_on_how_the_work_is_cut() {
    let scene = gallery("glass-marble", 96, 54, 24);
    let render_with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool").install(|| on_cpu(&scene))
    };
    assert!(render_with(1).pixels() == render_with(3).pixels());
    if skips("images_do_not_depend_on_how_the_work_is_cut") {
        return;
    }
    for adapter in all_adapters() {
        // A binding holds the accumulators of 700 pixels, so tiles have seven rows.
        let mut limits = adapter.limits();
        limits.max_storage_buffer_binding_size = 32 * 700;
        let cut = Device::Gpu(Box::new(open_with_limits(adapter, limits)));
        let [cut, whole] =
            [cut, device(adapter)].map(|device| image(&scene, Settings::default(), &device));
        assert!(
            cut.pixels() == whole.pixels(),
            "{}",
            adapter.get_info().name
        );
    }
}

/// A small image takes many samples in one launch. A software adapter leaves a kernel's loop after
/// 65,535 iterations.
#[test]
fn small_images_have_all_of_their_samples() {
    if skips("small_images_have_all_of_their_samples") {
        return;
    }
    let scene = gallery("one-weekend", 11, 6, 4096);
    for adapter in all_adapters() {
        let device = device(adapter);
        let rendered = render(&scene, Settings::default(), &device, QUIET).expect("an image");
        assert_eq!(rendered.rays, 66 * 4096);
    }
}

#[test]
fn a_noise_target_ends_a_render() {
    let scene = gallery("soft-light", 48, 32, MAX_SAMPLES);
    let settings = Settings::default().noise(0.02);
    let rendered = render(&scene, settings, &Device::Cpu, QUIET).expect("the scene renders");
    let reached = rendered.reached.expect("samples were taken");
    assert_eq!(reached.stopped_by, StoppedBy::Noise);
    assert!(
        reached.noise <= 0.02 && reached.samples < 10_000,
        "{reached:?}"
    );
}

#[test]
fn a_time_limit_ends_a_render() {
    let scene = gallery("soft-light", 48, 32, MAX_SAMPLES);
    let settings = Settings::default().time_limit(std::time::Duration::from_millis(50));
    let rendered = render(&scene, settings, &Device::Cpu, QUIET).expect("the scene renders");
    assert_eq!(
        rendered.reached.map(|reached| reached.stopped_by),
        Some(StoppedBy::TimeLimit)
    );
}

#[test]
fn what_is_done_before_the_tracing_is_timed_on_the_cpu_too() {
    let scene = gallery("soft-light", 48, 32, 1);
    let rendered = render(&scene, Settings::default(), &Device::Cpu, QUIET).expect("an image");
    // It builds a tree over 327 atoms.
    assert!(rendered.timings.setup > std::time::Duration::ZERO);
}

/// A scene calls for the effects that its keys need, and for no others.
#[test]
#[expect(clippy::too_many_lines, reason = "one table, an entry a key")]
fn each_effect_is_called_for_by_its_key() {
    let base = "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n";
    let read = |text: &str| {
        let text = format!("{text}\n{base}");
        spherule::read::toml::parse(Path::new("test.toml"), text).expect("a scene")
    };
    assert!(read("").effects().is_empty());
    let sky = "[sky]\nhorizon = [1, 1, 1]\n";
    let material = |kind: &str| {
        format!(
            "[materials.m]\n{kind}\n[[sphere]]\ncenter = [3, 0, 0]\nradius = 1\nmaterial = \"m\""
        )
    };
    let metal = material("kind = \"metal\"\ncolor = [1, 1, 1]");
    let rough = material("kind = \"metal\"\ncolor = [1, 1, 1]\nroughness = 0.5");
    let plastic = material("kind = \"plastic\"\ncolor = [1, 1, 1]");
    let glass = material("kind = \"glass\"");
    let lamp = material("kind = \"emissive\"\ncolor = [1, 1, 1]");
    let overlapping =
        format!("{glass}\n[[sphere]]\ncenter = [4, 0, 0]\nradius = 1\nmaterial = \"m\"");
    let cases: [(&str, Effects); 21] = [
        (
            "[image]\nsamples = 4",
            Effects::ANTIALIASING.and(Effects::HEADLAMP),
        ),
        (
            "[image]\ntransparent = true",
            Effects::TRANSPARENT_BACKGROUND.and(Effects::HEADLAMP),
        ),
        (
            "[image]\nambient_occlusion = 2\nsamples = 1",
            Effects::AMBIENT_OCCLUSION,
        ),
        (&metal, Effects::MIRROR.and(Effects::HEADLAMP)),
        (
            &rough,
            Effects::ROUGH_METAL
                .and(Effects::HEADLAMP)
                .and(Effects::ANTIALIASING),
        ),
        (
            &plastic,
            Effects::PLASTIC
                .and(Effects::HEADLAMP)
                .and(Effects::ANTIALIASING),
        ),
        (
            &glass,
            Effects::GLASS
                .and(Effects::HEADLAMP)
                .and(Effects::ANTIALIASING),
        ),
        (
            &lamp,
            Effects::EMISSION
                .and(Effects::SOFT_SHADOWS)
                .and(Effects::INTERREFLECTION)
                .and(Effects::ANTIALIASING),
        ),
        (
            "[[light]]\nposition = [0, 9, 0]\nintensity = [1, 1, 1]\n[image]\nmax_bounces = 0",
            Effects::HARD_SHADOWS,
        ),
        (
            "[[light]]\nposition = [0, 9, 0]\nradius = 1\nintensity = [1, 1, 1]\n[image]\nmax_bounces = 0\nsamples = 1",
            Effects::EMISSION.and(Effects::SOFT_SHADOWS),
        ),
        (sky, Effects::INTERREFLECTION.and(Effects::ANTIALIASING)),
        (
            "[sky]\nhorizon = [1, 1, 1]\nzenith = [0, 0, 1]\n[image]\nsamples = 1",
            Effects::INTERREFLECTION.and(Effects::SKY_GRADIENT),
        ),
        (
            "[sky]\nsun_direction = [0, 1, 0]\n[image]\nsamples = 1\nmax_bounces = 0",
            Effects::SUN.and(Effects::SOFT_SHADOWS),
        ),
        (
            "[sky]\nsun_direction = [0, 1, 0]\nsun_size = 0\n[image]\nmax_bounces = 0",
            Effects::HARD_SHADOWS,
        ),
        (
            "[camera]\neye = [0, 0, 9]\ntarget = [0, 0, 0]\naperture = 0.1",
            Effects::DEFOCUS
                .and(Effects::HEADLAMP)
                .and(Effects::ANTIALIASING),
        ),
        (
            "[camera]\neye = [0, 0, 9]\ntarget = [0, 0, 0]\nshutter = [0, 1]\n[[sphere]]\ncenter = [0, 5, 0]\nradius = 1\nvelocity = [1, 0, 0]",
            Effects::MOTION_BLUR
                .and(Effects::HEADLAMP)
                .and(Effects::ANTIALIASING),
        ),
        (
            "[[sphere]]\ncenter = [0, 5, 0]\nradius = 1\nvelocity = [1, 0, 0]",
            Effects::NONE,
        ),
        (
            "[fog]\nextinction = 0.1",
            Effects::FOG
                .and(Effects::HEADLAMP)
                .and(Effects::ANTIALIASING),
        ),
        (
            "[[light]]\nposition = [0, 9, 0]\nintensity = [1, 1, 1]\n[image]\nmax_bounces = 0\n[[sphere]]\ncenter = [0, -1e4, 0]\nradius = 1e4",
            Effects::HARD_SHADOWS.and(Effects::LARGE_SPHERES),
        ),
        (
            "[[sphere]]\ncenter = [0, -1e4, 0]\nradius = 1e4",
            Effects::NONE,
        ),
        (
            &overlapping,
            Effects::GLASS
                .and(Effects::NESTED_GLASS)
                .and(Effects::HEADLAMP)
                .and(Effects::ANTIALIASING),
        ),
    ];
    for (text, expected) in cases {
        let scene = read(text);
        assert_eq!(
            scene.effects(),
            expected,
            "{text}: {:#?}",
            scene.called_effects()
        );
    }
}

/// Keys of `[image]` call for an effect only where it changes the image.
#[test]
fn keys_that_change_nothing_call_for_nothing() {
    let of = |image: &str, scene: &str, asked: Effects| {
        let text =
            format!("[image]\n{image}\n{scene}\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n");
        let scene = spherule::read::toml::parse(Path::new("test.toml"), text).expect("a scene");
        (scene.effects().any(asked), scene.samples())
    };
    let sky = "[sky]\nzenith = [1, 1, 1]\nsun_direction = [0, 1, 0]\nsun_size =";
    let glass = "[materials.m]\nkind = \"glass\"\n[[sphere]]\ncenter = [3, 0, 0]\nradius = 1\nmaterial = \"m\"";
    let clear = "glass_shadows = \"clear\"";
    for (image, scene, asked, expected) in [
        (
            clear,
            format!("{sky} 0\n{glass}"),
            Effects::CLEAR_SHADOWS,
            true,
        ),
        (
            clear,
            format!("{sky} 1\n{glass}"),
            Effects::CLEAR_SHADOWS,
            false,
        ),
        (clear, format!("{sky} 0"), Effects::CLEAR_SHADOWS, false),
        (
            "glass_shadows = \"dark\"",
            format!("{sky} 0\n{glass}"),
            Effects::CLEAR_SHADOWS,
            false,
        ),
        (
            "filter = \"gaussian\"",
            String::new(),
            Effects::FILTER,
            true,
        ),
        ("filter_width = 2", String::new(), Effects::FILTER, true),
        (
            "filter = \"gaussian\"\nsamples = 1",
            String::new(),
            Effects::FILTER,
            false,
        ),
        (
            "filter = \"box\"\nfilter_width = 1",
            String::new(),
            Effects::FILTER,
            false,
        ),
        ("clamp = 2", format!("{sky} 0"), Effects::CLAMP, true),
        ("clamp = 2", String::new(), Effects::CLAMP, false),
    ] {
        let (found, samples) = of(image, &scene, asked);
        assert_eq!(found, expected, "{image}\n{scene}");
        if asked == Effects::FILTER {
            assert_eq!(samples > 1, expected, "{image}");
        }
    }
}

/// Tone curves are monotonic and keep black black. Each stop of exposure doubles the light.
#[test]
fn exposure_and_tone_curves_are_applied() {
    let pixel = |light: f32| spherule::kernel::Pixel::new(Vec3::splat(light), 1.0);
    let shown = |tonemap, exposure, light: f32| {
        let mut image =
            Image::new(1, 1, spherule::kernel::Shading::Lit, vec![pixel(light)]).expect("an image");
        image.develop.tonemap = tonemap;
        image.develop.exposure = exposure;
        image.to_rgb8()[0]
    };
    for tonemap in [Tonemap::Clamp, Tonemap::Reinhard, Tonemap::Aces] {
        assert_eq!(shown(tonemap, 0.0, 0.0), 0);
        let mut last = 0;
        for step in 0..200 {
            let now = shown(tonemap, 0.0, 0.05 * step as f32);
            assert!(now >= last);
            last = now;
        }
        assert!(last >= 235, "{tonemap:?} {last}");
        assert_eq!(shown(tonemap, 1.0, 0.1), shown(tonemap, 0.0, 0.2));
    }
    assert!(shown(Tonemap::Reinhard, 0.0, 4.0) < 255);
    assert_eq!(shown(Tonemap::Clamp, 0.0, 4.0), 255);
}

/// With a transparent background, pixels without a sphere have no opacity, and the colours of edges
/// are not mixed with the background.
#[test]
fn a_transparent_background_has_no_opacity() {
    let mut scene = Scene::load("scenes/c60.xyz").expect("a molecule");
    (scene.width, scene.height) = (40, 30);
    scene.transparent = true;
    scene.sampling.samples = Some(16);
    let image = on_cpu(&scene);
    let alpha = common::opacities(&image);
    assert_eq!(alpha[0], 0.0);
    assert_eq!(alpha[15 * 40 + 12], 1.0);
    assert!(alpha.iter().any(|alpha| (0.1..0.9).contains(alpha)));
    let bytes = image.to_rgba8();
    assert_eq!(bytes.len(), 4 * 40 * 30);
    assert_eq!(bytes[..4], [0, 0, 0, 0]);
}
