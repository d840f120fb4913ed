//! The practical, step 2: the same with `Sphere::intersect`, a function of the device code. It runs
//! on the GPU if there is one, otherwise on the CPU.
//!
//! `cargo run --release --example step2_sphere_type` writes `step2.png`.

mod practical;

use glam::Vec3;
use spherule::device::Access;
use spherule::kernel::{Hit, Pixel, Ray, Shading, Sphere};
use spherule::{DeviceChoice, Error, Gpu, Image, kernel_module};

/// Intersects each ray with the sphere of the same index, by the kernel's entry point
/// `intersect_pairs`. Returns the parameter of each ray's hit.
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
    let rays = practical::rays();
    // The entry point takes a sphere for each ray; here all are the same.
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
            Hit::NONE_T => practical::miss(),
            t => Pixel::new(Vec3::X, t),
        })
        .collect();
    let size = practical::SIZE;
    Image::new(size.x, size.y, Shading::Flat, pixels)?.save("step2.png")?;
    println!("wrote step2.png");
    Ok(())
}
