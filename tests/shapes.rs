//! Shapes beside spheres: each rung against exact arithmetic, the tree against every shape, devices
//! against each other, and light that must stay what it is.

mod common;

use std::path::Path;

use common::{all_adapters, device, devices, in_furnace};
use glam::{DVec3, Quat, Vec3};
use spherule::accel::ShapeTree;
use spherule::accuracy::shape_families::{Family, Known, ShapeErrors, measure};
use spherule::film::agreement::Agreement;
use spherule::film::compare::{Comparison, Tolerance};
use spherule::kernel::shape::among::Resting;
use spherule::kernel::shape::{Capsule, Cone, Cuboid, Cylinder, Disc, Ellipsoid, Kinds, Shape};
use spherule::kernel::{Hit, Material, Ray, Rung, Shading, Sphere};
use spherule::render::{QUIET, Settings, render};
use spherule::scene::shapes::RUNGS_OF_SHAPES;
use spherule::scene::{View, World};
use spherule::{Device, Image, Scene};

/// How many rays of each family; `SPHERULE_RAYS` says another number.
fn rays() -> usize {
    let asked = std::env::var("SPHERULE_RAYS").ok();
    asked.map_or(20_000, |text| text.parse().expect("a number of rays"))
}

/// What a rung may be off by: wrong classes, and the error of t in units in the last place.
fn is_allowed(rung: Rung, errors: &ShapeErrors) -> bool {
    match rung {
        Rung::Double => errors.false_hits + errors.missed == 0 && errors.ulps <= 1,
        // Measured: at most 5 of 20,000, for cones far away.
        Rung::Robust => errors.false_hits.max(errors.missed) <= rays() / 1000,
        Rung::Textbook | Rung::Compensated | Rung::Certified => true,
    }
}

/// Prints the table of docs/numerics.md.
#[test]
fn each_rung_keeps_its_promise_on_every_family() {
    println!("| device | shape | rung | hits | false | missed | worst ulp by family |");
    for (of, device) in devices() {
        for (kind, name) in Kinds::NAMED {
            for rung in RUNGS_OF_SHAPES {
                if rung == Rung::Double && !device.has_f64() {
                    continue;
                }
                let mut sum = ShapeErrors::default();
                let mut worst = Vec::new();
                for family in Family::ALL {
                    let samples = family.sample(*kind, 7, rays());
                    let errors = measure(device, rung, &samples).expect("answers");
                    let said = format!("{of}, {name}, {family:?}, {}: {errors:?}", rung.name());
                    assert!(
                        errors.hits > rays() / 8 && is_allowed(rung, &errors),
                        "{said}"
                    );
                    sum.hits += errors.hits;
                    sum.false_hits += errors.false_hits;
                    sum.missed += errors.missed;
                    worst.push(errors.ulps.to_string());
                }
                println!(
                    "| {of} | {name} | `{}` | {} | {} | {} | {} |",
                    rung.name(),
                    sum.hits,
                    sum.false_hits,
                    sum.missed,
                    worst.join(", ")
                );
            }
        }
    }
}

/// What is promised of double is not true of textbook: the check can fail.
#[test]
fn the_textbook_loses_what_double_keeps() {
    for (kind, name) in Kinds::NAMED {
        let samples = Family::Far.sample(*kind, 7, rays());
        let errors = measure(&Device::Cpu, Rung::Textbook, &samples).expect("answers");
        assert!(!is_allowed(Rung::Double, &errors), "{name} {errors:?}");
    }
}

