//! Sorts the boxes of a node by where a ray enters them.

use std::arch::x86_64::*;

/// Sorts eight keys, the largest first, by Batcher's bitonic network: pairs, fours, all eight.
/// `exchange!(keys, others, lanes)` keeps the smaller of two keys in the lanes of the mask, and the
/// larger one in the others.
macro_rules! sort_descending {
    ($keys:ident, $exchange:ident) => {{
        let reversed = _mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0);
        let keys = $exchange!(
            $keys,
            _mm256_shuffle_epi32::<0b10_11_00_01>($keys),
            0b1010_1010
        );
        let keys = $exchange!(
            keys,
            _mm256_shuffle_epi32::<0b00_01_10_11>(keys),
            0b1100_1100
        );
        let keys = $exchange!(
            keys,
            _mm256_shuffle_epi32::<0b10_11_00_01>(keys),
            0b1010_1010
        );
        let keys = $exchange!(
            keys,
            _mm256_permutevar8x32_epi32(keys, reversed),
            0b1111_0000
        );
        let keys = $exchange!(
            keys,
            _mm256_shuffle_epi32::<0b01_00_11_10>(keys),
            0b1100_1100
        );
        $exchange!(
            keys,
            _mm256_shuffle_epi32::<0b10_11_00_01>(keys),
            0b1010_1010
        )
    }};
}

/// The keys of the boxes that are met, as [`Stack`](super::walk) stores them, the largest first;
/// then negative ones.
#[inline]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
pub(super) fn keys_with_avx2(met: u32, near: __m256) -> __m256i {
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
    let near = _mm256_castps_si256(near);
    let keys = _mm256_or_si256(_mm256_andnot_si256(_mm256_set1_epi32(7), near), children);
    let is_missed = _mm256_and_si256(_mm256_set1_epi32(met.cast_signed()), bits);
    let is_missed = _mm256_cmpeq_epi32(is_missed, zero);
    let keys = _mm256_or_si256(
        keys,
        _mm256_and_si256(is_missed, _mm256_set1_epi32(i32::MIN)),
    );
    sort_descending!(keys, exchange)
}

/// [`keys_with_avx2`], with AVX-512.
#[inline]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
pub(super) fn keys_with_avx512(met: u32, near: __m256) -> __m256i {
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
