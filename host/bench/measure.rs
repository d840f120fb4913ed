//! Measures the times of rays and of building the tree.

use std::time::{Duration, Instant};

use serde::Serialize;
use spherule_kernel::{Hit, Pixel, Rung, Shading};

use super::limit::Limit;
use super::rays::{Kind, RaySets};
use crate::accel::{self, Acceleration};
use crate::device::{Device, busy};
use crate::error::Result;
use crate::film;
use crate::render::{self, QUIET, Settings, whole_image};
use crate::scene::Scene;
use crate::trace::{CpuTracer, GpuTracer};

/// The measurements of one world.
#[derive(Clone, Debug, Serialize)]
pub struct WorldSpeeds {
    /// The world's name.
    pub scene: String,
    /// The number of spheres.
    pub spheres: usize,
    /// Whether a tree was built.
    pub has_tree: bool,
    /// Width and height of the image.
    pub size: (u32, u32),
    /// The rung.
    pub precision: &'static str,
    /// Building the tree.
    pub build: Build,
    /// Device memory for tracing (spheres, nodes and material ids), in bytes a sphere.
    pub bytes_per_sphere: f64,
    /// The rays, kind by kind.
    pub rays: Rays,
}

/// The speed of each kind of rays.
#[derive(Clone, Debug, Serialize)]
pub struct Rays {
    /// Rays from the eye.
    pub primary: Speed,
    /// Rays to a light.
    pub shadow: Speed,
    /// Rays within a short reach.
    pub ambient: Speed,
    /// Diffuse rays in random order.
    pub incoherent: Speed,
}

/// The time that building the tree takes.
#[derive(Clone, Debug, Serialize)]
pub struct Build {
    /// The median, in seconds.
    pub seconds: f64,
    /// Half of the range between the fastest and the slowest, in seconds.
    pub spread: f64,
    /// Spheres over seconds.
    pub spheres_per_s: f64,
    /// The number of threads.
    pub threads: usize,
}

/// The speed of rays of one kind.
#[derive(Clone, Debug, Serialize)]
pub struct Speed {
    /// The number of rays.
    pub rays: usize,
    /// The number of rays that hit something.
    pub hits: usize,
    /// The median over the rounds, in seconds.
    pub seconds: f64,
    /// Half of the range between the fastest and the slowest, over the median.
    pub spread: f64,
    /// Millions of rays a second.
    pub mrays_per_s: f64,
    /// Nodes whose boxes a ray was tested with, on average.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nodes_per_ray: Option<f64>,
    /// Spheres that a ray was tested with, on average.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spheres_per_ray: Option<f64>,
    /// The share of the rays a second that [`Limit`] allows, if it was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share_of_limit: Option<f64>,
}

impl Speed {
    fn of(rays: usize, hits: usize, mut times: Vec<f64>) -> Self {
        let (seconds, spread) = median(&mut times);
        Self {
            rays,
            hits,
            seconds,
            spread: spread / seconds.max(f64::MIN_POSITIVE),
            mrays_per_s: rays as f64 / seconds.max(1e-12) * 1e-6,
            nodes_per_ray: None,
            spheres_per_ray: None,
            share_of_limit: None,
        }
    }
}

/// The median, and half of the range.
fn median(times: &mut [f64]) -> (f64, f64) {
    times.sort_by(f64::total_cmp);
    match (times.first(), times.last()) {
        (Some(first), Some(last)) => (times[times.len() / 2], 0.5 * (last - first)),
        _ => (0.0, 0.0),
    }
}

/// How to measure.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// The rung.
    pub rung: Rung,
    /// Whether to build a tree.
    pub acceleration: Acceleration,
    /// How often each kind is timed; the kinds take turns.
    pub rounds: usize,
}

/// Measures `scene` on `device`. `limit` is the device's, if it was measured.
///
/// # Errors
///
/// As [`render::render`].
pub fn measure(
    device: &Device,
    name: &str,
    scene: &Scene,
    reach: f32,
    plan: Plan,
    limit: Option<&Limit>,
) -> Result<WorldSpeeds> {
    let spheres = &scene.world.spheres;
    let mut builds = Vec::new();
    for _ in 0..plan.rounds.min(3) {
        let started = Instant::now();
        let tree = accel::build_still(spheres, plan.acceleration.min_spheres(accel::MIN_SPHERES));
        if tree.is_some() {
            builds.push(started.elapsed().as_secs_f64());
        }
    }
    let (seconds, spread) = median(&mut builds);
    let tracer = CpuTracer::new(spheres, plan.acceleration);
    let sets = RaySets::of(scene, &tracer, reach)?;
    let work = Kind::ALL.map(|kind| {
        let rays = sets.kind(kind);
        let work = tracer.work(plan.rung, kind.is_any(), rays);
        let a_ray = |sum: u64| sum as f64 / rays.len().max(1) as f64;
        work.map(|(nodes, spheres)| (a_ray(nodes), a_ray(spheres)))
    });
    let (held, mut speeds) = match device {
        Device::Cpu => (tracer.bytes(), on_cpu(&tracer, scene, &sets, plan)?),
        Device::Gpu(gpu) => {
            drop(tracer);
            let tracer = GpuTracer::new(gpu, spheres, plan.acceleration)?;
            (tracer.bytes(), on_gpu(gpu, &tracer, scene, &sets, plan)?)
        }
    };
    let ids = size_of_val(&scene.world.material_ids[..]);
    let bytes = (held + ids) as f64 / spheres.len().max(1) as f64;
    for ((speed, work), kind) in speeds.iter_mut().zip(work).zip(Kind::ALL) {
        speed.nodes_per_ray = work.map(|(nodes, _)| nodes);
        speed.spheres_per_ray = work.map(|(_, spheres)| spheres);
        let (nodes, spheres) = work.unwrap_or((0.0, spheres.len() as f64));
        speed.share_of_limit =
            limit.map(|limit| speed.mrays_per_s * 1e6 / limit.rays_per_s(kind, nodes, spheres));
    }
    let [primary, shadow, ambient, incoherent] = speeds;
    Ok(WorldSpeeds {
        scene: name.into(),
        spheres: spheres.len(),
        has_tree: !builds.is_empty(),
        size: (scene.width, scene.height),
        precision: plan.rung.name(),
        build: Build {
            seconds,
            spread,
            spheres_per_s: if seconds > 0.0 {
                spheres.len() as f64 / seconds
            } else {
                0.0
            },
            threads: rayon::current_num_threads(),
        },
        bytes_per_sphere: bytes,
        rays: Rays {
            primary,
            shadow,
            ambient,
            incoherent,
        },
    })
}

