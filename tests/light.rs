//! Light that falls on surfaces of every size, compared with closed forms, on the CPU and on every
//! GPU adapter: on grounds of radius 1 to that of the Earth, from lamps down to a thousandth, and
//! far from the origin.

mod common;

use std::sync::OnceLock;

use common::{all_adapters, device};
use glam::{DVec3, Vec3};
use spherule::kernel::color::luminance;
use spherule::kernel::{Effects, Material, Rung, Sphere};
use spherule::render::{EffectChoice, QUIET, Settings, render};
use spherule::scene::surroundings::{EnvironmentImage, PointLight, Sun, Surroundings};
use spherule::scene::{View, World};
use spherule::{Device, Scene};

const EARTH: f32 = 6_371_000.0;
const GROUNDS: [f32; 4] = [1.0, 1e3, 1e5, EARTH];

/// Two directions: along an axis many roundings are exact, along the other none is.
const UPS: [DVec3; 2] = [DVec3::Y, DVec3::new(0.36, 0.48, 0.8)];

/// A place on a white ground.
struct Place {
    /// The ground alone, from 2 above the place.
    scene: Scene,
    /// The place, which is as near to the origin as the centre of the ground can be placed.
    at: DVec3,
    /// The unit vector upwards.
    up: DVec3,
    /// A unit vector along the ground.
    along: DVec3,
}

impl Place {
    /// On a ground of this radius, where upwards is about `up`.
    fn on(radius: f32, up: DVec3) -> Self {
        let center = (up * -f64::from(radius)).as_vec3();
        let up = -center.as_dvec3().normalize();
        let at = center.as_dvec3() + up * f64::from(radius);
        let along = up.any_orthonormal_vector();
        let mut world = World::default();
        let white = world.add_material(Material::diffuse(Vec3::ONE));
        world.add(Sphere::new(center, radius), white);
        let mut scene = Scene::new(world);
        (scene.width, scene.height) = (24, 24);
        scene.background = Vec3::ZERO;
        scene.sampling.samples = Some(64);
        scene.sampling.max_bounces = 0;
        let mut place = Self {
            scene,
            at,
            up,
            along,
        };
        place.look_from(0.5, 2.0, 0.0, 0.25);
        place
    }

    /// The point so far along the ground and so high.
    fn point(&self, along: f64, height: f64) -> Vec3 {
        (self.at + self.along * along + self.up * height).as_vec3()
    }

    /// Looks from there at the ground at `target`, with a field of view of so many degrees.
    fn look_from(&mut self, along: f64, height: f64, target: f64, fov: f64) {
        self.scene.view = Some(View {
            eye: self.point(along, height),
            target: self.point(target, 0.0),
            up: self.along.cross(self.up).as_vec3(),
            vertical_fov: fov,
        });
    }

    /// Adds a lamp of radiance 1 and this radius 4 above, and returns what the ground gets of it:
    /// (r / d)² (J. R. Howell, A catalog of radiation heat transfer configuration factors, B-11).
    fn add_lamp(&mut self, radius: f32) -> f64 {
        let world = &mut self.scene.world;
        let lamp = world.add_material(Material::emissive(Vec3::ONE));
        let center = self.at + self.up * 4.0;
        world.add(Sphere::new(center.as_vec3(), radius), lamp);
        (f64::from(radius) / 4.0).powi(2)
    }
}

/// The CPU, and every adapter.
fn devices() -> &'static [(String, Device)] {
    static DEVICES: OnceLock<Vec<(String, Device)>> = OnceLock::new();
    DEVICES.get_or_init(|| {
        let adapters = all_adapters().iter();
        let gpus = adapters.map(|adapter| (adapter.get_info().name, device(adapter)));
        std::iter::once(("CPU".to_owned(), Device::Cpu))
            .chain(gpus)
            .collect()
    })
}

/// The mean luminance of the image, and its standard error.
fn mean(scene: &Scene, settings: &Settings, device: &Device) -> (f64, f64) {
    let rendered = render(scene, *settings, device, QUIET).expect("the scene renders");
    let pixels = rendered.image.pixels().iter();
    let values: Vec<f64> = pixels
        .map(|pixel| f64::from(luminance(pixel.color())))
        .collect();
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
    (mean, (variance / count).sqrt())
}

/// A sky of the same radiance everywhere, without a sun.
fn even_sky(radiance: Vec3) -> Surroundings {
    Surroundings {
        horizon: radiance,
        zenith: radiance,
        sun: None,
        rotation: 0.0,
        image: None,
    }
}

