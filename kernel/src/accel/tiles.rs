//! Brute force on a GPU: a workgroup lists the spheres that any of its pixels may see, of all there are, and each of its
//! threads goes through the list for four pixels, one after the other. Runs on the GPU.

use glam::{UVec2, Vec2, Vec4};
use spirv_std::arch::{
    IndexUnchecked, atomic_i_add, device_memory_barrier, workgroup_memory_barrier_with_group_sync,
};
use spirv_std::memory::{Scope, Semantics};

use crate::cull::cone::{Cone, Sight};
use crate::cull::frustum::{Frustum, Plane};
use crate::film::TILE;
use crate::gpu::instructions::{highest_bit, lowest_bit};
use crate::precision::intersect;
use crate::{Camera, Hit, Launch, Material, Pixel, Sphere};

/// The threads of a workgroup for each tile.
pub const GROUP: UVec2 = UVec2::new(8, 32);
const THREADS: u32 = GROUP.x * GROUP.y;
/// Each 32 threads have 8 × 4 pixels at a time, and four times as many stand side by side.
const BLOCK: UVec2 = UVec2::new(8, 4);
const ABREAST: u32 = TILE / BLOCK.x;
/// Rows of pixels that a workgroup has at a time.
const ROWS: u32 = THREADS / TILE;
/// How many spheres a list has room for. What a workgroup shares decides how many of them a multiprocessor holds.
pub const LISTED: usize = 256;
/// Spheres that a workgroup looks at between two barriers, at most. If a list has no room for those that are seen, it looks at a fourth of as many,
const BATCH: u32 = 1 << 14;
/// but not at fewer than this, which fit into half a list.
const SMALL_BATCH: u32 = LISTED as u32 / 2;
/// Cones that a thread looks at between two branches, and before it asks the rung.
const STEP: u32 = 4;
const BITS: u32 = u32::BITS;
/// Whose memory an atomic operation is on, and that it orders no other.
const WORKGROUP: u32 = Scope::Workgroup as u32;
const RELAXED: u32 = Semantics::NONE.bits();

/// What the threads of a workgroup share.
pub struct Shared<'a> {
    /// Around the rays of all of its pixels.
    pub planes: &'a mut [Vec4; 4],
    /// Where its rows of pixels are on the film.
    pub rows: &'a mut [f32; TILE as usize],
    /// How many spheres are listed, or would be if there were room.
    pub listed: &'a mut u32,
    /// The spheres that may be seen, by their indices. Those of one batch are in no order.
    pub list: &'a mut [u32; LISTED],
    /// They themselves.
    pub spheres: &'a mut [Sphere; LISTED],
    /// Their cones.
    pub cones: &'a mut [Vec4; LISTED],
}

