//! Sixteen rays at a time through [`Levels`], with AVX-512.
//!
//! Each step is done for all sixteen before the next step: the boxes that they meet on a level,
//! those on the level below, the spheres that may be hit, and the hits on the rung. A step is one
//! loop, without branches, over a list of pairs that the step before has written: the processor has
//! nothing to predict, and a ray that waits does not hold up the others. This saves more than
//! skipping what is behind the nearest hit would, as long as rays do not meet too many boxes.
//! Sixteen rays that do go through the tree instead.

use std::arch::x86_64::*;
use std::cell::Cell;
use std::mem::MaybeUninit;

use fearless_simd::SimdMask;
use spherule_kernel::accel::slabs::{Boxes, Slabs};
use spherule_kernel::lane::Lane as _;
use spherule_kernel::precision::intersect;
use spherule_kernel::{Hit, Ray, Rung, Sphere};

use super::avx512::{Avx512, LANES};
use super::boxes::near_and_far;
use super::levels::{Group, Levels};
use super::search::{Query, Resting};
use super::sixteen::{RayPlanes, Sixteen, end_of, is_plain};
use super::walk::{self, Features};
use crate::lanes::Single16;

/// The most boxes that sixteen rays may meet.
const MOST: usize = 64 * LANES;
/// The most boxes at the bottom of two levels.
const MOST_ALONE: usize = 1024;
/// The most pairs of rays and spheres that wait for the rung.
const WAITING: usize = 1024;

thread_local! {
    // In a box: it is taken and put back by each call.
    static SCRATCH: Cell<Option<Box<Scratch>>> = Cell::default();
}

/// Lists that are reused for the next rays.
#[derive(Default)]
struct Scratch {
    sixteen: Sixteen,
    /// Pairs of rays and the boxes that they meet, and those of the level below.
    pairs: Vec<u32>,
    below: Vec<u32>,
    /// Pairs of rays and the spheres that they may hit.
    rays: Vec<u32>,
    spheres: Vec<u32>,
}

/// A ray and a box in one number.
const fn pair(ray: usize, index: usize) -> u32 {
    (ray << Levels::INDEX_BITS | index) as u32
}

/// The ray and the box of a pair.
const fn of_pair(pair: u32) -> (usize, usize) {
    let index = pair & ((1 << Levels::INDEX_BITS) - 1);
    ((pair >> Levels::INDEX_BITS) as usize, index as usize)
}

/// Finds what each ray hits; `lefts` and `put` are as for [`Single::trace`](super::single::Single).
/// There must be at least as many spheres as the levels name.
#[target_feature(
    enable = "adx,aes,avx512bitalg,avx512bw,avx512cd,avx512dq,avx512f,avx512ifma,avx512vbmi,avx512vbmi2,avx512vl,avx512vnni,avx512vpopcntdq,bmi1,bmi2,cmpxchg16b,fma,fxsr,gfni,lzcnt,movbe,pclmulqdq,popcnt,rdrand,rdseed,sha,vaes,vpclmulqdq,xsave,xsavec,xsaveopt,xsaves"
)]
pub(super) fn trace<const ANY: bool>(
    wide: Avx512,
    levels: &Levels,
    query: &Query<'_>,
    rays: &[Ray],
    lefts: &[u32],
    spheres: &[Sphere],
    mut put: impl FnMut(usize, Hit),
) {
    let Some((top, below)) = levels.groups.split_first() else {
        return;
    };
    let mut scratch = SCRATCH.take().unwrap_or_default();
    for (some, rays) in rays.chunks(LANES).enumerate() {
        let mut put = |index: usize, hit: Hit| put(LANES * some + index, hit);
        let lefts = lefts.get(LANES * some..).unwrap_or_default();
        let are_plain = scratch.sixteen.take(query.rung, rays, lefts, &query.extent);
        if !are_plain {
            walk::trace::<ANY, _>(Features::Avx512(wide), query, rays, lefts, spheres, put);
            continue;
        }
        scratch.begin(wide, top, rays.len());
        for level in below {
            scratch.descend(wide, level);
        }
        if scratch.pairs.len() > MOST {
            walk::trace::<ANY, _>(Features::Avx512(wide), query, rays, lefts, spheres, put);
        } else {
            let nearest = scratch.evaluate(wide, query.rung, levels, spheres);
            for index in 0..rays.len() {
                put(index, nearest.hit(index));
            }
        }
    }
    SCRATCH.set(Some(scratch));
}

