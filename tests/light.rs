//! Light that falls on surfaces of every size, compared with closed forms, on the CPU and on every
//! GPU adapter: on grounds of radius 1 to that of the Earth, from lamps down to a thousandth, and
//! far from the origin.

mod common;

use common::devices;
use glam::{DVec3, Vec3};
use spherule::kernel::color::luminance;
use spherule::kernel::filter::Filter;
use spherule::kernel::{Effects, Material, Rung, Sphere};
use spherule::render::{EffectChoice, QUIET, Settings, render};
use spherule::scene::surroundings::{
    EnvironmentImage, GlassShadows, PointLight, Sun, Surroundings,
};
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

/// A sphere above the place: how far along the ground, how high, its radius and its material.
type Above = (f64, f64, f32, Material);

/// A white place 4 below a point of intensity 5, with spheres above it.
fn below(spheres: &[Above], shadows: GlassShadows) -> Place {
    let mut place = Place::on(1e3, UPS[1]);
    for (along, height, radius, material) in spheres {
        let id = place.scene.world.add_material(*material);
        let center = place.point(*along, *height);
        place.scene.world.add(Sphere::new(center, *radius), id);
    }
    place.scene.lights.push(PointLight {
        position: place.point(0.0, 4.0),
        intensity: Vec3::splat(5.0),
    });
    place.scene.sampling.samples = Some(16);
    place.scene.sampling.glass_shadows = shadows;
    place
}

/// What an even point of intensity 5 at a distance of 4 gives.
const UNSHADED: f64 = 5.0 / 16.0 / std::f64::consts::PI;

/// The share of light that a surface of glass of index n lets through at this angle: Fresnel's
/// equations.
fn let_through(index: f64, sine: f64) -> f64 {
    let (inside, outside) = (
        (1.0 - (sine / index).powi(2)).sqrt(),
        (1.0 - sine * sine).sqrt(),
    );
    let s = (outside - index * inside) / (outside + index * inside);
    let p = (index * outside - inside) / (index * outside + inside);
    1.0 - 0.5 * (s * s + p * p)
}

/// Light without extent goes straight through glass on request: it is absorbed by the length of its
/// way and loses what surfaces reflect. Otherwise glass blocks it, and what is not glass always
/// does.
#[test]
fn clear_shadows_are_what_glass_leaves_of_the_light() {
    let glass = |index: f32, sigma: f32| Material::glass(index, Vec3::splat(sigma));
    let hollow = |index: f32, sigma: f32| Material::bubble(index, Vec3::splat(sigma));
    let sigma = 0.75;
    let a = f64::from(sigma);
    let straight = let_through(1.5, 0.0);
    let cases: [(&str, Vec<Above>, f64); 9] = [
        (
            "a ball",
            vec![(0.0, 3.0, 0.5, glass(1.0, sigma))],
            (-a).exp(),
        ),
        (
            "a hollow ball",
            vec![
                (0.0, 3.0, 0.5, glass(1.0, sigma)),
                (0.0, 3.0, 0.25, hollow(1.0, sigma)),
            ],
            (-0.5 * a).exp(),
        ),
        (
            "two balls",
            vec![
                (0.0, 2.75, 0.25, glass(1.0, sigma)),
                (0.0, 3.5, 0.375, glass(1.0, sigma)),
            ],
            (-1.25 * a).exp(),
        ),
        (
            "two balls that overlap",
            vec![
                (0.0, 2.75, 0.25, glass(1.0, 0.0)),
                (0.0, 3.0, 0.5, glass(1.0, sigma)),
            ],
            (-0.5 * a).exp(),
        ),
        (
            "a ball that reflects",
            vec![(0.0, 3.0, 0.5, glass(1.5, sigma))],
            (-a).exp() * straight.powi(2),
        ),
        (
            "a hollow ball that reflects",
            vec![
                (0.0, 3.0, 0.5, glass(1.5, 0.0)),
                (0.0, 3.0, 0.25, hollow(1.5, 0.0)),
            ],
            straight.powi(4),
        ),
        (
            "a ball beside the middle",
            vec![(-0.375, 3.0, 0.5, glass(1.5, sigma))],
            (-a * (0.25_f64 - 0.375 * 0.375).sqrt() * 2.0).exp() * let_through(1.5, 0.75).powi(2),
        ),
        (
            "a ball around the light",
            vec![(0.0, 4.0, 0.5, glass(1.5, sigma))],
            (-0.5 * a).exp() * straight,
        ),
        (
            "a ball and chalk",
            vec![
                (0.0, 3.0, 0.5, glass(1.0, 0.0)),
                (0.0, 3.75, 0.125, Material::diffuse(Vec3::ONE)),
            ],
            0.0,
        ),
    ];
    for (name, spheres, share) in cases {
        let clear = below(&spheres, GlassShadows::Clear).scene;
        assert!(clear.effects().any(Effects::CLEAR_SHADOWS));
        assert_light(&clear, share * UNSHADED, name);
        let dark = below(&spheres, GlassShadows::Dark).scene;
        assert!(!dark.effects().any(Effects::CLEAR_SHADOWS));
        assert_light(&dark, 0.0, name);
    }
}

