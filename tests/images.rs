//! Rendered images, compared with committed references and with closed forms, on the CPU and on
//! every adapter.
//!
//! `SPHERULE_RENEW_REFERENCES=1` writes the references again; review what changed.

mod common;

use std::path::PathBuf;

use common::{all_adapters, device, gpus, open, open_through_naga, open_with_limits, skips};
use glam::{UVec2, Vec3};
use spherule::accel::Acceleration;
use spherule::device::GpuOptions;
use spherule::film::compare::{Comparison, Tolerance};
use spherule::kernel::shading::index_of;
use spherule::kernel::{Camera, Hit, Launch, Material, Pixel, Shading, Sphere, nearest_hit};
use spherule::render::pace::Pace;
use spherule::render::{self, QUIET, Settings};
use spherule::scene::{View, World};
use spherule::{Device, Image, Scene, wgpu};

/// The largest mean perceptual difference. Two renders of one scene that differ by roundings stay
/// below a tenth of this; a sphere moved by a pixel exceeds it.
const FLIP_TOLERANCE: f32 = 0.002;

fn two_spheres(width: u32, height: u32) -> Scene {
    let mut scene = Scene::load("scenes/two-spheres.toml").expect("the scene");
    (scene.width, scene.height) = (width, height);
    scene
}

/// One sphere in front of a camera that sees 1 scene unit at distance 1.
fn one_sphere(sphere: Sphere, width: u32, height: u32) -> Scene {
    let mut world = World::default();
    let white = world.add_material(Material::diffuse(Vec3::ONE));
    world.add(sphere, white);
    let mut scene = Scene::new(world);
    (scene.width, scene.height) = (width, height);
    scene.background = Vec3::ZERO;
    scene.view = Some(View {
        eye: Vec3::ZERO,
        target: Vec3::NEG_Z,
        up: Vec3::Y,
        vertical_fov: 2.0 * 0.5_f64.atan().to_degrees(),
    });
    scene
}

fn on_cpu(scene: &Scene, shading: Shading) -> Image {
    render::render(scene, shading, &Device::Cpu, QUIET)
        .expect("the CPU renders")
        .image
}

/// Renders on every adapter.
fn on_gpus(scene: &Scene, shading: Shading) -> Vec<Image> {
    all_adapters()
        .iter()
        .map(|adapter| {
            let device = device(adapter);
            render::render(scene, shading, &device, QUIET)
                .expect("the GPU renders")
                .image
        })
        .collect()
}

fn flip(a: &Image, b: &[u8]) -> f32 {
    let (width, height) = (a.width(), a.height());
    let a = nv_flip::FlipImageRgb8::with_data(width, height, &a.to_rgb8());
    let b = nv_flip::FlipImageRgb8::with_data(width, height, b);
    let errors = nv_flip::flip(a, b, nv_flip::DEFAULT_PIXELS_PER_DEGREE);
    nv_flip::FlipPool::from_image(&errors).mean()
}

/// The committed reference; when references are renewed, writes this image as the reference first.
fn reference(name: &str, image: &Image) -> Vec<u8> {
    let path = PathBuf::from("tests/references").join(name);
    if std::env::var_os("SPHERULE_RENEW_REFERENCES").is_some_and(|value| value != "0") {
        image.save(&path).expect("the reference can be written");
    }
    let reference = image::open(&path)
        .unwrap_or_else(|error| {
            panic!(
                "{}: {error}; SPHERULE_RENEW_REFERENCES=1 writes it",
                path.display()
            )
        })
        .to_rgb8();
    assert_eq!(reference.dimensions(), (image.width(), image.height()));
    reference.into_raw()
}

/// The figures: file name, scene and shading.
fn figures() -> Vec<(&'static str, Scene, Shading)> {
    let sphere = Sphere::new(Vec3::new(0.0, 0.0, -3.0), 0.5);
    let mut crambin = Scene::load("scenes/1crn.pdb").expect("crambin");
    (crambin.width, crambin.height) = (160, 120);
    vec![
        ("red-sphere.png", one_sphere(sphere, 160, 90), Shading::Flat),
        ("normals.png", one_sphere(sphere, 160, 90), Shading::Normals),
        (
            "two-spheres-normals.png",
            two_spheres(160, 90),
            Shading::Normals,
        ),
        ("two-spheres-lit.png", two_spheres(160, 90), Shading::Lit),
        (
            "two-spheres-depth.png",
            two_spheres(160, 90),
            Shading::Depth,
        ),
        ("crambin.png", crambin, Shading::Lit),
    ]
}

