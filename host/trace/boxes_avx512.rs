//! The tests of a node's boxes with AVX-512.

use std::arch::x86_64::*;

use glam::UVec4;
use spherule_kernel::accel::node::Node;
use spherule_kernel::accel::slabs::Slabs;

use super::avx512::Avx512;
use super::search::{Resting, Search};
use super::wide::{Wide, sort_descending};

impl Wide for Avx512 {
    type Planes = Avx512Planes;

    #[inline(always)]
    fn planes(self, slabs: &Slabs) -> Avx512Planes {
        // SAFETY: the machine has AVX-512.
        unsafe { Avx512Planes::of(slabs) }
    }

    #[inline(always)]
    fn end_at(self, planes: &mut Avx512Planes, end: f32) {
        // SAFETY: as above.
        planes.start_and_end = unsafe { near_and_far(0.0, end) };
    }

    #[inline(always)]
    fn meets(self, planes: &Avx512Planes, node: &Node) -> (u32, __m256) {
        // SAFETY: as above.
        unsafe { planes.meets(node) }
    }

    #[inline(always)]
    fn keys(self, met: u32, near: __m256) -> __m256i {
        // SAFETY: as above.
        unsafe { keys(met, near) }
    }

    #[inline(always)]
    fn test_all<const ANY: bool, S: Resting + ?Sized>(
        self,
        search: &mut Search,
        spheres: &S,
        node: &Node,
    ) -> bool {
        let Some(spheres) = spheres.at_rest() else {
            return false;
        };
        let (first, count) = node.all_spheres();
        search.test_wide::<ANY>(self, spheres, first, count);
        true
    }
}

/// The part of a ray that stays the same from node to node. In each vector, the first and the third
/// four lanes are for near planes. The others are for far planes, with parameters negated, so that
/// the latest entry and the earliest exit are both a maximum.
pub(super) struct Avx512Planes {
    /// One over the direction.
    inverse: [__m512; 3],
    /// The offsets of the planes.
    first: [__m512; 3],
    start_and_end: __m512,
    /// Which of a node's rows of sides are near planes.
    near_rows: [usize; 3],
}

/// A vector with the lanes of [`Avx512Planes`].
#[inline]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn near_and_far(near: f32, far: f32) -> __m512 {
    _mm512_mask_blend_ps(FAR, _mm512_set1_ps(near), _mm512_set1_ps(-far))
}

impl Avx512Planes {
    #[inline]
    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    fn of(slabs: &Slabs) -> Self {
        let (inverse, near, far) = (
            slabs.inverse.to_array(),
            slabs.near.to_array(),
            slabs.far.to_array(),
        );
        Self {
            inverse: [0, 1, 2].map(|axis| near_and_far(inverse[axis], inverse[axis])),
            first: [0, 1, 2].map(|axis| near_and_far(near[axis], far[axis])),
            start_and_end: near_and_far(0.0, 0.0),
            near_rows: slabs.near_rows.to_array().map(|row| row as usize),
        }
    }

    #[inline]
    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    fn meets(&self, node: &Node) -> (u32, __m256) {
        let corner = [node.corner.x, node.corner.y, node.corner.z].map(f32::from_bits);
        let row = |at: usize| -> __m128i {
            // SAFETY: `at` is one of the six rows.
            let words: *const UVec4 = unsafe { node.sides.get_unchecked(at) };
            // SAFETY: a row is 16 bytes.
            unsafe { _mm_loadu_si128(words.cast()) }
        };
        let planes = |axis: usize| {
            let near = self.near_rows[axis];
            let far = 2 * axis + 3 - near;
            let words = _mm256_inserti128_si256::<1>(_mm256_castsi128_si256(row(near)), row(far));
            let lower = _mm512_castsi256_si512(_mm256_slli_epi32::<16>(words));
            let sides = _mm512_castsi512_ps(_mm512_inserti64x4::<1>(lower, words));
            let inverse = self.inverse[axis];
            let first = _mm512_fmadd_ps(_mm512_set1_ps(corner[axis]), inverse, self.first[axis]);
            _mm512_fmadd_ps(sides, inverse, first)
        };
        let last = _mm512_max_ps(planes(2), self.start_and_end);
        let last = _mm512_max_ps(_mm512_max_ps(planes(0), planes(1)), last);
        // Each lane of a near plane is paired with that of its far plane.
        let others = _mm512_shuffle_f32x4::<0b10_11_00_01>(last, last);
        let gap = _mm512_add_ps(last, others);
        let met = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(gap, _mm512_setzero_ps());
        let met = _pext_u32(u32::from(met), u32::from(!FAR));
        let entries = _mm256_insertf128_ps::<1>(
            _mm512_castps512_ps256(last),
            _mm512_extractf32x4_ps::<2>(last),
        );
        (met, entries)
    }
}

/// The lanes of far planes.
const FAR: __mmask16 = 0xf0f0;

/// The keys of the boxes that are met, the largest first; then negative ones.
#[inline]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn keys(met: u32, near: __m256) -> __m256i {
    let children = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    let near = _mm256_castps_si256(near);
    // (near & !7) | child
    let keys = _mm256_ternarylogic_epi32::<0b1101_1000>(near, children, _mm256_set1_epi32(7));
    let keys = _mm256_mask_mov_epi32(_mm256_set1_epi32(i32::MIN), met as __mmask8, keys);
    macro_rules! exchange {
        ($keys:expr, $with:expr, $smaller:literal) => {{
            let (keys, others) = ($keys, $with);
            let larger = _mm256_max_epi32(keys, others);
            _mm256_mask_min_epi32(larger, $smaller, keys, others)
        }};
    }
    sort_descending!(keys, exchange)
}