/// Finds what one ray hits, in a world of at most two levels. `at_rest` is [`Resting::at_rest`] of
/// the spheres; there must be at least as many as the levels name.
///
/// A single ray goes through boxes from the nearest on, and skips those behind its nearest hit.
// As for [`Nearest::evaluate`].
#[target_feature(
    enable = "adx,aes,avx512bitalg,avx512bw,avx512cd,avx512dq,avx512f,avx512ifma,avx512vbmi,avx512vbmi2,avx512vl,avx512vnni,avx512vpopcntdq,bmi1,bmi2,cmpxchg16b,fma,fxsr,gfni,lzcnt,movbe,pclmulqdq,popcnt,rdrand,rdseed,sha,vaes,vpclmulqdq,xsave,xsavec,xsaveopt,xsaves"
)]
pub(super) fn trace_one<const ANY: bool, S: Resting + ?Sized>(
    wide: Avx512,
    levels: &Levels,
    query: &Query<'_>,
    ray: &Ray,
    spheres: &S,
    at_rest: &[Sphere],
) -> Hit {
    /// The bits of a key that hold the box's index.
    const INDEX: i32 = MOST_ALONE as i32 - 1;
    let slabs = Slabs::of(query.rung.to_u32(), ray, &query.extent);
    if !is_plain(ray, slabs.start) {
        return walk::trace_one::<ANY, S>(Features::Avx512(wide), query, ray, spheres);
    }
    let planes = RayPlanes::of(&slabs, ray.end());
    // Where a box is entered, as a float's bits, the lowest of which hold the box's index.
    let mut keys = [const { MaybeUninit::<i32>::uninit() }; MOST_ALONE + LANES];
    let mut count = 0;
    let mut enter = |group: &Group, first: usize| {
        let (is_met, enters) = group.meets(wide, &planes);
        // (enters & !INDEX) | index
        let found = _mm512_ternarylogic_epi32::<0b1101_1000>(
            _mm512_castps_si512(enters),
            _mm512_or_epi32(_mm512_set1_epi32(first as i32), lanes()),
            _mm512_set1_epi32(INDEX),
        );
        // SAFETY: there is room for sixteen more than the most boxes.
        unsafe {
            let to = keys.as_mut_ptr().add(count);
            _mm512_storeu_epi32(to.cast(), _mm512_maskz_compress_epi32(is_met, found));
        }
        count += is_met.count_ones() as usize;
    };
    if let [top, bottom] = &levels.groups[..] {
        for (at, group) in top.iter().enumerate() {
            let (mut met, _) = group.meets(wide, &planes);
            while met != 0 {
                let index = LANES * at + met.trailing_zeros() as usize;
                met &= met - 1;
                enter(&bottom[index], LANES * index);
            }
        }
    } else {
        for (index, group) in levels.groups[0].iter().enumerate() {
            enter(group, LANES * index);
        }
    }
    // SAFETY: as many were written.
    let keys = unsafe { keys[..count].assume_init_mut() };
    let mut search = query.search(ray, spheres.left());
    let mut last_key = i32::MAX;
    for done in 0..keys.len() {
        // Moves the nearest of the rest to its place.
        for other in done + 1..keys.len() {
            let (a, b) = (keys[done], keys[other]);
            (keys[done], keys[other]) = (a.min(b), a.max(b));
        }
        let key = keys[done];
        if key > last_key {
            break;
        }
        let (first, count) = levels.spheres[(key & INDEX) as usize];
        search.test_wide::<ANY>(wide, at_rest, first, count);
        if ANY && search.hit.is_some() {
            break;
        }
        last_key = end_of(&slabs, search.ray.t_max).to_bits().cast_signed() | INDEX;
    }
    search.finish::<ANY>()
}

