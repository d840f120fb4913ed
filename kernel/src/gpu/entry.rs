//! The `#[spirv]` entry points, and nothing else: each finds its element and calls the plain
//! function that the CPU calls too.
//!
//! Bindings are in descriptor set 0, in the order of the parameters. Buffers are as long as
//! the work; threads beyond it return.
//!
//! Those that render, and those that trace rays in a tree, run once on a rung, or twice for
//! certified: first with the rung [`DEFERRING`], then on the rung itself with `is_second` 1, for
//! what the first launch deferred and put into a list.

use glam::{UVec2, UVec3, Vec4};
use spirv_std::arch::{IndexUnchecked, workgroup_memory_barrier_with_group_sync};
use spirv_std::spirv;

use crate::accel::brute::{is_occluded, nearest_hit_in};
use crate::accel::node::{Node, Tree};
use crate::accel::tiles::{LISTED, Shared, columns, from_the_middle, render_group};
use crate::accel::traversal::OneByOne;
use crate::accel::walk::{any_hit_in_tree, nearest_hit_in_tree};
use crate::film::TILE;
use crate::gpu::deferred;
use crate::material::optics::{Fresnel, Incidence};
use crate::path::{Scenery, trace_pixel};
use crate::pixel::{render_pixel, render_pixel_of_shapes};
use crate::precision::{DEFERRING, intersect};
use crate::probe::canary::{Operands, Outcome, sing};
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
use crate::probe::canary::{WideOutcome, sing_wide};
use crate::probe::glass_walk::{Walk, walk_inside};
use crate::probe::layout;
use crate::probe::throughput::products;
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
use crate::probe::throughput::wide_products;
use crate::shading::{Seen, shade};
use crate::shape::{Kinds, Shape, Shapes};
use crate::{
    Accumulator, Effects, Hit, Launch, Light, Material, PathLaunch, Pixel, Ray, Shading, Sphere,
    Surface,
};

/// Renders one launch: a tile of the image against a run of the spheres.
#[spirv(compute(threads(8, 16), entry_point_name = "render"))]
pub fn render(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(local_invocation_index)] local: u32,
    #[spirv(workgroup_id)] group: UVec3,
    #[spirv(num_workgroups)] groups: UVec3,
    #[spirv(spec_constant(id = 0, default = 0))] shading: u32,
    #[spirv(spec_constant(id = 1, default = 1))] rung: u32,
    #[spirv(spec_constant(id = 4, default = 0))] has_tree: u32,
    #[spirv(spec_constant(id = 5, default = 0))] is_second: u32,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] launch: &Launch,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] spheres: &[Sphere],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] material_ids: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] materials: &[Material],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] nodes: &[Node],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] pixels: &mut [Pixel],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] list: &mut [u32],
) {
    // SAFETY: the host binds a tree's nodes.
    let tree = unsafe { Tree::of_unchecked(nodes) };
    let width = launch.tile_size.x;
    if is_second == 1 {
        let (count, step) = (deferred::count(list), groups.x * 128);
        let mut place = local * groups.x + group.x;
        while place < count {
            let index = deferred::entry(list, place);
            let pixel = UVec2::new(index % width, index / width);
            let index = index as usize;
            if index < pixels.len() {
                // SAFETY: as just asked.
                let previous = unsafe { pixels.index_unchecked(index) };
                let pixel = render_pixel(
                    shading,
                    rung,
                    has_tree,
                    launch,
                    tree,
                    spheres,
                    material_ids,
                    materials,
                    pixel,
                    previous,
                );
                // SAFETY: as above.
                unsafe { *pixels.index_unchecked_mut(index) = pixel };
            }
            place += step;
        }
        return;
    }
    let pixel = UVec2::new(id.x, id.y);
    if pixel.x < width && pixel.y < launch.tile_size.y {
        let index = pixel.y * width + pixel.x;
        if (index as usize) < pixels.len() {
            // SAFETY: as just asked.
            let previous = unsafe { pixels.index_unchecked(index as usize) };
            let pixel = render_pixel(
                shading,
                rung,
                has_tree,
                launch,
                tree,
                spheres,
                material_ids,
                materials,
                pixel,
                previous,
            );
            // SAFETY: as above.
            unsafe { *pixels.index_unchecked_mut(index as usize) = pixel };
            if rung == DEFERRING && pixel.is_deferred() {
                deferred::defer(list, index);
            }
        }
    }
}