/// Rays and shapes for which the answer is known without an oracle, too.
#[test]
#[expect(clippy::too_many_lines, reason = "one table, an entry a ray")]
fn named_rays_have_named_answers() {
    let along = Vec3::new(0.0, 0.0, -1.0);
    let from = |origin: Vec3| Ray::new(origin, along);
    let eye = from(Vec3::ZERO);
    let rod = Capsule::new(Vec3::new(0.0, 0.0, -3.0), Vec3::new(0.0, 0.0, -5.0), 0.5);
    let lying = Capsule::new(Vec3::new(-1.0, 0.0, -3.0), Vec3::new(1.0, 0.0, -3.0), 0.5);
    let can = Cylinder::new(Vec3::new(0.0, 0.0, -3.0), Vec3::new(0.0, 0.0, -5.0), 0.5);
    let across = Cylinder::new(Vec3::new(-1.0, 0.0, -3.0), Vec3::new(1.0, 0.0, -3.0), 0.5);
    let tip = Cone::new(
        Vec3::new(0.0, 0.0, -3.0),
        Vec3::new(0.0, 0.0, -5.0),
        0.0,
        0.5,
    );
    let base = Cone::new(
        Vec3::new(0.0, 0.0, -3.0),
        Vec3::new(0.0, 0.0, -5.0),
        0.5,
        0.0,
    );
    let grain = Ellipsoid::new(
        Vec3::new(0.0, 0.0, -3.0),
        Vec3::new(1.0, 1.0, 0.5),
        Quat::IDENTITY,
    );
    let cell = Cuboid::new(
        Vec3::new(0.0, 0.0, -3.0),
        Vec3::new(1.0, 1.0, 0.5),
        Quat::IDENTITY,
    );
    let disc = Disc::new(Vec3::new(0.0, 0.0, -3.0), Vec3::new(0.0, 0.0, 7.0), 1.0);
    let known: &[(&str, Known, Ray, Option<f32>)] = &[
        ("along a capsule", Known::Capsule(rod), eye, Some(2.5)),
        ("beside it", Known::Capsule(rod), from(Vec3::X * 0.6), None),
        (
            "touching along its axis",
            Known::Capsule(rod),
            from(Vec3::X * 0.5),
            Some(3.0),
        ),
        ("across it", Known::Capsule(lying), eye, Some(2.5)),
        (
            "at its seam",
            Known::Capsule(lying),
            from(Vec3::X),
            Some(2.5),
        ),
        (
            "through its end",
            Known::Capsule(lying),
            from(Vec3::X * 1.3),
            Some(2.6),
        ),
        (
            "touching its end",
            Known::Capsule(lying),
            from(Vec3::X * 1.5),
            Some(3.0),
        ),
        (
            "beyond its end",
            Known::Capsule(lying),
            from(Vec3::X * 1.501),
            None,
        ),
        (
            "from inside",
            Known::Capsule(lying),
            from(Vec3::new(0.0, 0.0, -3.0)),
            Some(0.5),
        ),
        (
            "touching from above",
            Known::Capsule(lying),
            from(Vec3::Y * 0.5),
            Some(3.0),
        ),
        ("along a cylinder", Known::Cylinder(can), eye, Some(3.0)),
        (
            "along its rim",
            Known::Cylinder(can),
            from(Vec3::X * 0.5),
            Some(3.0),
        ),
        (
            "beside the rim",
            Known::Cylinder(can),
            from(Vec3::X * 0.500_001),
            None,
        ),
        ("across it", Known::Cylinder(across), eye, Some(2.5)),
        (
            "along its end",
            Known::Cylinder(across),
            from(Vec3::X),
            Some(2.5),
        ),
        (
            "beyond its end",
            Known::Cylinder(across),
            from(Vec3::X * 1.000_001),
            None,
        ),
        ("onto the tip of a cone", Known::Cone(tip), eye, Some(3.0)),
        (
            "beside the tip",
            Known::Cone(tip),
            from(Vec3::X * 0.25),
            Some(4.0),
        ),
        (
            "along its rim",
            Known::Cone(tip),
            from(Vec3::X * 0.5),
            Some(5.0),
        ),
        ("onto its base", Known::Cone(base), eye, Some(3.0)),
        (
            "beside the base",
            Known::Cone(base),
            from(Vec3::X * 0.75),
            None,
        ),
        ("onto an ellipsoid", Known::Ellipsoid(grain), eye, Some(2.5)),
        (
            "touching it",
            Known::Ellipsoid(grain),
            from(Vec3::X),
            Some(3.0),
        ),
        (
            "beside it",
            Known::Ellipsoid(grain),
            from(Vec3::X * 1.000_001),
            None,
        ),
        ("onto a box", Known::Box(cell), eye, Some(2.5)),
        ("along its side", Known::Box(cell), from(Vec3::X), Some(2.5)),
        (
            "along its edge",
            Known::Box(cell),
            from(Vec3::new(1.0, 1.0, 0.0)),
            Some(2.5),
        ),
        (
            "beside it",
            Known::Box(cell),
            from(Vec3::X * 1.000_001),
            None,
        ),
        (
            "onto a disc",
            Known::Disc(disc),
            from(Vec3::X * 0.5),
            Some(3.0),
        ),
        ("onto its rim", Known::Disc(disc), from(Vec3::X), Some(3.0)),
        (
            "beside it",
            Known::Disc(disc),
            from(Vec3::X * 1.000_001),
            None,
        ),
        (
            "in its plane",
            Known::Disc(disc),
            Ray::new(Vec3::new(-3.0, 0.0, -3.0), Vec3::X),
            None,
        ),
    ];
    for (name, known, ray, expected) in known {
        assert_eq!(
            known.exact().exact_hit(ray),
            *expected,
            "the oracle, {name}"
        );
        let shape = known.shape();
        for rung in [Rung::Robust, Rung::Double] {
            let t = shape.span(rung.to_u32(), shape.kinds(), ray).first(ray);
            let found = (t < Hit::NONE_T).then_some(t);
            assert_eq!(found, *expected, "{}, {name}", rung.name());
        }
    }
}