#[test]
fn figures_match_their_references_on_the_cpu() {
    for (name, scene, shading) in figures() {
        let image = on_cpu(&scene, shading);
        let difference = flip(&image, &reference(name, &image));
        assert!(difference <= FLIP_TOLERANCE, "{name}: {difference}");
    }
}

#[test]
fn figures_match_their_references_on_gpus() {
    if skips("figures_match_their_references_on_gpus") {
        return;
    }
    for (name, scene, shading) in figures() {
        for image in on_gpus(&scene, shading) {
            let difference = flip(&image, &reference(name, &on_cpu(&scene, shading)));
            assert!(difference <= FLIP_TOLERANCE, "{name}: {difference}");
        }
    }
}

/// The twin of the tests above: an image with a sphere moved by a pixel, or with two channels
/// swapped, must not match.
#[test]
fn wrong_figures_do_not_match() {
    for (name, scene, shading) in figures() {
        let image = on_cpu(&scene, shading);
        let reference = reference(name, &image);

        let mut moved = scene.clone();
        let view = moved.view_or_framed();
        let sphere = &mut moved.world.spheres[0];
        // The size of a pixel at the distance of the first sphere.
        let depth = (sphere.center() - view.eye).length();
        let pixel =
            2.0 * (0.5 * view.vertical_fov.to_radians()).tan() as f32 * depth / scene.height as f32;
        *sphere = Sphere::new(sphere.center() + Vec3::X * pixel, sphere.radius());
        moved.view = Some(view);
        // In a molecule, one atom is a few pixels of thousands and may be hidden, so all atoms are
        // moved.
        if moved.world.spheres.len() > 2 {
            for sphere in &mut moved.world.spheres {
                *sphere = Sphere::new(sphere.center() + Vec3::X * pixel, sphere.radius());
            }
        }
        let difference = flip(&on_cpu(&moved, shading), &reference);
        assert!(difference > FLIP_TOLERANCE, "{name} moved: {difference}");

        if shading != Shading::Depth {
            let swapped: Vec<Pixel> = image
                .pixels()
                .iter()
                .map(|pixel| {
                    let color = pixel.color();
                    Pixel::new(Vec3::new(color.z, color.y, color.x), pixel.depth())
                })
                .collect();
            let swapped =
                Image::new(image.width(), image.height(), shading, swapped).expect("an image");
            let difference = flip(&swapped, &reference);
            assert!(difference > FLIP_TOLERANCE, "{name} swapped: {difference}");
        }
    }
}

#[test]
fn cpu_and_gpu_agree_within_the_stated_tolerance() {
    if skips("cpu_and_gpu_agree_within_the_stated_tolerance") {
        return;
    }
    for shading in [
        Shading::Lit,
        Shading::Normals,
        Shading::Depth,
        Shading::Flat,
    ] {
        for (width, height) in [(640, 360), (17, 13), (1, 1), (1920, 1), (1, 300)] {
            let scene = two_spheres(width, height);
            let cpu = on_cpu(&scene, shading);
            for gpu in on_gpus(&scene, shading) {
                let compared = Comparison::of(&cpu, &gpu, Tolerance::default()).expect("same size");
                assert!(
                    compared.is_within(),
                    "{shading:?} {width}x{height}: {compared:?}"
                );
            }
        }
    }
}

/// The twin of the test above: an image without the second sphere, or shifted by a pixel, must be
/// rejected.
#[test]
fn the_stated_tolerance_rejects_wrong_images() {
    let scene = two_spheres(640, 360);
    let image = on_cpu(&scene, Shading::Normals);
    let mut without = scene.clone();
    without.world.spheres.pop();
    without.world.material_ids.pop();
    let mut shifted = image.pixels().to_vec();
    shifted.rotate_right(1);
    let shifted = Image::new(640, 360, Shading::Normals, shifted).expect("an image");
    for wrong in [on_cpu(&without, Shading::Normals), shifted] {
        let compared = Comparison::of(&image, &wrong, Tolerance::default()).expect("same size");
        assert!(!compared.is_within(), "{compared:?}");
    }
}

