//! The walk of [`Single`] on machines with AVX2: the eight boxes of a node side by side.
//!
//! What differs from the kernel's walk is that the nearest box is entered first, that one beyond the
//! nearest hit is left out when its turn comes, and that two rays take turns, so that what one waits for does
//! not hold up the other.

use std::arch::x86_64::*;
use std::mem::MaybeUninit;

use glam::{UVec4, Vec3};
use spherule_kernel::nearest::Spheres;
use spherule_kernel::tree::{Node, Slabs};
use spherule_kernel::{Hit, Ray};

use super::single::{Search, Single};

const WIDTH: usize = Node::WIDTH;
/// The most entries of a stack: each node on the way leaves at most seven behind, and a last one is written
/// eight at once.
const MAX_HEIGHT: usize = Node::MAX_DEPTH * (WIDTH - 1) + WIDTH;
/// Rays that take turns.
const RAYS: usize = 2;

/// The proof that this machine has AVX2 and what comes with it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx2(());

impl Avx2 {
    pub(super) fn detect() -> Option<Self> {
        let has_all = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt");
        has_all.then_some(Self(()))
    }
}

/// What a ray hits: the nearest, or with `ANY` the first that is found.
pub(super) fn trace_one<const ANY: bool, S: Spheres + ?Sized>(
    avx2: Avx2,
    single: &Single<'_>,
    ray: &Ray,
    spheres: &S,
) -> Hit {
    // SAFETY: the machine has the features.
    unsafe { trace_one_inner::<ANY, S>(avx2, single, ray, spheres) }
}

/// What each ray hits; `put` is told the ray's index.
pub(super) fn trace<const ANY: bool, S: Spheres + ?Sized>(
    avx2: Avx2,
    single: &Single<'_>,
    rays: &[Ray],
    spheres: &S,
    put: impl FnMut(usize, Hit),
) {
    // SAFETY: the machine has the features.
    unsafe { trace_inner::<ANY, S>(avx2, single, rays, spheres, put) }
}

#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn trace_one_inner<const ANY: bool, S: Spheres + ?Sized>(
    avx2: Avx2,
    single: &Single<'_>,
    ray: &Ray,
    spheres: &S,
) -> Hit {
    let mut stack = Stack::new();
    let mut walk = Walk::of(avx2, single, ray);
    while walk.step::<ANY, S>(single.nodes, spheres, &mut stack) {}
    walk.search.finish::<ANY>()
}

#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn trace_inner<const ANY: bool, S: Spheres + ?Sized>(
    avx2: Avx2,
    single: &Single<'_>,
    rays: &[Ray],
    spheres: &S,
    mut put: impl FnMut(usize, Hit),
) {
    let nodes = single.nodes;
    let mut stacks = [const { Stack::new() }; RAYS];
    let mut rest = rays.iter().enumerate();
    let mut walks = [const { MaybeUninit::<Walk>::uninit() }; RAYS];
    let mut indices = [0; RAYS];
    // How many are under way: the first ones.
    let mut count = 0;
    for (walk, index) in walks.iter_mut().zip(&mut indices) {
        let Some((of, ray)) = rest.next() else { break };
        walk.write(Walk::of(avx2, single, ray));
        *index = of;
        count += 1;
    }
    while count > 0 {
        let mut place = 0;
        while place < count {
            // SAFETY: `place` is below `count`.
            let walk = unsafe { walks[place].assume_init_mut() };
            if walk.step::<ANY, S>(nodes, spheres, &mut stacks[place]) {
                place += 1;
                continue;
            }
            put(indices[place], walk.search.finish::<ANY>());
            if let Some((of, ray)) = rest.next() {
                *walk = Walk::of(avx2, single, ray);
                indices[place] = of;
                place += 1;
            } else {
                // The last takes its place.
                count -= 1;
                walks.swap(place, count);
                stacks.swap(place, count);
                indices.swap(place, count);
            }
        }
    }
}

/// Boxes that were met and not entered yet, the nearest of the latest on top. A key is where the ray
/// enters a box, as a float's bits, whose lowest three say which child of its parent that is.
struct Stack {
    keys: [MaybeUninit<i32>; MAX_HEIGHT],
    parents: [MaybeUninit<u32>; MAX_HEIGHT],
}

impl Stack {
    const fn new() -> Self {
        Self {
            keys: [const { MaybeUninit::uninit() }; MAX_HEIGHT],
            parents: [const { MaybeUninit::uninit() }; MAX_HEIGHT],
        }
    }

