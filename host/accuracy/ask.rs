//! Runs functions of the kernel on a device, GPU or CPU alike, many inputs at once; they are the
//! functions that the renderer calls.

use bytemuck::Pod;
use rayon::prelude::*;
use spherule_kernel::accel::brute::{is_occluded, nearest_hit_in};
use spherule_kernel::material::optics::{Fresnel, Incidence};
use spherule_kernel::probe::glass_walk::{Walk, walk_inside};
use spherule_kernel::{Hit, Ray, Rung, Sphere, Surface};

use crate::device::{Access, Binding, Device, Gpu, rung};
use crate::error::Result;

/// How often [`walks`] reflects a path; the entry point uses the same number.
const WALK: u32 = 1000;

/// The nearest hit of each ray among `spheres`.
///
/// # Errors
///
/// The device's errors, here and in the other functions of this module.
pub fn nearest(device: &Device, rung: Rung, rays: &[Ray], spheres: &[Sphere]) -> Result<Vec<Hit>> {
    match device {
        Device::Cpu => Ok(rays
            .par_iter()
            .map(|ray| nearest_hit_in(rung.to_u32(), ray, spheres, 0, u32::MAX))
            .collect()),
        Device::Gpu(gpu) => {
            let rays = gpu.upload("rays", rays)?;
            let spheres = gpu.upload("spheres", spheres)?;
            let inputs = [rays.binding(), spheres.binding()];
            launch(gpu, rung, "trace_rays", &inputs, rays.len(), 1)
        }
    }
}

/// Whether any of `spheres` occludes each ray.
///
/// # Errors
///
/// The device's errors.
pub fn occluded(
    device: &Device,
    rung: Rung,
    rays: &[Ray],
    spheres: &[Sphere],
) -> Result<Vec<bool>> {
    match device {
        Device::Cpu => Ok(rays
            .par_iter()
            .map(|ray| is_occluded(rung.to_u32(), ray, spheres))
            .collect()),
        Device::Gpu(gpu) => {
            let rays = gpu.upload("rays", rays)?;
            let spheres = gpu.upload("spheres", spheres)?;
            let inputs = [rays.binding(), spheres.binding()];
            let flags: Vec<u32> = launch(gpu, rung, "occlude_rays", &inputs, rays.len(), 1)?;
            Ok(flags.into_iter().map(|flag| flag != 0).collect())
        }
    }
}

/// The surface of sphere i at parameter i on ray i.
///
/// # Errors
///
/// The device's errors.
pub fn surfaces(
    device: &Device,
    samples: &[(Ray, Sphere)],
    parameters: &[f32],
) -> Result<Vec<Surface>> {
    match device {
        Device::Cpu => Ok(samples
            .iter()
            .zip(parameters)
            .map(|((ray, sphere), t)| Surface::at(ray, *t, *sphere))
            .collect()),
        Device::Gpu(gpu) => {
            let (rays, spheres): (Vec<Ray>, Vec<Sphere>) = samples.iter().copied().unzip();
            let rays = gpu.upload("rays", &rays)?;
            let spheres = gpu.upload("spheres", &spheres)?;
            let parameters = gpu.upload("parameters", parameters)?;
            let inputs = [rays.binding(), spheres.binding(), parameters.binding()];
            let vectors: Vec<glam::Vec4> = launch(
                gpu,
                Rung::default(),
                "find_surfaces",
                &inputs,
                rays.len(),
                2,
            )?;
            Ok(vectors
                .chunks_exact(2)
                .map(|pair| Surface {
                    point: pair[0].truncate(),
                    normal: pair[1].truncate(),
                    error: pair[0].w,
                })
                .collect())
        }
    }
}

/// The reflected and transmitted light at each boundary.
///
/// # Errors
///
/// The device's errors.
pub fn fresnel(device: &Device, incidences: &[Incidence]) -> Result<Vec<Fresnel>> {
    match device {
        Device::Cpu => Ok(incidences.iter().map(|one| one.fresnel()).collect()),
        Device::Gpu(gpu) => {
            let buffer = gpu.upload("incidences", incidences)?;
            let inputs = [buffer.binding()];
            let rung = Rung::default();
            launch(gpu, rung, "cross_boundaries", &inputs, buffer.len(), 1)
        }
    }
}

/// Walks of rays that each enter their sphere of this refractive index, are reflected a thousand
/// times, and leave.
///
/// # Errors
///
/// The device's errors.
pub fn walks(
    device: &Device,
    rung: Rung,
    samples: &[(Ray, Sphere)],
    indices: &[f32],
) -> Result<Vec<Walk>> {
    match device {
        Device::Cpu => Ok(samples
            .par_iter()
            .zip(indices)
            .map(|((ray, sphere), index)| walk_inside(rung.to_u32(), ray, *sphere, *index, WALK))
            .collect()),
        Device::Gpu(gpu) => {
            let (rays, spheres): (Vec<Ray>, Vec<Sphere>) = samples.iter().copied().unzip();
            let rays = gpu.upload("rays", &rays)?;
            let spheres = gpu.upload("spheres", &spheres)?;
            let indices = gpu.upload("refractive indices", indices)?;
            let inputs = [rays.binding(), spheres.binding(), indices.binding()];
            launch(gpu, rung, "walk_inside_spheres", &inputs, rays.len(), 1)
        }
    }
}

/// Runs an entry point with one thread for each element, which writes `each` results.
fn launch<T: Pod>(
    gpu: &Gpu,
    rung: Rung,
    entry: &str,
    inputs: &[Binding<'_>],
    elements: usize,
    each: usize,
) -> Result<Vec<T>> {
    let mut access = vec![Access::Read; inputs.len()];
    access.push(Access::ReadWrite);
    let kernel = gpu.kernel(&rung::module(gpu, rung)?, entry, &access)?;
    let output = gpu.zeroed::<T>("results", elements * each)?;
    let mut bindings = inputs.to_vec();
    bindings.push(output.binding());
    let groups = kernel.workgroups_for([elements as u32, 1, 1]);
    gpu.launch(&kernel, &bindings, groups)?;
    gpu.read(&output)
}