/// Where shapes are so far away that t has no digit of them, or so large that it has them all.
#[test]
fn shapes_a_million_away_keep_their_silhouettes() {
    for scale in [1.0_f32, 1e-3, 1e6, 1e15] {
        let at = Vec3::new(0.0, 0.0, -1e6) * scale;
        let shapes = [
            Known::Capsule(Capsule::new(
                at - Vec3::X * scale,
                at + Vec3::X * scale,
                0.5 * scale,
            )),
            Known::Cylinder(Cylinder::new(
                at - Vec3::X * scale,
                at + Vec3::X * scale,
                0.5 * scale,
            )),
            Known::Ellipsoid(Ellipsoid::new(
                at,
                Vec3::new(1.0, 0.5, 0.25) * scale,
                Quat::IDENTITY,
            )),
            Known::Box(Cuboid::new(
                at,
                Vec3::new(1.0, 0.5, 0.25) * scale,
                Quat::IDENTITY,
            )),
        ];
        for known in shapes {
            let shape = known.shape();
            for step in 0..200 {
                let aim = at + Vec3::Y * (scale * (0.4 + 0.001 * step as f32));
                let ray = Ray::new(Vec3::ZERO, aim / (1e6 * scale));
                let exact = known.exact().exact_hit(&ray);
                let double = shape
                    .span(Rung::Double.to_u32(), shape.kinds(), &ray)
                    .first(&ray);
                assert_eq!(
                    (double < Hit::NONE_T).then_some(double),
                    exact,
                    "{known:?} {step}"
                );
                let robust = shape
                    .span(Rung::Robust.to_u32(), shape.kinds(), &ray)
                    .first(&ray);
                // Within 64u of the distance, which is four units of a thousandth here, on both
                // sides of the silhouette.
                let is_certain = !(95..=105).contains(&step);
                assert!(
                    !is_certain || (robust < Hit::NONE_T) == exact.is_some(),
                    "{known:?} {step} {robust:e} {exact:?}"
                );
            }
        }
    }
}

/// A world of shapes of every kind, and rays: from outside, and from shapes.
fn crowd() -> (World, Vec<Ray>) {
    let mut world = World::default();
    let grey = world.add_material(Material::diffuse(Vec3::splat(0.5)));
    for (kind, _) in Kinds::NAMED {
        for (_, known) in Family::Generic.sample(*kind, 11, 300) {
            world.add_shape(known.shape(), grey);
        }
        for (_, known) in Family::Thin.sample(*kind, 12, 60) {
            world.add_shape(known.shape(), grey);
        }
    }
    let rays = Family::Generic.sample(Kinds::CAPSULE, 13, 2000);
    (world, rays.into_iter().map(|(ray, _)| ray).collect())
}