/// [`render`] for many spheres without a tree; a workgroup has 32 × 32 pixels.
#[spirv(compute(threads(8, 32), entry_point_name = "render_by_tiles"))]
pub fn render_by_tiles(
    #[spirv(local_invocation_id)] local: UVec3,
    #[spirv(workgroup_id)] group: UVec3,
    #[spirv(num_workgroups)] groups: UVec3,
    #[spirv(spec_constant(id = 0, default = 0))] shading: u32,
    #[spirv(spec_constant(id = 1, default = 1))] rung: u32,
    #[spirv(spec_constant(id = 5, default = 0))] is_second: u32,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] launch: &Launch,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] spheres: &[Sphere],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] material_ids: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] materials: &[Material],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] pixels: &mut [Pixel],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] tiles: &mut [u32],
    #[spirv(workgroup)] planes: &mut [Vec4; 4],
    #[spirv(workgroup)] rows: &mut [f32; TILE as usize],
    #[spirv(workgroup)] listed: &mut u32,
    #[spirv(workgroup)] deferred_here: &mut u32,
    #[spirv(workgroup)] list: &mut [u32; LISTED],
    #[spirv(workgroup)] listed_spheres: &mut [Sphere; LISTED],
    #[spirv(workgroup)] cones: &mut [Vec4; LISTED],
) {
    let mut shared = Shared {
        planes,
        rows,
        listed,
        deferred: deferred_here,
        list,
        spheres: listed_spheres,
        cones,
    };
    let local = local.truncate();
    if is_second == 1 {
        let (count, columns) = (deferred::count(tiles), columns(launch));
        let mut place = group.x;
        while place < count {
            let tile = deferred::entry(tiles, place);
            let tile = UVec2::new(tile % columns, tile / columns);
            render_group(
                tile,
                local,
                shading,
                rung,
                is_second,
                launch,
                spheres,
                material_ids,
                materials,
                pixels,
                tiles,
                &mut shared,
            );
            place += groups.x;
            // The next tile overwrites what threads share.
            workgroup_memory_barrier_with_group_sync();
        }
        return;
    }
    let tile = UVec2::new(group.x, from_the_middle(group.y, launch.tile_size.y));
    render_group(
        tile,
        local,
        shading,
        rung,
        is_second,
        launch,
        spheres,
        material_ids,
        materials,
        pixels,
        tiles,
        &mut shared,
    );
}

