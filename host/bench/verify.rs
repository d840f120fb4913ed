//! Checks that the tree loses no hit: compares it, ray by ray, with testing every sphere.

use serde::Serialize;
use spherule_kernel::{Hit, Ray, Rung};

use super::rays::{Kind, RaySets};
use crate::accel::Acceleration;
use crate::device::{Device, Gpu};
use crate::error::Result;
use crate::scene::Scene;
use crate::trace::{CpuTracer, GpuTracer};

/// The result of a comparison.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Verified {
    /// Rays that were traced both ways.
    pub rays: usize,
    /// Rays whose t differs, or that hit one way and miss the other way.
    pub differing: usize,
    /// Rays with equal t but different spheres: two spheres are equally near, and the tree has
    /// another order.
    pub ties: usize,
}

/// The most tests of rays with spheres for one kind.
fn budget(device: &Device) -> usize {
    match device {
        Device::Cpu => 1 << 28,
        Device::Gpu(gpu) if gpu.is_software() => 1 << 28,
        Device::Gpu(_) => 1 << 39,
    }
}

/// Compares both ways for the rays of each kind: for as many of them, evenly spaced, as can be
/// tested with every sphere within seconds.
///
/// # Errors
///
/// The device's errors.
pub fn verify(device: &Device, scene: &Scene, sets: &RaySets, rung: Rung) -> Result<Verified> {
    let spheres = &scene.world.spheres;
    let most = (budget(device) / spheres.len().max(1)).max(1);
    let mut verified = Verified::default();
    for kind in Kind::ALL {
        let rays = sets.kind(kind);
        let step = rays.len().div_ceil(most).max(1);
        let rays: Vec<Ray> = rays.iter().copied().step_by(step).collect();
        if rays.is_empty() {
            continue;
        }
        let trace = |acceleration| match device {
            Device::Cpu => {
                let tracer = CpuTracer::new(spheres, acceleration);
                Ok(trace_cpu(&tracer, kind, rung, &rays))
            }
            Device::Gpu(gpu) => trace_gpu(gpu, spheres, acceleration, kind, rung, &rays),
        };
        let with: Vec<Hit> = trace(Acceleration::Tree)?;
        let without: Vec<Hit> = trace(Acceleration::BruteForce)?;
        verified.rays += rays.len();
        for (with, without) in with.iter().zip(&without) {
            if with.t != without.t || with.is_some() != without.is_some() {
                verified.differing += 1;
            } else if with.sphere != without.sphere {
                verified.ties += 1;
            }
        }
    }
    Ok(verified)
}

/// The hits; if any hit will do, a hit at t = 0.
fn trace_cpu(tracer: &CpuTracer, kind: Kind, rung: Rung, rays: &[Ray]) -> Vec<Hit> {
    let mut hits = Vec::new();
    if kind.is_any() {
        let mut occluded = Vec::new();
        tracer.occluded(rung, rays, &mut occluded);
        hits.extend(occluded.into_iter().map(any_hit));
    } else {
        tracer.nearest(rung, rays, &mut hits);
    }
    hits
}

fn trace_gpu(
    gpu: &Gpu,
    spheres: &[spherule_kernel::Sphere],
    acceleration: Acceleration,
    kind: Kind,
    rung: Rung,
    rays: &[Ray],
) -> Result<Vec<Hit>> {
    let tracer = GpuTracer::new(gpu, spheres, acceleration)?;
    let batch = tracer.upload(rays)?;
    if kind.is_any() {
        tracer.occluded(rung, &batch)?;
        let occluded = tracer.occlusions(&batch)?;
        Ok(occluded.into_iter().map(any_hit).collect())
    } else {
        tracer.nearest(rung, &batch)?;
        tracer.hits(&batch)
    }
}

fn any_hit(occluded: u32) -> Hit {
    if occluded == 0 {
        Hit::NONE
    } else {
        Hit { t: 0.0, sphere: 0 }
    }
}
