//! Shared by the Rust peers: the scene on disk, the test of a ray with a sphere, timing and output.
//!
//! Every peer is called as `PEER DIR [--threads N] [--repeat 3] [--hits FOLDER] [--variant NAME]`
//! and prints one line of JSON.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// The id of a miss.
pub const NONE: u32 = u32::MAX;

/// A sphere of the scene.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Sphere {
    pub center: [f32; 3],
    pub radius: f32,
}

impl Sphere {
    pub fn min(&self) -> [f32; 3] {
        self.center.map(|c| c - self.radius)
    }

    pub fn max(&self) -> [f32; 3] {
        self.center.map(|c| c + self.radius)
    }

    /// The first t in `t_min..t_max` at which the ray meets the sphere, or infinity.
    #[inline(always)]
    pub fn meet(&self, ray: &Ray, t_max: f32) -> f32 {
        let [dx, dy, dz] = ray.direction;
        let cx = self.center[0] - ray.origin[0];
        let cy = self.center[1] - ray.origin[1];
        let cz = self.center[2] - ray.origin[2];
        let kx = cy * dz - cz * dy;
        let ky = cz * dx - cx * dz;
        let kz = cx * dy - cy * dx;
        let aa = dx * dx + dy * dy + dz * dz;
        let delta = aa * (self.radius * self.radius) - (kx * kx + ky * ky + kz * kz);
        if delta < 0.0 {
            return f32::INFINITY;
        }
        let root = delta.sqrt();
        let middle = cx * dx + cy * dy + cz * dz;
        let near = (middle - root) / aa;
        let t = if near >= ray.t_min { near } else { (middle + root) / aa };
        if t >= ray.t_min && t < t_max { t } else { f32::INFINITY }
    }
}

/// A ray of the scene; its direction need not be of unit length.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Ray {
    pub origin: [f32; 3],
    pub t_min: f32,
    pub direction: [f32; 3],
    pub t_max: f32,
}

/// A hit: t and the sphere's id, which is [`NONE`] for a miss.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Hit {
    pub t: f32,
    pub id: u32,
}

impl Hit {
    pub const MISS: Self = Self { t: f32::INFINITY, id: NONE };
}

/// An acceleration structure of one crate.
pub trait Peer: Sized + Sync {
    const NAME: &str;
    const VERSION: &str;

    /// Builds the structure; runs on the thread pool that traces.
    fn build(spheres: &[Sphere], variant: Option<&str>) -> Result<Self, String>;

    /// The memory of the structure while rays are traced, spheres included, in bytes.
    fn bytes(&self) -> usize;

    fn nearest(&self, ray: &Ray) -> Hit;

    fn any(&self, ray: &Ray) -> bool;
}

#[derive(Deserialize)]
struct Meta {
    scene: String,
}

#[derive(Serialize)]
struct Kind {
    seconds: f64,
    hits: usize,
}

#[derive(Serialize)]
struct Report {
    peer: &'static str,
    version: &'static str,
    scene: String,
    threads: usize,
    build_s: f64,
    bytes: usize,
    kinds: BTreeMap<&'static str, Kind>,
}

struct Args {
    dir: PathBuf,
    threads: usize,
    repeat: usize,
    hits: Option<PathBuf>,
    variant: Option<String>,
}

fn args() -> Result<Args, String> {
    let mut words = std::env::args().skip(1);
    let mut args = Args { dir: PathBuf::new(), threads: 0, repeat: 3, hits: None, variant: None };
    while let Some(word) = words.next() {
        if !word.starts_with("--") {
            args.dir = word.into();
            continue;
        }
        let value = words.next().ok_or(format!("{word} needs a value"))?;
        let number = || value.parse().map_err(|e| format!("{word} {value}: {e}"));
        match word.as_str() {
            "--threads" => args.threads = number()?,
            "--repeat" => args.repeat = number()?.max(1),
            "--hits" => args.hits = Some(value.into()),
            "--variant" => args.variant = Some(value),
            _ => return Err(format!("unknown option {word}")),
        }
    }
    if args.dir.as_os_str().is_empty() {
        return Err("usage: PEER DIR [--threads N] [--repeat N] [--hits FOLDER] [--variant NAME]".into());
    }
    Ok(args)
}

fn read<T: Pod>(path: &Path) -> Result<Vec<T>, String> {
    let bytes = std::fs::read(path).map_err(|e| format!("{}: {e}", path.display()))?;
    Ok(bytemuck::pod_collect_to_vec(&bytes))
}

/// Traces all rays `repeat` times; returns the answers and the fastest time in seconds.
fn trace<A: Copy + Send + Zeroable>(rays: &[Ray], repeat: usize, answer: impl Fn(&Ray) -> A + Sync) -> (Vec<A>, f64) {
    const PIECE: usize = 1024;
    let mut answers = vec![A::zeroed(); rays.len()];
    let mut best = f64::INFINITY;
    for _ in 0..repeat {
        let start = Instant::now();
        answers.par_chunks_mut(PIECE).zip(rays.par_chunks(PIECE)).for_each(|(answers, rays)| {
            for (to, ray) in answers.iter_mut().zip(rays) {
                *to = answer(ray);
            }
        });
        best = best.min(start.elapsed().as_secs_f64());
    }
    (answers, best)
}

fn run<P: Peer>() -> Result<(), String> {
    let args = args()?;
    rayon::ThreadPoolBuilder::new()
        .num_threads(args.threads)
        .build_global()
        .map_err(|e| e.to_string())?;
    let meta = std::fs::read_to_string(args.dir.join("meta.json")).map_err(|e| format!("meta.json: {e}"))?;
    let meta: Meta = serde_json::from_str(&meta).map_err(|e| format!("meta.json: {e}"))?;
    let spheres: Vec<Sphere> = read(&args.dir.join("spheres.f32"))?;

    let start = Instant::now();
    let peer = P::build(&spheres, args.variant.as_deref())?;
    let build_s = start.elapsed().as_secs_f64();

    let mut kinds = BTreeMap::new();
    for kind in ["primary", "shadow", "ambient", "incoherent"] {
        let rays: Vec<Ray> = read(&args.dir.join(format!("{kind}.f32")))?;
        let (bytes, hits, seconds) = if matches!(kind, "primary" | "incoherent") {
            let (answers, seconds) = trace(&rays, args.repeat, |ray| peer.nearest(ray));
            let hits = answers.iter().filter(|hit| hit.id != NONE).count();
            (bytemuck::cast_slice(&answers).to_vec(), hits, seconds)
        } else {
            let (answers, seconds) = trace(&rays, args.repeat, |ray| u32::from(peer.any(ray)));
            let hits = answers.iter().filter(|&&hit| hit != 0).count();
            (bytemuck::cast_slice(&answers).to_vec(), hits, seconds)
        };
        if let Some(folder) = &args.hits {
            let path = folder.join(format!("{kind}.hits"));
            std::fs::write(&path, &bytes as &[u8]).map_err(|e| format!("{}: {e}", path.display()))?;
        }
        kinds.insert(kind, Kind { seconds, hits });
    }

    let report = Report {
        peer: P::NAME,
        version: P::VERSION,
        scene: meta.scene,
        threads: rayon::current_num_threads(),
        build_s,
        bytes: peer.bytes(),
        kinds,
    };
    println!("{}", serde_json::to_string(&report).map_err(|e| e.to_string())?);
    Ok(())
}

/// The `main` of every peer.
pub fn main<P: Peer>() {
    if let Err(message) = run::<P>() {
        eprintln!("{}: {message}", P::NAME);
        std::process::exit(1);
    }
}
