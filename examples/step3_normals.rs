//! The practical, step 3: the point of the hit and the normal n there, shown as the colour
//! n · 0.5 + 0.5.
//!
//! `cargo run --release --example step3_normals` writes `step3.png`.

mod practical;

use glam::Vec3;
use spherule::Image;
use spherule::kernel::{Hit, Pixel, Shading, Sphere, Surface};

fn main() -> spherule::Result<()> {
    let sphere = Sphere::new(Vec3::new(0.0, 0.0, -3.0), 0.5);

    let pixels = practical::rays()
        .into_iter()
        .map(|ray| {
            let t = sphere.intersect(&ray);
            if t == Hit::NONE_T {
                return practical::miss();
            }
            let surface = Surface::at(&ray, t, sphere);
            // In the file a component between -1 and 1 becomes a channel between 0 and 1.
            Pixel::new(surface.normal, t)
        })
        .collect();
    let size = practical::SIZE;
    Image::new(size.x, size.y, Shading::Normals, pixels)?.save("step3.png")?;
    println!("wrote step3.png");
    Ok(())
}