impl Scratch {
    /// Finds the boxes on the top level that rays meet.
    #[inline]
    // As for [`Nearest::evaluate`].
    #[target_feature(
        enable = "adx,aes,avx512bitalg,avx512bw,avx512cd,avx512dq,avx512f,avx512ifma,avx512vbmi,avx512vbmi2,avx512vl,avx512vnni,avx512vpopcntdq,bmi1,bmi2,cmpxchg16b,fma,fxsr,gfni,lzcnt,movbe,pclmulqdq,popcnt,rdrand,rdseed,sha,vaes,vpclmulqdq,xsave,xsavec,xsaveopt,xsaves"
    )]
    fn begin(&mut self, wide: Avx512, top: &[Group], count: usize) {
        let mut pairs = Writer::new(&mut self.pairs, LANES * top.len() * count);
        for ray in 0..count {
            for (index, group) in top.iter().enumerate() {
                let (is_met, _) = group.meets(wide, &self.sixteen.planes(ray));
                let first = _mm512_set1_epi32(pair(ray, LANES * index).cast_signed());
                // SAFETY: at most sixteen of each group.
                unsafe { pairs.push(is_met, _mm512_or_epi32(first, lanes())) };
            }
        }
        pairs.finish();
    }

    /// Finds the boxes of a level that rays meet in the groups that they are paired with.
    #[inline]
    // As for [`Nearest::evaluate`].
    #[target_feature(
        enable = "adx,aes,avx512bitalg,avx512bw,avx512cd,avx512dq,avx512f,avx512ifma,avx512vbmi,avx512vbmi2,avx512vl,avx512vnni,avx512vpopcntdq,bmi1,bmi2,cmpxchg16b,fma,fxsr,gfni,lzcnt,movbe,pclmulqdq,popcnt,rdrand,rdseed,sha,vaes,vpclmulqdq,xsave,xsavec,xsaveopt,xsaves"
    )]
    fn descend(&mut self, wide: Avx512, level: &[Group]) {
        let mut below = Writer::new(&mut self.below, LANES * self.pairs.len());
        for met in &self.pairs {
            let (ray, index) = of_pair(*met);
            // SAFETY: a group on top, or that of a box of the level above, which each have one
            // here; unused boxes were not met.
            let group = unsafe { level.get_unchecked(index) };
            let (is_met, _) = group.meets(wide, &self.sixteen.planes(ray));
            let first = _mm512_set1_epi32(pair(ray, LANES * index).cast_signed());
            // SAFETY: at most sixteen of each pair.
            unsafe { below.push(is_met, _mm512_or_epi32(first, lanes())) };
        }
        below.finish();
        std::mem::swap(&mut self.pairs, &mut self.below);
    }

    /// Finds what rays hit among the spheres in the boxes that they are paired with.
    #[inline]
    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    fn evaluate(
        &mut self,
        wide: Avx512,
        rung: Rung,
        levels: &Levels,
        spheres: &[Sphere],
    ) -> Nearest {
        let mut nearest = Nearest([i64::MAX; LANES]);
        let mut ends = self.sixteen.ends();
        let pairs = &self.pairs[..];
        // As many boxes as there is certainly room for.
        for some in pairs.chunks(WAITING / LANES) {
            let mut rays = Writer::new(&mut self.rays, WAITING);
            let mut indices = Writer::new(&mut self.spheres, WAITING);
            for met in some {
                let (ray, index) = of_pair(*met);
                // SAFETY: a box at the bottom, and there are spheres for all boxes.
                let (first, some) = unsafe {
                    let (first, count) = *levels.spheres.get_unchecked(index);
                    let end = first as usize + count as usize;
                    (first, spheres.get_unchecked(first as usize..end))
                };
                let found = self.sixteen.cull(ray, some) as __mmask16;
                let first = _mm512_set1_epi32(first.cast_signed());
                // SAFETY: at most sixteen of each box.
                unsafe {
                    indices.push(found, _mm512_add_epi32(first, lanes()));
                    rays.push(found, _mm512_set1_epi32(ray as i32));
                }
            }
            rays.finish();
            indices.finish();
            // SAFETY: the machine has every feature of AVX-512 that this needs, as the proof says.
            unsafe {
                let (rays, found) = (&mut self.rays, &mut self.spheres);
                if rung.is_bounded() && rung != Rung::Robust {
                    keep_open(wide, &self.sixteen, &mut ends, rays, found, spheres);
                }
                nearest.evaluate(wide, rung, &self.sixteen, rays, found, spheres);
            };
        }
        nearest
    }
}

