//! The `#[spirv]` entry points, and nothing else: each finds its element and calls the plain
//! function that the CPU calls too.
//!
//! Bindings are in descriptor set 0, in the order of the parameters. Buffers are as long as
//! the work; threads beyond it return.

use glam::{UVec2, UVec3, Vec2, Vec4};
use spirv_std::arch::{IndexUnchecked, workgroup_memory_barrier_with_group_sync};
use spirv_std::spirv;

use crate::canary::{Operands, Outcome, sing};
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
use crate::canary::{WideOutcome, sing_wide};
use crate::cone::{Cone, Reach, Row};
use crate::film::render_pixel;
use crate::instructions::highest_bit;
use crate::integrate::{Scenery, trace_pixel};
use crate::nearest::{is_occluded, nearest_hit_in};
use crate::optics::{Fresnel, Incidence};
use crate::precision::intersect;
use crate::shading::shade;
use crate::throughput::products;
use crate::traversal::OneByOne;
use crate::tree::{Node, is_occluded_in_tree, nearest_hit_in_tree};
use crate::walk::{Walk, walk_inside};
use crate::{
    Accumulator, Camera, Effects, Hit, Launch, Light, Material, PathLaunch, Pixel, Ray, Sphere,
    Surface, layout,
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

/// Spheres that a workgroup keeps at hand, and those that a thread looks at between two branches.
const TILE: usize = 256;
const STEP: u32 = 16;
/// The threads of a workgroup for each tile, and the pixels of one row that each has.
const GROUP: UVec2 = UVec2::new(8, 16);
const PIXELS: u32 = 8;
/// Pixels of a workgroup.
const ALL: usize = (GROUP.x * GROUP.y * PIXELS) as usize;

/// [`render`] for many spheres without a tree: a workgroup works out once what its 64 by 16 pixels
/// share of a sphere, and each thread goes through the spheres with eight of the pixels.
#[spirv(compute(threads(8, 16), entry_point_name = "render_by_tiles"))]
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
    #[spirv(workgroup)] nearest: &mut [f32; ALL],
    #[spirv(workgroup)] found: &mut [u32; ALL],
) {
    let thread = local.y * GROUP.x + local.x;
    let first_pixel = UVec2::new(
        group.x * GROUP.x * PIXELS + local.x,
        group.y * GROUP.y + local.y,
    );
    let row = Row::of(
        &launch.camera,
        four_across(launch, first_pixel, 0),
        four_across(launch, first_pixel, 4),
        film(launch, first_pixel).y,
    );
    // What each pixel has found is not kept in registers, of which there are few; no other thread looks at it.
    let mut which = 0;
    while which < PIXELS {
        let place = (GROUP.x * GROUP.y * which + thread) as usize;
        // SAFETY: `place` is below the number of pixels.
        unsafe {
            *nearest.index_unchecked_mut(place) =
                end_of(pixels, launch, pixel_of(first_pixel, which));
            *found.index_unchecked_mut(place) = Hit::NONE_SPHERE;
        }
        which += 1;
    }

    let len = spheres.len() as u32;
    let begin = launch.first_sphere.min(len);
    let end = begin + launch.sphere_count.min(len - begin);
    let mut first = begin;
    while first < end {
        // The loop's bounds are the same for every thread of the workgroup.
        workgroup_memory_barrier_with_group_sync();
        let mut at = thread;
        while at < TILE as u32 {
            let mut cone = Cone::none();
            if first + at < end {
                // SAFETY: `end` is at most the number of spheres.
                let sphere = unsafe { *spheres.index_unchecked((first + at) as usize) };
                cone = Cone::of(sphere, &launch.camera);
            }
            // SAFETY: `at` is below the tile's size.
            unsafe { *tile.index_unchecked_mut(at as usize) = cone.to_vec4() };
            at += GROUP.x * GROUP.y;
        }
        workgroup_memory_barrier_with_group_sync();
        let count = (end - first).min(TILE as u32);
        let mut at = 0;
        while at < count {
            let reach = farthest_of_four(tile, &row, Row::nothing(), at);
            let reach = farthest_of_four(tile, &row, reach, at + 4);
            let reach = farthest_of_four(tile, &row, reach, at + 8);
            let reach = farthest_of_four(tile, &row, reach, at + 12);
            if row.may_meet(reach) {
                let mut four = at;
                while four < at + STEP {
                    let mut left = row.candidates(cones(tile, four));
                    // The rung's code stands here once, for whichever ray.
                    while left != 0 {
                        // In the order of the spheres: of two at the same t the first stays.
                        let bit = highest_bit(left);
                        left &= !(1 << bit);
                        let which = (31 - bit) & 7;
                        let index = first + four + (31 - bit) / 8;
                        if index < end {
                            let place = (GROUP.x * GROUP.y * which + thread) as usize;
                            // SAFETY: `place` is below the number of pixels.
                            let end_t = unsafe { *nearest.index_unchecked(place) };
                            // SAFETY: `end` is at most the number of spheres.
                            let sphere = unsafe { *spheres.index_unchecked(index as usize) };
                            let mut ray = launch.camera.ray(row.film(which));
                            ray.t_max = end_t;
                            let t = intersect(rung, sphere, &ray);
                            if t < end_t {
                                // SAFETY: as above.
                                unsafe {
                                    *nearest.index_unchecked_mut(place) = t;
                                    *found.index_unchecked_mut(place) = index;
                                }
                            }
                        }
                    }
                    four += 4;
                }
            }
            at += STEP;
        }
        first += TILE as u32;
    }

    let mut which = 0;
    while which < PIXELS {
        let pixel = pixel_of(first_pixel, which);
        let place = place_of(pixels.len(), launch, pixel);
        if place < pixels.len() {
            let ray = launch.ray(pixel, &pixels[place]);
            let own = (GROUP.x * GROUP.y * which + thread) as usize;
            // SAFETY: `own` is below the number of pixels.
            let hit = unsafe {
                Hit {
                    t: *nearest.index_unchecked(own),
                    sphere: *found.index_unchecked(own),
                }
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

/// Four of the tile's cones; it is a multiple of four long, and so is `at`, which is below its end.
#[inline]
fn cones(tile: &[Vec4; TILE], at: u32) -> [Cone; 4] {
    let at = at as usize;
    // SAFETY: as said.
    unsafe {
        [
            Cone::from_vec4(*tile.index_unchecked(at)),
            Cone::from_vec4(*tile.index_unchecked(at + 1)),
            Cone::from_vec4(*tile.index_unchecked(at + 2)),
            Cone::from_vec4(*tile.index_unchecked(at + 3)),
        ]
    }
}

/// How far the rays of a row reach into four more cones.
#[inline]
fn farthest_of_four(tile: &[Vec4; TILE], row: &Row, so_far: Reach, at: u32) -> Reach {
    let [first, second, third, fourth] = cones(tile, at);
    row.farther(row.farther(so_far, first, second), third, fourth)
}

/// Where on the film a pixel of a launch is.
#[inline]
fn film(launch: &Launch, pixel: UVec2) -> Vec2 {
    Camera::film(launch.tile_origin + pixel, launch.image_size)
}

/// How far to the right four of a thread's pixels are on the film.
#[inline]
fn four_across(launch: &Launch, first: UVec2, which: u32) -> Vec4 {
    Vec4::new(
        film(launch, pixel_of(first, which)).x,
        film(launch, pixel_of(first, which + 1)).x,
        film(launch, pixel_of(first, which + 2)).x,
        film(launch, pixel_of(first, which + 3)).x,
    )
}

/// Up to where the ray of a pixel is of interest: not farther than what it holds.
#[inline]
fn end_of(pixels: &[Pixel], launch: &Launch, pixel: UVec2) -> f32 {
    let place = place_of(pixels.len(), launch, pixel);
    if place < pixels.len() {
        launch.ray(pixel, &pixels[place]).t_max
    } else {
        Hit::NONE_T
    }
}

/// One of the pixels that a thread has: the others are to the right, as far apart as the workgroup is wide.
#[inline]
fn pixel_of(first: UVec2, which: u32) -> UVec2 {
    first + UVec2::new(GROUP.x * which, 0)
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

/// Multiplies, and does nothing else. What each thread needs is a factor, and how many rounds.
#[spirv(compute(threads(64), entry_point_name = "measure_multiplications"))]
pub fn measure_multiplications(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] factor_and_rounds: &[f32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] sums: &mut [f32],
) {
    let index = id.x as usize;
    if index < sums.len() && factor_and_rounds.len() >= 2 {
        let rounds = factor_and_rounds[1] as u32;
        sums[index] = products(index as f32, factor_and_rounds[0], rounds);
    }
}

/// Copies, and does nothing else.
#[spirv(compute(threads(64), entry_point_name = "measure_copying"))]
pub fn measure_copying(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(num_workgroups)] groups: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] from: &[Vec4],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] to: &mut [Vec4],
) {
    let index = (id.y * groups.x * 64 + id.x) as usize;
    if index < from.len() && index < to.len() {
        to[index] = from[index];
    }
}