    /// Puts eight at `height`, which is made to be in range.
    #[inline]
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    fn put(&mut self, height: usize, keys: __m256i, parent: u32) {
        let height = height.min(MAX_HEIGHT - WIDTH);
        let parents = _mm256_set1_epi32(parent.cast_signed());
        // SAFETY: there is room for eight from `height` on.
        unsafe {
            _mm256_storeu_si256(self.keys.as_mut_ptr().add(height).cast(), keys);
            _mm256_storeu_si256(self.parents.as_mut_ptr().add(height).cast(), parents);
        }
    }

    /// The key and the parent at `height`.
    ///
    /// # Safety
    ///
    /// Eight were put there, or so far below that they reach it.
    #[inline(always)]
    unsafe fn get(&self, height: usize) -> (i32, u32) {
        let height = height.min(MAX_HEIGHT - 1);
        // SAFETY: `height` is in range, and what is there the caller's.
        unsafe {
            (
                self.keys.get_unchecked(height).assume_init(),
                self.parents.get_unchecked(height).assume_init(),
            )
        }
    }
}

/// A ray on its way through a tree.
struct Walk {
    /// That the machine has it.
    _avx2: Avx2,
    search: Search,
    /// One over the direction, and what is added at near and far planes.
    inverse: __m128,
    near: __m128,
    far: __m128,
    /// Which of a node's rows of sides are near ones, and which are far.
    near_rows: [usize; 3],
    far_rows: [usize; 3],
    /// The start of the ray's interval, which the planes count from, and its end as they count it.
    start: f32,
    end: f32,
    /// The largest key that is of interest.
    last_key: i32,
    unit: f32,
    /// The node whose boxes are next.
    node: u32,
    /// Entries on the stack.
    height: usize,
}

impl Walk {
    #[inline(always)]
    fn of(avx2: Avx2, single: &Single<'_>, ray: &Ray) -> Self {
        let slabs = Slabs::of(single.rung.to_u32(), ray, single.nodes);
        let near_rows = slabs.near_rows.to_array().map(|row| row as usize);
        let lanes = |v: Vec3| -> __m128 { v.extend(0.0).into() };
        let mut walk = Self {
            _avx2: avx2,
            search: single.search(ray),
            inverse: lanes(slabs.inverse),
            near: lanes(slabs.near),
            far: lanes(slabs.far),
            near_rows,
            far_rows: [0, 1, 2].map(|axis| 2 * axis + 3 - near_rows[axis]),
            start: slabs.start,
            end: 0.0,
            last_key: 0,
            unit: slabs.unit,
            node: Node::ROOT,
            height: 0,
        };
        walk.end_at(ray.end());
        walk
    }

    /// What is beyond `t` is of no interest any more.
    #[inline(always)]
    fn end_at(&mut self, t: f32) {
        self.end = Slabs::widened_end(t * self.unit - self.start);
        // A ray that ends before it starts has no boxes.
        self.last_key = (self.end.max(0.0).to_bits() | 7).cast_signed();
    }

    /// Tests one node's boxes, and the spheres that are next before another node is; false once the ray
    /// is done.
    #[inline(always)]
    fn step<const ANY: bool, S: Spheres + ?Sized>(
        &mut self,
        nodes: &[Node],
        spheres: &S,
        stack: &mut Stack,
    ) -> bool {
        let last = nodes.len() - 1;
        let mut node = &nodes[(self.node as usize).min(last)];
        // SAFETY: `_avx2` is the proof that the machine has what it needs.
        let (met, near) = unsafe { self.meets(node) };
        let mut child;
        if met == 0 {
            let Some(next) = self.pop(stack) else {
                return false;
            };
            (child, node) = (next.0, &nodes[(next.1 as usize).min(last)]);
        } else if met & (met - 1) == 0 {
            child = met.trailing_zeros();
        } else {
            // SAFETY: as above.
            unsafe { stack.put(self.height, keys(met, near), self.node) };
            self.height += met.count_ones() as usize - 1;
            // SAFETY: it is one of those that were just put.
            let (key, _) = unsafe { stack.get(self.height) };
            child = key.cast_unsigned() & 7;
        }
        loop {
            if node.is_node(child) {
                self.node = node.child(child);
                return true;
            }
            let (first, count) = node.leaf(child);
            self.search.test::<ANY, S>(spheres, first, count);
            if ANY && self.search.hit.is_some() {
                return false;
            }
            self.end_at(self.search.ray.t_max);
            let Some(next) = self.pop(stack) else {
                return false;
            };
            (child, node) = (next.0, &nodes[(next.1 as usize).min(last)]);
        }
    }

    /// The next box of interest: which child of which node.
    #[inline(always)]
    fn pop(&mut self, stack: &Stack) -> Option<(u32, u32)> {
        while self.height > 0 {
            self.height -= 1;
            // SAFETY: what is below the height was put there.
            let (key, parent) = unsafe { stack.get(self.height) };
            if key <= self.last_key {
                return Some((key.cast_unsigned() & 7, parent));
            }
        }
        None
    }