/// Keeps the pairs of rays and spheres about which the rung must be asked: those that
/// [`bounds`](spherule_kernel::cull::bounds) leave open, mostly the nearest sphere of each ray.
/// `ends` are what is behind a certain hit of each ray.
#[inline]
// As for [`Nearest::evaluate`].
#[target_feature(
    enable = "adx,aes,avx512bitalg,avx512bw,avx512cd,avx512dq,avx512f,avx512ifma,avx512vbmi,avx512vbmi2,avx512vl,avx512vnni,avx512vpopcntdq,bmi1,bmi2,cmpxchg16b,fma,fxsr,gfni,lzcnt,movbe,pclmulqdq,popcnt,rdrand,rdseed,sha,vaes,vpclmulqdq,xsave,xsavec,xsaveopt,xsaves"
)]
fn keep_open(
    wide: Avx512,
    sixteen: &Sixteen,
    ends: &mut [f32; LANES],
    rays: &mut Vec<u32>,
    indices: &mut Vec<u32>,
    spheres: &[Sphere],
) {
    let mut lows = [0.0; WAITING + LANES];
    for at in (0..rays.len()).step_by(LANES) {
        let (there, some_rays, some_indices) = some_of(rays, indices, at);
        let (hits, high, low) = sixteen.bounds(wide, some_rays, spheres, some_indices);
        let counts = there & !sixteen.have_left(some_rays, some_indices);
        let low = _mm512_mask_mov_ps(_mm512_set1_ps(f32::NAN), counts, low);
        let (mut highs, mut of) = ([0.0_f32; LANES], [0_u32; LANES]);
        let none = _mm512_set1_ps(f32::INFINITY);
        let high = _mm512_mask_mov_ps(none, hits & counts, high);
        // SAFETY: there is room for sixteen more than pairs wait, and for sixteen.
        unsafe {
            _mm512_storeu_ps(lows.as_mut_ptr().add(at), low);
            _mm512_storeu_ps(highs.as_mut_ptr(), high);
            _mm512_storeu_epi32(of.as_mut_ptr().cast(), some_rays);
        }
        for (high, ray) in highs.into_iter().zip(of) {
            let end = &mut ends[ray as usize % LANES];
            *end = if high < *end { high } else { *end };
        }
    }
    // SAFETY: sixteen floats.
    let ends = unsafe { _mm512_loadu_ps(ends.as_ptr()) };
    let mut kept = 0;
    for at in (0..rays.len()).step_by(LANES) {
        let (there, some_rays, some_indices) = some_of(rays, indices, at);
        // SAFETY: as above.
        let low = unsafe { _mm512_loadu_ps(lows.as_ptr().add(at)) };
        let end = _mm512_permutexvar_ps(some_rays, ends);
        let is_open = there & _mm512_cmp_ps_mask::<_CMP_LE_OQ>(low, end);
        // SAFETY: not more are kept than were read, and the lists have room for sixteen more.
        unsafe {
            let to = rays.as_mut_ptr().add(kept);
            _mm512_storeu_epi32(to.cast(), _mm512_maskz_compress_epi32(is_open, some_rays));
            let to = indices.as_mut_ptr().add(kept);
            _mm512_storeu_epi32(
                to.cast(),
                _mm512_maskz_compress_epi32(is_open, some_indices),
            );
        }
        kept += is_open.count_ones() as usize;
    }
    rays.truncate(kept);
    indices.truncate(kept);
}