/// The kernel translated by naga, as on Metal and DirectX 12, renders the same image.
#[test]
fn naga_renders_the_same() {
    if skips("naga_renders_the_same") {
        return;
    }
    let scene = two_spheres(320, 180);
    let cpu = on_cpu(&scene, Shading::Lit);
    for adapter in all_adapters() {
        let gpu = open_through_naga(adapter);
        assert!(!gpu.passes_spirv_through());
        let image = render::render(&scene, Shading::Lit, &Device::Gpu(Box::new(gpu)), QUIET)
            .expect("naga takes the kernel")
            .image;
        let compared = Comparison::of(&cpu, &image, Tolerance::default()).expect("same size");
        assert!(compared.is_within(), "{compared:?}");
    }
}

/// The image must not change with tiny bindings, which split the world into parts and the image
/// into tiles; with a pace so slow that each tile takes many launches; or with workgroups too small
/// for brute force by tiles.
#[test]
fn splitting_changes_nothing() {
    if skips("splitting_changes_nothing") {
        return;
    }
    let mut scene = Scene::load("scenes/1crn.pdb").expect("crambin");
    (scene.width, scene.height) = (97, 61);
    for adapter in all_adapters() {
        let whole = open(adapter, GpuOptions::default());
        let limits = wgpu::Limits {
            // A binding holds 64 spheres or 64 pixels.
            max_storage_buffer_binding_size: 1024,
            ..adapter.limits()
        };
        let split = open_with_limits(adapter, limits);
        let limits = wgpu::Limits {
            max_compute_invocations_per_workgroup: 128,
            ..adapter.limits()
        };
        let narrow = open_with_limits(adapter, limits);
        let launch = launch_of(&scene);
        for acceleration in [Acceleration::Tree, Acceleration::BruteForce] {
            let settings = Settings::from(Shading::Lit).acceleration(acceleration);
            let prepare = |gpu| {
                render::gpu::Prepared::new(gpu, &scene.world, settings).expect("a world on the GPU")
            };
            let (expected, _) =
                render::gpu::render(&whole, &launch, &prepare(&whole), QUIET).expect("whole");
            for (gpu, mut pace) in [
                (&split, Pace::first_on(&split)),
                (&narrow, Pace::first_on(&narrow)),
                (&whole, Pace::starting_at(97 * 20)),
                (&whole, Pace::starting_at(50)),
            ] {
                let (pixels, _) =
                    render::gpu::render_paced(gpu, &launch, &prepare(gpu), QUIET, &mut pace)
                        .expect("split");
                assert!(pixels == expected, "{acceleration:?} {pace:?}");
            }
        }
    }
}

fn launch_of(scene: &Scene) -> Launch {
    render::whole_image(scene).expect("the scene is sound")
}

/// Every thread writes its pixel: no sentinel is left in a buffer that was filled with sentinels.
#[test]
fn every_pixel_is_written() {
    if skips("every_pixel_is_written") {
        return;
    }
    for (width, height) in [(1, 1), (17, 13), (1920, 1), (8, 8), (9, 7)] {
        let scene = two_spheres(width, height);
        let launch = launch_of(&scene);
        for gpu in gpus() {
            let module = spherule::kernel_module::f32().expect("the kernel");
            use spherule::device::Access::{Read, ReadWrite, Uniform};
            let kernel = gpu
                .kernel(
                    &module,
                    "render",
                    &[Uniform, Read, Read, Read, Read, ReadWrite, ReadWrite],
                )
                .expect("a kernel");
            let sentinel = Pixel::new(Vec3::splat(-7.0), -7.0);
            let count = (width * height) as usize;
            // One more pixel than the image has, which must not be written.
            let pixels = gpu
                .upload("pixels", &vec![sentinel; count + 1])
                .expect("pixels");
            let world = &scene.world;
            gpu.launch(
                &kernel,
                &[
                    gpu.upload_uniform("launch", &launch)
                        .expect("launch")
                        .binding(),
                    gpu.upload("spheres", &world.spheres)
                        .expect("spheres")
                        .binding(),
                    gpu.upload("ids", &world.material_ids)
                        .expect("ids")
                        .binding(),
                    gpu.upload("materials", &world.materials)
                        .expect("materials")
                        .binding(),
                    gpu.upload("nodes", &[spherule::kernel::accel::node::Node::default()])
                        .expect("nodes")
                        .binding(),
                    pixels.binding(),
                    gpu.zeroed::<u32>("deferred", 1).expect("a list").binding(),
                ],
                kernel.workgroups_for([width, height, 1]),
            )
            .expect("a launch");
            let pixels = gpu.read(&pixels).expect("pixels");
            assert_eq!(
                pixels[..count]
                    .iter()
                    .filter(|pixel| **pixel == sentinel)
                    .count(),
                0
            );
            assert_eq!(pixels[count], sentinel);
        }
    }
}

