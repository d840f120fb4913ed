//! The `#[spirv]` entry points, and nothing else: each finds its element and calls the plain
//! function that the CPU calls too.
//!
//! Bindings are in descriptor set 0, in the order of the parameters. Buffers are as long as
//! the work; threads beyond it return.

use glam::{UVec2, UVec3, UVec4, Vec4};
use spirv_std::arch::{IndexUnchecked, workgroup_memory_barrier_with_group_sync};
use spirv_std::spirv;

use crate::canary::{Operands, Outcome, sing};
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
use crate::canary::{WideOutcome, sing_wide};
use crate::candidates::{Shared, all_miss, candidates, discriminants, unit_of};
use crate::film::render_pixel;
use crate::integrate::{Scenery, trace_pixel};
use crate::nearest::{is_occluded, nearest_hit_in};
use crate::optics::{Fresnel, Incidence};
use crate::precision::intersect;
use crate::shading::shade;
use crate::traversal::OneByOne;
use crate::tree::{Node, is_occluded_in_tree, nearest_hit_in_tree};
use crate::walk::{Walk, walk_inside};
use crate::{
    Accumulator, Effects, Hit, Launch, Light, Material, PathLaunch, Pixel, Ray, Sphere, Surface,
    layout,
};

/// Renders one launch: a tile of the image against a run of the spheres.
#[spirv(compute(threads(8, 16), entry_point_name = "render"))]
pub fn render(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(spec_constant(id = 0, default = 0))] shading: u32,
    #[spirv(spec_constant(id = 1, default = 1))] rung: u32,
    #[spirv(spec_constant(id = 4, default = 0))] has_tree: u32,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] launch: &Launch,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] spheres: &[Sphere],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] material_ids: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] materials: &[Material],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] nodes: &[Node],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] pixels: &mut [Pixel],
) {
    let pixel = UVec2::new(id.x, id.y);
    if pixel.x < launch.tile_size.x && pixel.y < launch.tile_size.y {
        let index = (pixel.y * launch.tile_size.x + pixel.x) as usize;
        if index < pixels.len() {
            pixels[index] = render_pixel(
                shading,
                rung,
                has_tree,
                launch,
                nodes,
                spheres,
                material_ids,
                materials,
                pixel,
                &pixels[index],
            );
        }
    }
}

/// Spheres that a workgroup keeps at hand.
const TILE: usize = 256;