/// Every ground, with each direction upwards.
fn grounds() -> impl Iterator<Item = (f32, DVec3)> {
    GROUNDS
        .iter()
        .flat_map(|radius| UPS.map(|up| (*radius, up)))
}

fn settings() -> Settings {
    Settings::default().rung(Rung::Double)
}

/// Whether a device gives `expected`, to within four standard errors and a thousandth.
fn is_right(scene: &Scene, settings: &Settings, device: &Device, expected: f64) -> bool {
    let (mean, error) = mean(scene, settings, device);
    println!("{mean} ± {error}, expected {expected}");
    (mean - expected).abs() <= 4.0 * error + 1e-3 * expected
}

/// Asserts that each device gives `expected`.
fn assert_light(scene: &Scene, expected: f64, name: &str) {
    for (device_name, device) in devices() {
        assert!(
            is_right(scene, &settings(), device, expected),
            "{name} on {device_name}"
        );
    }
}

#[test]
fn lamps_of_every_size_light_grounds_of_every_size() {
    for (ground, up) in grounds() {
        for radius in [1.0, 0.1, 0.01, 0.001] {
            let mut place = Place::on(ground, up);
            let expected = place.add_lamp(radius);
            for max_bounces in [0, 1] {
                place.scene.sampling.max_bounces = max_bounces;
                let name = format!("radius {radius}, ground {ground}, {up}, {max_bounces}");
                assert_light(&place.scene, expected, &name);
            }
        }
    }
}

/// Where coordinates are off by 0.06 in 32-bit floats, light is the same as at the origin, bit for
/// bit.
#[test]
fn light_far_from_the_origin_is_the_same() {
    let pixels = |at: Vec3, extra: Option<Sphere>, device: &Device| {
        let mut place = Place::on(1e3, DVec3::Y);
        place.add_lamp(0.5);
        let mut scene = place.scene;
        let ball = Sphere::new(Vec3::new(0.5, 0.25, 0.0), 0.25);
        scene.world.add(ball, 0);
        for sphere in &mut scene.world.spheres {
            *sphere = Sphere::new(sphere.center() + at, sphere.radius());
        }
        scene.world.spheres.extend(extra);
        scene.world.material_ids.extend(extra.map(|_| 0));
        scene.sampling.max_bounces = 2;
        scene.view = Some(View {
            eye: at + Vec3::Z * 3.0 + Vec3::Y,
            target: at,
            up: Vec3::Y,
            vertical_fov: 40.0,
        });
        let rendered = render(&scene, settings(), device, QUIET).expect("the scene renders");
        rendered.image.pixels().to_vec()
    };
    let at = Vec3::new(1e6, -1e6, 1e6);
    for (name, device) in devices() {
        let near = pixels(Vec3::ZERO, None, device);
        assert!(near == pixels(at, None, device), "{name}");
        // A sphere that cannot be moved without an error keeps the scene where it is.
        let fixed = Sphere::new(Vec3::splat(0.1), 1e-3);
        assert!(near != pixels(at, Some(fixed), device), "{name}");
    }
}

