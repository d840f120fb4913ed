//! The proof that this machine has AVX-512, and culling of sixteen spheres for one ray.

use std::arch::x86_64::*;

use fearless_simd::x86;
use glam::Vec3;
use spherule_kernel::Sphere;
use spherule_kernel::cull::bounds::{Line, OFF, OFF_BY_RADIUS, OUTSIDE};
use spherule_kernel::cull::discriminant::{SLACK, SMALLEST};

use crate::cpu::InstructionSet;
pub(super) use crate::lanes::LANES;

/// The proof that this machine has AVX-512 and the extensions that come with it, and that they are
/// to be used.
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx512(pub(super) x86::Avx512);

impl Avx512 {
    pub(super) fn of(instructions: InstructionSet) -> Option<Self> {
        instructions.level()?.as_avx512().map(Self)
    }
}

/// Which of up to sixteen spheres a line may hit, a bit each. `a` is the squared length of
/// `direction`.
///
/// The test is [`Line::may_hit`]. With `bounded`, a line and its end in the line's units, spheres
/// that are behind the ray by [`Line::bounds`] are culled too, and so are those beyond the end;
/// this is for rungs from robust up. No point of a sphere is nearer than o·d/a − r/|d|, |d| is at
/// least one, and the error of o·d/a is less than what the bounds allow for.
#[inline]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
pub(super) fn cull(
    origin: Vec3,
    direction: Vec3,
    a: f32,
    bounded: Option<(&Line, f32)>,
    spheres: &[Sphere],
) -> u32 {
    let count = spheres.len().min(LANES);
    // Four floats a sphere. Missing spheres are zero, and masked out.
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
    // NaN counts as a possible hit.
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