/// [`render`] for many spheres without a tree: a workgroup works out once what its 16 by 16 pixels
/// share of a sphere, and each thread goes through the spheres with four of the pixels.
#[spirv(compute(threads(8, 8), entry_point_name = "render_by_tiles"))]
pub fn render_by_tiles(
    #[spirv(local_invocation_id)] local: UVec3,
    #[spirv(workgroup_id)] group: UVec3,
    #[spirv(spec_constant(id = 0, default = 0))] shading: u32,
    #[spirv(spec_constant(id = 1, default = 1))] rung: u32,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] launch: &Launch,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] spheres: &[Sphere],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] material_ids: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] materials: &[Material],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] pixels: &mut [Pixel],
    #[spirv(workgroup)] tile: &mut [Vec4; TILE],
) {
    let thread = local.y * 8 + local.x;
    let pixel = UVec2::new(group.x * 16 + local.x, group.y * 16 + local.y);
    let ray_0 = ray_of(pixels, launch, pixel_of(pixel, 0));
    let ray_1 = ray_of(pixels, launch, pixel_of(pixel, 1));
    let ray_2 = ray_of(pixels, launch, pixel_of(pixel, 2));
    let ray_3 = ray_of(pixels, launch, pixel_of(pixel, 3));
    let unit_0 = unit_of(ray_0.direction);
    let unit_1 = unit_of(ray_1.direction);
    let unit_2 = unit_of(ray_2.direction);
    let unit_3 = unit_of(ray_3.direction);
    // Only what changes is carried from round to round.
    let mut t_max = Vec4::new(ray_0.t_max, ray_1.t_max, ray_2.t_max, ray_3.t_max);
    let mut found = UVec4::splat(Hit::NONE_SPHERE);

    let len = spheres.len() as u32;
    let begin = launch.first_sphere.min(len);
    let end = begin + launch.sphere_count.min(len - begin);
    let mut first = begin;
    while first < end {
        // The loop's bounds are the same for every thread of the workgroup.
        workgroup_memory_barrier_with_group_sync();
        let mut at = thread;
        while at < TILE as u32 {
            let mut shared = Shared::none();
            if first + at < end {
                // SAFETY: `end` is at most the number of spheres.
                let sphere = unsafe { *spheres.index_unchecked((first + at) as usize) };
                shared = Shared::of(sphere, launch.camera.eye);
            }
            // SAFETY: `at` is below the tile's size.
            unsafe { *tile.index_unchecked_mut(at as usize) = shared.to_vec4() };
            at += 64;
        }
        workgroup_memory_barrier_with_group_sync();
        let count = (end - first).min(TILE as u32);
        let mut at = 0;
        while at < count {
            let here = at as usize;
            // SAFETY: `at` is below the tile's size, and both are multiples of eight.
            let (s0, s1, s2, s3) = unsafe {
                (
                    Shared::from_vec4(*tile.index_unchecked(here)),
                    Shared::from_vec4(*tile.index_unchecked(here + 1)),
                    Shared::from_vec4(*tile.index_unchecked(here + 2)),
                    Shared::from_vec4(*tile.index_unchecked(here + 3)),
                )
            };
            // SAFETY: as above.
            let (s4, s5, s6, s7) = unsafe {
                (
                    Shared::from_vec4(*tile.index_unchecked(here + 4)),
                    Shared::from_vec4(*tile.index_unchecked(here + 5)),
                    Shared::from_vec4(*tile.index_unchecked(here + 6)),
                    Shared::from_vec4(*tile.index_unchecked(here + 7)),
                )
            };
            let low_0 = discriminants(unit_0, s0, s1, s2, s3);
            let low_1 = discriminants(unit_1, s0, s1, s2, s3);
            let low_2 = discriminants(unit_2, s0, s1, s2, s3);
            let low_3 = discriminants(unit_3, s0, s1, s2, s3);
            let high_0 = discriminants(unit_0, s4, s5, s6, s7);
            let high_1 = discriminants(unit_1, s4, s5, s6, s7);
            let high_2 = discriminants(unit_2, s4, s5, s6, s7);
            let high_3 = discriminants(unit_3, s4, s5, s6, s7);
            let low = all_miss(low_0) & all_miss(low_1) & all_miss(low_2) & all_miss(low_3);
            let high = all_miss(high_0) & all_miss(high_1) & all_miss(high_2) & all_miss(high_3);
            if (low & high) >> 31 == 0 {
                // A byte a ray, a bit a sphere.
                let mut left = candidates(low_0)
                    | candidates(high_0) << 4
                    | candidates(low_1) << 8
                    | candidates(high_1) << 12
                    | candidates(low_2) << 16
                    | candidates(high_2) << 20
                    | candidates(low_3) << 24
                    | candidates(high_3) << 28;
                // The rung's code stands here once, for whichever ray.
                while left != 0 {
                    let candidate = left.trailing_zeros();
                    left &= left - 1;
                    let index = first + at + (candidate & 7);
                    let which = candidate >> 3;
                    if index < end {
                        let end_t = pick(t_max.x, t_max.y, t_max.z, t_max.w, which);
                        // SAFETY: `end` is at most the number of spheres.
                        let sphere = unsafe { *spheres.index_unchecked(index as usize) };
                        let mut ray = launch.ray(pixel_of(pixel, which), &Pixel::default());
                        ray.t_max = end_t;
                        let t = intersect(rung, sphere, &ray);
                        if t < end_t {
                            if which == 0 {
                                (t_max.x, found.x) = (t, index);
                            }
                            if which == 1 {
                                (t_max.y, found.y) = (t, index);
                            }
                            if which == 2 {
                                (t_max.z, found.z) = (t, index);
                            }
                            if which == 3 {
                                (t_max.w, found.w) = (t, index);
                            }
                        }
                    }
                }
            }
            at += 8;
        }
        first += TILE as u32;
    }

    let mut which = 0;
    while which < 4 {
        let pixel = pixel_of(pixel, which);
        let place = place_of(pixels.len(), launch, pixel);
        if place < pixels.len() {
            let ray = launch.ray(pixel, &pixels[place]);
            let hit = Hit {
                t: pick(t_max.x, t_max.y, t_max.z, t_max.w, which),
                sphere: pick(found.x, found.y, found.z, found.w, which),
            };
            pixels[place] = launch.pixel(
                shading,
                &ray,
                hit,
                spheres,
                material_ids,
                materials,
                &pixels[place],
            );
        }
        which += 1;
    }
}

/// The ray of a pixel, not farther than what it holds.
#[inline]
fn ray_of(pixels: &[Pixel], launch: &Launch, pixel: UVec2) -> Ray {
    let place = place_of(pixels.len(), launch, pixel);
    if place < pixels.len() {
        launch.ray(pixel, &pixels[place])
    } else {
        launch.ray(pixel, &Pixel::default())
    }
}

/// One of the four pixels that a thread has: the others are 8 to the right, below, and both.
#[inline]
fn pixel_of(first: UVec2, which: u32) -> UVec2 {
    first + UVec2::new(8 * (which & 1), 8 * (which >> 1))
}

