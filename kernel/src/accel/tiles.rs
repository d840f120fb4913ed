//! Brute force on a GPU by tiles. A workgroup culls all spheres and lists those that any of its
//! pixels may see. Then each of its threads goes through the list for four pixels, one after the
//! other. Runs on the GPU.

use glam::{UVec2, Vec2, Vec4};
use spirv_std::arch::{
    IndexUnchecked, atomic_i_add, device_memory_barrier, workgroup_memory_barrier_with_group_sync,
};
use spirv_std::memory::{Scope, Semantics};

use super::primitives::Primitives as _;
use crate::cull::bounds::Line;
use crate::cull::cone::{Cone, Sight};
use crate::cull::frustum::{Frustum, Plane};
use crate::film::TILE;
use crate::gpu::deferred::defer;
use crate::gpu::instructions::{highest_bit, lowest_bit};
use crate::precision::{DEFERRING, Rung, intersect_or_defer, is_lazy};
use crate::{Camera, Hit, Launch, Material, Pixel, Sphere};

/// The size of a workgroup in threads; one workgroup renders one tile.
pub const GROUP: UVec2 = UVec2::new(8, 32);
const THREADS: u32 = GROUP.x * GROUP.y;
/// 32 threads render a block of 8 × 4 pixels at a time, and [`ABREAST`] blocks lie side by side.
const BLOCK: UVec2 = UVec2::new(8, 4);
const ABREAST: u32 = TILE / BLOCK.x;
/// Rows of pixels that a workgroup renders at a time.
const ROWS: u32 = THREADS / TILE;
/// How many spheres a list has room for. The memory that a workgroup shares decides how many
/// workgroups a multiprocessor holds.
pub const LISTED: usize = 256;
/// The largest number of spheres that a workgroup culls between two barriers. If the list has no
/// room for those that are seen, the batch is tried again with a quarter of the size.
const BATCH: u32 = 1 << 14;
/// The smallest such number, which fits into half a list.
const SMALL_BATCH: u32 = LISTED as u32 / 2;
/// Cones that a thread tests between two branches, and before it evaluates the rung.
const STEP: u32 = 4;
const BITS: u32 = u32::BITS;
/// Atomic operations are on the workgroup's memory, and order no other operation.
const WORKGROUP: u32 = Scope::Workgroup as u32;
const RELAXED: u32 = Semantics::NONE.bits();

/// What the threads of a workgroup share.
pub struct Shared<'a> {
    /// Four planes around the rays of all of its pixels.
    pub planes: &'a mut [Vec4; 4],
    /// The y coordinate on the film of each of its rows of pixels.
    pub rows: &'a mut [f32; TILE as usize],
    /// How many spheres are in the list, or would be if it had room.
    pub listed: &'a mut u32,
    /// How many pixels were deferred.
    pub deferred: &'a mut u32,
    /// The indices of the spheres that may be seen. Those of one batch are in no order.
    pub list: &'a mut [u32; LISTED],
    /// The spheres in the list.
    pub spheres: &'a mut [Sphere; LISTED],
    /// The cones of the spheres in the list.
    pub cones: &'a mut [Vec4; LISTED],
}