/// A ray finds in the tree what it finds among all shapes. On the textbook's rung a tree leaves out
/// hits that are far from their shape: what is off without a bound is outside of any box.
#[test]
fn the_tree_loses_no_shape() {
    let (world, rays) = crowd();
    let tree = ShapeTree::of(&world, (0.0, 0.0));
    assert_eq!(tree.shapes.len(), world.shapes.len());
    let shapes = tree.shapes(0);
    let mut hits = 0;
    for rung in RUNGS_OF_SHAPES {
        for ray in &rays {
            let mut nearest = Hit::NONE;
            for (index, shape) in tree.shapes.iter().enumerate() {
                let t = shape.span(rung.to_u32(), tree.kinds, ray).first(ray);
                let (low, high) = shape.bounds();
                let at = ray.at(t);
                let is_near = rung != Rung::Textbook
                    || (at.cmpge(low - 1e-3).all() && at.cmple(high + 1e-3).all());
                if t < nearest.t && is_near {
                    nearest = Hit {
                        t,
                        sphere: index as u32,
                    };
                }
            }
            let none = Hit::NONE_SPHERE;
            let found = shapes.nearest_hit(rung.to_u32(), ray, Hit::NONE, none, Resting);
            if rung == Rung::Textbook && found.is_some() && found.t < nearest.t {
                // Far from its shape, but within a box.
                continue;
            }
            assert_eq!(found, nearest, "{} {ray:?}", rung.name());
            let is_hit = shapes.are_hit(rung.to_u32(), ray, none, Resting);
            assert_eq!(is_hit, nearest.is_some(), "{} {ray:?}", rung.name());
            hits += usize::from(nearest.is_some());
        }
    }
    assert!(hits > rays.len(), "{hits}");
}

/// A ray that leaves a shape outwards does not meet it again, and one that goes in meets it where
/// it comes out: also where it all but touches, and with its own error of t.
#[test]
fn rays_that_leave_a_shape_meet_only_what_is_ahead() {
    for (kind, name) in Kinds::NAMED {
        if *kind == Kinds::DISC {
            continue;
        }
        let mut counts = [0; 2];
        for (ray, known) in Family::Generic.sample(*kind, 17, 3000) {
            let (shape, kinds) = (known.shape(), *kind);
            for rung in [Rung::Robust, Rung::Double] {
                let rung = rung.to_u32();
                let t = shape.span(rung, kinds, &ray).first(&ray);
                if t == Hit::NONE_T {
                    continue;
                }
                let surface = shape.surface(kinds, &ray, t);
                let length = surface.normal.length();
                assert!((length - 1.0).abs() < 1e-5, "{name} {surface:?}");
                for towards in [surface.normal, -surface.normal, ray.direction] {
                    let from = Ray::within(
                        surface.point,
                        towards.normalize(),
                        f32::MIN_POSITIVE,
                        Hit::NONE_T,
                    );
                    let cosine = towards.normalize().dot(surface.normal);
                    let exit = shape.span(rung, kinds, &from).exit(&from);
                    if cosine > 0.1 {
                        assert_eq!(exit, Hit::NONE_T, "{name} {from:?} {shape:?}");
                        counts[0] += 1;
                    } else if cosine < -0.1 {
                        assert!(exit < Hit::NONE_T, "{name} {from:?} {shape:?}");
                        counts[1] += 1;
                    }
                }
            }
        }
        assert!(counts[0] > 1000 && counts[1] > 1000, "{name} {counts:?}");
    }
}