/// One of four numbers, without an array in memory.
#[inline]
fn pick<T: Copy>(first: T, second: T, third: T, fourth: T, which: u32) -> T {
    let mut number = first;
    if which == 1 {
        number = second;
    }
    if which == 2 {
        number = third;
    }
    if which == 3 {
        number = fourth;
    }
    number
}

/// Where a pixel of a launch is; `len` for one beyond the tile, which is traced for nothing because its
/// thread must meet the others' barriers.
#[inline]
fn place_of(len: usize, launch: &Launch, pixel: UVec2) -> usize {
    let is_inside = (pixel.x < launch.tile_size.x) & (pixel.y < launch.tile_size.y);
    if is_inside {
        (pixel.y * launch.tile_size.x + pixel.x) as usize
    } else {
        len
    }
}

/// Adds samples to the pixels of a tile, by the effects that the pipeline holds.
#[spirv(compute(threads(8, 8), entry_point_name = "trace_paths"))]
pub fn trace_paths(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(spec_constant(id = 1, default = 1))] rung: u32,
    #[spirv(spec_constant(id = 2, default = 0))] effects: u32,
    #[spirv(spec_constant(id = 3, default = 0))] is_exact: u32,
    #[spirv(spec_constant(id = 4, default = 0))] has_tree: u32,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] launch: &PathLaunch,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] spheres: &[Sphere],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] velocities: &[Vec4],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] material_ids: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] materials: &[Material],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] lights: &[Light],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] tables: &[f32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] nodes: &[Node],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 8)] accumulators: &mut [Accumulator],
) {
    let pixel = UVec2::new(id.x, id.y);
    if pixel.x < launch.tile_size.x && pixel.y < launch.tile_size.y {
        let index = (pixel.y * launch.tile_size.x + pixel.x) as usize;
        if index < accumulators.len() {
            let mut effects = Effects::from_bits(effects).within(Effects::BUILT);
            if is_exact == 0 {
                effects = effects.within(Effects::from_bits(launch.called_effects));
            }
            let scenery = Scenery {
                effects,
                rung,
                launch,
                traversal: OneByOne {
                    rung,
                    has_tree,
                    nodes,
                },
                spheres,
                velocities,
                material_ids,
                materials,
                lights,
                tables,
            };
            accumulators[index] = trace_pixel(&scenery, pixel, accumulators[index]);
        }
    }
}

/// Finds the nearest hit of each ray among all spheres.
#[spirv(compute(threads(64), entry_point_name = "trace_rays"))]
pub fn trace_rays(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(num_workgroups)] groups: UVec3,
    #[spirv(spec_constant(id = 1, default = 1))] rung: u32,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] rays: &[Ray],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] spheres: &[Sphere],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] hits: &mut [Hit],
) {
    let index = (id.y * groups.x * 64 + id.x) as usize;
    if index < rays.len() && index < hits.len() {
        hits[index] = nearest_hit_in(rung, &rays[index], spheres, 0, u32::MAX);
    }
}

/// [`trace_rays`] among the spheres of a tree.
#[spirv(compute(threads(64), entry_point_name = "trace_rays_in_tree"))]
pub fn trace_rays_in_tree(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(num_workgroups)] groups: UVec3,
    #[spirv(spec_constant(id = 1, default = 1))] rung: u32,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] rays: &[Ray],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] spheres: &[Sphere],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] nodes: &[Node],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] hits: &mut [Hit],
) {
    let index = (id.y * groups.x * 64 + id.x) as usize;
    if index < rays.len() && index < hits.len() {
        hits[index] = nearest_hit_in_tree(rung, &rays[index], nodes, spheres);
    }
}

/// Writes 1 for each ray that any sphere occludes, 0 for the others.
#[spirv(compute(threads(64), entry_point_name = "occlude_rays"))]
pub fn occlude_rays(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(num_workgroups)] groups: UVec3,
    #[spirv(spec_constant(id = 1, default = 1))] rung: u32,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] rays: &[Ray],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] spheres: &[Sphere],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] occluded: &mut [u32],
) {
    let index = (id.y * groups.x * 64 + id.x) as usize;
    if index < rays.len() && index < occluded.len() {
        occluded[index] = u32::from(is_occluded(rung, &rays[index], spheres));
    }
}

/// [`occlude_rays`] by the spheres of a tree.
#[spirv(compute(threads(64), entry_point_name = "occlude_rays_in_tree"))]
pub fn occlude_rays_in_tree(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(num_workgroups)] groups: UVec3,
    #[spirv(spec_constant(id = 1, default = 1))] rung: u32,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] rays: &[Ray],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] spheres: &[Sphere],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] nodes: &[Node],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] occluded: &mut [u32],
) {
    let index = (id.y * groups.x * 64 + id.x) as usize;
    if index < rays.len() && index < occluded.len() {
        occluded[index] = u32::from(is_occluded_in_tree(rung, &rays[index], nodes, spheres));
    }
}

