//! Brute force on a GPU: a workgroup makes a list of the spheres that any of its pixels may see, of all there are, and each of its
//! threads goes through the list with eight pixels. Runs on the GPU.

use glam::{UVec2, Vec2, Vec4};
use spirv_std::arch::{IndexUnchecked, atomic_i_add, workgroup_memory_barrier_with_group_sync};
use spirv_std::memory::{Scope, Semantics};

use crate::cone::{Cone, Row, is_square};
use crate::frustum::{Frustum, Plane};
use crate::instructions::{highest_bit, lowest_bit};
use crate::precision::intersect;
use crate::{Camera, Hit, Launch, Material, Pixel, Sphere};

/// The threads of a workgroup for each tile, and the pixels of one row that each has.
pub const GROUP: UVec2 = UVec2::new(4, 32);
const THREADS: u32 = GROUP.x * GROUP.y;
const PIXELS: u32 = 8;
/// Pixels of a workgroup.
pub const ALL: usize = (THREADS * PIXELS) as usize;
/// Cones that a workgroup keeps at hand: one of each thread's making.
pub const TILE: usize = THREADS as usize;
/// Cones that a thread looks at between two branches.
const STEP: u32 = 4;
/// Spheres that a workgroup looks at between two barriers, each thread at four.
const BATCH: u32 = 4 * THREADS;
/// How many spheres a list has room for. What a workgroup shares decides how many of them a multiprocessor holds.
pub const LISTED: usize = BATCH as usize + TILE;
/// Whose memory an atomic operation is on, and that it orders no other.
const WORKGROUP: u32 = Scope::Workgroup as u32;
const RELAXED: u32 = Semantics::NONE.bits();

