//! The tree, the packets of camera rays and brute force by tiles find what testing every sphere
//! finds.

use glam::Vec3;
use spherule::Scene;
use spherule::accel::{Acceleration, build_still};
use spherule::accuracy::cases::catalogue;
use spherule::accuracy::families::Family;
use spherule::accuracy::oracle::Intersection;
use spherule::bench::rays::{Kind, RaySets};
use spherule::bench::scenes;
use spherule::bench::verify::verify;
use spherule::device::Device;
use spherule::kernel::accel::brute::{MovingSpheres, is_occluded, nearest_hit_in};
use spherule::kernel::accel::node::Node;
use spherule::kernel::accel::walk::{is_occluded_in_tree, nearest_hit_in_tree};
use spherule::kernel::precision::{DEFERRING, intersect_or_defer};
use spherule::kernel::{Camera, Effects, Hit, Material, Pixel, Ray, Rung, Shading, Sphere};
use spherule::render::pace::Pace;
use spherule::render::{QUIET, Settings, cpu, whole_image};
use spherule::scene::World;
use spherule::trace::{CpuTracer, GpuTracer};

mod common;
use common::{all_adapters, device, gpus, skips};

/// Compares the tree with testing every sphere, for rays of every kind on every rung.
#[test]
fn the_tree_loses_no_hit() {
    for (name, rungs) in [
        ("S46", &Rung::ALL[..]),
        ("S500", &Rung::ALL),
        ("R10k", &Rung::ALL),
        ("X1M", &[Rung::Textbook, Rung::Robust]),
    ] {
        let (scene, reach) = scenes::load(name, 48, 36).expect("a scene");
        let tracer = CpuTracer::new(&scene.world.spheres, Acceleration::Auto);
        let sets = RaySets::of(&scene, &tracer, reach).expect("rays");
        assert!(!sets.kind(Kind::Ambient).is_empty(), "{name}");
        for rung in rungs.iter().copied() {
            let verified = verify(&Device::Cpu, &scene, &sets, rung).expect("a comparison");
            assert_eq!(
                verified.differing,
                0,
                "{name} {}: {verified:?}",
                rung.name()
            );
            assert!(verified.rays > 500, "{name}: {verified:?}");
        }
    }
}

/// Puts the hard cases and families among a million spheres. With the tree, by both walks, each ray
/// finds what it finds without; on the certified rung, no hit is farther than the exact hit with
/// the ray's own sphere. The first world leaves out spheres of a planet's size, which make all
/// boxes wide.
#[test]
fn hard_cases_are_hit_in_a_tree_of_a_million() {
    let (scene, _) = scenes::load("R1M", 16, 16).expect("a scene");
    let mut samples: Vec<(Ray, Sphere)> = catalogue()
        .iter()
        .flat_map(|case| case.samples().collect::<Vec<_>>())
        .collect();
    samples.extend(Family::ALL.iter().flat_map(|f| f.sample(11, 40)));
    for (limit, step) in [(1e4, 3), (Node::MAX_COORDINATE / 4.0, 50)] {
        let small: Vec<(Ray, Sphere)> = samples
            .iter()
            .copied()
            .filter(|(_, sphere)| {
                let far = sphere.center().abs().max_element() + sphere.radius().abs();
                sphere.is_valid() && far < limit
            })
            .step_by(step)
            .collect();
        assert!(small.len() * step > 500, "{}", small.len());
        let mut spheres = scene.world.spheres.clone();
        let first = spheres.len();
        spheres.extend(small.iter().map(|(_, sphere)| *sphere));
        let rays: Vec<Ray> = small.iter().map(|(ray, _)| *ray).collect();
        let tree = CpuTracer::new(&spheres, Acceleration::Tree);
        let order = tree.order();
        // Of equal spheres in one place, the tree holds only the first.
        assert!(order.len() > spheres.len() - spheres.len() / 100);
        let sorted: Vec<Sphere> = order.iter().map(|at| spheres[*at as usize]).collect();
        let (mut found, mut occluded) = (Vec::new(), Vec::new());
        for rung in Rung::ALL {
            tree.nearest(rung, &rays, &mut found);
            tree.occluded(rung, &rays, &mut occluded);
            let mut truth = Vec::new();
            // Of equally near spheres, the first in the order of the leaves wins.
            CpuTracer::new(&sorted, Acceleration::BruteForce).nearest(rung, &rays, &mut truth);
            for (index, ray) in rays.iter().enumerate() {
                let truth = truth[index];
                let mut given = truth;
                if truth.is_some() {
                    given.sphere = order[truth.sphere as usize];
                }
                assert_eq!(found[index], given, "{} {ray:?}", rung.name());
                assert_eq!(occluded[index] == 1, truth.is_some(), "{}", rung.name());
                let walked = nearest_hit_in_tree(rung.to_u32(), ray, tree.tree(), &sorted[..]);
                assert_eq!(walked, truth, "{} {ray:?}", rung.name());
                let own = &spheres[first + index];
                let exact = Intersection::of(ray, own).and_then(|exact| exact.nearest(ray));
                if let (Rung::Certified, Some(exact)) = (rung, exact) {
                    assert!(truth.t <= exact.next_up(), "{ray:?} {own:?}");
                }
            }
        }
    }
}