/// Intersects ray i with sphere i and nothing else; writes the parameter of the hit.
#[spirv(compute(threads(64), entry_point_name = "intersect_pairs"))]
pub fn intersect_pairs(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(spec_constant(id = 1, default = 1))] rung: u32,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] rays: &[Ray],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] spheres: &[Sphere],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] parameters: &mut [f32],
) {
    let index = id.x as usize;
    if index < rays.len() && index < spheres.len() && index < parameters.len() {
        parameters[index] = intersect(rung, spheres[index], &rays[index]);
    }
}

/// Computes the surface at parameter i of ray i on sphere i; writes point and error, and normal:
/// two vectors an element.
#[spirv(compute(threads(64), entry_point_name = "find_surfaces"))]
pub fn find_surfaces(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] rays: &[Ray],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] spheres: &[Sphere],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] parameters: &[f32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] surfaces: &mut [Vec4],
) {
    let index = id.x as usize;
    if index < rays.len()
        && index < spheres.len()
        && index < parameters.len()
        && 2 * index + 1 < surfaces.len()
    {
        let surface = Surface::at(&rays[index], parameters[index], spheres[index]);
        surfaces[2 * index] = surface.point.extend(surface.error);
        surfaces[2 * index + 1] = surface.normal.extend(0.0);
    }
}

/// Computes what becomes of light at each boundary.
#[spirv(compute(threads(64), entry_point_name = "cross_boundaries"))]
pub fn cross_boundaries(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] incidences: &[Incidence],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] outcomes: &mut [Fresnel],
) {
    let index = id.x as usize;
    if index < incidences.len() && index < outcomes.len() {
        outcomes[index] = incidences[index].fresnel();
    }
}

/// Lets ray i into glass sphere i of refractive index i and reflects it there a thousand times.
#[spirv(compute(threads(64), entry_point_name = "walk_inside_spheres"))]
pub fn walk_inside_spheres(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(spec_constant(id = 1, default = 1))] rung: u32,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] rays: &[Ray],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] spheres: &[Sphere],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] indices: &[f32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] walks: &mut [Walk],
) {
    let index = id.x as usize;
    if index < rays.len() && index < spheres.len() && index < indices.len() && index < walks.len() {
        walks[index] = walk_inside(rung, &rays[index], spheres[index], indices[index], 1000);
    }
}

/// Makes the ray through each pixel of an image whose size the launch gives.
#[spirv(compute(threads(64), entry_point_name = "make_camera_rays"))]
pub fn make_camera_rays(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] launch: &Launch,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] rays: &mut [Ray],
) {
    let index = id.x;
    let size = launch.image_size;
    if index / size.x < size.y && (index as usize) < rays.len() {
        let pixel = UVec2::new(index % size.x, index / size.x);
        rays[index as usize] = launch.camera.pixel_ray(pixel, size);
    }
}

/// Shades the hit at parameter i of ray i on sphere i in each of the four modes; writes four
/// colours an element.
#[spirv(compute(threads(64), entry_point_name = "shade_hits"))]
pub fn shade_hits(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] rays: &[Ray],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] spheres: &[Sphere],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] parameters: &[f32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] materials: &[Material],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] colors: &mut [Vec4],
) {
    let index = id.x as usize;
    if index < rays.len()
        && index < spheres.len()
        && index < parameters.len()
        && index < materials.len()
        && 4 * index + 3 < colors.len()
    {
        let ray = &rays[index];
        let t = parameters[index];
        let surface = Surface::at(ray, t, spheres[index]);
        let material = &materials[index];
        let mut mode = 0;
        while mode < 4 {
            let color = shade(mode, ray, t, &surface, material);
            colors[4 * index + mode as usize] = color.extend(1.0);
            mode += 1;
        }
    }
}

/// Writes the layout of the shared types as this compiler sees it.
#[spirv(compute(threads(1), entry_point_name = "measure_layout"))]
pub fn measure_layout(#[spirv(storage_buffer, descriptor_set = 0, binding = 0)] table: &mut [u32]) {
    layout::write(table);
}

/// Lets the canary sing on each pair of operands.
#[spirv(compute(threads(64), entry_point_name = "measure_arithmetic"))]
pub fn measure_arithmetic(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] operands: &[Operands],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] outcomes: &mut [Outcome],
) {
    let index = id.x as usize;
    if index < operands.len() && index < outcomes.len() {
        outcomes[index] = sing(operands[index]);
    }
}

/// The same in 64-bit floats.
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
#[spirv(compute(threads(64), entry_point_name = "measure_wide_arithmetic"))]
pub fn measure_wide_arithmetic(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] operands: &[Operands],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] outcomes: &mut [WideOutcome],
) {
    let index = id.x as usize;
    if index < operands.len() && index < outcomes.len() {
        outcomes[index] = sing_wide(operands[index]);
    }
}
