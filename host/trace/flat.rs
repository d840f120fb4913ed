//! [`Flat`]: a small tree without its inner nodes. With AVX-512 a ray looks at all boxes at the bottom at once,
//! sixteen side by side, and goes through those that it meets from the nearest on: what it would spend on a few
//! inner nodes is more.

use std::arch::x86_64::*;
use std::mem::MaybeUninit;

use glam::Vec3;
use spherule_kernel::tree::{Node, Slabs};
use spherule_kernel::{Hit, Ray, Sphere};

use super::avx512::Avx512;
use super::single::{Search, Single};

/// Boxes side by side.
const LANES: usize = 16;
/// The most boxes: of some 5000 spheres.
const MAX: usize = 256;
/// Rays whose boxes are looked at before their spheres: nothing of the first depends on guesses.
const RAYS: usize = 4;

/// The boxes at the bottom of a tree, and the spheres in each.
#[derive(Clone, Debug)]
pub(super) struct Flat {
    groups: Vec<Group>,
    /// Of each box the first sphere, and how many there are.
    spheres: Vec<(u32, u32)>,
}

/// The sides of sixteen boxes: the smallest x, y, z, then the largest. A box that is none is empty.
#[derive(Clone, Debug)]
#[repr(align(64))]
struct Group([[f32; LANES]; 6]);

impl Flat {
    /// Of a tree; `None` if it has more boxes than pay.
    pub(super) fn of(nodes: &[Node]) -> Option<Self> {
        let mut boxes = Vec::new();
        collect(nodes, Node::ROOT, &mut boxes).then(|| Self {
            groups: groups(&boxes),
            spheres: boxes.iter().map(|of| of.spheres).collect(),
        })
    }
}

/// Boxes side by side.
fn groups(boxes: &[Bottom]) -> Vec<Group> {
    let group = |some: &[Bottom]| {
        let beyond = Node::MAX_COORDINATE;
        let none = |side| [if side < 3 { beyond } else { -beyond }; LANES];
        let mut sides = [0, 1, 2, 3, 4, 5].map(none);
        for (lane, of) in some.iter().enumerate() {
            for axis in 0..3 {
                sides[axis][lane] = of.low[axis];
                sides[3 + axis][lane] = of.high[axis];
            }
        }
        Group(sides)
    };
    boxes.chunks(LANES).map(group).collect()
}

struct Bottom {
    low: Vec3,
    high: Vec3,
    spheres: (u32, u32),
}

/// Adds what is at the bottom below a node; false where that is too much.
fn collect(nodes: &[Node], at: u32, boxes: &mut Vec<Bottom>) -> bool {
    let node = &nodes[at as usize];
    let corner = [node.corner.x, node.corner.y, node.corner.z].map(f32::from_bits);
    let corner = Vec3::from_array(corner);
    let side = |row: usize, child: u32| {
        let word = node.sides[row][child as usize % 4];
        if child < 4 {
            Node::lower(word)
        } else {
            Node::upper(word)
        }
    };
    // Rounded outwards.
    let low = |child| corner + Vec3::new(side(0, child), side(1, child), side(2, child));
    let high = |child| corner + Vec3::new(side(3, child), side(4, child), side(5, child));
    let down = |v: Vec3| Vec3::from_array(v.to_array().map(f32::next_down));
    let up = |v: Vec3| Vec3::from_array(v.to_array().map(f32::next_up));
    let leaves = (0..Node::WIDTH as u32).filter(|child| node.leaf(*child).1 > 0);
    if node.has_nodes() {
        for child in 0..Node::WIDTH as u32 {
            if node.is_node(child) && !collect(nodes, node.child(child), boxes) {
                return false;
            }
        }
        boxes.extend(leaves.map(|child| Bottom {
            low: down(low(child)),
            high: up(high(child)),
            spheres: node.leaf(child),
        }));
    } else {
        let none = Bottom {
            low: Vec3::MAX,
            high: Vec3::MIN,
            spheres: node.all_spheres(),
        };
        boxes.push(leaves.fold(none, |all, child| Bottom {
            low: all.low.min(down(low(child))),
            high: all.high.max(up(high(child))),
            ..all
        }));
    }
    boxes.len() <= MAX
}