/// The settings with which primary rays are timed: an image of one colour.
fn settings(plan: Plan) -> Settings {
    Settings {
        acceleration: plan.acceleration,
        ..Settings::from((Shading::Flat, plan.rung))
    }
}

fn on_cpu(
    tracer: &CpuTracer,
    scene: &Scene,
    sets: &RaySets,
    plan: Plan,
) -> Result<[Speed; Kind::ALL.len()]> {
    let launch = whole_image(scene)?;
    let world = render::cpu::Prepared::new(&scene.world, plan.acceleration);
    let mut times = Kind::ALL.map(|_| Vec::new());
    let mut found = [0; Kind::ALL.len()];
    let (mut hits, mut occluded) = (Vec::new(), Vec::new());
    let mut pixels = film::allocate(scene.width, scene.height)?;
    for round in 0..=plan.rounds {
        for kind in Kind::ALL {
            let rays = sets.kind(kind);
            let started = Instant::now();
            let took: Duration;
            let index = kind as usize;
            if kind == Kind::Primary {
                render::cpu::render_to(&mut pixels, &launch, &world, settings(plan), QUIET)?;
                took = started.elapsed();
                found[index] = pixels
                    .iter()
                    .filter(|pixel: &&Pixel| pixel.is_hit())
                    .count();
            } else if kind.is_any() {
                tracer.occluded(plan.rung, rays, &mut occluded);
                took = started.elapsed();
                found[index] = occluded.iter().filter(|hit| **hit != 0).count();
            } else {
                tracer.nearest(plan.rung, rays, &mut hits);
                took = started.elapsed();
                found[index] = hits.iter().filter(|hit: &&Hit| hit.is_some()).count();
            }
            // The first round warms up.
            if round > 0 {
                times[index].push(took.as_secs_f64());
            }
        }
    }
    Ok(speeds(sets, found, times))
}

fn on_gpu(
    gpu: &crate::device::Gpu,
    tracer: &GpuTracer<'_>,
    scene: &Scene,
    sets: &RaySets,
    plan: Plan,
) -> Result<[Speed; Kind::ALL.len()]> {
    let launch = whole_image(scene)?;
    let world = render::gpu::Prepared::new(gpu, &scene.world, settings(plan))?;
    let [shadow, ambient, incoherent] = [&sets.shadow, &sets.ambient, &sets.incoherent];
    let batches = [
        tracer.upload(shadow)?,
        tracer.upload(ambient)?,
        tracer.upload(incoherent)?,
    ];
    let mut times = Kind::ALL.map(|_| Vec::new());
    let mut found = [0; Kind::ALL.len()];
    busy::keep_busy(gpu, busy::WARM_UP)?;
    let launch_once = |kind: Kind| match kind {
        Kind::Primary => render::gpu::time(gpu, &launch, &world),
        Kind::Shadow | Kind::Ambient => tracer.occluded(plan.rung, &batches[kind as usize - 1]),
        Kind::Incoherent => tracer.nearest(plan.rung, &batches[kind as usize - 1]),
    };
    for _ in 0..plan.rounds {
        for kind in Kind::ALL {
            if sets.kind(kind).is_empty() {
                continue;
            }
            busy::keep_busy(gpu, busy::BETWEEN)?;
            // The caches then hold the scene, as they do if one image follows another.
            launch_once(kind)?;
            times[kind as usize].push(launch_once(kind)?.as_secs_f64());
        }
    }
    let (pixels, _) = render::gpu::render(gpu, &launch, &world, QUIET)?;
    found[Kind::Primary as usize] = pixels.iter().filter(|pixel| pixel.is_hit()).count();
    for kind in [Kind::Shadow, Kind::Ambient] {
        let index = kind as usize;
        let occluded = tracer.occlusions(&batches[index - 1])?;
        found[index] = occluded.iter().filter(|hit| **hit != 0).count();
    }
    tracer.nearest(plan.rung, &batches[Kind::Incoherent as usize - 1])?;
    let hits = tracer.hits(&batches[Kind::Incoherent as usize - 1])?;
    found[Kind::Incoherent as usize] = hits.iter().filter(|hit| hit.is_some()).count();
    Ok(speeds(sets, found, times))
}

fn speeds(
    sets: &RaySets,
    found: [usize; Kind::ALL.len()],
    times: [Vec<f64>; Kind::ALL.len()],
) -> [Speed; Kind::ALL.len()] {
    let mut times = times.into_iter();
    Kind::ALL.map(|kind| {
        let times = times.next().unwrap_or_default();
        Speed::of(sets.kind(kind).len(), found[kind as usize], times)
    })
}