/// A sun of irradiance E at the angle θ from the zenith gives E cos θ / π, a point of intensity I
/// at the distance d above gives I / π d².
#[test]
fn suns_and_points_light_grounds_of_every_size() {
    let pi = std::f64::consts::PI;
    for (ground, up) in grounds() {
        for size in [0.0, 0.5] {
            let mut place = Place::on(ground, up);
            let direction = (place.up * 0.8 + place.along * 0.6).as_vec3();
            place.scene.sky = Some(Surroundings {
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
            let name = format!("{size}, {ground}, {up}");
            assert_light(&place.scene, 2.0 * 0.8 / pi, &name);
        }
        let mut place = Place::on(ground, up);
        place.scene.lights.push(PointLight {
            position: place.point(0.0, 4.0),
            intensity: Vec3::splat(5.0),
        });
        assert_light(&place.scene, 5.0 / 16.0 / pi, &format!("{ground}, {up}"));
    }
}

/// A white ground under an even sky, at the distance x from where a ball of radius ρ stands on it:
/// the ball takes ρ³ / (x² + ρ²)^(3/2) of the light (Howell, B-11 again).
fn beside_a_ball(ground: f32, up: DVec3, x: f64) -> (Scene, f64) {
    let radius = 0.5;
    let mut place = Place::on(ground, up);
    let center = place.point(0.0, radius);
    place.scene.world.add(Sphere::new(center, radius as f32), 0);
    // From so low that the ball does not hide its shadow.
    place.look_from(x + 1.0, 0.05, x, 0.01);
    place.scene.sampling.ambient_occlusion = Some(1e3);
    let blocked = radius.powi(3) / (x * x + radius * radius).powf(1.5);
    (place.scene, 1.0 - blocked)
}

#[test]
fn shadows_touch_what_stands_on_grounds_of_every_size() {
    for (ground, up) in grounds().filter(|(ground, _)| *ground > 1.0) {
        for x in [0.1, 0.3, 1.0] {
            let (scene, expected) = beside_a_ball(ground, up, x);
            assert_light(&scene, expected, &format!("{x} on {ground}, {up}"));
        }
    }
    // Without what large spheres call for, it is not so.
    let (scene, expected) = beside_a_ball(EARTH, UPS[1], 0.3);
    assert!(scene.effects().any(Effects::LARGE_SPHERES));
    let without = Effects::ALL.without(Effects::LARGE_SPHERES);
    let settings = settings().effects(EffectChoice::Only(without));
    for (name, device) in devices() {
        assert!(!is_right(&scene, &settings, device, expected), "{name}");
    }
}

/// A white ball in a box whose walls are spheres that glow sees the same radiance everywhere.
#[test]
fn boxes_of_huge_spheres_lose_no_light() {
    for wall in [1e2, 1e4, 1e6] {
        let mut world = World::default();
        let white = world.add_material(Material::diffuse(Vec3::ONE));
        let glow = world.add_material(Material::emissive(Vec3::ONE));
        world.add(Sphere::new(Vec3::ZERO, 0.25), white);
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            for side in [-1.0, 1.0] {
                world.add(Sphere::new(axis * (side * (wall + 1.0)), wall), glow);
            }
        }
        let mut scene = Scene::new(world);
        (scene.width, scene.height) = (24, 24);
        scene.view = Some(View {
            eye: Vec3::Z * 0.9,
            target: Vec3::ZERO,
            up: Vec3::Y,
            vertical_fov: 30.0,
        });
        scene.sampling.samples = Some(64);
        scene.sampling.max_bounces = 1;
        assert_light(&scene, 1.0, &format!("walls of {wall}"));
    }
}

/// A sphere's place on the x axis, its radius, and its material.
type Ball = (f32, f32, Material);

/// What a camera sees straight through glass of index 1, along the x axis, of light of radiance 1.
fn through(spheres: &[Ball], eye: f32) -> Scene {
    let mut world = World::default();
    for (x, radius, material) in spheres {
        let id = world.add_material(*material);
        world.add(Sphere::new(Vec3::X * *x, *radius), id);
    }
    let lamp = world.add_material(Material::emissive(Vec3::ONE));
    world.add(Sphere::new(Vec3::X * 200.0, 100.0), lamp);
    let mut scene = Scene::new(world);
    (scene.width, scene.height) = (8, 8);
    scene.view = Some(View {
        eye: Vec3::X * eye,
        target: Vec3::X * 100.0,
        up: Vec3::Y,
        vertical_fov: 0.01,
    });
    scene.sampling.samples = Some(16);
    scene
}

/// Light is absorbed by the length of its way in each medium, e^(−Σ σ s), however glass lies in
/// glass; where spheres overlap, the smallest is the medium.
#[test]
fn beers_law_holds_in_nested_glass() {
    let glass = |sigma: f32| Material::glass(1.0, Vec3::splat(sigma));
    let hollow = |sigma: f32| Material::bubble(1.0, Vec3::splat(sigma));
    let (a, b) = (0.5_f32, 0.25);
    let cases: [(&str, Vec<Ball>, f32, f32); 11] = [
        ("a ball", vec![(0.0, 1.0, glass(a))], -9.0, 2.0 * a),
        (
            "a hollow ball",
            vec![(0.0, 1.0, glass(a)), (0.0, 0.5, hollow(a))],
            -9.0,
            a,
        ),
        (
            "air in a ball",
            vec![(0.0, 1.0, glass(a)), (0.2, 0.5, glass(0.0))],
            -9.0,
            a,
        ),
        (
            "a ball in a ball",
            vec![(0.0, 1.0, glass(a)), (0.0, 0.5, glass(b))],
            -9.0,
            a + b,
        ),
        (
            "a ball in air in a ball",
            vec![
                (0.0, 1.0, glass(a)),
                (0.0, 0.5, hollow(a)),
                (0.0, 0.25, glass(b)),
            ],
            -9.0,
            a + 0.5 * b,
        ),
        ("an eye in a ball", vec![(0.0, 1.0, glass(a))], 0.0, a),
        (
            "an eye in air in a ball",
            vec![(0.0, 1.0, glass(a)), (0.0, 0.5, hollow(a))],
            0.0,
            0.5 * a,
        ),
        (
            "balls of one glass that overlap",
            vec![(0.0, 1.0, glass(a)), (1.0, 1.0, glass(a))],
            -9.0,
            3.0 * a,
        ),
        (
            "balls of two glasses that overlap, the smaller first",
            vec![(0.0, 0.5, glass(a)), (1.0, 1.0, glass(b))],
            -9.0,
            a + 1.5 * b,
        ),
        (
            "and last",
            vec![(0.0, 1.0, glass(b)), (1.0, 0.5, glass(a))],
            -9.0,
            a + 1.5 * b,
        ),
        (
            "five balls in each other",
            (0..5)
                .map(|i| (0.0, 1.0 - 0.125 * i as f32, glass(0.125 * (i % 2) as f32)))
                .collect(),
            -9.0,
            2.0 * 0.125 * (0.125 + 0.125),
        ),
    ];
    for (name, spheres, eye, depth) in cases {
        let scene = through(&spheres, eye);
        assert_light(&scene, f64::from(-depth).exp(), name);
    }
}

/// A small lamp in the middle of a large glass ball shines on what is outside as much as without,
/// but for the share that the surface reflects.
#[test]
fn glass_adds_no_light() {
    let of = |index: Option<f32>, device: &Device| {
        let mut world = World::default();
        let lamp = world.add_material(Material::emissive(Vec3::ONE));
        world.add(Sphere::new(Vec3::ZERO, 0.02), lamp);
        if let Some(index) = index {
            let glass = world.add_material(Material::glass(index, Vec3::ZERO));
            world.add(Sphere::new(Vec3::ZERO, 1.0), glass);
        }
        let mut scene = Scene::new(world);
        (scene.width, scene.height) = (64, 64);
        scene.background = Vec3::ZERO;
        scene.view = Some(View {
            eye: Vec3::Z * 20.0,
            target: Vec3::ZERO,
            up: Vec3::Y,
            vertical_fov: 0.3,
        });
        scene.sampling.samples = Some(1024);
        let rendered = render(&scene, settings(), device, QUIET).expect("the scene renders");
        let pixels = rendered.image.pixels().iter();
        pixels
            .map(|pixel| f64::from(luminance(pixel.color())))
            .sum::<f64>()
    };
    for (name, device) in devices() {
        let bare = of(None, device);
        for index in [1.5_f32, 2.0] {
            let reflected = ((index - 1.0) / (index + 1.0)).powi(2);
            let share = of(Some(index), device) / bare;
            let expected = f64::from(1.0 - reflected);
            assert!(
                (share / expected - 1.0).abs() < 5e-3,
                "{index} on {name}: {share} {expected}"
            );
        }
    }
}

/// An eye in clear glass sees a sky of radiance 1 as it is.
#[test]
fn eyes_in_glass_see_no_more_light() {
    let mut scene = through(&[(0.0, 1.0, Material::glass(1.5, Vec3::ZERO))], 0.0);
    scene.world.spheres.truncate(1);
    scene.world.material_ids.truncate(1);
    scene.sky = Some(even_sky(Vec3::ONE));
    assert_light(&scene, 1.0, "a sky");
}

/// Clear glass in fog that only absorbs lets light through: it holds no fog.
#[test]
fn fog_is_outside_of_glass() {
    let mut scene = through(&[(0.0, 1.0, Material::glass(1.0, Vec3::ZERO))], -9.0);
    scene.fog = Some(spherule::scene::FogBall {
        medium: spherule::kernel::fog::Fog {
            radius: 2.0,
            extinction: 0.5,
            ..Default::default()
        },
    });
    scene.sampling.samples = Some(4096);
    // Two of the four scene units in the fog are in glass.
    assert_light(&scene, (-1.0_f64).exp(), "glass in fog");
}

/// With so many bounces a white floor under a white sky, given as a colour, as an image or as a
/// glowing sphere around all, is as bright.
#[test]
fn bounces_count_alike_for_every_light() {
    // Two white balls that see each other: each bounce adds light.
    let scene = |light: &str, max_bounces: u32| {
        let mut world = World::default();
        let white = world.add_material(Material::diffuse(Vec3::splat(0.9)));
        world.add(Sphere::new(Vec3::X, 1.0), white);
        world.add(Sphere::new(Vec3::NEG_X, 1.0), white);
        if light == "lamp" {
            let glow = world.add_material(Material::emissive(Vec3::ONE));
            world.add(Sphere::new(Vec3::ZERO, 50.0), glow);
        }
        let mut scene = Scene::new(world);
        (scene.width, scene.height) = (16, 16);
        scene.view = Some(View {
            eye: Vec3::Z * 20.0,
            target: Vec3::X * 0.5,
            up: Vec3::Y,
            vertical_fov: 1.0,
        });
        let image = EnvironmentImage {
            width: 4,
            height: 2,
            texels: vec![Vec3::ONE; 8],
        };
        if light != "lamp" {
            scene.sky = Some(Surroundings {
                horizon: Vec3::ONE,
                zenith: Vec3::ONE,
                sun: None,
                rotation: 0.0,
                image: (light == "image").then_some(image),
            });
        }
        scene.sampling.samples = Some(1024);
        scene.sampling.max_bounces = max_bounces;
        scene
    };
    for (name, device) in devices() {
        let mut before = 0.0;
        for max_bounces in [0, 1] {
            let (sky, error) = mean(&scene("sky", max_bounces), &settings(), device);
            assert!(
                sky > before + 4.0 * error,
                "{name}, {max_bounces}: {sky} {before}"
            );
            before = sky;
            for light in ["image", "lamp"] {
                let scene = scene(light, max_bounces);
                let (other, other_error) = mean(&scene, &settings(), device);
                assert!(
                    (sky - other).abs() < 4.0 * (error + other_error) + 1e-4,
                    "{light} on {name}, {max_bounces}: {other} {sky}"
                );
            }
        }
    }
}

/// The radiance of the sky at an elevation: the horizon's there and below, the zenith's above.
#[test]
fn the_sky_is_what_its_keys_say() {
    for (name, device) in devices() {
        for (y, expected) in [
            (-1.0_f32, 0.0_f32),
            (-0.5, 0.0),
            (0.0, 0.0),
            (0.5, 0.5),
            (1.0, 1.0),
        ] {
            let direction = Vec3::new((1.0 - y * y).sqrt(), y, 0.0);
            let mut scene = through(&[(0.0, 1.0, Material::metal(Vec3::ONE, 0.0))], 0.0);
            scene.world.spheres = vec![Sphere::new(-direction * 50.0, 1.0)];
            scene.world.material_ids = vec![0];
            scene.sky = Some(Surroundings {
                horizon: Vec3::X,
                zenith: Vec3::Z,
                sun: None,
                rotation: 0.0,
                image: None,
            });
            scene.view = Some(View {
                eye: Vec3::ZERO,
                target: direction,
                up: Vec3::new(0.3, 0.7, 0.2),
                vertical_fov: 0.01,
            });
            let rendered = render(&scene, settings(), device, QUIET).expect("the scene renders");
            let color = rendered.image.pixels()[0].color();
            let right = Vec3::new(1.0 - expected, 0.0, expected);
            assert!(
                (color - right).abs().max_element() < 1e-3,
                "{name}, {y}: {color}"
            );
        }
    }
}

/// However many rows an image has, its sampled light is as bright as it is: also next to the poles,
/// where cosines of polar angles have no digits left.
#[test]
fn images_of_many_rows_are_as_bright_as_they_are() {
    let (width, height) = (4_u32, 8192_u32);
    let mut texels = vec![Vec3::ZERO; (width * height) as usize];
    // A disc around the zenith, of 16 rows, of which the last is dimmed by interpolation.
    texels[..16 * width as usize].fill(Vec3::splat(1e4));
    let polar = |v: f64| std::f64::consts::PI * v / f64::from(height);
    let expected = 1e4 * (polar(16.0).sin().powi(2) + polar(0.5).powi(2) / 3.0);
    let mut place = Place::on(1.0, DVec3::Y);
    place.scene.sky = Some(Surroundings {
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
    assert_light(&place.scene, expected, "a disc");
}

/// Two hollow glass balls under a white sky lose less than half a per cent of the light by the
/// default limit on bounces.
#[test]
fn the_default_bounces_are_enough_for_hollow_glass() {
    let mut world = World::default();
    let glass = world.add_material(Material::glass(1.5, Vec3::ZERO));
    let hollow = world.add_material(Material::bubble(1.5, Vec3::ZERO));
    for x in [-1.05, 1.05] {
        world.add(Sphere::new(Vec3::X * x, 1.0), glass);
        world.add(Sphere::new(Vec3::X * x, 0.94), hollow);
    }
    let mut scene = Scene::new(world);
    (scene.width, scene.height) = (48, 24);
    scene.view = Some(View {
        eye: Vec3::new(0.0, 3.0, 8.0),
        target: Vec3::ZERO,
        up: Vec3::Y,
        vertical_fov: 14.0,
    });
    scene.sky = Some(even_sky(Vec3::ONE));
    scene.sampling.samples = Some(64);
    for (name, device) in devices() {
        let (lost, _) = mean(&scene, &settings(), device);
        assert!((0.995..1.0001).contains(&lost), "{name}: {lost}");
        let mut few = scene.clone();
        few.sampling.max_bounces = 8;
        let (lost, _) = mean(&few, &settings(), device);
        assert!(lost < 0.995, "{name}: {lost}");
    }
}

/// Copies of spheres change no bit of an image, with a tree and without one.
#[test]
fn copies_of_spheres_change_nothing() {
    for count in [2, 40] {
        let mut world = World::default();
        let white = world.add_material(Material::diffuse(Vec3::splat(0.8)));
        let glass = world.add_material(Material::glass(1.5, Vec3::ZERO));
        for at in 0..count {
            let angle = at as f32 * 2.4;
            let center = Vec3::new(angle.cos(), angle.sin(), 0.3 * angle.sin()) * 1.5;
            world.add(
                Sphere::new(center, 0.4),
                if at % 2 == 0 { white } else { glass },
            );
        }
        let mut scene = Scene::new(world);
        (scene.width, scene.height) = (32, 32);
        scene.sky = Some(even_sky(Vec3::ONE));
        scene.sampling.samples = Some(16);
        let mut doubled = scene.clone();
        doubled.world.append(&scene.world);
        for (name, device) in devices() {
            let pixels = |scene: &Scene| {
                let rendered = render(scene, settings(), device, QUIET).expect("the scene renders");
                rendered.image.pixels().to_vec()
            };
            assert!(pixels(&scene) == pixels(&doubled), "{count} on {name}");
        }
    }
}

/// Eighty lamps and points in a row, of which each place is near to few: it gets what all give it,
/// and since those few are chosen most of the time, without much noise.
#[test]
fn many_lamps_give_what_each_gives() {
    let mut place = Place::on(1e3, UPS[1]);
    let world = &mut place.scene.world;
    let glow = world.add_material(Material::emissive(Vec3::ONE));
    let (at, up, along) = (place.at, place.up, place.along);
    let mut expected = 0.0;
    for i in 0..80 {
        let (x, height) = (f64::from(i) * 0.5 - 3.0, 0.4 + 0.01 * f64::from(i % 7));
        let center = (at + along * x + up * height).as_vec3();
        let towards = center.as_dvec3() - at;
        let squared = towards.length_squared();
        let cosine = towards.dot(up) / squared.sqrt();
        let radius = 0.02 + 0.001 * (i % 5) as f32;
        if i % 4 == 0 {
            let intensity = 1e-3;
            place.scene.lights.push(PointLight {
                position: center,
                intensity: Vec3::splat(intensity),
            });
            expected += f64::from(intensity) * cosine / squared / std::f64::consts::PI;
        } else {
            place.scene.world.add(Sphere::new(center, radius), glow);
            expected += f64::from(radius).powi(2) / squared * cosine;
        }
    }
    place.look_from(0.0, 0.2, 0.0, 0.25);
    assert!(place.scene.effects().any(Effects::MANY_LIGHTS));
    assert_light(&place.scene, expected, "many lamps");
    // By power alone the noise is 24 % here.
    place.scene.sampling.samples = Some(16);
    for (name, device) in devices() {
        let (mean, error) = mean(&place.scene, &settings(), device);
        let pixels = f64::from(place.scene.width * place.scene.height);
        let noise = error * pixels.sqrt() / mean;
        println!("{name}: noise {noise}");
        assert!(noise < 0.12, "{name}: {noise}");
    }
}
