//! Measures the time of one intersection on each rung.

use std::time::Instant;

use serde::Serialize;
use spherule_kernel::accel::brute::nearest_hit_in;
use spherule_kernel::precision::OnRung;
use spherule_kernel::{Hit, Ray, Rung, Sphere};

use crate::device::{Access, Device, rung};
use crate::error::Result;

/// The time of one intersection.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Price {
    /// The median over the runs, in nanoseconds an intersection.
    pub nanoseconds: f64,
    /// The fastest run, in nanoseconds an intersection.
    pub fastest: f64,
    /// The slowest run, in nanoseconds an intersection.
    pub slowest: f64,
}

/// How often each rung is timed. The rungs take turns, so that a drift of the machine's speed
/// affects all of them alike.
const ROUNDS: usize = 7;

/// Times each of `rungs` on `samples`: every ray with a list of spheres, as a renderer does.
///
/// # Errors
///
/// The device's errors.
pub fn measure(device: &Device, rungs: &[Rung], samples: &[(Ray, Sphere)]) -> Result<Vec<Price>> {
    let (rays, spheres): (Vec<Ray>, Vec<Sphere>) = samples.iter().copied().unzip();
    let mut seconds = vec![Vec::new(); rungs.len()];
    let tests;
    match device {
        Device::Cpu => {
            // One thread: the price of an intersection, not of the machine.
            let rays = &rays[..rays.len().min(2048)];
            let spheres = &spheres[..spheres.len().min(64)];
            tests = rays.len() * spheres.len();
            for round in 0..=ROUNDS {
                for (index, rung) in rungs.iter().enumerate() {
                    let started = Instant::now();
                    std::hint::black_box(rung.with(Trace(rays, spheres)));
                    // The first round warms up.
                    if round > 0 {
                        seconds[index].push(started.elapsed().as_secs_f64());
                    }
                }
            }
        }
        Device::Gpu(gpu) => {
            let spheres = &spheres[..spheres.len().min(256)];
            let rays = &rays[..rays.len().min(1 << 20)];
            tests = rays.len() * spheres.len();
            let ray_buffer = gpu.upload("rays", rays)?;
            let sphere_buffer = gpu.upload("spheres", spheres)?;
            let hits = gpu.zeroed::<Hit>("hits", rays.len())?;
            let mut kernels = Vec::new();
            for rung in rungs {
                let module = rung::module(gpu, *rung)?;
                let access = [Access::Read, Access::Read, Access::ReadWrite];
                kernels.push(gpu.kernel(&module, "trace_rays", &access)?);
            }
            for round in 0..=ROUNDS {
                for (index, kernel) in kernels.iter().enumerate() {
                    let time = gpu.launch(
                        kernel,
                        &[
                            ray_buffer.binding(),
                            sphere_buffer.binding(),
                            hits.binding(),
                        ],
                        kernel.workgroups_for([rays.len() as u32, 1, 1]),
                    )?;
                    if round > 0 {
                        seconds[index].push(time.best().as_secs_f64());
                    }
                }
            }
        }
    }
    Ok(seconds
        .into_iter()
        .map(|mut runs| {
            runs.sort_by(f64::total_cmp);
            let nanoseconds = |seconds: f64| seconds * 1e9 / tests as f64;
            Price {
                nanoseconds: nanoseconds(runs[ROUNDS / 2]),
                fastest: nanoseconds(runs[0]),
                slowest: nanoseconds(runs[ROUNDS - 1]),
            }
        })
        .collect())
}

/// Tests each ray with every sphere, compiled for the rung.
struct Trace<'a>(&'a [Ray], &'a [Sphere]);

impl OnRung for Trace<'_> {
    type Output = u32;

    fn run<const RUNG: u32>(self) -> u32 {
        let Self(rays, spheres) = self;
        rays.iter().fold(0, |sum, ray| {
            sum ^ nearest_hit_in(RUNG, ray, spheres, 0, u32::MAX).sphere
        })
    }
}
