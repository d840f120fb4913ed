//! Finds the free room in a world of spheres: for each point of a grid, how many spheres contain
//! it, and how far along +z the next surface is.
//!
//! The types and the search for the nearest hit come from `spherule-kernel`. This file is compiled
//! twice, for the GPU and for the CPU.

#![no_std]

use bytemuck::{Pod, Zeroable};
use spherule_kernel::glam::{UVec3, Vec3};
use spherule_kernel::{Ray, Sphere, nearest_hit};
use spirv_std::spirv;

/// The points `origin + spacing · (i, j, k)` with 0 ≤ i, j, k < `points_per_side`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Grid {
    /// The first point.
    pub origin: Vec3,
    /// The distance between neighbours, in scene units.
    pub spacing: f32,
    /// The number of points along each axis.
    pub points_per_side: u32,
    /// Unused: a uniform's size is a multiple of 16 bytes.
    pub padding: [u32; 3],
}

impl Grid {
    /// The point with this index; x runs fastest.
    pub fn point(&self, index: u32) -> Vec3 {
        let side = self.points_per_side;
        let cell = UVec3::new(index % side, index / side % side, index / (side * side));
        self.origin + cell.as_vec3() * self.spacing
    }
}

/// The result for a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Room {
    /// The number of spheres that contain the point.
    pub inside: u32,
    /// The distance along +z to the next surface, in scene units;
    /// [`spherule_kernel::Hit::NONE_T`] if there is none.
    pub clearance: f32,
}

/// Computes the result for a point. The entry point calls it on the GPU, the host on the CPU.
pub fn measure_room(point: Vec3, spheres: &[Sphere]) -> Room {
    let mut inside = 0;
    let mut index = 0;
    while index < spheres.len() {
        if spheres[index].contains(point) {
            inside += 1;
        }
        index += 1;
    }
    Room {
        inside,
        clearance: nearest_hit(&Ray::new(point, Vec3::Z), spheres).t,
    }
}

/// The entry point, with one thread a point.
#[spirv(compute(threads(64), entry_point_name = "measure_rooms"))]
pub fn measure_rooms(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] grid: &Grid,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] spheres: &[Sphere],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] rooms: &mut [Room],
) {
    let index = id.x as usize;
    if index < rooms.len() {
        rooms[index] = measure_room(grid.point(id.x), spheres);
    }
}