/// Up to sixteen pairs of two lists, from `at` on, and which there are. The others are of the first
/// ray and the first sphere.
#[inline]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn some_of(rays: &[u32], indices: &[u32], at: usize) -> (__mmask16, __m512i, __m512i) {
    let left = rays.len().min(indices.len()).saturating_sub(at).min(LANES);
    let there = _bzhi_u32(0xffff, left as u32) as __mmask16;
    // SAFETY: only lanes within both lists are read.
    unsafe {
        (
            there,
            _mm512_maskz_loadu_epi32(there, rays.as_ptr().wrapping_add(at).cast()),
            _mm512_maskz_loadu_epi32(there, indices.as_ptr().wrapping_add(at).cast()),
        )
    }
}

#[inline]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn lanes() -> __m512i {
    _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)
}

/// Overwrites a list.
struct Writer<'a> {
    list: &'a mut Vec<u32>,
    to: *mut u32,
    length: usize,
}

impl<'a> Writer<'a> {
    /// Starts a list of at most `most` numbers.
    #[inline(always)]
    fn new(list: &'a mut Vec<u32>, most: usize) -> Self {
        list.clear();
        list.reserve(most + LANES);
        Self {
            to: list.as_mut_ptr(),
            list,
            length: 0,
        }
    }

    /// Appends the chosen ones of sixteen values.
    ///
    /// # Safety
    ///
    /// There must be room for them.
    #[inline]
    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    unsafe fn push(&mut self, chosen: __mmask16, values: __m512i) {
        // SAFETY: there is room for sixteen more than the caller guarantees.
        unsafe {
            let to = self.to.add(self.length);
            _mm512_storeu_epi32(to.cast(), _mm512_maskz_compress_epi32(chosen, values));
        }
        self.length += chosen.count_ones() as usize;
    }

    #[inline(always)]
    fn finish(self) {
        // SAFETY: as many were written.
        unsafe { self.list.set_len(self.length) };
    }
}

/// Joins upper and lower halves into sixteen numbers of 64 bits.
#[inline]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn joined(upper: __m512i, lower: __m512i) -> (__m512i, __m512i) {
    let join = |upper: __m256i, lower: __m256i| {
        let upper = _mm512_slli_epi64::<32>(_mm512_cvtepu32_epi64(upper));
        _mm512_or_epi64(upper, _mm512_cvtepu32_epi64(lower))
    };
    (
        join(_mm512_castsi512_si256(upper), _mm512_castsi512_si256(lower)),
        join(
            _mm512_extracti64x4_epi64::<1>(upper),
            _mm512_extracti64x4_epi64::<1>(lower),
        ),
    )
}

impl Group {
    /// Which boxes a ray meets, a bit each, and where it enters them.
    #[inline(always)]
    fn meets(&self, Avx512(simd): Avx512, planes: &RayPlanes) -> (__mmask16, __m512) {
        let side = |row: usize| {
            // SAFETY: near rows are 0 or 3, 1 or 4, 2 or 5, and far ones the others.
            Single16::load(simd, unsafe { self.0.get_unchecked(row) })
        };
        let rows = planes.near_rows.map(|row| row as usize);
        let (near, far) = near_and_far(rows, side);
        let boxes = Boxes {
            inverse: Single16::splat3(simd, planes.inverse),
            near: Single16::splat3(simd, planes.near),
            far: Single16::splat3(simd, planes.far),
            end: Single16::splat(simd, planes.end),
        };
        let (enter, leave) = boxes.enter_and_leave(near, far);
        (
            enter.simd_le(leave).to_bitmask() as __mmask16,
            enter.0.into(),
        )
    }
}

