//! The practical, step 2: the same with the device's own `Sphere` and its `intersect`, run on
//! the GPU where there is one.
//!
//! `cargo run --release --example step2_sphere_type` writes `step2.png`.

use glam::{UVec2, Vec3};
use spherule::device::Access;
use spherule::kernel::{Camera, Hit, Pixel, Ray, Shading, Sphere};
use spherule::{DeviceChoice, Error, Gpu, Image, kernel_module};

/// The parameter of each ray's hit, by the kernel's entry point `intersect_pairs`.
fn intersect_on_gpu(gpu: &Gpu, rays: &[Ray], spheres: &[Sphere]) -> spherule::Result<Vec<f32>> {
    let kernel = gpu.kernel(
        &kernel_module::f32()?,
        "intersect_pairs",
        &[Access::Read, Access::Read, Access::ReadWrite],
    )?;
    let parameters = gpu.zeroed::<f32>("parameters", rays.len())?;
    gpu.launch(
        &kernel,
        &[
            gpu.upload("rays", rays)?.binding(),
            gpu.upload("spheres", spheres)?.binding(),
            parameters.binding(),
        ],
        kernel.workgroups_for([rays.len() as u32, 1, 1]),
    )?;
    gpu.read(&parameters)
}

fn main() -> spherule::Result<()> {
    let size = UVec2::new(640, 360);
    let aspect = size.x as f32 / size.y as f32;
    let camera = Camera::from_basis(
        Vec3::ZERO,
        Vec3::NEG_Z,
        Vec3::X * 0.5 * aspect,
        Vec3::Y * 0.5,
    );
    let rays: Vec<Ray> = (0..size.x * size.y)
        .map(|index| camera.pixel_ray(UVec2::new(index % size.x, index / size.x), size))
        .collect();
    // One sphere a ray, all the same here.
    let spheres = vec![Sphere::new(Vec3::new(0.0, 0.0, -3.0), 0.5); rays.len()];

    let parameters = match Gpu::open(&DeviceChoice::Gpu) {
        Ok(gpu) => {
            println!("intersecting on {}", gpu.name());
            intersect_on_gpu(&gpu, &rays, &spheres)?
        }
        Err(Error::NoAdapter { .. }) => {
            println!("intersecting on the CPU, with the same function");
            rays.iter()
                .zip(&spheres)
                .map(|(ray, sphere)| sphere.intersect(ray))
                .collect()
        }
        Err(error) => return Err(error),
    };

    let pixels = parameters
        .into_iter()
        .map(|t| match t {
            Hit::NONE_T => Pixel::new(Vec3::splat(0.8), t),
            t => Pixel::new(Vec3::X, t),
        })
        .collect();
    Image::new(size.x, size.y, Shading::Flat, pixels)?.save("step2.png")?;
    println!("wrote step2.png");
    Ok(())
}
