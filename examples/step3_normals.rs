//! The practical, step 3: the point of the hit and the normal there, shown as the colour
//! n · 0.5 + 0.5.
//!
//! `cargo run --release --example step3_normals` writes `step3.png`.

use glam::{UVec2, Vec3};
use spherule::Image;
use spherule::kernel::{Camera, Hit, Pixel, Shading, Sphere, Surface};

fn main() -> spherule::Result<()> {
    let size = UVec2::new(640, 360);
    let aspect = size.x as f32 / size.y as f32;
    let camera = Camera::from_basis(
        Vec3::ZERO,
        Vec3::NEG_Z,
        Vec3::X * 0.5 * aspect,
        Vec3::Y * 0.5,
    );
    let sphere = Sphere::new(Vec3::new(0.0, 0.0, -3.0), 0.5);

    let pixels = (0..size.x * size.y)
        .map(|index| {
            let ray = camera.pixel_ray(UVec2::new(index % size.x, index / size.x), size);
            let t = sphere.intersect(&ray);
            if t == Hit::NONE_T {
                return Pixel::new(Vec3::ZERO, t);
            }
            let surface = Surface::at(&ray, t, sphere);
            // In the file a component between -1 and 1 becomes a channel between 0 and 1.
            Pixel::new(surface.normal, t)
        })
        .collect();
    Image::new(size.x, size.y, Shading::Normals, pixels)?.save("step3.png")?;
    println!("wrote step3.png");
    Ok(())
}
