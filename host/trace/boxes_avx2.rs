//! The tests of a node's boxes with AVX2.

use std::arch::x86_64::*;

use fearless_simd::Level;
use glam::{UVec4, Vec3};
use spherule_kernel::accel::node::Node;
use spherule_kernel::accel::slabs::Slabs;

use super::search::{Resting, Search};
use super::wide::{Wide, sort_descending};
use crate::cpu::InstructionSet;

/// The proof that this machine has AVX2 and the extensions that come with it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx2(());

impl Avx2 {
    pub(super) fn of(instructions: InstructionSet) -> Option<Self> {
        matches!(instructions.level()?, Level::Avx2(_) | Level::Avx512(_)).then_some(Self(()))
    }
}

impl Wide for Avx2 {
    type Planes = Avx2Planes;

    #[inline(always)]
    fn planes(self, slabs: &Slabs) -> Avx2Planes {
        let near_rows = slabs.near_rows.to_array().map(|row| row as usize);
        let lanes = |v: Vec3| -> __m128 { v.extend(0.0).into() };
        Avx2Planes {
            inverse: lanes(slabs.inverse),
            near: lanes(slabs.near),
            far: lanes(slabs.far),
            near_rows,
            far_rows: [0, 1, 2].map(|axis| 2 * axis + 3 - near_rows[axis]),
            end: 0.0,
        }
    }

    #[inline(always)]
    fn end_at(self, planes: &mut Avx2Planes, end: f32) {
        planes.end = end;
    }

    #[inline(always)]
    fn meets(self, planes: &Avx2Planes, node: &Node) -> (u32, __m256) {
        // SAFETY: the machine has AVX2.
        unsafe { planes.meets(node) }
    }

    #[inline(always)]
    fn keys(self, met: u32, near: __m256) -> __m256i {
        // SAFETY: the machine has AVX2.
        unsafe { keys(met, near) }
    }

    #[inline(always)]
    fn test_all<const ANY: bool, S: Resting + ?Sized>(
        self,
        _: &mut Search,
        _: &S,
        _: &Node,
    ) -> bool {
        false
    }
}

/// The part of a ray that stays the same from node to node.
pub(super) struct Avx2Planes {
    /// One over the direction, and the offsets of near and far planes.
    inverse: __m128,
    near: __m128,
    far: __m128,
    /// Which of a node's rows of sides are near planes, and which are far.
    near_rows: [usize; 3],
    far_rows: [usize; 3],
    /// The end of the ray, as [`Slabs::widened_end`] returns it.
    end: f32,
}

impl Avx2Planes {
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

/// The keys of the boxes that are met, the largest first; then negative ones.
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
    sort_descending!(keys, exchange)
}
