//! Walks through a tree with a ray, front to back. Runs on the GPU and on the CPU.
//!
//! Children are visited in the order given by the octant of the ray's direction, and the stack
//! holds whole groups of children (H. Ylitie, T. Karras, S. Laine, Efficient Incoherent Ray
//! Traversal on GPUs Through Compressed Wide BVHs, HPG 2017).
//!
//! # Why a walk stays in bounds
//!
//! A walk takes a [`Tree`], whose nodes were checked: each is the child of one node that stands
//! before it, and none is deeper than the stack has room for. The indices of spheres need not fit
//! the spheres that a walk is given: on the CPU an index beyond them becomes the last, on a GPU the
//! driver checks it (`robustBufferAccess`).

use core::mem::MaybeUninit;

use glam::{UVec2, UVec4};
use spirv_std::arch::IndexUnchecked;

use super::node::{Extent, Node, Tree, point};
use super::primitives::Primitives;
use super::slabs::{FIRST_OF_FOUR, load};
use crate::cull::bounds::Line;
use crate::gpu::instructions::{highest_bit, lowest_bit};
use crate::hit::Hit;
use crate::precision::is_lazy;
use crate::ray::Ray;

/// The nearest hit of `ray` on this rung among the spheres of a tree; of two equally near hits, the
/// one with the lower index.
#[inline]
#[must_use]
pub fn nearest_hit_in_tree<S: Primitives + ?Sized>(
    rung: u32,
    ray: &Ray,
    tree: Tree<'_>,
    spheres: &S,
) -> Hit {
    walk::<false, S>(rung, ray, tree, spheres, &mut Work::default())
}

/// Any hit of `ray` among the spheres of a tree; its parameter need not be that of the hit.
#[inline]
#[must_use]
pub fn any_hit_in_tree<S: Primitives + ?Sized>(
    rung: u32,
    ray: &Ray,
    tree: Tree<'_>,
    spheres: &S,
) -> Hit {
    walk::<true, S>(rung, ray, tree, spheres, &mut Work::default())
}

/// Whether `ray` hits any sphere of a tree.
#[inline]
#[must_use]
pub fn is_occluded_in_tree<S: Primitives + ?Sized>(
    rung: u32,
    ray: &Ray,
    tree: Tree<'_>,
    spheres: &S,
) -> bool {
    any_hit_in_tree(rung, ray, tree, spheres).is_some()
}

/// How many tests a ray took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// The nodes whose boxes the ray was tested against.
    pub nodes: u32,
    /// The spheres that the ray was tested against.
    pub spheres: u32,
}