    /// Which of a node's boxes the ray may meet, a bit each, and where it enters them.
    #[inline]
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    fn meets(&self, node: &Node) -> (u32, __m256) {
        macro_rules! splat {
            ($lanes:expr, $lane:literal) => {
                _mm256_broadcastss_ps(_mm_permute_ps::<{ $lane * 0b0101_0101 }>($lanes))
            };
        }
        let (x, y, z) = (node.corner.x, node.corner.y, node.corner.z);
        let [x, y, z] = [x, y, z].map(u32::cast_signed);
        let corner = _mm_castsi128_ps(_mm_setr_epi32(x, y, z, 0));
        let near = _mm_fmadd_ps(corner, self.inverse, self.near);
        let far = _mm_fmadd_ps(corner, self.inverse, self.far);
        let row = |at: usize, inverse: __m256, first: __m256| {
            // SAFETY: `at` is one of the six rows.
            let words: *const UVec4 = unsafe { node.sides.get_unchecked(at) };
            // SAFETY: a row is 16 bytes.
            let words = unsafe { _mm_loadu_si128(words.cast()) };
            let lower = _mm256_castsi128_si256(_mm_slli_epi32::<16>(words));
            let sides = _mm256_castsi256_ps(_mm256_inserti128_si256::<1>(lower, words));
            _mm256_fmadd_ps(sides, inverse, first)
        };
        let inverse = self.inverse;
        let (inverse_x, inverse_y) = (splat!(inverse, 0), splat!(inverse, 1));
        let inverse_z = splat!(inverse, 2);
        let near_x = row(self.near_rows[0], inverse_x, splat!(near, 0));
        let near_y = row(self.near_rows[1], inverse_y, splat!(near, 1));
        let near_z = row(self.near_rows[2], inverse_z, splat!(near, 2));
        let far_x = row(self.far_rows[0], inverse_x, splat!(far, 0));
        let far_y = row(self.far_rows[1], inverse_y, splat!(far, 1));
        let far_z = row(self.far_rows[2], inverse_z, splat!(far, 2));
        let first = _mm256_max_ps(
            _mm256_max_ps(near_x, near_y),
            _mm256_max_ps(near_z, _mm256_setzero_ps()),
        );
        let last = _mm256_min_ps(
            _mm256_min_ps(far_x, far_y),
            _mm256_min_ps(far_z, _mm256_set1_ps(self.end)),
        );
        let met = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(first, last));
        (met.cast_unsigned(), first)
    }
}

/// Keys of the boxes that are met, the largest first, and behind them negative ones.
#[inline]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn keys(met: u32, near: __m256) -> __m256i {
    macro_rules! exchange {
        ($keys:expr, $with:expr, $smaller:literal) => {{
            let (keys, others) = ($keys, $with);
            let (larger, smaller) = (
                _mm256_max_epi32(keys, others),
                _mm256_min_epi32(keys, others),
            );
            _mm256_blend_epi32::<$smaller>(larger, smaller)
        }};
    }
    let zero = _mm256_setzero_si256();
    let children = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    let near = _mm256_castps_si256(_mm256_max_ps(near, _mm256_setzero_ps()));
    let keys = _mm256_or_si256(_mm256_andnot_si256(_mm256_set1_epi32(7), near), children);
    let is_missed = _mm256_and_si256(_mm256_set1_epi32(met.cast_signed()), bits);
    let is_missed = _mm256_cmpeq_epi32(is_missed, zero);
    let keys = _mm256_or_si256(
        keys,
        _mm256_and_si256(is_missed, _mm256_set1_epi32(i32::MIN)),
    );
    // Batcher's bitonic network: pairs, fours, all eight.
    let keys = exchange!(
        keys,
        _mm256_shuffle_epi32::<0b10_11_00_01>(keys),
        0b1010_1010
    );
    let keys = exchange!(
        keys,
        _mm256_shuffle_epi32::<0b00_01_10_11>(keys),
        0b1100_1100
    );
    let keys = exchange!(
        keys,
        _mm256_shuffle_epi32::<0b10_11_00_01>(keys),
        0b1010_1010
    );
    let reversed = _mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0);
    let keys = exchange!(
        keys,
        _mm256_permutevar8x32_epi32(keys, reversed),
        0b1111_0000
    );
    let keys = exchange!(
        keys,
        _mm256_shuffle_epi32::<0b01_00_11_10>(keys),
        0b1100_1100
    );
    exchange!(
        keys,
        _mm256_shuffle_epi32::<0b10_11_00_01>(keys),
        0b1010_1010
    )
}