/// Renders the pixels of a tile of a launch, given by its place, with one workgroup. In the second
/// of two launches these are the pixels that the first deferred; `deferred` lists tiles that have
/// some.
#[expect(
    clippy::too_many_arguments,
    reason = "these are the kernel's bindings, one each"
)]
#[inline]
pub fn render_group(
    tile: UVec2,
    local: UVec2,
    shading: u32,
    rung: u32,
    is_second: u32,
    launch: &Launch,
    spheres: &[Sphere],
    material_ids: &[u32],
    materials: &[Material],
    pixels: &mut [Pixel],
    deferred: &mut [u32],
    shared: &mut Shared<'_>,
) {
    let thread = local.y * GROUP.x + local.x;
    let corner = tile * TILE;
    let block = UVec2::new(local.y / BLOCK.y % ABREAST, local.y / BLOCK.y / ABREAST);
    let first_pixel = corner + block * BLOCK + UVec2::new(local.x, local.y % BLOCK.y);
    let across = film(launch, first_pixel).x;
    if thread < 4 {
        let (first, last) = (film(launch, corner), film(launch, corner + (TILE - 1)));
        let (low, high) = (Vec2::new(first.x, last.y), Vec2::new(last.x, first.y));
        let plane = Plane::around(&launch.camera, low, high, thread);
        // SAFETY: there are four planes.
        unsafe { *shared.planes.index_unchecked_mut(thread as usize) = plane.to_vec4() };
    }
    if thread < TILE {
        let y = film(launch, corner + UVec2::new(0, thread)).y;
        // SAFETY: `thread` is below the number of rows.
        unsafe { *shared.rows.index_unchecked_mut(thread as usize) = y };
    }
    if thread == 0 {
        *shared.listed = 0;
        *shared.deferred = 0;
    }

    let len = spheres.len() as u32;
    let mut first = launch.first_sphere.min(len);
    let end = first + launch.sphere_count.min(len - first);
    let mut is_continued = launch.first_of_tile == 0;
    // The rows of this thread's pixels that the second launch renders, by their lowest bits.
    let mut rendered = 0;
    if is_second == 1 {
        // What the first launch deferred is blank, or shows what it found before that.
        is_continued = true;
        rendered = take_deferred(first_pixel, launch.tile_size, pixels);
    }
    let mut batch = BATCH;
    let mut before = 0;
    // Every thread of the workgroup goes through the same iterations.
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
        list_seen(rung, &frustum, spheres, first, stop, thread, shared);
        workgroup_memory_barrier_with_group_sync();
        let mut count = *shared.listed;
        let mut is_due = true;
        if count > LISTED as u32 {
            // The list had no room. What was listed before this batch is still there; a smaller
            // batch is tried.
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
            // Every thread has read how many there were.
            if thread == 0 {
                *shared.listed = 0;
            }
            before = 0;
            if is_continued {
                // Pixels that were written are read again below: the barrier keeps those reads from
                // stale copies.
                device_memory_barrier();
            }
            let mut row = 0;
            loop {
                let pixel = first_pixel + UVec2::new(0, row);
                // SAFETY: there is one element for each row of the tile.
                let upwards =
                    unsafe { *shared.rows.index_unchecked((pixel.y - corner.y) as usize) };
                if (is_second == 0) | (rendered >> (row / ROWS) & 1 == 1) {
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
                        tile,
                        deferred,
                        shared,
                    );
                }
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

/// How many tiles stand side by side in a launch.
#[inline]
#[must_use]
pub fn columns(launch: &Launch) -> u32 {
    launch.tile_size.x.div_ceil(TILE)
}

/// Which of a thread's pixels were deferred, the topmost by the lowest bit; they are marked as
/// written.
#[inline]
fn take_deferred(first_pixel: UVec2, tile_size: UVec2, pixels: &mut [Pixel]) -> u32 {
    let mut deferred = 0;
    let mut row = 0;
    while row < TILE {
        let pixel = first_pixel + UVec2::new(0, row);
        let place = (pixel.y * tile_size.x + pixel.x) as usize;
        if (pixel.x < tile_size.x) & (pixel.y < tile_size.y) & (place < pixels.len()) {
            // SAFETY: as just asked.
            let pixel = unsafe { pixels.index_unchecked_mut(place) };
            if pixel.is_deferred() {
                *pixel = Pixel::new(pixel.color(), pixel.depth());
                deferred |= 1 << (row / ROWS);
            }
        }
        row += ROWS;
    }
    deferred
}

/// The row of tiles that a row of workgroups renders, in a launch of `height` rows of pixels. The
/// middle rows come first: images have most spheres there, and what takes longest must not begin
/// last.
#[inline]
#[must_use]
pub fn from_the_middle(row: u32, height: u32) -> u32 {
    let (middle, away) = (height.div_ceil(TILE) / 2, row.div_ceil(2));
    if row & 1 == 1 {
        middle - away
    } else {
        middle + away
    }
}

/// Culls this thread's share of the spheres from `first` up to `stop`, and adds to the list those
/// that the frustum does not miss.
#[inline]
fn list_seen(
    rung: u32,
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
        // Both are loaded before the first is tested, so that a thread waits for memory once.
        let one = look(mine);
        let two = look((mine + THREADS).min(stop - 1));
        let mut seen = u32::from(!frustum.misses(rung, one));
        seen |= u32::from(!frustum.misses(rung, two) & (mine + THREADS < stop)) << 1;
        if seen != 0 {
            loop {
                let which = lowest_bit(seen);
                seen &= seen - 1;
                // SAFETY: until the next barrier, all threads count by atomic additions.
                let place = unsafe { atomic_i_add::<u32, WORKGROUP, RELAXED>(shared.listed, 1) };
                if place < LISTED as u32 {
                    // SAFETY: `place` is below the length of the list.
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

/// Makes the cones of the spheres in the list, and pads them to whole steps with cones that every
/// ray misses.
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
        // SAFETY: the list's length is a multiple of a step, and listed indices are below the
        // number of spheres.
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

/// Renders a pixel of the launch from the `count` spheres in the list. A pixel that is continued
/// keeps its colour unless one of them is nearer.
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
    tile: UVec2,
    deferred: &mut [u32],
    shared: &mut Shared<'_>,
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
            // SAFETY: `place` is below the number of pixels.
            unsafe { *pixels.index_unchecked_mut(place) = blank };
        }
        return;
    }
    let mut end = Hit::NONE_T;
    if is_continued {
        // SAFETY: `place` is below the number of pixels.
        let pixel = unsafe { *pixels.index_unchecked(place) };
        if (rung == DEFERRING) & pixel.is_deferred() {
            return;
        }
        end = pixel.depth();
    }
    let ray = launch.camera.ray(film);
    let sight = Sight::along(ray.direction);
    let mut nearest = Hit { t: end, sphere: 0 };
    // For lazy rungs, as in a walk through a tree: where the nearest sphere may begin, and where it
    // certainly has begun, in the line's parameters. The former is below the latter as long as the
    // rung was not evaluated for it. The whole of certified is for the few rays that are deferred:
    // one copy of its code is worth more than to evaluate it once a ray.
    let is_lazy = is_lazy(rung) & (rung != Rung::Certified.to_u32());
    let line = Line::of(&ray);
    let mut high = end * line.unit;
    let mut low = high;
    let mut base = 0;
    // The loops test their end at the end of the body: otherwise the driver copies everything that
    // changes. The list is not empty here.
    loop {
        let stop = count.next_multiple_of(STEP).min(base + BITS);
        let mut misses = step(&sight, u32::MAX, base, shared);
        let mut at = base + STEP;
        // If the scene has few spheres, most lists are one step long.
        if at < stop {
            loop {
                misses = step(&sight, misses, at, shared);
                at += STEP;
                if at >= stop {
                    break;
                }
            }
        }
        // The lowest bit is the last cone's.
        let mut candidates = !misses;
        if is_lazy & (candidates != 0) {
            let mut all = candidates;
            candidates = 0;
            loop {
                let bit = highest_bit(all);
                all ^= 1 << bit;
                let (index, sphere) = listed(stop - 1 - bit, shared);
                let bounds = line.bounds(sphere);
                if bounds.hits & (bounds.high < low) {
                    nearest.sphere = index;
                    (low, high) = (bounds.low, bounds.high);
                } else {
                    candidates |= u32::from(bounds.is_open(high)) << bit;
                }
                if all == 0 {
                    break;
                }
            }
        }
        if candidates != 0 {
            loop {
                let index;
                let sphere;
                if is_lazy & (low < high) {
                    // The nearest sphere comes first, if the rung was not evaluated for it.
                    index = nearest.sphere;
                    // SAFETY: listed indices are below the number of spheres.
                    sphere = unsafe { *spheres.index_unchecked(index as usize) };
                } else {
                    let bit = highest_bit(candidates);
                    candidates ^= 1 << bit;
                    (index, sphere) = listed(stop - 1 - bit, shared);
                }
                let t = intersect_or_defer(rung, sphere, &ray);
                // The list is in no order: of two spheres at the same t, the one with the lower
                // index wins.
                if (t < nearest.t) | ((t == nearest.t) & (index < nearest.sphere)) {
                    nearest = Hit { t, sphere: index };
                }
                if is_lazy {
                    high = nearest.t * line.unit;
                    low = high;
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
    if is_lazy & (low < high) {
        // SAFETY: listed indices are below the number of spheres.
        let sphere = unsafe { *spheres.index_unchecked(nearest.sphere as usize) };
        nearest.t = <[Sphere]>::ask_entry(rung, sphere, &ray, &line, low, high);
    }
    if (rung == DEFERRING) & nearest.is_deferred() {
        // SAFETY: all threads count by atomic additions.
        let before = unsafe { atomic_i_add::<u32, WORKGROUP, RELAXED>(shared.deferred, 1) };
        if before == 0 {
            defer(deferred, tile.y * columns(launch) + tile.x);
        }
        // SAFETY: `place` is below the number of pixels.
        let pixel = unsafe { pixels.index_unchecked_mut(place) };
        *pixel = if is_continued { *pixel } else { blank }.deferred();
        return;
    }
    // A pixel keeps the colour that it has from earlier spheres unless a sphere of this list is
    // nearer.
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
        // SAFETY: `place` is below the number of pixels.
        unsafe { *pixels.index_unchecked_mut(place) = pixel };
    }
}

/// Tests four cones from `at` on: shifts `before` left by four bits and puts in a 1 for each that
/// the ray misses.
#[inline]
fn step(sight: &Sight, before: u32, at: u32, shared: &Shared<'_>) -> u32 {
    let first = sight.misses(before, cone(at, shared));
    let second = sight.misses(first, cone(at + 1, shared));
    let third = sight.misses(second, cone(at + 2, shared));
    sight.misses(third, cone(at + 3, shared))
}

/// The index of a sphere in the list, and the sphere.
#[inline]
fn listed(at: u32, shared: &Shared<'_>) -> (u32, Sphere) {
    // SAFETY: callers ask for places below the list's length.
    unsafe {
        (
            *shared.list.index_unchecked(at as usize),
            *shared.spheres.index_unchecked(at as usize),
        )
    }
}

/// The cone at this place of the list.
#[inline]
fn cone(at: u32, shared: &Shared<'_>) -> Cone {
    // SAFETY: callers ask for places below the list's length, rounded up to whole steps.
    Cone::from_vec4(unsafe { *shared.cones.index_unchecked(at as usize) })
}

/// The place of a launch's pixel on the film.
#[inline]
fn film(launch: &Launch, pixel: UVec2) -> Vec2 {
    Camera::film(launch.tile_origin + pixel, launch.image_size)
}