/// A sphere of radius r at distance d is seen as a disc whose radius on the image plane at
/// distance 1 is r / √(d² − r²).
#[test]
fn a_spheres_silhouette_has_its_area() {
    for (distance, radius) in [(3.0_f64, 0.5_f64), (3.0, 1.2), (50.0, 10.0), (1.0, 0.3)] {
        let sphere = Sphere::new(Vec3::new(0.0, 0.0, -distance as f32), radius as f32);
        let scene = one_sphere(sphere, 801, 801);
        for image in all_paths(&scene, Shading::Flat) {
            let hits = image.pixels().iter().filter(|pixel| pixel.is_hit()).count();
            let pixels = 801.0 * radius / (distance * distance - radius * radius).sqrt();
            let area = std::f64::consts::PI * pixels * pixels;
            // Gauss's circle problem: the count is off by about R^(2/3), and was never seen off by
            // more than four times that.
            let tolerance = 4.0 * pixels.powf(2.0 / 3.0);
            assert!(
                (hits as f64 - area).abs() <= tolerance,
                "{hits} {area} ± {tolerance}"
            );
        }
    }
}

#[test]
fn the_normal_at_the_centre_faces_the_camera() {
    for size in [(801, 801), (1280, 720), (17, 13)] {
        let scene = two_spheres(size.0, size.1);
        for image in all_paths(&scene, Shading::Normals) {
            let rgb = image.to_rgb8();
            let centre = (size.1 / 2 * size.0 + size.0 / 2) as usize;
            for (channel, expected) in [128_u8, 128, 255].iter().enumerate() {
                let found = rgb[3 * centre + channel];
                // An image of even size has no pixel exactly at its centre.
                let slack = if size.0 % 2 == 1 || size.0 > 1000 {
                    1
                } else {
                    8
                };
                assert!(
                    found.abs_diff(*expected) <= slack,
                    "{size:?}: channel {channel} is {found}"
                );
            }
        }
    }
}

/// In each column, the horizon is where the ray is tangent to the ground sphere.
#[test]
fn the_horizon_is_where_rays_touch_the_ground() {
    let scene = two_spheres(1280, 720);
    let camera: Camera = launch_of(&scene).camera;
    let ground = scene.world.spheres[1];
    let c = ground.center().as_dvec3();
    let radius = f64::from(ground.radius());
    for image in all_paths(&scene, Shading::Flat) {
        // The small sphere covers none of these columns.
        for column in [0_u32, 100, 400, 900, 1279] {
            let x = f64::from(2 * column + 1) / 1280.0 - 1.0;
            let forward = camera.forward.as_dvec3() + camera.right.as_dvec3() * x;
            let up = camera.up.as_dvec3();
            // (c·d)² = d·d (c·c − r²) with d = forward + y·up, a quadratic in y.
            let k = c.dot(c) - radius * radius;
            let (cf, cu) = (c.dot(forward), c.dot(up));
            let qa = cu * cu - k * up.dot(up);
            let qb = 2.0 * (cf * cu - k * forward.dot(up));
            let qc = cf * cf - k * forward.dot(forward);
            let root = (qb * qb - 4.0 * qa * qc).sqrt();
            let y = [(-qb + root) / (2.0 * qa), (-qb - root) / (2.0 * qa)]
                .into_iter()
                .filter(|y| cf + cu * y > 0.0)
                .fold(f64::NEG_INFINITY, f64::max);
            let horizon = (1.0 - y) * 360.0;
            let first = (0..720)
                .find(|row| image.pixel(column, *row).expect("a pixel").is_hit())
                .expect("the ground is in view");
            // `first` must be the first row whose centre is below the horizon.
            assert!(
                (f64::from(first) + 0.5 - horizon - 0.5).abs() <= 0.75,
                "column {column}: row {first}, horizon at {horizon}"
            );
        }
    }
}