/// A key's bits that say which box.
const INDEX: i32 = MAX as i32 - 1;

/// Boxes that a ray meets, in any order. A key is where it enters one, as a float's bits, whose lowest say which box.
struct Met {
    keys: [MaybeUninit<i32>; MAX + LANES],
    count: usize,
}

impl Met {
    const fn new() -> Self {
        Self {
            keys: [const { MaybeUninit::uninit() }; MAX + LANES],
            count: 0,
        }
    }
}

/// What each ray hits; `put` is told the ray's index.
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
pub(super) fn trace<const ANY: bool>(
    wide: Avx512,
    flat: &Flat,
    single: &Single<'_>,
    rays: &[Ray],
    spheres: &[Sphere],
    mut put: impl FnMut(usize, Hit),
) {
    let mut mets = [const { Met::new() }; RAYS];
    for (some, rays) in rays.chunks(RAYS).enumerate() {
        let mut slabs = [MaybeUninit::uninit(); RAYS];
        for ((ray, met), slabs) in rays.iter().zip(&mut mets).zip(&mut slabs) {
            let slabs = slabs.write(Slabs::of(single.rung.to_u32(), ray, single.nodes));
            flat.meet(slabs, ray.end(), met);
        }
        for (index, ((ray, met), slabs)) in rays.iter().zip(&mut mets).zip(&slabs).enumerate() {
            // SAFETY: it was written above.
            let slabs = unsafe { slabs.assume_init_ref() };
            let mut search = single.search(ray);
            flat.search::<ANY>(wide, slabs, met, spheres, &mut search);
            put(RAYS * some + index, search.finish::<ANY>());
        }
    }
}

/// The end of a ray, as boxes count it. One that ends before it starts has no boxes.
#[inline(always)]
fn end_of(slabs: &Slabs, t: f32) -> f32 {
    Slabs::widened_end(t * slabs.unit - slabs.start).max(0.0)
}

impl Flat {
    /// Finds the boxes that a ray meets before `t`.
    #[inline]
    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    fn meet(&self, slabs: &Slabs, t: f32, met: &mut Met) {
        let rows = slabs.near_rows.to_array().map(|row| row as usize);
        let splat = |value: f32| _mm512_set1_ps(value);
        let (inverse, near, far) = (
            slabs.inverse.to_array().map(splat),
            slabs.near.to_array().map(splat),
            slabs.far.to_array().map(splat),
        );
        let lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
        let end = splat(end_of(slabs, t));
        let mut count = 0;
        for (index, group) in self.groups.iter().enumerate() {
            let side = |row: usize| {
                // SAFETY: near rows are 0 or 3, 1 or 4, 2 or 5, and far ones the others.
                let sides = unsafe { group.0.get_unchecked(row) };
                // SAFETY: sixteen floats on a boundary of 64 bytes.
                unsafe { _mm512_load_ps(sides.as_ptr()) }
            };
            let enter = |axis: usize| _mm512_fmadd_ps(side(rows[axis]), inverse[axis], near[axis]);
            let leave = |axis: usize| {
                let row = 2 * axis + 3 - rows[axis];
                _mm512_fmadd_ps(side(row), inverse[axis], far[axis])
            };
            let enters = _mm512_max_ps(
                _mm512_max_ps(enter(0), enter(1)),
                _mm512_max_ps(enter(2), _mm512_setzero_ps()),
            );
            let leaves = _mm512_min_ps(
                _mm512_min_ps(leave(0), leave(1)),
                _mm512_min_ps(leave(2), end),
            );
            let is_met = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(enters, leaves);
            let index = _mm512_set1_epi32((LANES * index) as i32);
            // (enters & !INDEX) | index
            let keys = _mm512_ternarylogic_epi32::<0b1101_1000>(
                _mm512_castps_si512(enters),
                _mm512_or_epi32(index, lanes),
                _mm512_set1_epi32(INDEX),
            );
            // SAFETY: there is room for sixteen behind the most that there may be.
            unsafe {
                let to = met.keys.as_mut_ptr().add(count);
                _mm512_storeu_epi32(to.cast(), _mm512_maskz_compress_epi32(is_met, keys));
            }
            count += is_met.count_ones() as usize;
        }
        met.count = count;
    }

