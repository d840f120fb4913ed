//! The walk of [`Single`](super::single::Single) on machines with wide instructions: all eight
//! boxes of a node at once.
//!
//! It differs from the kernel's walk: the nearest box is entered first, a box beyond the nearest
//! hit is skipped when its turn comes, and four rays take turns, so that a ray that waits does not
//! hold up the others. With AVX-512 the boxes of a node without nodes as children are not tested:
//! its spheres, at most 32, are tested sixteen at a time.

use std::arch::x86_64::*;
use std::mem::MaybeUninit;

use spherule_kernel::accel::node::Node;
use spherule_kernel::accel::slabs::Slabs;
use spherule_kernel::{Hit, Ray};

use super::avx2::Avx2;
use super::avx512::Avx512;
use super::boxes::Planes;
use super::search::{Query, Resting, Search, left};
use super::wide::Wide;
use crate::cpu::InstructionSet;

const WIDTH: usize = Node::WIDTH;
/// The most entries on a stack: each node on the way leaves at most seven behind, and the last one
/// writes eight at once.
const MAX_HEIGHT: usize = Node::MAX_DEPTH * (WIDTH - 1) + WIDTH;
/// Rays that take turns.
const RAYS: usize = 4;

/// The instructions that the walk uses, with the proof that the machine has them.
#[derive(Clone, Copy, Debug)]
pub(super) enum Features {
    Avx2(Avx2),
    Avx512(Avx512),
}

impl Features {
    /// The features of an instruction set; `None` for less than AVX2.
    pub(super) fn of(instructions: InstructionSet) -> Option<Self> {
        let avx512 = Avx512::of(instructions).map(Self::Avx512);
        avx512.or_else(|| Avx2::of(instructions).map(Self::Avx2))
    }
}

/// Finds what a ray hits: the nearest, or with `ANY` the first that is found.
pub(super) fn trace_one<const ANY: bool, S: Resting + ?Sized>(
    features: Features,
    query: &Query<'_>,
    ray: &Ray,
    spheres: &S,
) -> Hit {
    match features {
        // SAFETY: the machine has the features.
        Features::Avx2(wide) => unsafe { one_with_avx2::<ANY, _, S>(wide, query, ray, spheres) },
        // SAFETY: as above.
        Features::Avx512(wide) => unsafe {
            one_with_avx512::<ANY, _, S>(wide, query, ray, spheres)
        },
    }
}

/// Finds what each ray hits; `lefts` and `put` are as for [`Single::trace`](super::single::Single).
pub(super) fn trace<const ANY: bool, S: Resting + ?Sized>(
    features: Features,
    query: &Query<'_>,
    rays: &[Ray],
    lefts: &[u32],
    spheres: &S,
    put: impl FnMut(usize, Hit),
) {
    match features {
        // SAFETY: the machine has the features.
        Features::Avx2(wide) => unsafe {
            all_with_avx2::<ANY, _, S>(wide, query, rays, lefts, spheres, put);
        },
        // SAFETY: as above.
        Features::Avx512(wide) => unsafe {
            all_with_avx512::<ANY, _, S>(wide, query, rays, lefts, spheres, put);
        },
    }
}

// All features that `fearless_simd` compiles an instruction set for; otherwise nothing of it is
// inlined.
macro_rules! with_features {
    ($one:ident, $all:ident, $features:literal) => {
        #[target_feature(enable = $features)]
        fn $one<const ANY: bool, W: Wide, S: Resting + ?Sized>(
            wide: W,
            query: &Query<'_>,
            ray: &Ray,
            spheres: &S,
        ) -> Hit {
            let mut stack = Stack::new();
            let mut walk = Walk::of(wide, query, ray, spheres.left());
            while walk.step::<ANY, S>(query.tree.nodes(), spheres, &mut stack) {}
            walk.search.finish::<ANY>()
        }

        #[target_feature(enable = $features)]
        fn $all<const ANY: bool, W: Wide, S: Resting + ?Sized>(
            wide: W,
            query: &Query<'_>,
            rays: &[Ray],
            lefts: &[u32],
            spheres: &S,
            put: impl FnMut(usize, Hit),
        ) {
            in_turns::<ANY, W, S>(wide, query, rays, lefts, spheres, put);
        }
    };
}

with_features!(
    one_with_avx2,
    all_with_avx2,
    "avx2,bmi1,bmi2,cmpxchg16b,f16c,fma,fxsr,lzcnt,movbe,popcnt,xsave"
);
with_features!(
    one_with_avx512,
    all_with_avx512,
    "adx,aes,avx512bitalg,avx512bw,avx512cd,avx512dq,avx512f,avx512ifma,avx512vbmi,avx512vbmi2,avx512vl,avx512vnni,avx512vpopcntdq,bmi1,bmi2,cmpxchg16b,fma,fxsr,gfni,lzcnt,movbe,pclmulqdq,popcnt,rdrand,rdseed,sha,vaes,vpclmulqdq,xsave,xsavec,xsaveopt,xsaves"
);