/// Renders the pixels of one workgroup of a launch.
#[expect(
    clippy::too_many_arguments,
    reason = "these are the kernel's bindings, one each"
)]
#[inline]
pub fn render_group(
    group: UVec2,
    local: UVec2,
    shading: u32,
    rung: u32,
    launch: &Launch,
    spheres: &[Sphere],
    material_ids: &[u32],
    materials: &[Material],
    pixels: &mut [Pixel],
    shared: &mut Shared<'_>,
) {
    let thread = local.y * GROUP.x + local.x;
    let corner = UVec2::new(group.x, from_the_middle(group.y, launch.tile_size.y)) * TILE;
    let block = UVec2::new(local.y / BLOCK.y % ABREAST, local.y / BLOCK.y / ABREAST);
    let first_pixel = corner + block * BLOCK + UVec2::new(local.x, local.y % BLOCK.y);
    let across = film(launch, first_pixel).x;
    if thread < 4 {
        let (first, last) = (film(launch, corner), film(launch, corner + (TILE - 1)));
        let (low, high) = (Vec2::new(first.x, last.y), Vec2::new(last.x, first.y));
        let plane = Plane::around(&launch.camera, low, high, thread);
        // SAFETY: there are four.
        unsafe { *shared.planes.index_unchecked_mut(thread as usize) = plane.to_vec4() };
    }
    if thread < TILE {
        let y = film(launch, corner + UVec2::new(0, thread)).y;
        // SAFETY: as just asked.
        unsafe { *shared.rows.index_unchecked_mut(thread as usize) = y };
    }
    if thread == 0 {
        *shared.listed = 0;
    }

    let len = spheres.len() as u32;
    let mut first = launch.first_sphere.min(len);
    let end = first + launch.sphere_count.min(len - first);
    let mut is_continued = launch.first_of_tile == 0;
    let mut batch = BATCH;
    let mut before = 0;
    // The bounds of the loop are the same for every thread of the workgroup.
    loop {
        workgroup_memory_barrier_with_group_sync();
        let planes = [
            Plane::from_vec4(shared.planes[0]),
            Plane::from_vec4(shared.planes[1]),
            Plane::from_vec4(shared.planes[2]),
            Plane::from_vec4(shared.planes[3]),
        ];
        let frustum = Frustum::within(launch.camera.eye, planes);
        let stop = first + batch.min(end - first);
        list_seen(&frustum, spheres, first, stop, thread, shared);
        workgroup_memory_barrier_with_group_sync();
        let mut count = *shared.listed;
        let mut is_due = true;
        if count > LISTED as u32 {
            // What was listed before this batch is still there; the batch is looked at again.
            count = before;
            batch = SMALL_BATCH.max(batch / 4);
        } else {
            first = stop;
            before = count;
            batch = BATCH.min(batch * 2);
            is_due = (count > LISTED as u32 - SMALL_BATCH) | (first >= end);
        }
        if is_due {
            put_cones(launch, spheres, count, thread, shared);
            workgroup_memory_barrier_with_group_sync();
            // All know how many there were.
            if thread == 0 {
                *shared.listed = 0;
            }
            before = 0;
            if is_continued {
                // Pixels are read that were written: not from where they were kept before.
                device_memory_barrier();
            }
            let mut row = 0;
            loop {
                let pixel = first_pixel + UVec2::new(0, row);
                // SAFETY: there are as many.
                let upwards =
                    unsafe { *shared.rows.index_unchecked((pixel.y - corner.y) as usize) };
                render_listed(
                    pixel,
                    Vec2::new(across, upwards),
                    count,
                    is_continued,
                    shading,
                    rung,
                    launch,
                    spheres,
                    material_ids,
                    materials,
                    pixels,
                    shared,
                );
                row += ROWS;
                if row >= TILE {
                    break;
                }
            }
            is_continued = true;
            if first >= end {
                break;
            }
        }
    }
}

/// Which row of tiles, of so many rows of pixels, a row of workgroups has: those in the middle come first, as pictures have most there, and what
/// takes longest must not begin last.
#[inline]
fn from_the_middle(row: u32, height: u32) -> u32 {
    let (middle, away) = (height.div_ceil(TILE) / 2, row.div_ceil(2));
    if row & 1 == 1 {
        middle - away
    } else {
        middle + away
    }
}

/// Adds to the list what this thread looks at, of spheres from `first` up to `stop`, and the frustum does not miss.
#[inline]
fn list_seen(
    frustum: &Frustum,
    spheres: &[Sphere],
    first: u32,
    stop: u32,
    thread: u32,
    shared: &mut Shared<'_>,
) {
    let mut mine = first + thread;
    if mine >= stop {
        return;
    }
    loop {
        // SAFETY: `stop` is at most the number of spheres.
        let look = |index: u32| unsafe { *spheres.index_unchecked(index as usize) };
        // Both are asked for before the first is looked at, so that a thread waits for memory once.
        let one = look(mine);
        let two = look((mine + THREADS).min(stop - 1));
        let mut seen = u32::from(!frustum.misses(one));
        seen |= u32::from(!frustum.misses(two) & (mine + THREADS < stop)) << 1;
        if seen != 0 {
            loop {
                let which = lowest_bit(seen);
                seen &= seen - 1;
                // SAFETY: all threads count by atomic additions until they next meet.
                let place = unsafe { atomic_i_add::<u32, WORKGROUP, RELAXED>(shared.listed, 1) };
                if place < LISTED as u32 {
                    // SAFETY: as just asked.
                    unsafe {
                        *shared.list.index_unchecked_mut(place as usize) = mine + which * THREADS;
                    }
                }
                if seen == 0 {
                    break;
                }
            }
        }
        mine += 2 * THREADS;
        if mine >= stop {
            break;
        }
    }
}

/// Makes the cones of the spheres that are listed, and of none up to whole steps.
#[inline]
fn put_cones(
    launch: &Launch,
    spheres: &[Sphere],
    count: u32,
    thread: u32,
    shared: &mut Shared<'_>,
) {
    let mut at = thread;
    while at < count.next_multiple_of(STEP) {
        let mut cone = Cone::none();
        // SAFETY: lists are whole steps long, and what is listed is below the number of spheres.
        unsafe {
            if at < count {
                let index = *shared.list.index_unchecked(at as usize);
                let sphere = *spheres.index_unchecked(index as usize);
                *shared.spheres.index_unchecked_mut(at as usize) = sphere;
                cone = Cone::of(sphere, launch.camera.eye);
            }
            *shared.cones.index_unchecked_mut(at as usize) = cone.to_vec4();
        }
        at += THREADS;
    }
}

