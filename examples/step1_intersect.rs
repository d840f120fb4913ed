//! The practical, step 1: intersects a ray with a sphere analytically. Hits are red, misses keep
//! the grey of the untouched image.
//!
//! `cargo run --release --example step1_intersect` writes `step1.png`.

mod practical;

use glam::{UVec2, Vec3};
use spherule::Image;
use spherule::kernel::{Pixel, Ray, Shading};

/// The smaller root of the quadratic a t² + b t + c = 0 of a ray and a sphere that is not negative.
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
    let (size, camera) = (practical::SIZE, practical::camera());
    let mut pixels = vec![practical::miss(); (size.x * size.y) as usize];
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