/// A sun without extent shines through glass as a point does; a place that is in glass itself gets
/// what the way there leaves, and fog is outside of glass.
#[test]
fn clear_shadows_are_of_suns_in_glass_and_in_fog_too() {
    let ball: Above = (0.0, 3.0, 0.5, Material::glass(1.0, Vec3::splat(0.75)));
    let mut place = below(&[ball], GlassShadows::Clear);
    place.scene.lights.clear();
    place.scene.sky = Some(Surroundings {
        sun: Some(Sun {
            direction: place.up.as_vec3(),
            size: 0.0,
            irradiance: Vec3::splat(2.0),
        }),
        ..even_sky(Vec3::ZERO)
    });
    let share = (-0.75_f64).exp();
    assert_light(&place.scene, 2.0 / std::f64::consts::PI * share, "a sun");

    let around: Above = (0.0, 0.0, 1.5, Material::glass(1.0, Vec3::splat(0.25)));
    let mut place = below(&[around], GlassShadows::Clear);
    place.scene.sampling.max_bounces = 2;
    // To the eye and to the light.
    let share = (-0.25 * (1.5_f64 + 1.5)).exp();
    assert_light(&place.scene, UNSHADED * share, "in glass");

    let clear: Above = (0.0, 3.0, 0.5, Material::glass(1.0, Vec3::ZERO));
    let mut place = below(&[clear], GlassShadows::Clear);
    place.scene.sampling.samples = Some(1024);
    place.scene.fog = Some(spherule::scene::FogBall {
        medium: spherule::kernel::fog::Fog {
            radius: 50.0,
            extinction: 0.25,
            ..Default::default()
        },
    });
    let way = (2.0_f64 * 2.0 + 0.5 * 0.5).sqrt() + 3.0;
    assert_light(&place.scene, UNSHADED * (-0.25 * way).exp(), "in fog");
}

/// Lights with extent shine through glass by chance, and not once more.
#[test]
fn clear_shadows_change_no_light_with_extent() {
    let scene = |shadows: GlassShadows| {
        let ball: Above = (0.0, 2.0, 0.5, Material::glass(1.0, Vec3::splat(0.5)));
        let mut place = below(&[ball], shadows);
        place.add_lamp(0.5);
        // A light that gives none calls for the effect.
        place.scene.lights[0].intensity = Vec3::ZERO;
        place.scene.sampling.max_bounces = 4;
        place.scene
    };
    let clear = scene(GlassShadows::Clear);
    assert!(clear.effects().any(Effects::CLEAR_SHADOWS));
    for (name, device) in devices() {
        let pixels = |scene: &Scene| {
            let rendered = render(scene, settings(), device, QUIET).expect("the scene renders");
            rendered.image.pixels().to_vec()
        };
        assert!(
            pixels(&clear) == pixels(&scene(GlassShadows::Dark)),
            "{name}"
        );
        let (light, _) = mean(&clear, &settings(), device);
        assert!(light > 0.0, "{name}: {light}");
    }
}

/// Light passes a thousand surfaces and no more, so that its way ends.
#[test]
fn clear_shadows_have_an_end() {
    for (count, share) in [(500, 1.0), (520, 0.0)] {
        let ball = |at: usize| -> Above {
            let height = 2.5 + 1.4 * at as f64 / count as f64;
            (0.0, height, 1e-3, Material::glass(1.0, Vec3::ZERO))
        };
        let spheres: Vec<Above> = (0..count).map(ball).collect();
        let mut scene = below(&spheres, GlassShadows::Clear).scene;
        scene.sampling.samples = Some(1);
        scene.view = scene.view.map(|view| View {
            vertical_fov: 1e-3,
            ..view
        });
        let rendered = render(&scene, settings(), &Device::Cpu, QUIET).expect("the scene renders");
        let middle = f64::from(rendered.image.pixels()[12 * 24 + 12].color().x);
        let expected = share * UNSHADED;
        assert!(
            (middle - expected).abs() <= 1e-3 * expected,
            "{count}: {middle}"
        );
    }
}