/// What the threads of a workgroup share.
pub struct Shared<'a> {
    /// Around the rays of all of its pixels.
    pub planes: &'a mut [Vec4; 4],
    /// 1 if the bounds of cones hold.
    pub is_square: &'a mut u32,
    /// How many spheres are listed.
    pub listed: &'a mut u32,
    /// The spheres that may be seen, by their indices, in no order.
    pub list: &'a mut [u32; LISTED],
    /// The cones of some of them.
    pub tile: &'a mut [Vec4; TILE],
    /// For each pixel where its ray meets the nearest sphere so far, and which that is. A thread looks at its own pixels only; they are
    /// here because registers are few.
    pub nearest: &'a mut [f32; ALL],
    /// See `nearest`.
    pub found: &'a mut [u32; ALL],
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
    let corner = UVec2::new(group.x * GROUP.x * PIXELS, group.y * GROUP.y);
    let first_pixel = corner + local;
    if thread < 4 {
        let last = corner + UVec2::new(GROUP.x * PIXELS - 1, GROUP.y - 1);
        let (first, last) = (film(launch, corner), film(launch, last));
        let (low, high) = (Vec2::new(first.x, last.y), Vec2::new(last.x, first.y));
        let plane = Plane::around(&launch.camera, low, high, thread);
        // SAFETY: there are four.
        unsafe { *shared.planes.index_unchecked_mut(thread as usize) = plane.to_vec4() };
    }
    if thread == 0 {
        *shared.is_square = u32::from(is_square(&launch.camera));
        *shared.listed = 0;
    }
    let row = Row::of(
        &launch.camera,
        four_across(launch, first_pixel, 0),
        four_across(launch, first_pixel, 4),
        film(launch, first_pixel).y,
    );
    let mut which = 0;
    while which < PIXELS {
        let own = (THREADS * which + thread) as usize;
        // SAFETY: `own` is below the number of pixels.
        unsafe {
            *shared.nearest.index_unchecked_mut(own) = Hit::NONE_T;
            *shared.found.index_unchecked_mut(own) = 0;
        }
        which += 1;
    }
    let strip = Strip::of(launch, first_pixel, pixels.len() as u32);
    let is_continued = launch.first_of_tile == 0;
    if is_continued {
        let mut which = 0;
        while which < strip.count {
            let own = (THREADS * which + thread) as usize;
            // SAFETY: `own` is below the number of pixels, and the strip is within them.
            unsafe {
                let previous = pixels.index_unchecked(strip.place(which));
                *shared.nearest.index_unchecked_mut(own) = previous.depth();
            }
            which += 1;
        }
    }

    let len = spheres.len() as u32;
    let begin = launch.first_sphere.min(len);
    let end = begin + launch.sphere_count.min(len - begin);
    let mut first = begin;
    // The bounds of the loops with barriers are the same for every thread of the workgroup.
    while first < end {
        workgroup_memory_barrier_with_group_sync();
        let planes = [
            Plane::from_vec4(shared.planes[0]),
            Plane::from_vec4(shared.planes[1]),
            Plane::from_vec4(shared.planes[2]),
            Plane::from_vec4(shared.planes[3]),
        ];
        let frustum = Frustum::within(launch.camera.eye, planes);
        list_seen(&frustum, spheres, first, end, thread, shared);
        first += BATCH;
        workgroup_memory_barrier_with_group_sync();
        let count = *shared.listed;
        if (count > LISTED as u32 - BATCH) | (first >= end) {
            let mut base = 0;
            while base < count {
                if base > 0 {
                    workgroup_memory_barrier_with_group_sync();
                }
                let left = (count - base).min(TILE as u32);
                put_cone(launch, spheres, base, left, thread, shared);
                workgroup_memory_barrier_with_group_sync();
                let mut at = 0;
                while at < left {
                    ask(rung, launch, spheres, &row, base, at, left, thread, shared);
                    at += STEP;
                }
                base += TILE as u32;
            }
            // All know how many there were: they have met since, if there were any.
            if thread == 0 {
                *shared.listed = 0;
            }
        }
    }

    let mut which = 0;
    while which < strip.count {
        let own = (THREADS * which + thread) as usize;
        let place = strip.place(which);
        // SAFETY: `own` is below the number of pixels, and the strip is within them.
        let (t, sphere, end) = unsafe {
            let mut end = Hit::NONE_T;
            if is_continued {
                end = pixels.index_unchecked(place).depth();
            }
            (
                *shared.nearest.index_unchecked(own),
                *shared.found.index_unchecked(own),
                end,
            )
        };
        // What a pixel has from an earlier launch it keeps.
        if !is_continued | (t < end) {
            let hit = if t < end {
                Hit { t, sphere }
            } else {
                Hit::NONE
            };
            let ray = launch.camera.ray(row.film(which));
            let blank = launch.blank();
            let pixel = launch.pixel(shading, &ray, hit, spheres, material_ids, materials, blank);
            // SAFETY: as above.
            unsafe { *pixels.index_unchecked_mut(place) = pixel };
        }
        which += 1;
    }
}

/// Which of a thread's pixels are the launch's. Those beyond are traced for nothing, because their thread must meet the others' barriers.
#[derive(Clone, Copy)]
struct Strip {
    first: u32,
    count: u32,
}

impl Strip {
    /// Of the pixels from `first` on, of a launch that `len` pixels are bound to.
    #[inline]
    fn of(launch: &Launch, first: UVec2, len: u32) -> Self {
        let UVec2 {
            x: width,
            y: height,
        } = launch.tile_size;
        let start = first.y * width;
        let mut count = 0;
        if (first.x < width) & (first.y < height) & (start + width <= len) {
            count = (width - first.x).div_ceil(GROUP.x).min(PIXELS);
        }
        Self {
            first: start + first.x,
            count,
        }
    }

    /// Where a pixel is.
    #[inline]
    fn place(self, which: u32) -> usize {
        (self.first + GROUP.x * which) as usize
    }
}

