//! The `#[spirv]` entry points, and nothing else: each finds its element and calls the plain
//! function that the CPU calls too.
//!
//! Bindings are in descriptor set 0, in the order of the parameters. Buffers are as long as
//! the work; threads beyond it return.

use glam::{UVec2, UVec3, Vec2, Vec4};
use spirv_std::arch::{IndexUnchecked, atomic_i_add, workgroup_memory_barrier_with_group_sync};
use spirv_std::memory::{Scope, Semantics};
use spirv_std::spirv;

use crate::canary::{Operands, Outcome, sing};
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
use crate::canary::{WideOutcome, sing_wide};
use crate::cone::{Cone, Reach, Row};
use crate::film::render_pixel;
use crate::frustum::Frustum;
use crate::instructions::{highest_bit, lowest_bit};
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

/// Whose memory an atomic operation is on, and that it orders no other.
const WORKGROUP: u32 = Scope::Workgroup as u32;
const RELAXED: u32 = Semantics::NONE.bits();

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

/// Cones that a workgroup keeps at hand, and those that a thread looks at between two branches.
const TILE: usize = 256;
const STEP: u32 = 16;
/// The threads of a workgroup for each tile, and the pixels of one row that each has.
const GROUP: UVec2 = UVec2::new(4, 32);
const THREADS: u32 = GROUP.x * GROUP.y;
const PIXELS: u32 = 8;
/// Pixels of a workgroup.
const ALL: usize = (THREADS * PIXELS) as usize;
/// Spheres that a thread looks at for its workgroup between two barriers; and how many a workgroup's list has room for.
const LOOKS: u32 = 4;
const LISTED: u32 = 768;

