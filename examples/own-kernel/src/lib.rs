//! Runs your own kernel with spherule's devices and errors: it finds the free and the occupied room
//! among spheres.

pub use own_kernel_device::{Grid, Room, measure_room};
use rayon::prelude::*;
use spherule::device::{Access, Gpu, Module};
use spherule::kernel::Sphere;

/// The SPIR-V that this package's build script compiled.
static SPIRV: &[u8] = include_bytes!(env!("OWN_KERNEL_SPV"));

/// The result for each point of the grid, x running fastest, computed on a GPU.
///
/// # Errors
///
/// The errors of the device: an invalid kernel, missing memory, a failed launch or readback.
pub fn rooms_on_gpu(gpu: &Gpu, grid: &Grid, spheres: &[Sphere]) -> spherule::Result<Vec<Room>> {
    let module = Module::from_bytes("own-kernel", SPIRV)?;
    // SAFETY: rust-gpu emitted these words, and the bindings below are those of the entry point.
    // Without this, naga would translate the module, which is safe and slower.
    let module = unsafe { module.trusted() };
    let kernel = gpu.kernel(
        &module,
        "measure_rooms",
        &[Access::Uniform, Access::Read, Access::ReadWrite],
    )?;
    let count = grid.points_per_side.pow(3);
    let rooms = gpu.zeroed::<Room>("rooms", count as usize)?;
    gpu.launch(
        &kernel,
        &[
            gpu.upload_uniform("grid", grid)?.binding(),
            gpu.upload("spheres", spheres)?.binding(),
            rooms.binding(),
        ],
        kernel.workgroups_for([count, 1, 1]),
    )?;
    gpu.read(&rooms)
}

/// The same on the CPU, by the same function.
#[must_use]
pub fn rooms_on_cpu(grid: &Grid, spheres: &[Sphere]) -> Vec<Room> {
    (0..grid.points_per_side.pow(3))
        .into_par_iter()
        .map(|index| measure_room(grid.point(index), spheres))
        .collect()
}

/// A cubic grid that contains every sphere, with `points_per_side` points a side, clamped to 2 to
/// 128.
#[must_use]
pub fn grid_around(spheres: &[Sphere], points_per_side: u32) -> Grid {
    let points_per_side = points_per_side.clamp(2, 128);
    let first = spheres.first().map(Sphere::center).unwrap_or_default();
    let (mut low, mut high) = (first, first);
    for sphere in spheres {
        low = low.min(sphere.center() - sphere.radius());
        high = high.max(sphere.center() + sphere.radius());
    }
    Grid {
        origin: low,
        spacing: (high - low).max_element() / (points_per_side - 1) as f32,
        points_per_side,
        padding: [0; 3],
    }
}