/// Adds to the list what this thread looks at, of spheres from `first` up to `end`, and the frustum does not miss.
#[inline]
fn list_seen(
    frustum: &Frustum,
    spheres: &[Sphere],
    first: u32,
    end: u32,
    thread: u32,
    shared: &mut Shared<'_>,
) {
    let mine = first + thread;
    let mut seen;
    // The same for all threads.
    if first + THREADS < end {
        // All are asked for before the first is looked at, so that a thread waits for memory once.
        let one = look(spheres, end, mine);
        let two = look(spheres, end, mine + THREADS);
        let three = look(spheres, end, mine + 2 * THREADS);
        let four = look(spheres, end, mine + 3 * THREADS);
        seen = u32::from(!frustum.misses(one) & (mine < end));
        seen |= u32::from(!frustum.misses(two) & (mine + THREADS < end)) << 1;
        seen |= u32::from(!frustum.misses(three) & (mine + 2 * THREADS < end)) << 2;
        seen |= u32::from(!frustum.misses(four) & (mine + 3 * THREADS < end)) << 3;
    } else {
        seen = u32::from(!frustum.misses(look(spheres, end, mine)) & (mine < end));
    }
    while seen != 0 {
        let which = lowest_bit(seen);
        seen &= seen - 1;
        // SAFETY: all threads count by atomic additions until they next meet, and there was room for as many as are looked at.
        unsafe {
            let place = atomic_i_add::<u32, WORKGROUP, RELAXED>(shared.listed, 1);
            *shared.list.index_unchecked_mut(place as usize) = mine + which * THREADS;
        }
    }
}

/// The sphere with this index, or the last of those up to `end`, of which there is one at least.
#[inline]
fn look(spheres: &[Sphere], end: u32, index: u32) -> Sphere {
    // SAFETY: `end` is at most the number of spheres.
    unsafe { *spheres.index_unchecked(index.min(end - 1) as usize) }
}

/// Puts a thread's cone into the tile: of one of the spheres that are left of those listed from `base` on, if there are so many.
#[inline]
fn put_cone(
    launch: &Launch,
    spheres: &[Sphere],
    base: u32,
    left: u32,
    thread: u32,
    shared: &mut Shared<'_>,
) {
    let mut cone = Cone::none();
    if thread < left {
        // SAFETY: below the number of those listed, and of spheres.
        let sphere = unsafe {
            let index = *shared.list.index_unchecked((base + thread) as usize);
            *spheres.index_unchecked(index as usize)
        };
        cone = Cone::of(sphere, &launch.camera, *shared.is_square == 1);
    }
    // SAFETY: there is a cone for each thread.
    unsafe { *shared.tile.index_unchecked_mut(thread as usize) = cone.to_vec4() };
}

/// Asks the rung about those of a step's spheres that a thread's rays may meet.
#[expect(
    clippy::too_many_arguments,
    reason = "what a thread knows is in registers, and structs that change cost more of them"
)]
#[inline]
fn ask(
    rung: u32,
    launch: &Launch,
    spheres: &[Sphere],
    row: &Row,
    base: u32,
    at: u32,
    left: u32,
    thread: u32,
    shared: &mut Shared<'_>,
) {
    let mut candidates = row.candidates([
        cone(shared, at),
        cone(shared, at + 1),
        cone(shared, at + 2),
        cone(shared, at + 3),
    ]);
    // The rung's code stands here once, for whichever ray.
    while candidates != 0 {
        let bit = highest_bit(candidates);
        candidates &= !(1 << bit);
        let which = (31 - bit) & 7;
        let at = at + (31 - bit) / 8;
        if at < left {
            let own = (THREADS * which + thread) as usize;
            // SAFETY: below the number of those listed, of spheres, and of pixels.
            unsafe {
                let index = *shared.list.index_unchecked((base + at) as usize);
                let sphere = *spheres.index_unchecked(index as usize);
                let ray = launch.camera.ray(row.film(which));
                let t = intersect(rung, sphere, &ray);
                let nearest_t = *shared.nearest.index_unchecked(own);
                let nearest_sphere = *shared.found.index_unchecked(own);
                // Lists are in no order: of two at the same t the first of all spheres is taken.
                if (t < nearest_t) | ((t == nearest_t) & (index < nearest_sphere)) {
                    *shared.nearest.index_unchecked_mut(own) = t;
                    *shared.found.index_unchecked_mut(own) = index;
                }
            }
        }
    }
}

/// One of the tile's cones, where `at` is below its size.
#[inline]
fn cone(shared: &Shared<'_>, at: u32) -> Cone {
    // SAFETY: as said.
    Cone::from_vec4(unsafe { *shared.tile.index_unchecked(at as usize) })
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

/// One of the pixels that a thread has: the others are to the right, as far apart as the workgroup is wide.
#[inline]
fn pixel_of(first: UVec2, which: u32) -> UVec2 {
    first + UVec2::new(GROUP.x * which, 0)
}