/// A pixel's share of a filter below an edge, at `edge` pixels from the pixel's middle.
fn share_below(filter: Filter, edge: f64) -> f64 {
    let at = (2.0 * edge / f64::from(filter.width)).clamp(-1.0, 1.0);
    let density = |place: f64| match filter.kind {
        Filter::GAUSSIAN => (-4.5 * place * place).exp(),
        Filter::BLACKMAN_HARRIS => {
            let wave = |n: f64| (n * std::f64::consts::PI * place).cos();
            0.35875 + 0.48829 * wave(1.0) + 0.14128 * wave(2.0) + 0.01168 * wave(3.0)
        }
        _ => 1.0,
    };
    let steps = 1000;
    let below = |end: f64| {
        let middle = |step: i32| -1.0 + (end + 1.0) * (f64::from(step) + 0.5) / f64::from(steps);
        (0..steps).map(|step| density(middle(step))).sum::<f64>() * (end + 1.0)
    };
    below(at) / below(1.0)
}

/// A straight edge is shown as the filter's integral, wherever it is in a pixel.
#[test]
fn filters_show_edges_as_their_integrals() {
    const SIZE: u32 = 9;
    let wide = Filter::new(Filter::BOX, 2.0);
    let filters = Filter::NAMED.map(|(_, filter)| filter);
    for filter in filters.into_iter().chain([wide]) {
        for offset in [0.0, 0.3, 0.75] {
            // The sphere touches the ray through the edge, which is so many pixels below the
            // middle of the image, and so it is at the left and the right.
            let pixel = 2.0 * 10_f64.to_radians().tan() / f64::from(SIZE);
            let dip = (offset * pixel).atan();
            let radius = 1e4;
            let mut world = World::default();
            let glow = world.add_material(Material::emissive(Vec3::ONE));
            let center = Vec3::NEG_Y * (radius / dip.cos()) as f32;
            world.add(Sphere::new(center, radius as f32), glow);
            let mut scene = Scene::new(world);
            (scene.width, scene.height) = (1, SIZE);
            scene.background = Vec3::ZERO;
            scene.view = Some(View {
                eye: Vec3::ZERO,
                target: Vec3::NEG_Z,
                up: Vec3::Y,
                vertical_fov: 20.0,
            });
            scene.sampling.samples = Some(4096);
            scene.sampling.filter = filter;
            for (name, device) in devices() {
                let rendered =
                    render(&scene, settings(), device, QUIET).expect("the scene renders");
                for (row, found) in rendered.image.pixels().iter().enumerate() {
                    let middle = row as f64 + 0.5 - 0.5 * f64::from(SIZE);
                    let expected = share_below(filter, middle - offset);
                    let found = f64::from(found.color().x);
                    assert!(
                        (found - expected).abs() < 2e-3,
                        "{filter:?}, {offset}, {row} on {name}: {found} {expected}"
                    );
                }
            }
        }
    }
}

/// What is the same everywhere stays as it is, with every filter, up to the image's edge.
#[test]
fn filters_keep_an_even_sky() {
    let mut scene = through(&[(-50.0, 1.0, Material::diffuse(Vec3::ONE))], 0.0);
    scene.world.spheres.truncate(1);
    scene.world.material_ids.truncate(1);
    scene.sky = Some(even_sky(Vec3::new(0.25, 0.5, 2.0)));
    for (filter_name, filter) in Filter::NAMED {
        scene.sampling.filter = filter;
        assert_eq!(
            scene.effects().any(Effects::FILTER),
            filter.kind != Filter::BOX
        );
        for (name, device) in devices() {
            let rendered = render(&scene, settings(), device, QUIET).expect("the scene renders");
            let mut pixels = rendered.image.pixels().iter();
            let is_even = pixels.all(|pixel| pixel.color() == Vec3::new(0.25, 0.5, 2.0));
            assert!(is_even, "{filter_name} on {name}");
        }
    }
}

