//! The practical, step 1: intersect a ray with a sphere analytically. Hits are painted red,
//! misses are left untouched.
//!
//! `cargo run --release --example step1_intersect` writes `step1.png`.

use glam::{UVec2, Vec3};
use spherule::Image;
use spherule::kernel::{Camera, Hit, Pixel, Ray, Shading};

/// The quadratic a t² + b t + c = 0 of a ray and a sphere; its smaller root that is not
/// negative.
fn intersect(center: Vec3, radius: f32, ray: &Ray) -> Option<f32> {
    let oc = ray.origin - center;
    let a = ray.direction.dot(ray.direction);
    let b = 2.0 * oc.dot(ray.direction);
    let c = oc.dot(oc) - radius * radius;
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    [(-b - root) / (2.0 * a), (-b + root) / (2.0 * a)]
        .into_iter()
        .find(|t| *t >= 0.0)
}

fn main() -> spherule::Result<()> {
    let size = UVec2::new(640, 360);
    // Looks along -z and sees one scene unit upwards at distance one.
    let aspect = size.x as f32 / size.y as f32;
    let camera = Camera::from_basis(
        Vec3::ZERO,
        Vec3::NEG_Z,
        Vec3::X * 0.5 * aspect,
        Vec3::Y * 0.5,
    );

    let untouched = Pixel::new(Vec3::splat(0.8), Hit::NONE_T);
    let mut pixels = vec![untouched; (size.x * size.y) as usize];
    for (index, pixel) in (0..).zip(&mut pixels) {
        let ray = camera.pixel_ray(UVec2::new(index % size.x, index / size.x), size);
        if let Some(t) = intersect(Vec3::new(0.0, 0.0, -3.0), 0.5, &ray) {
            *pixel = Pixel::new(Vec3::X, t);
        }
    }
    Image::new(size.x, size.y, Shading::Flat, pixels)?.save("step1.png")?;
    println!("wrote step1.png");
    Ok(())
}