/// [`render`] for many spheres without a tree. A workgroup makes a list of the spheres that any of its 32 by 32 pixels may see,
/// of all there are. It works out once what these share of a sphere, and each thread goes through the list with eight of
/// the pixels.
#[spirv(compute(threads(4, 32), entry_point_name = "render_by_tiles"))]
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
    #[spirv(workgroup)] listed: &mut u32,
    #[spirv(workgroup)] list: &mut [u32; LISTED as usize],
    #[spirv(workgroup)] tile: &mut [Vec4; TILE],
    #[spirv(workgroup)] nearest: &mut [f32; ALL],
    #[spirv(workgroup)] found: &mut [u32; ALL],
) {
    let thread = local.y * GROUP.x + local.x;
    let corner = UVec2::new(group.x * GROUP.x * PIXELS, group.y * GROUP.y);
    let first_pixel = corner + local.truncate();
    let frustum = {
        let last = corner + UVec2::new(GROUP.x * PIXELS - 1, GROUP.y - 1);
        let (first, last) = (film(launch, corner), film(launch, last));
        let (low, high) = (Vec2::new(first.x, last.y), Vec2::new(last.x, first.y));
        Frustum::around(&launch.camera, low, high)
    };
    let row = Row::of(
        &launch.camera,
        four_across(launch, first_pixel, 0),
        four_across(launch, first_pixel, 4),
        film(launch, first_pixel).y,
    );
    // What each pixel has found is not kept in registers, of which there are few; no other thread looks at it.
    let mut which = 0;
    while which < PIXELS {
        let place = (THREADS * which + thread) as usize;
        // SAFETY: `place` is below the number of pixels.
        unsafe {
            *nearest.index_unchecked_mut(place) =
                end_of(pixels, launch, pixel_of(first_pixel, which));
            *found.index_unchecked_mut(place) = 0;
        }
        which += 1;
    }
    if thread == 0 {
        *listed = 0;
    }

    let len = spheres.len() as u32;
    let begin = launch.first_sphere.min(len);
    let end = begin + launch.sphere_count.min(len - begin);
    let mut first = begin;
    // The bounds of the loops with barriers are the same for every thread of the workgroup.
    while first < end {
        workgroup_memory_barrier_with_group_sync();
        // All are asked for before the first is looked at, so that a thread waits for memory once.
        let mine = first + thread;
        let one = look(spheres, end, mine);
        let two = look(spheres, end, mine + THREADS);
        let three = look(spheres, end, mine + 2 * THREADS);
        let four = look(spheres, end, mine + 3 * THREADS);
        let mut seen = u32::from(!frustum.misses(one) & (mine < end));
        seen |= u32::from(!frustum.misses(two) & (mine + THREADS < end)) << 1;
        seen |= u32::from(!frustum.misses(three) & (mine + 2 * THREADS < end)) << 2;
        seen |= u32::from(!frustum.misses(four) & (mine + 3 * THREADS < end)) << 3;
        while seen != 0 {
            let which = lowest_bit(seen);
            seen &= seen - 1;
            // SAFETY: all threads count by atomic additions until they next meet.
            let place = unsafe { atomic_i_add::<u32, WORKGROUP, RELAXED>(listed, 1) };
            // SAFETY: there was room for as many spheres as are looked at.
            unsafe { *list.index_unchecked_mut(place as usize) = mine + which * THREADS };
        }
        first += LOOKS * THREADS;
        workgroup_memory_barrier_with_group_sync();
        let count = *listed;
        let is_due = (count > LISTED - LOOKS * THREADS) | (first >= end);
        let mut base = 0;
        while is_due & (base < count) {
            workgroup_memory_barrier_with_group_sync();
            let left = (count - base).min(TILE as u32);
            let mut at = thread;
            // Up to the end of a step.
            while at < (left + STEP - 1) / STEP * STEP {
                let mut cone = Cone::none();
                if at < left {
                    // SAFETY: below the number of those listed, and of spheres.
                    let sphere = unsafe {
                        let index = *list.index_unchecked((base + at) as usize);
                        *spheres.index_unchecked(index as usize)
                    };
                    cone = Cone::of(sphere, &launch.camera);
                }
                // SAFETY: `at` is below the tile's size, which is a multiple of a step.
                unsafe { *tile.index_unchecked_mut(at as usize) = cone.to_vec4() };
                at += THREADS;
            }
            workgroup_memory_barrier_with_group_sync();
            let mut at = 0;
            while at < left {
                let reach = farthest_of_four(tile, &row, Row::nothing(), at);
                let reach = farthest_of_four(tile, &row, reach, at + 4);
                let reach = farthest_of_four(tile, &row, reach, at + 8);
                let reach = farthest_of_four(tile, &row, reach, at + 12);
                if row.may_meet(reach) {
                    let mut four = at;
                    while four < at + STEP {
                        let mut candidates = row.candidates(cones(tile, four));
                        // The rung's code stands here once, for whichever ray.
                        while candidates != 0 {
                            let bit = highest_bit(candidates);
                            candidates &= !(1 << bit);
                            let which = (31 - bit) & 7;
                            let at = four + (31 - bit) / 8;
                            if at < left {
                                let place = (THREADS * which + thread) as usize;
                                // SAFETY: below the number of those listed, of spheres, and of pixels.
                                let (index, sphere, nearest_t, nearest_sphere) = unsafe {
                                    let index = *list.index_unchecked((base + at) as usize);
                                    (
                                        index,
                                        *spheres.index_unchecked(index as usize),
                                        *nearest.index_unchecked(place),
                                        *found.index_unchecked(place),
                                    )
                                };
                                let ray = launch.camera.ray(row.film(which));
                                let t = intersect(rung, sphere, &ray);
                                // Lists are in no order: of two at the same t the first of all spheres is taken.
                                if (t < nearest_t) | ((t == nearest_t) & (index < nearest_sphere)) {
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
            base += TILE as u32;
        }
        // All know how many there were before the next are counted.
        workgroup_memory_barrier_with_group_sync();
        if is_due & (thread == 0) {
            *listed = 0;
        }
    }

    let mut which = 0;
    while which < PIXELS {
        let pixel = pixel_of(first_pixel, which);
        let place = place_of(pixels.len(), launch, pixel);
        if place < pixels.len() {
            let ray = launch.ray(pixel, &pixels[place]);
            let own = (THREADS * which + thread) as usize;
            // SAFETY: `own` is below the number of pixels.
            let (t, sphere) =
                unsafe { (*nearest.index_unchecked(own), *found.index_unchecked(own)) };
            let mut hit = Hit::NONE;
            if t < ray.t_max {
                hit = Hit { t, sphere };
            }
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

/// The sphere with this index, or the last of those up to `end`, of which there is one at least.
#[inline]
fn look(spheres: &[Sphere], end: u32, index: u32) -> Sphere {
    // SAFETY: `end` is at most the number of spheres.
    unsafe { *spheres.index_unchecked(index.min(end - 1) as usize) }
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
