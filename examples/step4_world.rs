//! The practical, step 4: a world of spheres. The host makes it with the device's own type and
//! uploads it in one buffer. Each pixel shows the nearest hit.
//!
//! `cargo run --release --example step4_world` writes `step4.png`.

use glam::Vec3;
use spherule::kernel::{Material, Shading, Sphere};
use spherule::render::{QUIET, render};
use spherule::scene::{View, World};
use spherule::{Device, DeviceChoice, Scene};

fn main() -> spherule::Result<()> {
    let mut world = World::default();
    let grey = world.add_material(Material::diffuse(Vec3::splat(0.5)));
    world.add(Sphere::new(Vec3::new(0.0, 0.0, -3.0), 0.5), grey);
    world.add(Sphere::new(Vec3::new(0.0, -100.5, -3.0), 100.0), grey);

    let mut scene = Scene::new(world);
    (scene.width, scene.height) = (640, 360);
    scene.view = Some(View {
        eye: Vec3::ZERO,
        target: Vec3::NEG_Z,
        up: Vec3::Y,
        vertical_fov: 2.0 * 0.5_f64.atan().to_degrees(),
    });

    let (device, why) = Device::open(&DeviceChoice::Auto)?;
    println!("rendering on {} ({why})", device.name());
    render(&scene, Shading::Normals, &device, QUIET)?
        .image
        .save("step4.png")?;
    println!("wrote step4.png");
    Ok(())
}