/// The nearest hit of each ray. The upper half of a number is the distance, as an integer in the
/// order of the floats; the lower half is the sphere.
struct Nearest([i64; LANES]);

impl Nearest {
    /// Evaluates the rung for pairs of rays and spheres.
    #[inline]
    // As for `Sixteen::robust`, which is inlined here.
    #[target_feature(
        enable = "adx,aes,avx512bitalg,avx512bw,avx512cd,avx512dq,avx512f,avx512ifma,avx512vbmi,avx512vbmi2,avx512vl,avx512vnni,avx512vpopcntdq,bmi1,bmi2,cmpxchg16b,fma,fxsr,gfni,lzcnt,movbe,pclmulqdq,popcnt,rdrand,rdseed,sha,vaes,vpclmulqdq,xsave,xsavec,xsaveopt,xsaves"
    )]
    fn evaluate(
        &mut self,
        wide: Avx512,
        rung: Rung,
        sixteen: &Sixteen,
        rays: &[u32],
        indices: &[u32],
        spheres: &[Sphere],
    ) {
        for at in (0..rays.len()).step_by(LANES) {
            let (there, some_rays, some_indices) = some_of(rays, indices, at);
            let one_by_one = |open: __mmask16, t: __m512| {
                let mut found = [0.0; LANES];
                // SAFETY: room for sixteen.
                unsafe { _mm512_storeu_ps(found.as_mut_ptr(), t) };
                let mut open = open & there;
                while open != 0 {
                    let lane = open.trailing_zeros() as usize;
                    open &= open - 1;
                    let ray = sixteen.ray(rays[at + lane] as usize);
                    let sphere = spheres[indices[at + lane] as usize];
                    found[lane] = intersect(rung.to_u32(), sphere, &ray);
                }
                // SAFETY: sixteen floats.
                unsafe { _mm512_loadu_ps(found.as_ptr()) }
            };
            let t = match rung {
                Rung::Robust => sixteen.robust(wide, some_rays, spheres, some_indices),
                Rung::Double => sixteen.double(wide, some_rays, spheres, some_indices),
                Rung::Certified => {
                    let (t, are_certain) =
                        sixteen.certified(wide, there, some_rays, spheres, some_indices);
                    let open = there & !are_certain;
                    if open == 0 { t } else { one_by_one(open, t) }
                }
                Rung::Textbook | Rung::Compensated => one_by_one(there, _mm512_setzero_ps()),
            };
            // Makes −0 into +0.
            let t = _mm512_add_ps(t, _mm512_setzero_ps());
            let hits = _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(there, t, _mm512_set1_ps(Hit::NONE_T));
            let hits = hits & !sixteen.have_left(some_rays, some_indices);
            let bits = _mm512_castps_si512(t);
            let sign = _mm512_srli_epi32::<1>(_mm512_srai_epi32::<31>(bits));
            let (first, second) = joined(_mm512_xor_epi32(bits, sign), some_indices);
            let none = _mm512_set1_epi64(i64::MAX);
            let first = _mm512_mask_mov_epi64(none, hits as __mmask8, first);
            let second = _mm512_mask_mov_epi64(none, (hits >> 8) as __mmask8, second);
            let (mut found, mut of) = ([0; LANES], [0_u32; LANES]);
            // SAFETY: room for sixteen, for eight and for eight.
            unsafe {
                _mm512_storeu_epi32(of.as_mut_ptr().cast(), some_rays);
                _mm512_storeu_epi64(found.as_mut_ptr(), first);
                _mm512_storeu_epi64(found.as_mut_ptr().add(8), second);
            }
            // Lanes beyond the lists have no hit.
            for i in 0..LANES {
                let nearest = &mut self.0[of[i] as usize % LANES];
                *nearest = found[i].min(*nearest);
            }
        }
    }

    #[inline]
    fn hit(&self, ray: usize) -> Hit {
        let key = self.0[ray];
        if key == i64::MAX {
            return Hit::NONE;
        }
        let ordered = (key >> 32) as i32;
        let bits = ordered ^ ((ordered >> 31).cast_unsigned() >> 1).cast_signed();
        Hit {
            t: f32::from_bits(bits.cast_unsigned()),
            sphere: key as u32,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use spherule_kernel::Effects;
    use spherule_kernel::accel::brute::{MovingSpheres, nearest_hit_in};
    use spherule_kernel::accel::traversal::Traversal;

    use super::super::sample_rays::{rays, world};
    use super::super::single::Single;
    use super::*;
    use crate::accel::build_still;
    use crate::cpu::InstructionSet;
    use crate::random::Random;

    /// Each ray finds what testing every sphere finds, together with others and alone, on every
    /// rung: in worlds of one box and of many levels, and with all spheres in almost the same
    /// place, so that there are too many boxes.
    #[test]
    fn streams_find_what_testing_every_sphere_finds() {
        if Avx512::of(InstructionSet::Avx512).is_none() {
            return;
        }
        let mut random = Random::new(11);
        // If they were equal, the tree would keep only the first.
        let heap = (0..2000)
            .map(|shell| Sphere::new(Vec3::new(0.1, 0.2, -0.3), 0.7 + 1e-6 * shell as f32))
            .collect();
        let mut worlds = vec![(heap, true)];
        for count in [1, 7, 40, 500, 3000, 20_000] {
            worlds.push((world(&mut random, count), false));
        }
        for (spheres, is_heap) in worlds {
            let tree = build_still(&spheres, 1).expect("a tree");
            let spheres = tree.sort(&spheres);
            let levels = Levels::of(tree.nodes.tree()).expect("levels");
            assert!(!is_heap || levels.spheres.len() * LANES > MOST);
            let rays = rays(&mut random);
            // The one that most rays hit, because it is around all.
            let around = (0..spheres.len()).find(|index| spheres[*index].radius() == 5.0);
            let lefts: Vec<u32> = (0..rays.len())
                .map(|ray| match around {
                    Some(index) if ray % 2 == 0 => index as u32,
                    _ => Hit::NONE_SPHERE,
                })
                .collect();
            let moving = MovingSpheres {
                spheres: &spheres,
                velocities: &[],
                time: 0.0,
                effects: Effects::default(),
                left: Hit::NONE_SPHERE,
                target: Hit::NONE_SPHERE,
            };
            let name = format!("{} spheres, a heap: {is_heap}", spheres.len());
            for rung in Rung::ALL {
                let single = Single::new(rung, tree.nodes.tree(), Some(&levels));
                let code = rung.to_u32();
                let mut found = vec![(Hit::NONE, Hit::NONE); rays.len()];
                let all = &spheres[..];
                single.trace::<false>(&rays, &lefts, all, |index, hit| found[index].0 = hit);
                single.trace::<true>(&rays, &lefts, all, |index, hit| found[index].1 = hit);
                for ((ray, left), (nearest, any)) in rays.iter().zip(&lefts).zip(&found) {
                    let moving = MovingSpheres {
                        left: *left,
                        target: Hit::NONE_SPHERE,
                        ..moving
                    };
                    let expected = nearest_hit_in(code, ray, &moving, 0, u32::MAX);
                    assert_eq!(*nearest, expected, "{name}, {rung:?}, {ray:?}");
                    let alone = single.nearest_hit(ray, &moving);
                    assert_eq!(alone, expected, "{name}, {rung:?}, alone {ray:?}");
                    let is_occluded = expected.is_some();
                    assert_eq!(any.is_some(), is_occluded, "{name}, {rung:?}, {ray:?}");
                    let alone = single.is_occluded(ray, &moving);
                    assert_eq!(alone, is_occluded, "{name}, {rung:?}, alone {ray:?}");
                }
            }
        }
    }

    #[test]
    fn large_worlds_have_no_levels() {
        let mut random = Random::new(12);
        let tree = build_still(&world(&mut random, 300_000), 1).expect("a tree");
        assert!(Levels::of(tree.nodes.tree()).is_none());
    }
}