/// Renders a pixel of the launch by the `count` spheres that are listed. If it is continued, it keeps what it has unless one of them is nearer.
#[expect(
    clippy::too_many_arguments,
    reason = "these are the kernel's bindings, one each"
)]
#[inline]
fn render_listed(
    pixel: UVec2,
    film: Vec2,
    count: u32,
    is_continued: bool,
    shading: u32,
    rung: u32,
    launch: &Launch,
    spheres: &[Sphere],
    material_ids: &[u32],
    materials: &[Material],
    pixels: &mut [Pixel],
    shared: &Shared<'_>,
) {
    let UVec2 {
        x: width,
        y: height,
    } = launch.tile_size;
    let place = (pixel.y * width + pixel.x) as usize;
    if (pixel.x >= width) | (pixel.y >= height) | (place >= pixels.len()) {
        return;
    }
    let blank = launch.blank();
    if count == 0 {
        if !is_continued {
            // SAFETY: as just asked.
            unsafe { *pixels.index_unchecked_mut(place) = blank };
        }
        return;
    }
    let mut end = Hit::NONE_T;
    if is_continued {
        // SAFETY: as just asked.
        end = unsafe { pixels.index_unchecked(place).depth() };
    }
    let ray = launch.camera.ray(film);
    let sight = Sight::along(ray.direction);
    let mut nearest = Hit { t: end, sphere: 0 };
    let mut base = 0;
    // Loops test their end where they may go on: of the other shape the driver makes copies of all that changes. No list is empty here.
    loop {
        let stop = count.next_multiple_of(STEP).min(base + BITS);
        let mut misses = step(&sight, u32::MAX, base, shared);
        let mut at = base + STEP;
        // Of few spheres most lists are one step long.
        if at < stop {
            loop {
                misses = step(&sight, misses, at, shared);
                at += STEP;
                if at >= stop {
                    break;
                }
            }
        }
        // The last cone's bit is the lowest.
        let mut candidates = !misses;
        if candidates != 0 {
            loop {
                let bit = highest_bit(candidates);
                candidates ^= 1 << bit;
                let (index, sphere) = listed(stop - 1 - bit, shared);
                let t = intersect(rung, sphere, &ray);
                // Lists are in no order: of two at the same t the first of all spheres is taken.
                if (t < nearest.t) | ((t == nearest.t) & (index < nearest.sphere)) {
                    nearest = Hit { t, sphere: index };
                }
                if candidates == 0 {
                    break;
                }
            }
        }
        base += BITS;
        if base >= count {
            break;
        }
    }
    // What a pixel has from earlier spheres it keeps.
    if !is_continued | (nearest.t < end) {
        if nearest.t >= end {
            nearest = Hit::NONE;
        }
        let pixel = launch.pixel(
            shading,
            &ray,
            nearest,
            spheres,
            material_ids,
            materials,
            blank,
        );
        // SAFETY: as above.
        unsafe { *pixels.index_unchecked_mut(place) = pixel };
    }
}

/// Moves in from the right whether the ray misses each of four cones.
#[inline]
fn step(sight: &Sight, before: u32, at: u32, shared: &Shared<'_>) -> u32 {
    let first = sight.misses(before, cone(at, shared));
    let second = sight.misses(first, cone(at + 1, shared));
    let third = sight.misses(second, cone(at + 2, shared));
    sight.misses(third, cone(at + 3, shared))
}

/// A sphere of the list, and its index.
#[inline]
fn listed(at: u32, shared: &Shared<'_>) -> (u32, Sphere) {
    // SAFETY: callers ask for those that are listed.
    unsafe {
        (
            *shared.list.index_unchecked(at as usize),
            *shared.spheres.index_unchecked(at as usize),
        )
    }
}

/// One of the cones.
#[inline]
fn cone(at: u32, shared: &Shared<'_>) -> Cone {
    // SAFETY: callers ask for those that were put.
    Cone::from_vec4(unsafe { *shared.cones.index_unchecked(at as usize) })
}

/// Where on the film a pixel of a launch is.
#[inline]
fn film(launch: &Launch, pixel: UVec2) -> Vec2 {
    Camera::film(launch.tile_origin + pixel, launch.image_size)
}