/// Renders the shapes beside the spheres of a world, after [`render`] or [`render_by_tiles`].
#[spirv(compute(threads(8, 16), entry_point_name = "render_shapes"))]
pub fn render_shapes(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(spec_constant(id = 0, default = 0))] shading: u32,
    #[spirv(spec_constant(id = 1, default = 1))] rung: u32,
    #[spirv(spec_constant(id = 6, default = 0))] kinds: u32,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] launch: &Launch,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] shapes: &[Shape],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] material_ids: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] materials: &[Material],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] nodes: &[Node],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] pixels: &mut [Pixel],
) {
    let pixel = UVec2::new(id.x, id.y);
    if pixel.x < launch.tile_size.x && pixel.y < launch.tile_size.y {
        let index = (pixel.y * launch.tile_size.x + pixel.x) as usize;
        if index < pixels.len() {
            let shapes = Shapes {
                kinds: Kinds::from_bits(kinds),
                shapes,
                // SAFETY: the host binds a tree's nodes.
                tree: unsafe { Tree::of_unchecked(nodes) },
                first: 0,
            };
            pixels[index] = render_pixel_of_shapes(
                shading,
                rung,
                launch,
                &shapes,
                material_ids,
                materials,
                pixel,
                &pixels[index],
            );
        }
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
    #[spirv(spec_constant(id = 6, default = 0))] kinds: u32,
    #[spirv(uniform, descriptor_set = 0, binding = 0)] launch: &PathLaunch,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] spheres: &[Sphere],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] velocities: &[Vec4],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] material_ids: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] materials: &[Material],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] lights: &[Light],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] tables: &[f32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] texels: &[f32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 8)] nodes: &[Node],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 9)] shapes: &[Shape],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 10)] shape_nodes: &[Node],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 11)] accumulators: &mut [Accumulator],
) {
    let pixel = UVec2::new(id.x, id.y);
    if pixel.x < launch.tile_size.x && pixel.y < launch.tile_size.y {
        let index = (pixel.y * launch.tile_size.x + pixel.x) as usize;
        if index < accumulators.len() {
            let mut effects = Effects::from_bits(effects).within(Effects::BUILT);
            if is_exact == 0 {
                effects = effects.within(Effects::from_bits(launch.called_effects));
            }
            // SAFETY: the host binds a tree's.
            let tree = unsafe { Tree::of_unchecked(nodes) };
            let scenery = Scenery {
                effects,
                rung,
                launch,
                traversal: OneByOne {
                    rung,
                    has_tree,
                    tree,
                },
                spheres,
                shapes: Shapes {
                    kinds: Kinds::from_bits(kinds),
                    shapes,
                    // SAFETY: the host binds a tree's.
                    tree: unsafe { Tree::of_unchecked(shape_nodes) },
                    first: launch.first_shape,
                },
                velocities,
                material_ids,
                materials,
                lights,
                tables,
                texels,
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
    #[spirv(spec_constant(id = 5, default = 0))] is_second: u32,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] rays: &[Ray],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] spheres: &[Sphere],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] nodes: &[Node],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] hits: &mut [Hit],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] list: &mut [u32],
) {
    // SAFETY: the host binds a tree's nodes.
    let tree = unsafe { Tree::of_unchecked(nodes) };
    if is_second == 1 {
        let (count, step) = (deferred::count(list), groups.x * 64);
        let mut place = id.x % 64 * groups.x + id.x / 64;
        while place < count {
            let index = deferred::entry(list, place) as usize;
            if index < rays.len() && index < hits.len() {
                hits[index] = nearest_hit_in_tree(rung, &rays[index], tree, spheres);
            }
            place += step;
        }
        return;
    }
    let index = id.y * groups.x * 64 + id.x;
    let place = index as usize;
    if place < rays.len() && place < hits.len() {
        let hit = nearest_hit_in_tree(rung, &rays[place], tree, spheres);
        hits[place] = hit;
        if rung == DEFERRING && hit.is_deferred() {
            deferred::defer(list, index);
        }
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
    #[spirv(spec_constant(id = 5, default = 0))] is_second: u32,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] rays: &[Ray],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] spheres: &[Sphere],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] nodes: &[Node],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] occluded: &mut [u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] list: &mut [u32],
) {
    // SAFETY: the host binds a tree's nodes.
    let tree = unsafe { Tree::of_unchecked(nodes) };
    if is_second == 1 {
        let (count, step) = (deferred::count(list), groups.x * 64);
        let mut place = id.x % 64 * groups.x + id.x / 64;
        while place < count {
            let index = deferred::entry(list, place) as usize;
            if index < rays.len() && index < occluded.len() {
                occluded[index] = any_hit_in_tree(rung, &rays[index], tree, spheres)
                    .is_some()
                    .into();
            }
            place += step;
        }
        return;
    }
    let index = id.y * groups.x * 64 + id.x;
    let place = index as usize;
    if place < rays.len() && place < occluded.len() {
        let hit = any_hit_in_tree(rung, &rays[place], tree, spheres);
        occluded[place] = hit.is_some().into();
        if rung == DEFERRING && hit.is_deferred() {
            deferred::defer(list, index);
        }
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

/// Intersects ray i with shape i and nothing else; writes the parameter of the hit.
#[spirv(compute(threads(64), entry_point_name = "intersect_shapes"))]
pub fn intersect_shapes(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(spec_constant(id = 1, default = 1))] rung: u32,
    #[spirv(spec_constant(id = 6, default = 0))] kinds: u32,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] rays: &[Ray],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] shapes: &[Shape],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] parameters: &mut [f32],
) {
    let index = id.x as usize;
    if index < rays.len() && index < shapes.len() && index < parameters.len() {
        let span = shapes[index].span(rung, Kinds::from_bits(kinds), &rays[index]);
        parameters[index] = span.first(&rays[index]);
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

/// Shades the hit at parameter i of ray i on sphere i in each mode; writes a colour for each
/// of [`Shading::ALL`] an element.
#[spirv(compute(threads(64), entry_point_name = "shade_hits"))]
pub fn shade_hits(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] rays: &[Ray],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] spheres: &[Sphere],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] parameters: &[f32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] materials: &[Material],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] colors: &mut [Vec4],
) {
    const MODES: usize = Shading::ALL.len();
    let index = id.x as usize;
    if index < rays.len()
        && index < spheres.len()
        && index < parameters.len()
        && index < materials.len()
        && MODES * index + (MODES - 1) < colors.len()
    {
        let ray = &rays[index];
        let hit = Hit {
            t: parameters[index],
            sphere: id.x,
        };
        let seen = Seen {
            ray: *ray,
            hit,
            surface: Surface::at(ray, hit.t, spheres[index]),
            material: materials[index],
            tag: id.x,
        };
        let mut mode = 0;
        while mode < MODES {
            colors[MODES * index + mode] = shade(mode as u32, seen).extend(1.0);
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

/// The same in 64-bit floats.
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
#[spirv(compute(threads(64), entry_point_name = "measure_wide_multiplications"))]
pub fn measure_wide_multiplications(
    #[spirv(global_invocation_id)] id: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] factor_and_rounds: &[f32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] sums: &mut [f32],
) {
    let index = id.x as usize;
    if index < sums.len() && factor_and_rounds.len() >= 2 {
        let rounds = factor_and_rounds[1] as u32;
        sums[index] = wide_products(index as f32, factor_and_rounds[0], rounds);
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