#[test]
fn misses_show_the_background_and_hits_have_depth() {
    let mut scene = one_sphere(Sphere::new(Vec3::new(0.0, 0.0, -3.0), 0.5), 33, 33);
    scene.background = Vec3::new(0.25, 0.5, 0.75);
    for image in all_paths(&scene, Shading::Flat) {
        let corner = image.pixel(0, 0).expect("a pixel");
        assert_eq!(
            (corner.color(), corner.depth()),
            (scene.background, Hit::NONE_T)
        );
        let centre = image.pixel(16, 16).expect("a pixel");
        assert_eq!((centre.color(), centre.depth()), (Vec3::X, 2.5));
        assert!(image.pixel(33, 0).is_none());
    }
}

/// The image on the CPU and on every adapter.
fn all_paths(scene: &Scene, shading: Shading) -> Vec<Image> {
    let mut images = vec![on_cpu(scene, shading)];
    images.extend(on_gpus(scene, shading));
    images
}

/// An id is the sphere's place in the scene, whatever order the tree has put the spheres in.
#[test]
fn ids_are_those_of_the_scene() {
    let mut scene = Scene::load("scenes/1crn.pdb").expect("crambin");
    (scene.width, scene.height) = (80, 60);
    let camera = scene
        .view_or_framed()
        .camera(scene.aspect())
        .expect("a camera");
    let size = UVec2::new(scene.width, scene.height);
    for image in all_paths(&scene, Shading::Id) {
        let mut hits = 0;
        for (index, pixel) in image.pixels().iter().enumerate() {
            let at = UVec2::new(index as u32 % size.x, index as u32 / size.x);
            let ray = camera.pixel_ray(at, size);
            let hit = nearest_hit(&ray, &scene.world.spheres);
            if pixel.is_hit() && hit.is_some() {
                assert_eq!(index_of(pixel.color()), hit.sphere, "{at}");
                hits += 1;
            }
        }
        assert!(hits > 1000, "{hits}");
    }
}

/// Measurements are themselves in EXR files: signed normals, distances, indices; where nothing is
/// hit they are zero, infinite, and no index, with no opacity.
#[test]
fn exr_files_hold_measurements() {
    use exr::prelude::{FlatSamples, read_first_flat_layer_from_file};

    let folder = tempfile::tempdir().expect("a folder");
    let scene = two_spheres(80, 45);
    for shading in [Shading::Normals, Shading::Depth, Shading::Id] {
        let image = on_cpu(&scene, shading);
        let path = folder.path().join(format!("{}.exr", shading.name()));
        image.save(&path).expect("a file");
        let file = read_first_flat_layer_from_file(&path).expect("an EXR file");
        let channels = &file.layer_data.channel_data.list;
        let names: Vec<String> = channels.iter().map(|it| it.name.to_string()).collect();
        let floats = |name: &str| match &channels
            [names.iter().position(|it| it == name).expect(name)]
        .sample_data
        {
            FlatSamples::F32(values) => values.clone(),
            other => panic!("{other:?}"),
        };
        let alpha = floats("A");
        for (index, pixel) in image.pixels().iter().enumerate() {
            assert_eq!(alpha[index], f32::from(u8::from(pixel.is_hit())));
        }
        let is_hit = |index: usize| image.pixels()[index].is_hit();
        match shading {
            Shading::Lit | Shading::Flat => unreachable!("they are no measurements"),
            Shading::Normals => {
                assert_eq!(names, ["A", "B", "G", "R"]);
                let normals = ["R", "G", "B"].map(floats);
                assert!(normals[1].iter().any(|y| *y < -0.5), "signed");
                let [x, y, z] = &normals;
                for (index, ((x, y), z)) in x.iter().zip(y).zip(z).enumerate() {
                    let normal = Vec3::new(*x, *y, *z);
                    let length = if is_hit(index) { 1.0 } else { 0.0 };
                    assert!((normal.length() - length).abs() < 1e-6, "{normal}");
                }
            }
            Shading::Depth => {
                assert_eq!(names, ["A", "Z"]);
                for (index, z) in floats("Z").into_iter().enumerate() {
                    assert_eq!(z.is_infinite(), !is_hit(index));
                    assert!(z > 1.0);
                }
            }
            Shading::Id => {
                assert_eq!(names, ["A", "id"]);
                let FlatSamples::U32(ids) = &channels[1].sample_data else {
                    panic!("whole numbers");
                };
                for (index, id) in ids.iter().enumerate() {
                    assert_eq!(*id == Hit::NONE_SPHERE, !is_hit(index));
                    assert!(*id < 2 || !is_hit(index));
                }
            }
        }
    }
}