/// A point that a ray hits is on the surface, inside of the bounds, and of what contains it.
#[test]
fn a_hit_is_on_the_surface_and_within_the_bounds() {
    for (kind, name) in Kinds::NAMED {
        for (ray, known) in Family::Generic.sample(*kind, 19, 5000) {
            let shape = known.shape();
            let t = shape.span(Rung::Double.to_u32(), *kind, &ray).first(&ray);
            if t == Hit::NONE_T {
                continue;
            }
            let surface = shape.surface(*kind, &ray, t);
            let at: DVec3 = ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(t);
            let off = (surface.point.as_dvec3() - at).length();
            // t is rounded, and so is the point.
            let rounding = f64::from(t) * f64::from(ray.direction.length()) * 1e-6;
            assert!(off < rounding + 1e-5, "{name} {off:e} {ray:?} {shape:?}");
            let (low, high) = shape.bounds();
            let error = Vec3::splat(surface.error + 1e-5);
            let is_within =
                surface.point.cmpge(low - error).all() && surface.point.cmple(high + error).all();
            assert!(is_within, "{name} {surface:?} {low} {high}");
            if *kind != Kinds::DISC {
                let inner = surface.point - surface.normal * (shape.thickness(*kind) * 1e-3);
                assert!(shape.contains(inner), "{name} {surface:?} {shape:?}");
            }
            let outer = surface.point + surface.normal * (shape.thickness(*kind) * 1e-3);
            assert!(!shape.contains(outer), "{name} {surface:?} {shape:?}");
        }
    }
}

/// The shape of each kind, about as large as the unit sphere.
fn one_of_each() -> Vec<(&'static str, Shape)> {
    let turn = Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 0.7);
    let (start, end) = (Vec3::new(-0.6, -0.3, 0.2), Vec3::new(0.5, 0.4, -0.3));
    vec![
        ("capsule", Capsule::new(start, end, 0.4).into()),
        ("cylinder", Cylinder::new(start, end, 0.5).into()),
        (
            "ellipsoid",
            Ellipsoid::new(Vec3::ZERO, Vec3::new(0.9, 0.4, 0.6), turn).into(),
        ),
        (
            "box",
            Cuboid::new(Vec3::ZERO, Vec3::new(0.7, 0.4, 0.5), turn).into(),
        ),
        ("cone", Cone::new(start, end, 0.6, 0.1).into()),
        (
            "disc",
            Disc::new(Vec3::ZERO, Vec3::new(0.3, 0.4, 1.0), 0.9).into(),
        ),
    ]
}

/// A scene with one shape of this material, in surroundings of radiance one.
fn furnace(shape: Shape, material: Material) -> Scene {
    let mut world = World::default();
    let id = world.add_material(material);
    world.add_shape(shape, id);
    let mut scene = in_furnace(world);
    (scene.width, scene.height) = (48, 48);
    scene.sampling.samples = Some(32);
    scene.sampling.max_bounces = 300;
    scene
}

fn image(scene: &Scene, settings: impl Into<Settings>, device: &Device) -> Image {
    let rendered = render(scene, settings, device, QUIET);
    rendered.unwrap_or_else(|error| panic!("{error}")).image
}

/// The mean of an image, and its standard error by the pixels' spread.
fn mean(image: &Image) -> (f64, f64) {
    let values: Vec<f64> = image
        .pixels()
        .iter()
        .map(|pixel| f64::from(pixel.color().y))
        .collect();
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / count;
    (mean, (variance / count).sqrt())
}

/// What reflects or transmits all light is invisible where the light is the same from everywhere.
#[test]
fn white_shapes_vanish_in_a_furnace() {
    let materials = [
        ("diffuse", Material::diffuse(Vec3::ONE)),
        ("mirror", Material::metal(Vec3::ONE, 0.0)),
        ("glass", Material::glass(1.5, Vec3::ZERO)),
    ];
    for (of, device) in devices() {
        for (name, shape) in one_of_each() {
            for (material_name, material) in materials {
                if (name, material_name) == ("disc", "glass") {
                    continue;
                }
                let scene = furnace(shape, material);
                let (mean, error) = mean(&image(&scene, Settings::default(), device));
                assert!(
                    (mean - 1.0).abs() <= 4.0 * error + 2e-3,
                    "{of}, {name} of {material_name}: {mean} ± {error}"
                );
            }
            // The check can fail: what reflects half of the light is visible.
            let grey = furnace(shape, Material::diffuse(Vec3::splat(0.5)));
            let (mean, error) = mean(&image(&grey, Settings::default(), device));
            assert!(
                mean < 0.97 && error < 0.02,
                "{of}, {name}: {mean} ± {error}"
            );
        }
    }
}