#[inline(always)]
fn in_turns<const ANY: bool, W: Wide, S: Resting + ?Sized>(
    wide: W,
    query: &Query<'_>,
    rays: &[Ray],
    lefts: &[u32],
    spheres: &S,
    mut put: impl FnMut(usize, Hit),
) {
    let nodes = query.tree.nodes();
    let mut stacks = [const { Stack::new() }; RAYS];
    let mut rest = rays.iter().enumerate();
    let mut walks = [const { MaybeUninit::<Walk<W>>::uninit() }; RAYS];
    let mut indices = [0; RAYS];
    // The first `count` walks are under way.
    let mut count = 0;
    for (walk, index) in walks.iter_mut().zip(&mut indices) {
        let Some((of, ray)) = rest.next() else { break };
        walk.write(Walk::of(wide, query, ray, left(lefts, of)));
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
                *walk = Walk::of(wide, query, ray, left(lefts, of));
                indices[place] = of;
                place += 1;
            } else {
                // The last walk takes its place.
                count -= 1;
                walks.swap(place, count);
                stacks.swap(place, count);
                indices.swap(place, count);
            }
        }
    }
}

/// Boxes that were met and not entered yet, the nearest of the latest node on top. A key is where
/// the ray enters a box, as a float's bits; the lowest three say which child of its parent it is.
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

    /// Writes eight entries at `height`, which is clamped to the range.
    #[inline(always)]
    fn put(&mut self, _: impl Wide, height: usize, keys: __m256i, parent: u32) {
        let height = height.min(MAX_HEIGHT - WIDTH);
        // SAFETY: the machine has AVX2, and there is room for eight from `height` on.
        unsafe {
            let parents = _mm256_set1_epi32(parent.cast_signed());
            _mm256_storeu_si256(self.keys.as_mut_ptr().add(height).cast(), keys);
            _mm256_storeu_si256(self.parents.as_mut_ptr().add(height).cast(), parents);
        }
    }

    /// The key and the parent at `height`.
    ///
    /// # Safety
    ///
    /// Eight entries must have been written there, or so little below that they reach it.
    #[inline(always)]
    unsafe fn get(&self, height: usize) -> (i32, u32) {
        let height = height.min(MAX_HEIGHT - 1);
        // SAFETY: `height` is in range, and the caller says that the entry was written.
        unsafe {
            (
                self.keys.get_unchecked(height).assume_init(),
                self.parents.get_unchecked(height).assume_init(),
            )
        }
    }
}

/// A ray on its way through a tree.
struct Walk<W: Wide> {
    wide: W,
    search: Search,
    planes: Planes<W::Simd>,
    /// The start of the ray's interval, from which the planes measure.
    start: f32,
    unit: f32,
    /// The largest key that still matters.
    last_key: i32,
    /// The node whose boxes are tested next.
    node: u32,
    /// The number of entries on the stack.
    height: usize,
}

impl<W: Wide> Walk<W> {
    #[inline(always)]
    fn of(wide: W, query: &Query<'_>, ray: &Ray, left: u32) -> Self {
        let slabs = Slabs::of(query.rung.to_u32(), ray, &query.extent);
        let mut walk = Self {
            wide,
            search: query.search(ray, left),
            planes: Planes::of(wide.simd(), &slabs),
            start: slabs.start,
            unit: slabs.unit,
            last_key: 0,
            node: Node::ROOT,
            height: 0,
        };
        walk.end_at(ray.end());
        walk
    }

    /// Ends the ray at `t`: what is beyond does not matter any more.
    #[inline(always)]
    fn end_at(&mut self, t: f32) {
        let end = Slabs::widened_end(t * self.unit - self.start);
        self.planes.end_at(end);
        // A ray that ends before it starts meets no boxes.
        self.last_key = (end.max(0.0).to_bits() | 7).cast_signed();
    }

    /// Tests one node's boxes, and spheres until the next node is on top of the stack. Returns
    /// false once the ray is done.
    #[inline(always)]
    fn step<const ANY: bool, S: Resting + ?Sized>(
        &mut self,
        nodes: &[Node],
        spheres: &S,
        stack: &mut Stack,
    ) -> bool {
        let last = nodes.len() - 1;
        let mut node = &nodes[(self.node as usize).min(last)];
        if node.has_nodes()
            || !self
                .wide
                .test_all::<ANY, S>(&mut self.search, spheres, node)
        {
            // Even a single box goes through the stack: a processor mispredicts how many are met.
            let (met, near) = self.planes.meets(node);
            let keys = self.wide.keys(met, near);
            stack.put(self.wide, self.height, keys, self.node);
            self.height += met.count_ones() as usize;
        } else {
            if ANY && self.search.hit.is_some() {
                return false;
            }
            self.end_at(self.search.ray.t_max);
        }
        loop {
            let Some((child, parent)) = self.pop(stack) else {
                return false;
            };
            node = &nodes[(parent as usize).min(last)];
            if node.is_node(child) {
                self.node = node.child(child);
                let next: *const Node = &raw const nodes[(self.node as usize).min(last)];
                // SAFETY: a prefetch changes nothing.
                unsafe {
                    _mm_prefetch::<_MM_HINT_T0>(next.cast());
                    _mm_prefetch::<_MM_HINT_T0>(next.cast::<i8>().wrapping_add(64));
                    _mm_prefetch::<_MM_HINT_T0>(next.cast::<i8>().wrapping_add(127));
                }
                return true;
            }
            let (first, count) = node.leaf(child);
            self.search.test::<ANY, S>(spheres, first, count);
            if ANY && self.search.hit.is_some() {
                return false;
            }
            self.end_at(self.search.ray.t_max);
        }
    }