    /// Tests the spheres in the boxes, from the nearest on.
    #[inline]
    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    fn search<const ANY: bool>(
        &self,
        wide: Avx512,
        slabs: &Slabs,
        met: &mut Met,
        spheres: &[Sphere],
        search: &mut Search,
    ) {
        // SAFETY: as many were written.
        let keys = unsafe { met.keys[..met.count].assume_init_mut() };
        let mut last_key = i32::MAX;
        for done in 0..keys.len() {
            // The nearest of the others to its place.
            for other in done + 1..keys.len() {
                let (a, b) = (keys[done], keys[other]);
                (keys[done], keys[other]) = (a.min(b), a.max(b));
            }
            let key = keys[done];
            if key > last_key {
                break;
            }
            let (first, count) = self.spheres[(key & INDEX) as usize];
            search.test_wide::<ANY>(wide, spheres, first, count);
            if ANY && search.hit.is_some() {
                break;
            }
            let end = end_of(slabs, search.ray.t_max);
            last_key = end.to_bits().cast_signed() | INDEX;
        }
    }
}

#[cfg(test)]
mod tests {
    use spherule_kernel::Rung;
    use spherule_kernel::nearest::{is_occluded, nearest_hit_in};

    use super::super::walk::tests::{rays, world};
    use super::*;
    use crate::accuracy::random::Random;
    use crate::scene::tree::grow_still;

    /// Each ray finds what testing every sphere finds, in worlds of one box and of many, on every rung.
    #[test]
    fn flat_trees_find_what_testing_every_sphere_finds() {
        let Some(wide) = Avx512::detect() else {
            return;
        };
        let mut random = Random::new(11);
        for count in [1, 7, 40, 500, 3000] {
            let spheres = world(&mut random, count);
            let tree = grow_still(&spheres, 1).expect("a tree");
            let spheres = tree.sort(&spheres);
            let flat = Flat::of(&tree.nodes).expect("a small tree");
            let rays = rays(&mut random);
            for rung in Rung::ALL {
                let single = Single::new(rung, &tree.nodes);
                let code = rung.to_u32();
                let mut found = vec![(Hit::NONE, Hit::NONE); rays.len()];
                // SAFETY: the machine has AVX-512.
                unsafe {
                    let nearest = |index: usize, hit| found[index].0 = hit;
                    trace::<false>(wide, &flat, &single, &rays, &spheres, nearest);
                    let any = |index: usize, hit| found[index].1 = hit;
                    trace::<true>(wide, &flat, &single, &rays, &spheres, any);
                }
                for (ray, (nearest, any)) in rays.iter().zip(&found) {
                    let expected = nearest_hit_in(code, ray, &spheres[..], 0, u32::MAX);
                    assert_eq!(*nearest, expected, "{count} {rung:?} {ray:?}");
                    let is_occluded = is_occluded(code, ray, &spheres[..]);
                    assert_eq!(any.is_some(), is_occluded, "{count} {rung:?} {ray:?}");
                }
            }
        }
    }

    #[test]
    fn large_trees_are_not_flat() {
        let mut random = Random::new(12);
        let tree = grow_still(&world(&mut random, 20_000), 1).expect("a tree");
        assert!(Flat::of(&tree.nodes).is_none());
    }
}
