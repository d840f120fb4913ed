//! A ray's way through a tree, front to back. Runs on the GPU and on the CPU.
//!
//! Children are visited in the order of the octant of the ray's direction, and the stack holds whole groups of
//! children (H. Ylitie, T. Karras, S. Laine, Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs, HPG 2017).
//!
//! # No walk gets lost
//!
//! Walks take a [`Tree`], whose nodes are known to be one: each is the child of one other that stands before it, and none
//! is deeper than there is room for on a stack. What links say of spheres need not fit the spheres that a walk is given: on the CPU
//! an index beyond them is cut to the last, on a GPU the driver checks it (`robustBufferAccess`).

use core::mem::MaybeUninit;

use glam::{UVec2, UVec4};
use spirv_std::arch::IndexUnchecked;

use super::brute::Spheres;
use super::node::{Extent, Node, Tree, point};
use super::slabs::{FIRST_OF_FOUR, Slabs, load};
use crate::cull::bounds::Line;
use crate::gpu::instructions::{highest_bit, lowest_bit};
use crate::hit::Hit;
use crate::precision::{intersect, intersect_at_once, is_lazy};
use crate::ray::Ray;

/// The nearest hit of `ray` on this rung among the spheres of a tree; of two equally near, the one
/// of lower index.
#[inline]
#[must_use]
pub fn nearest_hit_in_tree<S: Spheres + ?Sized>(
    rung: u32,
    ray: &Ray,
    tree: Tree<'_>,
    spheres: &S,
) -> Hit {
    walk::<false, S>(rung, ray, tree, spheres, &mut Work::default())
}

/// Whether `ray` hits any sphere of a tree.
#[inline]
#[must_use]
pub fn is_occluded_in_tree<S: Spheres + ?Sized>(
    rung: u32,
    ray: &Ray,
    tree: Tree<'_>,
    spheres: &S,
) -> bool {
    walk::<true, S>(rung, ray, tree, spheres, &mut Work::default()).is_some()
}

/// What a ray took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// The nodes whose boxes it was tested against.
    pub nodes: u32,
    /// The spheres that it was tested against.
    pub spheres: u32,
}

/// What `ray` takes in a tree; with `any`, up to the first hit that is found.
#[must_use]
pub fn work_in_tree<S: Spheres + ?Sized>(
    rung: u32,
    any: bool,
    ray: &Ray,
    tree: Tree<'_>,
    spheres: &S,
) -> Work {
    let mut work = Work::default();
    if any {
        let _ = walk::<true, S>(rung, ray, tree, spheres, &mut work);
    } else {
        let _ = walk::<false, S>(rung, ray, tree, spheres, &mut work);
    }
    work
}

/// The index of the sphere that has this bit in a node's links.
#[inline]
fn sphere_at(links: UVec4, bit: u32, count: u32) -> u32 {
    let before = (links.z & ((1 << bit) - 1)).count_ones();
    within(links.y.wrapping_add(before), count)
}

/// The two lowest bits of some that are set, the same twice if there is one; and the others.
#[inline]
fn take_two(bits: u32) -> (u32, u32, u32) {
    let one = lowest_bit(bits);
    let mut rest = bits & (bits - 1);
    let mut two = one;
    if rest != 0 {
        two = lowest_bit(rest);
        rest &= rest - 1;
    }
    (one, two, rest)
}

/// An index below a length that is not zero. The spheres need not be those of the tree, and a GPU's buffers are checked by
/// their driver (`robustBufferAccess`).
#[inline]
fn within(index: u32, length: u32) -> u32 {
    if cfg!(target_arch = "spirv") {
        index
    } else {
        index.min(length - 1)
    }
}