/// How many tests `ray` takes in a tree: to find the nearest hit, or with `any` the first hit at
/// all.
#[must_use]
pub fn work_in_tree<S: Primitives + ?Sized>(
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

/// The index of the sphere whose bit in `links.z` is this one, cut to `count`.
#[inline]
fn sphere_at(links: UVec4, bit: u32, count: u32) -> u32 {
    let before = (links.z & ((1 << bit) - 1)).count_ones();
    within(links.y.wrapping_add(before), count)
}

/// The numbers of the two lowest bits that are set (the same twice if only one is), and the
/// remaining bits.
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

/// Cuts an index to below `length`, which is not zero, because the spheres need not be those of the
/// tree. On a GPU the driver checks the index (`robustBufferAccess`).
#[inline]
fn within(index: u32, length: u32) -> u32 {
    if cfg!(target_arch = "spirv") {
        index
    } else {
        index.min(length - 1)
    }
}

/// The nearest hit, or with `ANY` any hit.
#[expect(
    clippy::too_many_lines,
    reason = "its parts share a dozen variables, which compilers for GPUs carry through memory if they \
              are in a struct"
)]
#[inline]
fn walk<const ANY: bool, S: Primitives + ?Sized>(
    rung: u32,
    ray: &Ray,
    tree: Tree<'_>,
    spheres: &S,
    work: &mut Work,
) -> Hit {
    let (nodes, count) = (tree.nodes(), spheres.total());
    if (nodes.len() <= Node::ROOT as usize) | (count == 0) {
        return Hit::NONE;
    }
    // SAFETY: there is more than one node.
    let world = Extent::of_node(unsafe { nodes.index_unchecked(0) });
    let slabs = S::slabs(rung, ray, &world);
    let line = Line::of(ray);
    // Lazy rungs are slow: they are evaluated once, for the nearest sphere, when it is found.
    let is_lazy = S::HAVE_BOUNDS & is_lazy(rung);
    let ray = &Ray {
        t_max: ray.end(),
        ..*ray
    };
    // What changes during the walk is kept in a few separate variables: if one field of a struct
    // changes, compilers for GPUs carry the whole struct from iteration to iteration, and copy it.
    // For the same reason, inner loops test their end at the end of the body.
    //
    // The nearest hit so far, and its sphere.
    let mut t = ray.t_max;
    let mut hit_sphere = 0;
    // The end of the ray in the line's parameters. If the rung is lazy, `low` is where the nearest
    // sphere may begin; it is below `end` as long as the rung was not evaluated for that sphere.
    let mut end = t * line.unit;
    let mut low = end;

    // An empty group lies at the bottom of the stack.
    let mut stack = [MaybeUninit::<UVec2>::uninit(); Node::MAX_DEPTH + 1];
    stack[0] = MaybeUninit::new(UVec2::ZERO);
    let mut height = 1;
    // A group of nodes: the index of the first, which are still to be visited (bits 4c, c in the
    // order of the visit), and which exist (bits 4c + 1). The root is a group of one.
    let mut first = Node::ROOT;
    let mut group = 0x1000_0000_u32;
    loop {
        // The next node to visit.
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
            // The threads of a GPU wait for each other. So all spheres are culled with few
            // operations first, and the few that are left get the many operations. Two spheres at a
            // time, so that loading one does not hold up the other.
            let mut leaves = candidates;
            candidates = 0;
            loop {
                let (one, two, rest) = take_two(leaves);
                leaves = rest;
                let indices = [sphere_at(links, one, count), sphere_at(links, two, count)];
                // SAFETY: both are below the number of spheres.
                let pair = unsafe { [spheres.one(indices[0]), spheres.one(indices[1])] };
                let are_left = [
                    spheres.is_passed_over::<ANY>(indices[0]),
                    spheres.is_passed_over::<ANY>(indices[1]),
                ];
                if is_lazy {
                    let [first, second] = [S::bounds(&line, pair[0]), S::bounds(&line, pair[1])];
                    if first.hits & (first.high < low) & !are_left[0] {
                        (hit_sphere, low, end) = (indices[0], first.low, first.high);
                    } else {
                        candidates |= u32::from(first.is_open(end) & !are_left[0]) << one;
                    }
                    if second.hits & (second.high < low) & !are_left[1] {
                        (hit_sphere, low, end) = (indices[1], second.low, second.high);
                    } else {
                        let is_open = second.is_open(end) & (one != two) & !are_left[1];
                        candidates |= u32::from(is_open) << two;
                    }
                } else {
                    candidates |= u32::from(S::may_hit(&line, pair[0]) & !are_left[0]) << one;
                    candidates |= u32::from(S::may_hit(&line, pair[1]) & !are_left[1]) << two;
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
                // The nearest sphere comes first, if the rung was not evaluated for it.
                let index = if is_lazy & (low < end) {
                    hit_sphere
                } else {
                    let bit = lowest_bit(candidates);
                    candidates &= candidates - 1;
                    sphere_at(links, bit, count)
                };
                // SAFETY: `index` is below the number of spheres.
                let sphere = unsafe { spheres.one(index) };
                let answer = S::ask(rung, sphere, ray);
                if (answer < t) | ((answer == t) & (index < hit_sphere)) {
                    (t, hit_sphere) = (answer, index);
                }
                end = t * line.unit;
                low = end;
                // Setting `candidates` to zero above would not do: compilers then leave the loop
                // from there, which Mesa 22's llvmpipe was seen to get wrong.
                if (candidates == 0) | (ANY & (t < ray.t_max)) {
                    break;
                }
            }
        }
        if !(is_lazy | ANY) & (candidates != 0) {
            // Most candidates are hits, and this rung is fast: culling first does not pay.
            loop {
                let (one, two, rest) = take_two(candidates);
                candidates = rest;
                let indices = [sphere_at(links, one, count), sphere_at(links, two, count)];
                // SAFETY: both are below the number of spheres.
                let pair = unsafe { [spheres.one(indices[0]), spheres.one(indices[1])] };
                let answers = [
                    S::ask_at_once(rung, pair[0], ray),
                    S::ask_at_once(rung, pair[1], ray),
                ];
                let are_left = [
                    spheres.is_passed_over::<false>(indices[0]),
                    spheres.is_passed_over::<false>(indices[1]),
                ];
                let is_nearer = (answers[0] < t) | ((answers[0] == t) & (indices[0] < hit_sphere));
                if is_nearer & !are_left[0] {
                    (t, hit_sphere) = (answers[0], indices[0]);
                }
                let is_nearer = (answers[1] < t) | ((answers[1] == t) & (indices[1] < hit_sphere));
                if is_nearer & !are_left[1] {
                    (t, hit_sphere) = (answers[1], indices[1]);
                }
                if candidates == 0 {
                    break;
                }
            }
            end = t * line.unit;
        }
        if ANY & ((t < ray.t_max) | (is_lazy & (low < end))) {
            // Nothing is left to visit. Mesa 22's llvmpipe was seen to compile a `return` out of
            // both loops wrongly.
            (met, height) = (0, 1);
        }

        first = links.x;
        group = slabs.in_order(met) | inner;
        if met == 0 {
            height -= 1;
            // SAFETY: `height` is below the array's length, and every element below the top was
            // written.
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
        let sphere = unsafe { spheres.one(hit_sphere) };
        // This is a miss only where numbers are beyond the range that the bounds are derived for.
        t = S::ask_entry(rung, sphere, ray, &line, low, end);
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
