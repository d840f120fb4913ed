//! Fields of a million spheres, rods, ellipsoids, and balls and sticks: how fast a camera's rays
//! are among each, and a picture of the ellipsoids, which turn from layer to layer as the molecules
//! of a chiral nematic do.
//!
//! `cargo run --release --example shapes_by_the_million [COUNT]` prints the rates, and writes
//! `nematic.png` with a tenth of the ellipsoids.

use std::time::{Duration, Instant};

use glam::{Quat, Vec3};
use spherule::kernel::shape::{Capsule, Ellipsoid};
use spherule::kernel::{Material, Rung, Shading, Sphere};
use spherule::random::Random;
use spherule::render::{QUIET, Settings, cpu, gpu, render, whole_image};
use spherule::scene::{View, World};
use spherule::{Device, DeviceChoice, Scene};

/// How often each is rendered; the median counts.
const ROUNDS: usize = 7;
/// How long a GPU works before its frames are timed.
const WARM_UP: Duration = Duration::from_millis(500);

/// Adds one thing of a field around a point; the field is so large.
type Add = fn(&mut World, &mut Random, Vec3, f32);

fn main() -> spherule::Result<()> {
    let count = std::env::args().nth(1).and_then(|count| count.parse().ok());
    let count: usize = count.unwrap_or(1_000_000);
    let (device, why) = Device::open(&DeviceChoice::Auto)?;
    println!(
        "{} ({why}), 1920 × 1080, robust, the median of {ROUNDS}",
        device.name()
    );
    let fields: [(&str, Add); 4] = [
        ("spheres", ball),
        ("rods", rod),
        ("ellipsoids", grain),
        ("balls and sticks", ball_and_stick),
    ];
    for (name, add) in fields {
        let mut scene = field(count, add);
        (scene.width, scene.height) = (1920, 1080);
        let time = frame_time(&scene, &device)?.as_secs_f64().max(1e-9);
        let rate = 1920.0 * 1080.0 * 1e-6 / time;
        println!("{name:17} {:8.3} ms  {rate:8.1} Mrays/s", time * 1e3);
    }

    let mut scene = field(count / 10, grain);
    scene.background = Vec3::ONE;
    scene.sampling.ambient_occlusion = Some(6.0);
    scene.sampling.samples = Some(64);
    let rendered = render(&scene, Settings::default(), &device, QUIET)?;
    rendered.image.save("nematic.png")?;
    println!("wrote nematic.png");
    Ok(())
}

/// The median time of a frame, without what is done once. On a GPU frames follow each other, so
/// that its clock is up.
fn frame_time(scene: &Scene, device: &Device) -> spherule::Result<Duration> {
    let settings = Settings::from((Shading::Normals, Rung::Robust));
    let launch = whole_image(scene)?;
    let mut times = Vec::new();
    match device {
        Device::Cpu => {
            let world = cpu::Prepared::new(&scene.world, settings.acceleration);
            for _ in 0..ROUNDS {
                let started = Instant::now();
                let pixels = cpu::render(&launch, &world, settings, QUIET)?;
                times.push(started.elapsed());
                drop(pixels);
            }
        }
        Device::Gpu(gpu) => {
            let world = gpu::Prepared::new(gpu, &scene.world, settings)?;
            let started = Instant::now();
            while started.elapsed() < WARM_UP {
                gpu::time(gpu, &launch, &world)?;
            }
            for _ in 0..ROUNDS {
                times.push(gpu::time(gpu, &launch, &world)?);
            }
        }
    }
    times.sort();
    Ok(times[ROUNDS / 2])
}

/// Things in a cube, as dense whatever their number is.
fn field(count: usize, add: Add) -> Scene {
    let mut random = Random::new(5);
    let mut world = World::default();
    world.add_material(Material::diffuse(Vec3::new(0.85, 0.45, 0.2)));
    world.add_material(Material::diffuse(Vec3::new(0.2, 0.5, 0.75)));
    let half = 40.0 * (count as f32 / 1e5).cbrt();
    for _ in 0..count {
        let at = random.vec3(-half, half);
        add(&mut world, &mut random, at, half);
    }
    let mut scene = Scene::new(world);
    scene.view = Some(View {
        eye: Vec3::new(2.7, 1.7, 3.65) * half,
        target: Vec3::new(0.0, -0.12, 0.0) * half,
        up: Vec3::Y,
        vertical_fov: 38.0,
    });
    scene
}

/// One in three is of the second material.
fn material(random: &mut Random) -> u32 {
    u32::from(random.next_u32().is_multiple_of(3))
}

fn ball(world: &mut World, random: &mut Random, at: Vec3, _: f32) {
    let material = material(random);
    world.add(Sphere::new(at, 0.8), material);
}

fn rod(world: &mut World, random: &mut Random, at: Vec3, _: f32) {
    let half = random.unit_vec3() * 1.5;
    let material = material(random);
    world.add_shape(Capsule::new(at - half, at + half, 0.3), material);
}

fn grain(world: &mut World, random: &mut Random, at: Vec3, half: f32) {
    // The layers turn by two thirds of a turn from the lowest to the highest.
    let angle = 2.4 * at.y / half + random.within(-0.3, 0.3);
    let turn = Quat::from_rotation_y(angle) * Quat::from_rotation_z(random.within(-0.25, 0.25));
    let material = material(random);
    world.add_shape(Ellipsoid::new(at, Vec3::new(1.5, 0.5, 0.5), turn), material);
}

fn ball_and_stick(world: &mut World, random: &mut Random, at: Vec3, _: f32) {
    let half = random.unit_vec3() * 0.9;
    world.add(Sphere::new(at - half, 0.45), 0);
    world.add(Sphere::new(at + half, 0.45), 1);
    world.add_shape(Capsule::new(at - half, at + half, 0.18), 0);
}