/// The nearest hit, or any.
#[inline]
fn walk<const ANY: bool, S: Spheres + ?Sized>(
    rung: u32,
    ray: &Ray,
    tree: Tree<'_>,
    spheres: &S,
    work: &mut Work,
) -> Hit {
    let (nodes, count) = (tree.nodes(), spheres.count());
    if (nodes.len() <= Node::ROOT as usize) | (count == 0) {
        return Hit::NONE;
    }
    // SAFETY: there are more than one.
    let world = Extent::of_node(unsafe { nodes.index_unchecked(0) });
    let slabs = Slabs::of(rung, ray, &world);
    let line = Line::of(ray);
    // Rungs that take long are asked about the nearest sphere only, when it is found.
    let is_lazy = is_lazy(rung);
    let ray = &Ray {
        t_max: ray.end(),
        ..*ray
    };
    // What changes on the way is kept apart from what does not, and is little: compilers for GPUs carry a
    // whole struct from round to round if any of it changes, and copy what they carry. Inner loops end where
    // they may go on, for the same reason.
    //
    // The nearest answer so far, and its sphere.
    let mut t = ray.t_max;
    let mut hit_sphere = 0;
    // The end of the ray, as the line counts it; and if it is lazy where the nearest sphere may begin, which is before
    // the end if the rung was not asked.
    let mut end = t * line.unit;
    let mut low = end;

    // Below the last group is an empty one.
    let mut stack = [MaybeUninit::<UVec2>::uninit(); Node::MAX_DEPTH + 1];
    stack[0] = MaybeUninit::new(UVec2::ZERO);
    let mut height = 1;
    // A group of nodes: where the first is, and which are to be visited (bits 4c, c in the order of the visit),
    // which are there (bits 4c + 1). The root is one alone.
    let mut first = Node::ROOT;
    let mut group = 0x1000_0000_u32;
    loop {
        // The next to be visited.
        let bit = highest_bit(group & FIRST_OF_FOUR);
        group ^= 1 << bit;
        if (group & FIRST_OF_FOUR != 0) & (height <= Node::MAX_DEPTH) {
            let kept = MaybeUninit::new(UVec2::new(first, group));
            // SAFETY: `height` is below the array's length.
            unsafe { *stack.index_unchecked_mut(height) = kept };
            height += 1;
        }
        let before = group & !FIRST_OF_FOUR & ((1 << (bit ^ slabs.octant)) - 1);
        let at = within(first + before.count_ones(), nodes.len() as u32);
        // SAFETY: `at` is below the slice's length, which is not zero.
        let node = unsafe { nodes.index_unchecked(at as usize) };
        let (corner, links) = (load(&node.corner), load(&node.links));
        let inner = corner.w;
        let met = slabs.meets(point(corner), &node.sides, end - slabs.start);
        work.nodes += 1;

        let mut candidates = (met * 15) & links.z;
        let mut met = met & (inner >> 1);
        work.spheres += candidates.count_ones();
        if (is_lazy | ANY) & (candidates != 0) {
            // Threads of a GPU wait for each other: few operations on all spheres, and many on the few that are left.
            // Two at a time, so that what one waits for does not hold up the other.
            let mut leaves = candidates;
            candidates = 0;
            loop {
                let (one, two, rest) = take_two(leaves);
                leaves = rest;
                let indices = [sphere_at(links, one, count), sphere_at(links, two, count)];
                // SAFETY: both are below the number of spheres.
                let pair = unsafe { [spheres.sphere(indices[0]), spheres.sphere(indices[1])] };
                if is_lazy {
                    let [first, second] = [line.bounds(pair[0]), line.bounds(pair[1])];
                    if first.hits & (first.high < low) {
                        (hit_sphere, low, end) = (indices[0], first.low, first.high);
                    } else {
                        candidates |= u32::from(first.is_open(end)) << one;
                    }
                    if second.hits & (second.high < low) {
                        (hit_sphere, low, end) = (indices[1], second.low, second.high);
                    } else {
                        candidates |= u32::from(second.is_open(end) & (one != two)) << two;
                    }
                } else {
                    candidates |= u32::from(line.may_hit(pair[0])) << one;
                    candidates |= u32::from(line.may_hit(pair[1])) << two;
                }
                if (leaves == 0) | (is_lazy & ANY & (low < end)) {
                    break;
                }
            }
            if is_lazy & ANY & (low < end) {
                candidates = 0;
            }
        }
        if (is_lazy | ANY) & (candidates != 0) {
            loop {
                // The nearest sphere comes first, if its rung was not asked.
                let index = if is_lazy & (low < end) {
                    hit_sphere
                } else {
                    let bit = lowest_bit(candidates);
                    candidates &= candidates - 1;
                    sphere_at(links, bit, count)
                };
                // SAFETY: `index` is below the number of spheres.
                let sphere = unsafe { spheres.sphere(index) };
                let answer = intersect(rung, sphere, ray);
                if (answer < t) | ((answer == t) & (index < hit_sphere)) {
                    (t, hit_sphere) = (answer, index);
                }
                end = t * line.unit;
                low = end;
                // Not by making `candidates` zero above: compilers leave the loop from there then, which Mesa 22's
                // llvmpipe was seen to get wrong.
                if (candidates == 0) | (ANY & (t < ray.t_max)) {
                    break;
                }
            }
        }
        if !(is_lazy | ANY) & (candidates != 0) {
            // Most are hits, and a hit is cheap: there is nothing to sift.
            loop {
                let (one, two, rest) = take_two(candidates);
                candidates = rest;
                let indices = [sphere_at(links, one, count), sphere_at(links, two, count)];
                // SAFETY: both are below the number of spheres.
                let pair = unsafe { [spheres.sphere(indices[0]), spheres.sphere(indices[1])] };
                let answers = [
                    intersect_at_once(rung, pair[0], ray),
                    intersect_at_once(rung, pair[1], ray),
                ];
                if (answers[0] < t) | ((answers[0] == t) & (indices[0] < hit_sphere)) {
                    (t, hit_sphere) = (answers[0], indices[0]);
                }
                if (answers[1] < t) | ((answers[1] == t) & (indices[1] < hit_sphere)) {
                    (t, hit_sphere) = (answers[1], indices[1]);
                }
                if candidates == 0 {
                    break;
                }
            }
            end = t * line.unit;
        }
        if ANY & ((t < ray.t_max) | (is_lazy & (low < end))) {
            // Nothing is left to be visited. A `return` out of both loops was seen to be compiled wrongly, by
            // Mesa 22's llvmpipe.
            (met, height) = (0, 1);
        }

        first = links.x;
        group = slabs.in_order(met) | inner;
        if met == 0 {
            height -= 1;
            // SAFETY: `height` is below the array's length, and what is there was put there.
            let next = unsafe { (*stack.index_unchecked(height)).assume_init() };
            first = next.x;
            group = next.y;
        }
        if group & FIRST_OF_FOUR == 0 {
            break;
        }
    }

    let is_unasked = is_lazy & (low < end);
    if is_unasked & !ANY {
        // SAFETY: `hit_sphere` is below the number of spheres.
        let sphere = unsafe { spheres.sphere(hit_sphere) };
        // No hit after all only where numbers are beyond what bounds are made for.
        t = intersect(rung, sphere, ray);
    }
    if (t < ray.t_max) | (is_unasked & ANY) {
        Hit {
            t,
            sphere: hit_sphere,
        }
    } else {
        Hit::NONE
    }
}