/// A sphere, as a shape of two kinds and as itself, looks the same: glass and glow, too.
#[test]
fn a_round_ellipsoid_is_a_sphere() {
    let mut spheres = Vec::new();
    for shape in [
        Shape::from(Capsule::new(Vec3::Y, Vec3::Y, 0.5)),
        Ellipsoid::new(Vec3::Y, Vec3::splat(0.5), Quat::from_rotation_x(1.0)).into(),
    ] {
        let mut world = World::default();
        world.add_shape(shape, 0);
        assert!(world.shapes.is_empty());
        spheres.extend(world.spheres);
    }
    assert_eq!(spheres, [Sphere::new(Vec3::Y, 0.5); 2]);
}

/// The area of a silhouette is what geometry says.
#[test]
fn silhouettes_have_their_areas() {
    use std::f64::consts::PI;
    let far = 1000.0_f32;
    let flat = |shape: Shape| {
        let mut scene = furnace(shape, Material::diffuse(Vec3::ONE));
        scene.sky = None;
        scene.sampling.samples = None;
        (scene.width, scene.height) = (1000, 1000);
        scene.view = Some(View {
            eye: Vec3::new(0.0, 0.0, far),
            target: Vec3::ZERO,
            up: Vec3::Y,
            // Two scene units are the image's height.
            vertical_fov: 2.0 * f64::from(1.0 / far).atan().to_degrees(),
        });
        let image = image(&scene, Shading::Flat, &Device::Cpu);
        let hits = image
            .pixels()
            .iter()
            .filter(|pixel| pixel.depth() < Hit::NONE_T);
        hits.count() as f64 * 4e-6
    };
    let turn = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
    let areas: [(&str, Shape, f64); 7] = [
        (
            "capsule",
            Capsule::new(Vec3::X * -0.4, Vec3::X * 0.4, 0.3).into(),
            PI * 0.09 + 0.8 * 0.6,
        ),
        (
            "capsule from its end",
            Capsule::new(Vec3::Z * -0.4, Vec3::Z * 0.4, 0.3).into(),
            PI * 0.09,
        ),
        (
            "cylinder",
            Cylinder::new(Vec3::X * -0.4, Vec3::X * 0.4, 0.3).into(),
            0.8 * 0.6,
        ),
        (
            "cone",
            Cone::new(Vec3::X * -0.4, Vec3::X * 0.4, 0.6, 0.0).into(),
            0.8 * 0.6,
        ),
        (
            "ellipsoid",
            Ellipsoid::new(Vec3::ZERO, Vec3::new(0.2, 0.5, 0.8), turn).into(),
            PI * 0.5 * 0.8,
        ),
        (
            "box",
            Cuboid::new(Vec3::ZERO, Vec3::new(0.2, 0.5, 0.8), turn).into(),
            1.0 * 1.6,
        ),
        (
            "disc at 60 degrees",
            Disc::new(Vec3::ZERO, Vec3::new(3.0_f32.sqrt(), 0.0, 1.0), 0.8).into(),
            PI * 0.64 * 0.5,
        ),
    ];
    for (name, shape, area) in areas {
        let seen = flat(shape);
        // Nearer parts are larger by a thousandth, and pixels are counted.
        assert!((seen / area - 1.0).abs() < 4e-3, "{name}: {seen} of {area}");
    }
}

/// The picture of all shapes, rendered by every device, with light and without.
#[test]
fn devices_agree_on_the_still_life() {
    let mut scene = Scene::load(Path::new("scenes/still-life.toml")).expect("a scene");
    (scene.width, scene.height) = (160, 100);
    scene.sampling.samples = Some(4);
    for adapter in all_adapters() {
        let gpu = device(adapter);
        for shading in [Shading::Normals, Shading::Id, Shading::Depth] {
            for rung in RUNGS_OF_SHAPES {
                if rung == Rung::Double && !gpu.has_f64() {
                    continue;
                }
                let settings = Settings::from((shading, rung));
                let (cpu, other) = (
                    image(&scene, settings, &Device::Cpu),
                    image(&scene, settings, &gpu),
                );
                let compared = Comparison::of(&cpu, &other, Tolerance::default());
                let compared = compared.expect("comparable");
                assert!(compared.is_within(), "{shading:?} {rung:?}: {compared:?}");
            }
        }
        let settings = Settings::default();
        let (cpu, other) = (
            image(&scene, settings, &Device::Cpu),
            image(&scene, settings, &gpu),
        );
        let compared = Comparison::of(&cpu, &other, Tolerance::of_paths(4)).expect("comparable");
        let agreement = Agreement::of(&cpu, &other).expect("comparable");
        assert!(
            compared.is_within() && agreement.is_within(),
            "{compared:?} {agreement:?}"
        );
    }
}

