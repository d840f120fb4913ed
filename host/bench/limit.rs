//! [`Limit`]: the measured peak throughput of a device, and the rays a second that it would allow.
//!
//! At least, a ray must be tested with the boxes and the spheres that it meets on its way through
//! the tree, or with every sphere in a world without a tree; it must be read, and its hit written.
//! The limit is reached if the device does nothing else: no waiting, no sorting, no idle lanes, and
//! no cache misses.
//!
//! Packets and tiles share tests among rays, so they may come close to the limit or exceed it.

use std::hint::black_box;
use std::time::{Duration, Instant};

use fearless_simd::{Level, Simd, dispatch};
use glam::Vec4;
use rayon::prelude::*;
use serde::Serialize;
use spherule_kernel::accel::node::Node;
use spherule_kernel::probe::throughput::MULTIPLICATIONS;
use spherule_kernel::{Hit, Pixel, Ray};

use super::rays::Kind;
use crate::cpu::InstructionSet;
use crate::device::{Access, Device, Gpu, busy};
use crate::error::Result;
use crate::kernel_module;
use crate::lanes::{LANES, Single16};

/// Operations of a test. Box: six multiply-adds, six comparisons for the largest and the smallest,
/// one of these two. Sphere, by its discriminant: three differences, three products for each of o·d
/// and o·o, one for c, two for the discriminant, one comparison.
const OPERATIONS: f64 = 13.0;
/// How often each throughput is measured; the fastest counts.
const ROUNDS: usize = 5;
/// The shortest launch whose start and end do not matter.
const LONG: Duration = Duration::from_millis(5);

/// The peak throughput of a device.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Limit {
    /// Multiplications of 32-bit floats a second. Sums, multiply-adds and comparisons take as long.
    pub operations_per_s: f64,
    /// Bytes read and written a second, in large arrays.
    pub bytes_per_s: f64,
}

impl Limit {
    /// Measures a device.
    ///
    /// # Errors
    ///
    /// The device's errors.
    pub fn of(device: &Device) -> Result<Self> {
        match device {
            Device::Cpu => Ok(Self {
                operations_per_s: multiply_on_cpu()?,
                bytes_per_s: copy_on_cpu()?,
            }),
            Device::Gpu(gpu) => Ok(Self {
                operations_per_s: multiply_on_gpu(gpu)?,
                bytes_per_s: copy_on_gpu(gpu)?,
            }),
        }
    }

    /// The most rays a second of a kind, for rays that meet this many nodes and spheres each.
    #[must_use]
    pub fn rays_per_s(&self, kind: Kind, nodes: f64, spheres: f64) -> f64 {
        let tests = nodes * Node::WIDTH as f64 + spheres;
        let bytes = match kind {
            Kind::Primary => size_of::<Pixel>(),
            Kind::Shadow | Kind::Ambient => size_of::<Ray>() + size_of::<u32>(),
            Kind::Incoherent => size_of::<Ray>() + size_of::<Hit>(),
        };
        let seconds =
            (tests * OPERATIONS / self.operations_per_s).max(bytes as f64 / self.bytes_per_s);
        1.0 / seconds
    }
}

/// The largest result of several rounds.
fn fastest(mut round: impl FnMut() -> Result<f64>) -> Result<f64> {
    (0..ROUNDS).try_fold(0.0, |fastest: f64, _| Ok(fastest.max(round()?)))
}

/// Independent products of `rounds` factors each.
fn products(level: Level, factor: f32, rounds: u32) -> f32 {
    #[inline(always)]
    fn with<S: Simd>(simd: S, factor: f32, rounds: u32) -> f32 {
        let mut products = [Single16::splat(simd, 1.0); PRODUCTS];
        let factor = Single16::splat(simd, factor);
        for _ in 0..rounds {
            for product in &mut products {
                *product = *product * factor;
            }
        }
        let mut sum = [0.0; LANES];
        let zero = Single16::splat(simd, 0.0);
        let all = products
            .into_iter()
            .fold(zero, |sum, product| sum + product);
        all.store(&mut sum);
        sum.iter().sum()
    }
    dispatch!(level, simd => with(simd, factor, rounds))
}

/// Enough products to hide the latency of a multiplication, but few enough for the registers.
const PRODUCTS: usize = 10;

fn multiply_on_cpu() -> Result<f64> {
    const FACTORS: u32 = 2_000_000;
    let level = InstructionSet::chosen()
        .level()
        .unwrap_or(Level::baseline());
    fastest(|| {
        let started = Instant::now();
        let threads =
            rayon::broadcast(|_| black_box(products(level, black_box(0.999_999_9), FACTORS)));
        let done = threads.len() as f64 * f64::from(FACTORS) * (LANES * PRODUCTS) as f64;
        Ok(done / started.elapsed().as_secs_f64())
    })
}

fn copy_on_cpu() -> Result<f64> {
    const WORDS: usize = 1 << 25;
    const PIECE: usize = 1 << 16;
    let from = vec![1_u32; WORDS];
    let mut to = vec![2_u32; WORDS];
    let bytes = (size_of_val(&from[..]) + size_of_val(&to[..])) as f64;
    fastest(|| {
        let started = Instant::now();
        to.par_chunks_mut(PIECE)
            .zip(from.par_chunks(PIECE))
            .for_each(|(to, from)| to.copy_from_slice(from));
        black_box(&to);
        Ok(bytes / started.elapsed().as_secs_f64())
    })
}

fn multiply_on_gpu(gpu: &Gpu) -> Result<f64> {
    let access = [Access::Read, Access::ReadWrite];
    let kernel = gpu.kernel(&kernel_module::f32()?, "measure_multiplications", &access)?;
    let threads = if gpu.is_software() { 1 << 12 } else { 1 << 20 };
    let sums = gpu.zeroed::<f32>("sums", threads as usize)?;
    let groups = kernel.workgroups_for([threads, 1, 1]);
    // Enough rounds to take long enough, but not so many that a driver's watchdog ends the launch.
    let mut rounds = 16;
    loop {
        let parameters = gpu.upload("factor and rounds", &[0.999_999_9, rounds as f32])?;
        let bindings = [parameters.binding(), sums.binding()];
        let took = gpu.launch(&kernel, &bindings, groups)?.best();
        if took < LONG && rounds < 1 << 20 {
            rounds *= 2;
            continue;
        }
        busy::keep_busy(gpu, busy::WARM_UP)?;
        let done = f64::from(threads) * f64::from(rounds) * f64::from(MULTIPLICATIONS);
        return fastest(|| {
            let took = gpu.launch(&kernel, &bindings, groups)?.best();
            Ok(done / took.as_secs_f64().max(f64::MIN_POSITIVE))
        });
    }
}

fn copy_on_gpu(gpu: &Gpu) -> Result<f64> {
    let access = [Access::Read, Access::ReadWrite];
    let kernel = gpu.kernel(&kernel_module::f32()?, "measure_copying", &access)?;
    let most = gpu.limits().max_storage_buffer_binding_size as usize;
    let count = (most / size_of::<Vec4>()).min(1 << 24);
    let from = gpu.zeroed::<Vec4>("copied from", count)?;
    let to = gpu.zeroed::<Vec4>("copied to", count)?;
    let bindings = [from.binding(), to.binding()];
    let groups = gpu.rows_of(kernel.workgroups_for([count as u32, 1, 1])[0]);
    let bytes = (2 * count * size_of::<Vec4>()) as f64;
    fastest(|| {
        let took = gpu.launch(&kernel, &bindings, groups)?.best();
        Ok(bytes / took.as_secs_f64().max(f64::MIN_POSITIVE))
    })
}
