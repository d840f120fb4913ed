//! The boxes of a node with AVX-512, and sixteen spheres against one ray.

use std::arch::x86_64::*;

use fearless_simd::{Level, x86};
use glam::{UVec4, Vec3};
use spherule_kernel::Sphere;
use spherule_kernel::bounds::{Line, OFF, OFF_BY_RADIUS, OUTSIDE};
use spherule_kernel::candidates::{SLACK, SMALLEST};
use spherule_kernel::tree::{Node, Slabs};

use super::single::{Resting, Search};
use super::walk::Wide;
use crate::cpu::InstructionSet;
pub(super) use crate::lanes::LANES;

/// The proof that this machine has AVX-512 and what comes with it, and that it is to be used.
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx512(pub(super) x86::Avx512);

impl Avx512 {
    pub(super) fn of(instructions: InstructionSet) -> Option<Self> {
        match instructions.level()? {
            Level::Avx512(token) => Some(Self(token)),
            _ => None,
        }
    }
}

impl Wide for Avx512 {
    type Planes = Planes;

    #[inline(always)]
    fn planes(self, slabs: &Slabs) -> Planes {
        // SAFETY: the machine has AVX-512.
        unsafe { Planes::of(slabs) }
    }

    #[inline(always)]
    fn end_at(self, planes: &mut Planes, end: f32) {
        // SAFETY: as above.
        planes.start_and_end = unsafe { near_and_far(0.0, end) };
    }

    #[inline(always)]
    fn meets(self, planes: &Planes, node: &Node) -> (u32, __m256) {
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

/// What stays the same of a ray from node to node. Of each four lanes of a vector the first and the third are of near
/// planes, the others of far ones, whose parameters are negated: so the latest entry and the earliest exit are both a largest one.
pub(super) struct Planes {
    /// One over the direction.
    inverse: [__m512; 3],
    /// What is added.
    first: [__m512; 3],
    start_and_end: __m512,
    /// Which of a node's rows of sides are near ones.
    near_rows: [usize; 3],
}

/// As the lanes of [`Planes`].
#[inline]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn near_and_far(near: f32, far: f32) -> __m512 {
    _mm512_mask_blend_ps(FAR, _mm512_set1_ps(near), _mm512_set1_ps(-far))
}
impl Planes {
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
        // Each of a near plane's lanes is met by that of the far one.
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

/// Lanes of far planes.
const FAR: __mmask16 = 0xf0f0;

/// Keys of the boxes that are met.
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

/// Which of up to sixteen spheres a line may hit, given by its origin, its direction and that one's square, a bit each.
///
/// As [`Line::may_hit`]; and if `bounded` by a line and its end, as the line counts it, on rungs from robust up, not those
/// that are behind by [`Line::bounds`], nor those that lie beyond the end: no point of a sphere is nearer than o·d/a − r/|d|, |d| is at least
/// one, and what the middle is off by is less than what bounds allow for.
#[inline]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
pub(super) fn sift(
    origin: Vec3,
    direction: Vec3,
    a: f32,
    bounded: Option<(&Line, f32)>,
    spheres: &[Sphere],
) -> u32 {
    let count = spheres.len().min(LANES);
    // Four floats a sphere; what is not there is zero, and masked out.
    let there = _bzhi_u64(u64::MAX, 4 * count as u32);
    let four = |at: usize| {
        let mask = (there >> (16 * at)) as __mmask16;
        let from = spheres.as_ptr().cast::<f32>().wrapping_add(16 * at);
        // SAFETY: masked lanes are not read, and the others are spheres of the slice.
        unsafe { _mm512_maskz_loadu_ps(mask, from) }
    };
    let rows = [four(0), four(1), four(2), four(3)];
    let xy = _mm512_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28, 1, 5, 9, 13, 17, 21, 25, 29);
    let zr = _mm512_setr_epi32(2, 6, 10, 14, 18, 22, 26, 30, 3, 7, 11, 15, 19, 23, 27, 31);
    let halves = |order| {
        let first = _mm512_castps_pd(_mm512_permutex2var_ps(rows[0], order, rows[1]));
        let second = _mm512_castps_pd(_mm512_permutex2var_ps(rows[2], order, rows[3]));
        (
            _mm512_castpd_ps(_mm512_shuffle_f64x2::<0b01_00_01_00>(first, second)),
            _mm512_castpd_ps(_mm512_shuffle_f64x2::<0b11_10_11_10>(first, second)),
        )
    };
    let ((x, y), (z, r)) = (halves(xy), halves(zr));
    let splat = _mm512_set1_ps;
    let x = _mm512_sub_ps(x, splat(origin.x));
    let y = _mm512_sub_ps(y, splat(origin.y));
    let z = _mm512_sub_ps(z, splat(origin.z));
    let dot = |ax, ay, az, bx, by, bz| {
        _mm512_fmadd_ps(ax, bx, _mm512_fmadd_ps(ay, by, _mm512_mul_ps(az, bz)))
    };
    let d = direction;
    let rr = _mm512_mul_ps(r, r);
    let oo = dot(x, y, z, x, y, z);
    let b = dot(x, y, z, splat(d.x), splat(d.y), splat(d.z));
    let c = _mm512_fnmadd_ps(splat(SLACK), _mm512_add_ps(oo, rr), _mm512_sub_ps(oo, rr));
    let discriminant = _mm512_fmsub_ps(b, b, _mm512_mul_ps(splat(a), c));
    // A number that is none is asked about, too.
    let mut found = _mm512_cmp_ps_mask::<_CMP_NLT_UQ>(discriminant, splat(SMALLEST));
    if let Some((line, end)) = bounded {
        let r = _mm512_abs_ps(r);
        let middle = _mm512_mul_ps(b, splat(line.inverse));
        let off = _mm512_mul_ps(_mm512_abs_ps(middle), splat(OFF));
        let off = _mm512_fmadd_ps(r, splat(OFF_BY_RADIUS), off);
        let first = _mm512_sub_ps(_mm512_sub_ps(middle, r), off);
        found = _mm512_mask_cmp_ps_mask::<_CMP_NGT_UQ>(found, first, splat(end));
        let outside = _mm512_cmp_ps_mask::<_CMP_GT_OQ>(_mm512_mul_ps(oo, splat(OUTSIDE)), rr);
        let behind = _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(outside, b, splat(line.behind));
        found &= !behind;
    }
    u32::from(found) & ((1 << count) - 1)
}