/// A white floor, half of it in the shadow of a glass ball that is out of sight, under a small
/// lamp: through the ball a path meets the lamp by chance alone.
fn with_bright_dots(clamp: Option<f32>) -> Scene {
    let mut world = World::default();
    let white = world.add_material(Material::diffuse(Vec3::splat(0.8)));
    let glass = world.add_material(Material::glass(1.5, Vec3::ZERO));
    let lamp = world.add_material(Material::emissive(Vec3::new(40.0, 20.0, 10.0)));
    world.add(Sphere::new(Vec3::NEG_Y * 100.0, 100.0), white);
    world.add(Sphere::new(Vec3::Y, 1.0), glass);
    world.add(Sphere::new(Vec3::new(2.0, 5.0, 1.0), 0.5), lamp);
    let mut scene = Scene::new(world);
    (scene.width, scene.height) = (48, 32);
    scene.background = Vec3::ZERO;
    scene.view = Some(View {
        eye: Vec3::new(-4.0, 2.0, -2.0),
        target: Vec3::new(-1.6, 0.0, -0.8),
        up: Vec3::Y,
        vertical_fov: 12.0,
    });
    scene.sampling.samples = Some(64);
    scene.sampling.max_bounces = 8;
    scene.sampling.clamp = clamp;
    scene
}

/// Indirect light is limited: no pixel becomes brighter, the noise is less, and a limit that is
/// never reached, or none, changes nothing.
#[test]
fn the_clamp_takes_bright_dots_away() {
    let none = with_bright_dots(None);
    assert!(!none.effects().any(Effects::CLAMP));
    for (name, device) in devices() {
        let image = |clamp: Option<f32>| {
            let scene = with_bright_dots(clamp);
            let rendered = render(&scene, settings(), device, QUIET).expect("the scene renders");
            let pixels = rendered.image.pixels().iter();
            let colors: Vec<Vec3> = pixels.map(|pixel| pixel.color()).collect();
            let light: f64 = colors.iter().map(|c| f64::from(luminance(*c))).sum();
            let noise = rendered.reached.expect("samples").noise * light;
            (colors, light, noise, rendered.image.remarks)
        };
        let (plain, light, noise, remarks) = image(None);
        assert!(remarks.is_empty(), "{name}: {remarks}");
        let (clamped, less, less_noise, remarks) = image(Some(0.5));
        assert!(remarks.contains("clamp = 0.5"), "{name}: {remarks}");
        assert!(
            less < light && less_noise < 0.5 * noise,
            "{name}: {light} ± {noise}, {less} ± {less_noise}"
        );
        let (unreached, ..) = image(Some(1e12));
        for ((plain, clamped), unreached) in plain.iter().zip(&clamped).zip(&unreached) {
            let rounding = *plain * 1e-5 + Vec3::splat(1e-6);
            assert!(
                clamped.cmple(*plain + rounding).all()
                    && (*unreached - *plain).abs().cmple(rounding).all(),
                "{name}: {plain}, {clamped}, {unreached}"
            );
        }
    }
}

/// A pixel of one sample gets no more indirect light than the limit, of the same hue, and all of
/// its direct light. Without indirect light an image is that of no bounces.
#[test]
fn the_clamp_is_of_indirect_light_alone() {
    for (name, device) in devices() {
        let colors = |clamp: f32| -> Vec<Vec3> {
            let mut scene = with_bright_dots(Some(clamp));
            (scene.width, scene.height) = (192, 128);
            scene.sampling.samples = Some(1);
            let rendered = render(&scene, settings(), device, QUIET).expect("the scene renders");
            let pixels = rendered.image.pixels().iter();
            pixels.map(|pixel| pixel.color()).collect()
        };
        let (all, some, direct) = (colors(1e12), colors(0.25), colors(1e-30));
        let mut limited = 0;
        for ((all, some), direct) in all.iter().zip(&some).zip(&direct) {
            let (indirect, left) = (*all - *direct, *some - *direct);
            let rounding = 1e-5 * all.max_element() + 1e-6;
            let brightest = indirect.max_element();
            let expected = indirect
                * if brightest > 0.25 {
                    0.25 / brightest
                } else {
                    1.0
                };
            assert!(
                (left - expected).abs().max_element() <= rounding,
                "{name}: {left} {expected}"
            );
            limited += u32::from(brightest > 0.25);
        }
        assert!(limited > 0, "{name}");
        let mut scene = with_bright_dots(Some(1e-30));
        let (direct, error) = mean(&scene, &settings(), device);
        scene.sampling.clamp = None;
        scene.sampling.max_bounces = 0;
        let (no_bounces, other) = mean(&scene, &settings(), device);
        assert!(
            (direct - no_bounces).abs() < 0.05 * no_bounces,
            "{name}: {direct} ± {error}, {no_bounces} ± {other}"
        );
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