    /// The next box that matters: which child of which node.
    #[inline(always)]
    fn pop(&mut self, stack: &Stack) -> Option<(u32, u32)> {
        while self.height > 0 {
            self.height -= 1;
            // SAFETY: everything below the height was written.
            let (key, parent) = unsafe { stack.get(self.height) };
            if key <= self.last_key {
                return Some((key.cast_unsigned() & 7, parent));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use spherule_kernel::accel::brute::{MovingSpheres, Spheres, is_occluded, nearest_hit_in};
    use spherule_kernel::accel::node::Tree;
    use spherule_kernel::{Effects, Rung, Sphere};

    use super::super::sample_rays::{rays, world};
    use super::*;
    use crate::accel::build_still;
    use crate::random::Random;

    fn compare<S: Resting + ?Sized>(tree: Tree<'_>, spheres: &S, rays: &[Ray]) {
        let all = [
            Avx2::of(InstructionSet::Avx2).map(Features::Avx2),
            Avx512::of(InstructionSet::Avx512).map(Features::Avx512),
        ];
        for features in all.into_iter().flatten() {
            for rung in Rung::ALL {
                let query = Query::new(rung, tree);
                let code = rung.to_u32();
                let expected = |ray: &Ray| nearest_hit_in(code, ray, spheres, 0, u32::MAX);
                let (mut count, mut hits) = (0, 0);
                trace::<false, S>(features, &query, rays, &[], spheres, |index, hit| {
                    let ray = &rays[index];
                    assert_eq!(hit, expected(ray), "{features:?} {rung:?} {ray:?}");
                    count += 1;
                    hits += usize::from(hit.is_some());
                });
                assert_eq!(count, rays.len());
                assert!(hits > rays.len() / 2, "{hits}");
                trace::<true, S>(features, &query, rays, &[], spheres, |index, hit| {
                    let ray = &rays[index];
                    let is_occluded = is_occluded(code, ray, spheres);
                    assert_eq!(hit.is_some(), is_occluded, "{features:?} {rung:?} {ray:?}");
                });
                let one = trace_one::<false, S>(features, &query, &rays[0], spheres);
                assert_eq!(one, expected(&rays[0]));
            }
        }
    }

    /// Each ray finds what testing every sphere finds, on every rung, with every instruction set
    /// that this machine has.
    #[test]
    fn walks_find_what_testing_every_sphere_finds() {
        let mut random = Random::new(5);
        let spheres = world(&mut random, 3000);
        let tree = build_still(&spheres, 1).expect("a tree");
        compare(
            tree.nodes.tree(),
            &tree.sort(&spheres)[..],
            &rays(&mut random),
        );
    }

    /// Moving spheres are tested where they are at the time, not where they lie in memory.
    #[test]
    fn walks_find_spheres_in_motion() {
        let mut random = Random::new(6);
        let spheres = world(&mut random, 3000);
        let velocities = vec![Vec3::new(0.25, -0.5, 0.125).extend(0.0); spheres.len()];
        let at = |spheres: &[Sphere]| -> Vec<Sphere> {
            let moving = MovingSpheres {
                spheres,
                velocities: &velocities,
                time: 1.0,
                effects: Effects::MOTION_BLUR,
                left: Hit::NONE_SPHERE,
                target: Hit::NONE_SPHERE,
            };
            // SAFETY: the indices are below the count.
            (0..moving.count())
                .map(|index| unsafe { moving.sphere(index) })
                .collect()
        };
        let tree = build_still(&at(&spheres), 1).expect("a tree");
        let moving = MovingSpheres {
            spheres: &tree.sort(&spheres),
            velocities: &velocities,
            time: 1.0,
            effects: Effects::MOTION_BLUR,
            left: Hit::NONE_SPHERE,
            target: Hit::NONE_SPHERE,
        };
        compare(tree.nodes.tree(), &moving, &rays(&mut random));
        let resting = MovingSpheres {
            effects: Effects::default(),
            ..moving
        };
        assert!(moving.at_rest().is_none() && resting.at_rest().is_some());
    }
}