/// The same in whatever units lengths and directions are, as long as squares of lengths and
/// parameters are normal floats.
#[test]
fn the_tree_loses_no_hit_in_any_units() {
    let (scene, reach) = scenes::load("S500", 24, 18).expect("a scene");
    let tracer = CpuTracer::new(&scene.world.spheres, Acceleration::Auto);
    let sets = RaySets::of(&scene, &tracer, reach).expect("rays");
    let rays: Vec<Ray> = Kind::ALL
        .iter()
        .flat_map(|kind| sets.kind(*kind))
        .step_by(5)
        .copied()
        .collect();
    let mut wrong = Vec::new();
    for length in [-53_i32, -40, -20, 20, 40, 54] {
        for direction in [-60_i32, -30, 0, 30, 60, 66, 100, 120] {
            if (length - direction).abs() > 110 {
                continue;
            }
            let (by, along) = (2.0_f32.powi(length), 2.0_f32.powi(direction));
            let spheres: Vec<Sphere> = scene
                .world
                .spheres
                .iter()
                .map(|sphere| Sphere::new(sphere.center() * by, sphere.radius() * by))
                .collect();
            let of_t = |t: f32| {
                if t == Hit::NONE_T {
                    t
                } else {
                    (f64::from(t) * 2.0_f64.powi(length - direction)) as f32
                }
            };
            let rays: Vec<Ray> = rays
                .iter()
                .map(|ray| {
                    Ray::within(
                        ray.origin * by,
                        ray.direction * along,
                        of_t(ray.t_min),
                        of_t(ray.t_max),
                    )
                })
                .collect();
            let tree = CpuTracer::new(&spheres, Acceleration::Tree);
            let brute = CpuTracer::new(&spheres, Acceleration::BruteForce);
            let (mut found, mut truth) = (Vec::new(), Vec::new());
            for rung in Rung::ALL {
                tree.nearest(rung, &rays, &mut found);
                brute.nearest(rung, &rays, &mut truth);
                let differing = found.iter().zip(&truth).filter(|(a, b)| a != b).count();
                let hits = truth.iter().filter(|hit| hit.is_some()).count();
                if differing > 0 {
                    wrong.push(format!("lengths 2^{length}, directions 2^{direction}, {}: {differing} of {} differ, {hits} hits", rung.name(), rays.len()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The same on every adapter. On the rungs below compensated, a driver may fuse and reorder
/// differently in the two kernels; a software adapter does not.
#[test]
fn the_tree_loses_no_hit_on_a_gpu() {
    if skips("the_tree_loses_no_hit_on_a_gpu") {
        return;
    }
    for adapter in all_adapters() {
        let device = device(adapter);
        let (scene, reach) = scenes::load("S500", 32, 24).expect("a scene");
        let tracer = CpuTracer::new(&scene.world.spheres, Acceleration::Auto);
        let sets = RaySets::of(&scene, &tracer, reach).expect("rays");
        for rung in Rung::ALL {
            if rung == Rung::Double && !device.has_f64() {
                continue;
            }
            let verified = verify(&device, &scene, &sets, rung).expect("a comparison");
            assert_eq!(
                verified.differing,
                0,
                "{} on {}",
                rung.name(),
                device.name()
            );
        }
    }
}

/// Each pixel's depth is the nearest hit's t, with a tree and without, whatever part of a packet is
/// inside the image.
#[test]
fn packets_find_what_single_rays_find() {
    for (name, width, height) in [
        ("S2", 33, 17),
        ("S46", 41, 23),
        ("S500", 40, 30),
        ("R10k", 37, 29),
        ("R10k", 1, 9),
    ] {
        let (scene, _) = scenes::load(name, width, height).expect("a scene");
        let launch = whole_image(&scene).expect("a launch");
        for rung in Rung::ALL {
            for acceleration in [Acceleration::Tree, Acceleration::BruteForce] {
                let world = cpu::Prepared::new(&scene.world, acceleration);
                let settings = Settings::from((Shading::Flat, rung)).acceleration(acceleration);
                let pixels = cpu::render(&launch, &world, settings, QUIET).expect("an image");
                let mut hits = 0;
                for (index, pixel) in pixels.iter().enumerate() {
                    let at = glam::UVec2::new(index as u32 % width, index as u32 / width);
                    let ray = launch.camera.pixel_ray(at, launch.image_size);
                    let spheres = &scene.world.spheres[..];
                    let hit = nearest_hit_in(rung.to_u32(), &ray, spheres, 0, u32::MAX);
                    assert_eq!(pixel.depth(), hit.t, "{name} {} {at}", rung.name());
                    hits += usize::from(hit.is_some());
                }
                assert!(width == 1 || hits > 50, "{name}: only {hits} hits");
            }
        }
    }
}

/// Compares brute force by tiles on a GPU with the packets on the CPU.
#[test]
fn tiles_find_what_the_cpu_finds() {
    if skips("tiles_find_what_the_cpu_finds") {
        return;
    }
    // No side is a multiple of a tile's. The cases have several tiles, several batches, lists that
    // are full before the last batch and lists that are not, and camera axes that are not at right
    // angles.
    let cases = [
        ("S500", 45, 37, 0.0),
        ("S500", 45, 37, 0.4),
        ("R3k", 45, 37, 0.0),
        ("R10k", 330, 190, 0.0),
    ];
    for gpu in gpus() {
        for (name, width, height, skew) in cases {
            let (scene, _) = scenes::load(name, width, height).expect("a scene");
            let mut launch = whole_image(&scene).expect("a launch");
            launch.camera.up += skew * launch.camera.right;
            for rung in [Rung::Robust, Rung::Certified] {
                let settings =
                    Settings::from((Shading::Flat, rung)).acceleration(Acceleration::BruteForce);
                let world = spherule::render::gpu::Prepared::new(gpu, &scene.world, settings)
                    .expect("a world");
                let (on_gpu, _) =
                    spherule::render::gpu::render(gpu, &launch, &world, QUIET).expect("an image");
                let world = cpu::Prepared::new(&scene.world, Acceleration::BruteForce);
                let on_cpu = cpu::render(&launch, &world, settings, QUIET).expect("an image");
                let hits = on_cpu.iter().filter(|pixel| pixel.is_hit()).count();
                assert!(hits > 200, "{name}: only {hits} hits");
                let differing = on_gpu
                    .iter()
                    .zip(&on_cpu)
                    .filter(|(a, b)| (a.depth() - b.depth()).abs() > 1e-4 * b.depth())
                    .count();
                assert!(
                    differing <= 2,
                    "{name}: {differing} pixels on {}",
                    gpu.name()
                );
            }
        }
    }
}

/// A sphere that the line y = 1 along x touches, one that the line y = 100 meets half way between
/// two floats, and others beside them.
fn left_open(count: usize) -> Vec<Sphere> {
    let mut spheres = vec![
        Sphere::new(Vec3::ZERO, 1.0),
        Sphere::new(Vec3::new(0.0, 100.0, 0.0), 0.25),
    ];
    let beside = |index| Sphere::new(Vec3::new(index as f32, -100.0, 0.0), 0.5);
    spheres.extend((2..count).map(beside));
    spheres
}

/// From here the root of the second of [`left_open`] is 8388606.75, half way between two floats.
const FAR: Vec3 = Vec3::new(-8_388_607.0, 100.0, 0.0);

/// What a first launch on a GPU leaves open is answered by a second one, however much that is: more
/// rays than the second has threads.
#[test]
fn rays_that_are_deferred_are_answered() {
    if skips("rays_that_are_deferred_are_answered") {
        return;
    }
    let spheres = left_open(32);
    let touching = Ray::new(Vec3::new(-4.0, 1.0, 0.0), Vec3::X);
    let half_way = Ray::new(FAR, Vec3::X);
    let rays = [
        touching,
        half_way,
        Ray::new(Vec3::new(-4.0, 0.0, 0.0), Vec3::X),
        Ray::new(Vec3::new(-4.0, 2.0, 0.0), Vec3::X),
    ];
    let first = [(spheres[0], &touching), (spheres[1], &half_way)]
        .map(|(sphere, ray)| intersect_or_defer(DEFERRING, sphere, ray));
    assert_eq!(first, [Hit::DEFERRED_T; 2]);
    let hit = |t, sphere| Hit { t, sphere };
    let expected = [hit(4.0, 0), hit(8_388_607.0, 1), hit(3.0, 0), Hit::NONE];
    let many: Vec<Ray> = rays.iter().copied().cycle().take(36_000).collect();
    for gpu in gpus() {
        let tracer = GpuTracer::new(gpu, &spheres, Acceleration::Tree).expect("a tree");
        let batch = tracer.upload(&many).expect("rays");
        // Twice, with the same list.
        for _ in 0..2 {
            tracer.nearest(Rung::Certified, &batch).expect("hits");
            let hits = tracer.hits(&batch).expect("hits");
            assert!(hits.iter().eq(expected.iter().cycle().take(many.len())));
            tracer
                .occluded(Rung::Certified, &batch)
                .expect("occlusions");
            let occluded = tracer.occlusions(&batch).expect("occlusions");
            assert!(occluded.chunks(4).all(|four| four == [1, 1, 1, 0]));
        }
    }
}

/// The same for pixels, by a tree, by tiles, and among few spheres.
#[test]
fn pixels_that_are_deferred_are_answered() {
    if skips("pixels_that_are_deferred_are_answered") {
        return;
    }
    for (count, acceleration) in [
        (32, Acceleration::Tree),
        (32, Acceleration::BruteForce),
        (2, Acceleration::BruteForce),
    ] {
        let mut world = World::default();
        let white = world.add_material(Material::diffuse(Vec3::ONE));
        for sphere in left_open(count) {
            world.add(sphere, white);
        }
        let mut scene = Scene::new(world);
        (scene.width, scene.height) = (65, 41);
        let mut launch = whole_image(&scene).expect("a launch");
        // The image is less than a tenth of the sphere.
        launch.camera = Camera::from_basis(FAR, Vec3::X, 2e-9 * Vec3::Z, 2e-9 * Vec3::Y);
        let spheres = &scene.world.spheres[..];
        let rays: Vec<Ray> = (0..65 * 41)
            .map(|index| glam::UVec2::new(index % 65, index / 65))
            .map(|at| launch.camera.pixel_ray(at, launch.image_size))
            .collect();
        let is_open = |ray| intersect_or_defer(DEFERRING, spheres[1], ray) == Hit::DEFERRED_T;
        assert!(is_open(&rays[20 * 65 + 32]));
        let rung = Rung::Certified;
        let settings = Settings::from((Shading::Flat, rung)).acceleration(acceleration);
        for gpu in gpus() {
            let world =
                spherule::render::gpu::Prepared::new(gpu, &scene.world, settings).expect("a world");
            let (pixels, _) =
                spherule::render::gpu::render(gpu, &launch, &world, QUIET).expect("an image");
            for (pixel, ray) in pixels.iter().zip(&rays) {
                let hit = nearest_hit_in(rung.to_u32(), ray, spheres, 0, u32::MAX);
                assert_eq!(pixel.depth(), hit.t, "{acceleration:?} {}", gpu.name());
            }
        }
    }
}

/// 1,200 spheres in 600 places. In each place a green sphere comes first; a red one is next, or
/// comes after all the green ones.
fn equals(are_next: bool) -> World {
    let mut world = World::default();
    let green = world.add_material(Material::diffuse(Vec3::Y));
    let red = world.add_material(Material::diffuse(Vec3::X));
    for index in 0..1200 {
        let (place, is_red) = if are_next {
            (index / 2, index % 2 == 1)
        } else {
            (index % 600, index >= 600)
        };
        let (x, y) = (place % 30 - 15, place / 30 - 10);
        world.add(
            Sphere::new(Vec3::new(x as f32, y as f32, -40.0), 0.6),
            if is_red { red } else { green },
        );
    }
    world
}

/// Of two spheres in one place, the one with the lower index is seen, whatever the order of the
/// list and the number of launches, and even if the list has no room for all.
#[test]
fn tiles_take_the_first_of_equals() {
    if skips("tiles_take_the_first_of_equals") {
        return;
    }
    let settings =
        Settings::from((Shading::Lit, Rung::Robust)).acceleration(Acceleration::BruteForce);
    for (are_next, width, height) in [
        (false, 150, 100),
        (true, 150, 100),
        (false, 30, 20),
        (true, 30, 20),
    ] {
        let mut scene = Scene::new(equals(are_next));
        (scene.width, scene.height) = (width, height);
        scene.background = Vec3::ZERO;
        let launch = whole_image(&scene).expect("a launch");
        for gpu in gpus() {
            for pace in [Pace::first_on(gpu), Pace::starting_at(1)] {
                let world = spherule::render::gpu::Prepared::new(gpu, &scene.world, settings)
                    .expect("a world");
                let (pixels, _) =
                    spherule::render::gpu::render_paced(gpu, &launch, &world, QUIET, &mut { pace })
                        .expect("an image");
                let count = |of: fn(Vec3) -> bool| {
                    let colors = pixels.iter().map(Pixel::color);
                    colors.filter(|color| of(*color)).count()
                };
                let green = count(|color| color.y > 0.0);
                assert!(2 * green > pixels.len(), "only {green} green pixels");
                let red = count(|color| color.x > 0.0);
                assert_eq!(red, 0, "{width} × {height} on {}", gpu.name());
            }
        }
    }
}

/// A ray that asks what is in its way to a lamp passes over the lamp, wherever rounding lets that
/// begin; and over nothing else.
#[test]
fn rays_pass_over_the_sphere_that_they_go_to() {
    let mut spheres: Vec<Sphere> = (0..40)
        .map(|index| Sphere::new(Vec3::new(3.0 * index as f32, 0.0, 0.0), 1.0))
        .collect();
    let nodes = build_still(&spheres, 1).expect("a tree");
    spheres = nodes.sort(&spheres);
    let lamp = spheres.iter().position(|sphere| sphere.center().x == 30.0);
    let lamp = lamp.expect("the lamp") as u32;
    // From above, a little into the lamp.
    let free = Ray::within(Vec3::new(30.0, 5.0, 0.0), Vec3::NEG_Y, 0.0, 4.001);
    // The same from far away, through its neighbour.
    let blocked = Ray::within(Vec3::new(40.0, 0.0, 0.0), Vec3::NEG_X, 0.0, 9.001);
    for rung in Rung::ALL.map(Rung::to_u32) {
        for (ray, target, expected) in [
            (free, lamp, false),
            (free, Hit::NONE_SPHERE, true),
            (free, lamp ^ 1, true),
            (blocked, lamp, true),
        ] {
            let moving = MovingSpheres {
                spheres: &spheres,
                velocities: &[],
                time: 0.0,
                effects: Effects::SOFT_SHADOWS,
                left: Hit::NONE_SPHERE,
                target,
            };
            assert_eq!(is_occluded(rung, &ray, &moving), expected);
            let tree = nodes.nodes.tree();
            assert_eq!(is_occluded_in_tree(rung, &ray, tree, &moving), expected);
            // Only rays that ask for any hit pass over it.
            assert!(nearest_hit_in(rung, &free, &moving, 0, u32::MAX).is_some());
            assert!(nearest_hit_in_tree(rung, &free, tree, &moving).is_some());
        }
    }
}
