//! The practical, beyond step 4: its last pointer is to other intersections. The world holds shapes
//! beside spheres; each pixel shows the nearest hit of either, on the rung that is asked for.
//!
//! `cargo run --release --example step4b_other_shapes` writes `step4b.png`.

use glam::{Quat, Vec3};
use spherule::kernel::shape::{Capsule, Cone, Cuboid, Cylinder, Disc, Ellipsoid};
use spherule::kernel::{Material, Ray, Rung, Shading, Sphere};
use spherule::render::{QUIET, render};
use spherule::scene::{View, World};
use spherule::{Device, DeviceChoice, Scene};

fn main() -> spherule::Result<()> {
    let mut world = World::default();
    let grey = world.add_material(Material::diffuse(Vec3::splat(0.5)));
    world.add(Sphere::new(Vec3::new(0.0, -100.5, -4.0), 100.0), grey);
    let at = |x: f32| Vec3::new(x, 0.0, -4.0);
    let turn = Quat::from_rotation_y(0.5);
    world.add_shape(Capsule::new(at(-2.4), at(-1.8) + Vec3::Y, 0.25), grey);
    world.add_shape(
        Cylinder::new(at(-1.1) - Vec3::Y * 0.4, at(-1.1) + Vec3::Y * 0.6, 0.35),
        grey,
    );
    world.add_shape(
        Cone::new(at(0.0) - Vec3::Y * 0.4, at(0.0) + Vec3::Y * 0.7, 0.4, 0.0),
        grey,
    );
    world.add_shape(
        Ellipsoid::new(at(1.1), Vec3::new(0.5, 0.3, 0.2), turn),
        grey,
    );
    world.add_shape(Cuboid::new(at(2.2), Vec3::splat(0.4), turn), grey);
    world.add_shape(
        Disc::new(Vec3::new(0.0, 1.2, -5.0), Vec3::new(0.0, -0.3, 1.0), 0.8),
        grey,
    );

    // One rod a million times as far away as it is thick, and a ray at the edge of its silhouette.
    let rod = Capsule::new(Vec3::new(-5.0, 0.0, -1e6), Vec3::new(5.0, 0.0, -1e6), 1.0);
    let ray = Ray::new(Vec3::ZERO, Vec3::new(0.0, 0.99, -1e6));
    for rung in [Rung::Textbook, Rung::Robust, Rung::Double] {
        let t = rod.intersect(rung, &ray);
        let hits = if t < spherule::kernel::Hit::NONE_T {
            "hits"
        } else {
            "misses"
        };
        println!("{:9} {hits} the far rod", rung.name());
    }

    let mut scene = Scene::new(world);
    (scene.width, scene.height) = (640, 360);
    scene.view = Some(View {
        eye: Vec3::new(0.0, 0.6, 1.0),
        target: Vec3::new(0.0, 0.2, -4.0),
        up: Vec3::Y,
        vertical_fov: 35.0,
    });
    let (device, why) = Device::open(&DeviceChoice::Auto)?;
    println!("rendering on {} ({why})", device.name());
    let settings = (Shading::Normals, Rung::Robust);
    let rendered = render(&scene, settings, &device, QUIET)?;
    rendered.image.save("step4b.png")?;
    println!("wrote step4b.png");
    Ok(())
}