/// A shape that moves while the shutter is open is where a shape at rest is at that time, and a
/// mean of both ends is blurred.
#[test]
fn shapes_move_while_the_shutter_is_open() {
    for (name, shape) in one_of_each() {
        let velocity = Vec3::new(0.5, -0.25, 0.0);
        let moved = shape.moved(shape.kinds(), velocity);
        let mut moving = furnace(shape, Material::diffuse(Vec3::splat(0.2)));
        moving.world.shape_velocities = vec![velocity];
        moving.lens.shutter = (1.0, 1.0);
        let resting = furnace(moved, Material::diffuse(Vec3::splat(0.2)));
        let (one, other) = (
            mean(&image(&moving, Settings::default(), &Device::Cpu)),
            mean(&image(&resting, Settings::default(), &Device::Cpu)),
        );
        assert!((one.0 - other.0).abs() < 4e-3, "{name}: {one:?} {other:?}");
        let center = |scene: &Scene| {
            let image = image(scene, Settings::default(), &Device::Cpu);
            let dark = image.pixels().iter().enumerate();
            let (mut sum, mut weight) = (0.0, 0.0);
            for (index, pixel) in dark {
                let darkness = f64::from(1.0 - pixel.color().y);
                sum += darkness * (index % 48) as f64;
                weight += darkness;
            }
            sum / weight
        };
        let (one, other) = (center(&moving), center(&resting));
        assert!((one - other).abs() < 0.3, "{name}: {one} {other}");
        // While the shutter is open for the whole way the middle is half of it.
        moving.lens.shutter = (0.0, 1.0);
        let still = center(&furnace(shape, Material::diffuse(Vec3::splat(0.2))));
        let half = center(&moving);
        assert!(
            (half - 0.5 * (one + still)).abs() < 0.8,
            "{name}: {half} of {still} to {one}"
        );
    }
}

/// A shape that glows lights what is around it, though it is found by chance alone: a glowing
/// capsule as short as nothing gives the light of the sphere that it all but is.
#[test]
fn shapes_that_glow_give_their_light() {
    let floor = |lamp: Shape| {
        let mut world = World::default();
        let white = world.add_material(Material::diffuse(Vec3::splat(0.8)));
        let glow = world.add_material(Material::emissive(Vec3::splat(4.0)));
        world.add(Sphere::new(Vec3::NEG_Y * 100.0, 100.0), white);
        world.add_shape(lamp, glow);
        let mut scene = Scene::new(world);
        scene.background = Vec3::ZERO;
        (scene.width, scene.height) = (32, 32);
        scene.view = Some(View {
            eye: Vec3::new(0.0, 1.5, 3.0),
            target: Vec3::new(0.0, 0.0, 0.0),
            up: Vec3::Y,
            vertical_fov: 20.0,
        });
        scene.sampling.samples = Some(1024);
        scene.sampling.max_bounces = 1;
        scene
    };
    let at = Vec3::new(0.0, 2.5, 0.0);
    let sphere = floor(Capsule::new(at, at, 1.0).into());
    assert!(sphere.world.shapes.is_empty());
    let nearly = floor(Capsule::new(at, at + Vec3::X * 1e-3, 1.0).into());
    assert!(!nearly.world.shapes.is_empty());
    for (of, device) in devices() {
        let (expected, _) = mean(&image(&sphere, Settings::default(), &Device::Cpu));
        let (found, error) = mean(&image(&nearly, Settings::default(), device));
        assert!(
            (found - expected).abs() < 4.0 * error + 0.01 * expected,
            "{of}: {found} ± {error}, {expected}"
        );
    }
}
