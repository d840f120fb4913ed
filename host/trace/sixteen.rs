//! [`Sixteen`]: sixteen rays in vectors, and what stays the same of each from sphere to sphere.

use std::arch::x86_64::*;

use fearless_simd::{SimdFrom, SimdMask, f32x16, x86};
use glam::Vec3;
use spherule_kernel::accel::node::{Extent, Node};
use spherule_kernel::accel::slabs::Slabs;
use spherule_kernel::cull::bounds::{Aim, Line};
use spherule_kernel::lane::{Lane as _, Lane3};
use spherule_kernel::precision::OnRung;
use spherule_kernel::precision::certified::corrected::Residual;
use spherule_kernel::precision::certified::wide::WideRay;
use spherule_kernel::precision::root::root_within;
use spherule_kernel::precision::{double, robust};
use spherule_kernel::{Hit, Ray, Rung, Sphere};

use super::avx512::{self, Avx512};
use super::search::left;
use crate::lanes::{Double16, LANES, Single16};

/// One value of each ray.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Lanes<T>([T; LANES]);

impl Default for Lanes<f32> {
    fn default() -> Self {
        Self([0.0; LANES])
    }
}

impl Default for Lanes<u32> {
    fn default() -> Self {
        Self([0; LANES])
    }
}

impl Lanes<f32> {
    #[inline]
    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    fn load(&self) -> __m512 {
        // SAFETY: sixteen floats on a boundary of 64 bytes.
        unsafe { _mm512_load_ps(self.0.as_ptr()) }
    }
}

/// Up to sixteen rays. Lanes beyond the last ray are unused.
#[derive(Clone, Debug, Default)]
pub(super) struct Sixteen {
    /// The index of the sphere over which the ray passes.
    left: Lanes<u32>,
    /// As in the rays.
    origin: [Lanes<f32>; 3],
    direction: [Lanes<f32>; 3],
    t_min: Lanes<f32>,
    end: Lanes<f32>,
    /// The direction's squared length, and its inverse.
    squared: Lanes<f32>,
    inverse_squared: Lanes<f32>,
    slabs: ManySlabs,
    /// 1 for the rays that [`is_plain`] accepts.
    are_plain: [u32; LANES],
    /// [`Line::direction`] and [`Line::a`].
    scaled: [Lanes<f32>; 3],
    scaled_squared: Lanes<f32>,
    /// [`Line::inverse`], [`Line::start`] and [`Line::behind`], and the end in the same units.
    inverse_scaled_squared: Lanes<f32>,
    start: Lanes<f32>,
    behind: Lanes<f32>,
    scaled_end: Lanes<f32>,
}

/// One ray's [`Slabs`], and its end in their units.
#[derive(Clone, Copy)]
pub(super) struct RayPlanes {
    pub(super) inverse: Vec3,
    pub(super) near: Vec3,
    pub(super) far: Vec3,
    pub(super) near_rows: [u32; 3],
    pub(super) end: f32,
}

impl RayPlanes {
    #[inline(always)]
    pub(super) fn of(slabs: &Slabs, end: f32) -> Self {
        Self {
            inverse: slabs.inverse,
            near: slabs.near,
            far: slabs.far,
            near_rows: slabs.near_rows.to_array(),
            end: end_of(slabs, end),
        }
    }
}

/// The fields of [`Slabs`] that are used, for every ray.
#[derive(Clone, Debug, Default)]
struct ManySlabs {
    inverse: [Lanes<f32>; 3],
    near: [Lanes<f32>; 3],
    far: [Lanes<f32>; 3],
    near_rows: [Lanes<u32>; 3],
    end: Lanes<f32>,
}

/// The end of a ray in the units of its slabs; zero for a ray that ends before it starts.
#[inline(always)]
pub(super) fn end_of(slabs: &Slabs, t: f32) -> f32 {
    Slabs::widened_end(t * slabs.unit - slabs.start).max(0.0)
}

/// Whether a ray certainly misses a box from 2⁶⁰ to −2⁶⁰ along each axis. Its inverse direction i
/// is then at least 1/2, and the ray enters such a box after it leaves it, by 2 · 2⁶⁰ i less twice
/// the widening of the planes, which is below 2⁵⁵ i + 2⁴⁰. A ray with NaN is not plain.
#[inline(always)]
pub(super) fn is_plain(ray: &Ray, start: f32) -> bool {
    // A sum of absolute values is NaN or infinite if any of them is.
    let far = ray.origin.abs().element_sum() + start.abs();
    let fast = ray.direction.abs().element_sum();
    (far < Node::MAX_COORDINATE) & (fast <= f32::MAX)
}

impl Sixteen {
    /// Takes the rays of a slice, sixteen at most, with the spheres that they leave. Returns
    /// whether all are plain; if not, they must not be traced here.
    #[must_use]
    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    pub(super) fn take(&mut self, rung: Rung, rays: &[Ray], lefts: &[u32], world: &Extent) -> bool {
        for (i, ray) in rays.iter().take(LANES).enumerate() {
            self.left.0[i] = left(lefts, i);
            for axis in 0..3 {
                self.origin[axis].0[i] = ray.origin[axis];
                self.direction[axis].0[i] = ray.direction[axis];
            }
            self.t_min.0[i] = ray.t_min;
            self.end.0[i] = ray.t_max;
        }
        rung.with(Ready(self, world));
        self.are_plain[..rays.len().min(LANES)]
            .iter()
            .all(|is| *is == 1)
    }

    /// Prepares the rays for boxes and spheres. The compiler turns the loops over arrays into
    /// vector instructions.
    #[inline(never)]
    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    fn ready<const RUNG: u32>(&mut self, world: &Extent) {
        for i in 0..LANES {
            let at = |of: &[Lanes<f32>; 3]| Vec3::new(of[0].0[i], of[1].0[i], of[2].0[i]);
            let ray = Ray {
                origin: at(&self.origin),
                t_min: self.t_min.0[i],
                direction: at(&self.direction),
                t_max: self.end.0[i],
            };
            let a = ray.direction.dot(ray.direction);
            self.end.0[i] = ray.end();
            self.squared.0[i] = a;
            self.inverse_squared.0[i] = 1.0 / a;
            let slabs = Slabs::of(RUNG, &ray, world);
            self.slabs.end.0[i] = end_of(&slabs, ray.end());
            self.are_plain[i] = u32::from(is_plain(&ray, slabs.start));
            let line = Line::of(&ray);
            self.scaled_squared.0[i] = line.a;
            // Robust is evaluated without bounds.
            if RUNG != Rung::Robust.to_u32() {
                self.inverse_scaled_squared.0[i] = line.inverse;
                self.start.0[i] = line.start;
                self.behind.0[i] = line.behind;
                self.scaled_end.0[i] = ray.end() * line.unit;
            }
            let put = |of: &mut [Lanes<f32>; 3], v: Vec3| {
                (of[0].0[i], of[1].0[i], of[2].0[i]) = (v.x, v.y, v.z);
            };
            put(&mut self.slabs.inverse, slabs.inverse);
            put(&mut self.slabs.near, slabs.near);
            put(&mut self.slabs.far, slabs.far);
            put(&mut self.scaled, line.direction);
            let rows = slabs.near_rows;
            self.slabs.near_rows[0].0[i] = rows.x;
            self.slabs.near_rows[1].0[i] = rows.y;
            self.slabs.near_rows[2].0[i] = rows.z;
        }
    }
}

/// [`Sixteen::ready`], compiled for each rung. Made only where the machine has the features.
struct Ready<'a>(&'a mut Sixteen, &'a Extent);

impl OnRung for Ready<'_> {
    type Output = ();

    fn run<const RUNG: u32>(self) {
        let Self(sixteen, world) = self;
        // SAFETY: as above.
        unsafe { sixteen.ready::<RUNG>(world) }
    }
}

impl Sixteen {
    /// The planes of a ray.
    #[inline(always)]
    pub(super) fn planes(&self, ray: usize) -> RayPlanes {
        let ray = ray % LANES;
        let of = |lanes: &[Lanes<f32>; 3]| Vec3::from_array(lanes.each_ref().map(|of| of.0[ray]));
        RayPlanes {
            inverse: of(&self.slabs.inverse),
            near: of(&self.slabs.near),
            far: of(&self.slabs.far),
            near_rows: self.slabs.near_rows.each_ref().map(|of| of.0[ray]),
            end: self.slabs.end.0[ray],
        }
    }

    /// Which of up to sixteen spheres a ray may hit, a bit each.
    #[inline]
    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    pub(super) fn cull(&self, ray: usize, spheres: &[Sphere]) -> u32 {
        let ray = ray % LANES;
        let of = |lanes: &[Lanes<f32>; 3]| Vec3::from_array(lanes.each_ref().map(|of| of.0[ray]));
        let a = self.scaled_squared.0[ray];
        avx512::cull(of(&self.origin), of(&self.scaled), a, None, spheres)
    }

    /// Of which of sixteen pairs, given by index, the ray passes over the sphere.
    #[inline]
    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    pub(super) fn have_left(&self, rays: __m512i, spheres: __m512i) -> __mmask16 {
        // SAFETY: sixteen numbers on a boundary of 64 bytes.
        let left = unsafe { _mm512_load_epi32(self.left.0.as_ptr().cast()) };
        _mm512_cmpeq_epi32_mask(_mm512_permutexvar_epi32(rays, left), spheres)
    }

    /// Where the ray and the sphere of each of sixteen pairs meet on [`Rung::Robust`];
    /// [`Hit::NONE_T`] where they do not. Both are given by index.
    #[inline]
    // All features that `fearless_simd` compiles its AVX-512 for; otherwise nothing of it is
    // inlined.
    #[target_feature(
        enable = "adx,aes,avx512bitalg,avx512bw,avx512cd,avx512dq,avx512f,avx512ifma,avx512vbmi,avx512vbmi2,avx512vl,avx512vnni,avx512vpopcntdq,bmi1,bmi2,cmpxchg16b,fma,fxsr,gfni,lzcnt,movbe,pclmulqdq,popcnt,rdrand,rdseed,sha,vaes,vpclmulqdq,xsave,xsavec,xsaveopt,xsaves"
    )]
    pub(super) fn robust(
        &self,
        Avx512(simd): Avx512,
        rays: __m512i,
        spheres: &[Sphere],
        indices: __m512i,
    ) -> __m512 {
        let of = |lanes: &Lanes<f32>| {
            let lanes = _mm512_permutexvar_ps(rays, lanes.load());
            Single16(f32x16::simd_from(simd, lanes))
        };
        let quadratic = self.quadratic(Avx512(simd), rays, gather(spheres, indices));
        let (near, far) = quadratic.roots();
        let (t, is_within) = root_within(near, far, of(&self.t_min), of(&self.end));
        let hits = is_within & quadratic.meets();
        let none = Single16::splat(simd, Hit::NONE_T);
        Single16::select(hits, t, none).0.into()
    }

    /// The quadratics of sixteen pairs on [`Rung::Robust`], given centres and radii.
    #[inline]
    // As for `robust`.
    #[target_feature(
        enable = "adx,aes,avx512bitalg,avx512bw,avx512cd,avx512dq,avx512f,avx512ifma,avx512vbmi,avx512vbmi2,avx512vl,avx512vnni,avx512vpopcntdq,bmi1,bmi2,cmpxchg16b,fma,fxsr,gfni,lzcnt,movbe,pclmulqdq,popcnt,rdrand,rdseed,sha,vaes,vpclmulqdq,xsave,xsavec,xsaveopt,xsaves"
    )]
    fn quadratic(
        &self,
        Avx512(simd): Avx512,
        rays: __m512i,
        spheres: [__m512; 4],
    ) -> robust::Quadratic<Single16<x86::Avx512>> {
        let number = |lanes| Single16(f32x16::simd_from(simd, lanes));
        let of = |lanes: &Lanes<f32>| number(_mm512_permutexvar_ps(rays, lanes.load()));
        let [cx, cy, cz, radius] = spheres.map(number);
        let [x, y, z] = self.direction.each_ref().map(of);
        let [ox, oy, oz] = self.origin.each_ref().map(of);
        let o = Lane3 {
            x: ox - cx,
            y: oy - cy,
            z: oz - cz,
        };
        let d = Lane3 { x, y, z };
        let (a, inverse) = (of(&self.squared), of(&self.inverse_squared));
        robust::Quadratic::of(o, radius, d, a, inverse)
    }

    /// What [`bounds`](spherule_kernel::cull::bounds) tell of sixteen pairs: whether the ray hits
    /// for certain, up to where then, and from where on it may hit, in the units of [`Line`]; NaN
    /// where it misses for certain.
    #[inline]
    // As for `robust`.
    #[target_feature(
        enable = "adx,aes,avx512bitalg,avx512bw,avx512cd,avx512dq,avx512f,avx512ifma,avx512vbmi,avx512vbmi2,avx512vl,avx512vnni,avx512vpopcntdq,bmi1,bmi2,cmpxchg16b,fma,fxsr,gfni,lzcnt,movbe,pclmulqdq,popcnt,rdrand,rdseed,sha,vaes,vpclmulqdq,xsave,xsavec,xsaveopt,xsaves"
    )]
    pub(super) fn bounds(
        &self,
        Avx512(simd): Avx512,
        rays: __m512i,
        spheres: &[Sphere],
        indices: __m512i,
    ) -> (__mmask16, __m512, __m512) {
        let number = |lanes| Single16(f32x16::simd_from(simd, lanes));
        let of = |lanes: &Lanes<f32>| number(_mm512_permutexvar_ps(rays, lanes.load()));
        let [cx, cy, cz, radius] = gather(spheres, indices).map(number);
        let [x, y, z] = self.scaled.each_ref().map(of);
        let [ox, oy, oz] = self.origin.each_ref().map(of);
        let aim = Aim {
            direction: Lane3 { x, y, z },
            inverse: of(&self.inverse_scaled_squared),
            start: of(&self.start),
            behind: of(&self.behind),
        };
        let o = Lane3 {
            x: cx - ox,
            y: cy - oy,
            z: cz - oz,
        };
        let (misses, hits, low, high) = aim.bounds(o, radius);
        let (before, none) = (radius.splat(f32::NEG_INFINITY), radius.splat(f32::NAN));
        let low = Single16::select(hits, low, before);
        let low = Single16::select(misses, none, low);
        (hits.to_bitmask() as __mmask16, high.0.into(), low.0.into())
    }

    /// The end of each ray, in the units of [`Line`].
    #[inline(always)]
    pub(super) fn ends(&self) -> [f32; LANES] {
        self.scaled_end.0
    }

    /// The same as [`Sixteen::robust`] on [`Rung::Double`].
    #[inline]
    // As for `robust`.
    #[target_feature(
        enable = "adx,aes,avx512bitalg,avx512bw,avx512cd,avx512dq,avx512f,avx512ifma,avx512vbmi,avx512vbmi2,avx512vl,avx512vnni,avx512vpopcntdq,bmi1,bmi2,cmpxchg16b,fma,fxsr,gfni,lzcnt,movbe,pclmulqdq,popcnt,rdrand,rdseed,sha,vaes,vpclmulqdq,xsave,xsavec,xsaveopt,xsaves"
    )]
    pub(super) fn double(
        &self,
        Avx512(simd): Avx512,
        rays: __m512i,
        spheres: &[Sphere],
        indices: __m512i,
    ) -> __m512 {
        let line = self.wide_rays(Avx512(simd), rays);
        let number = |lanes| Single16(f32x16::simd_from(simd, lanes));
        let [x, y, z, radius] =
            gather(spheres, indices).map(|lanes| Double16::widened(number(lanes)));
        let center = Lane3 { x, y, z };
        let quadratic = double::Quadratic::of(line.origin, line.direction, center, radius);
        let roots = quadratic.roots();
        let (near, far) = (roots.near.rounded(), roots.far.rounded());
        let of = |lanes: &Lanes<f32>| number(_mm512_permutexvar_ps(rays, lanes.load()));
        let (t, is_within) = root_within(near, far, of(&self.t_min), of(&self.end));
        let hits = is_within & quadratic.meets().narrowed(simd);
        let none = Single16::splat(simd, Hit::NONE_T);
        Single16::select(hits, t, none).0.into()
    }

    /// The same on [`Rung::Certified`] for the pairs of `there` in 64-bit floats, and for which of
    /// them these are certain.
    #[inline]
    // As for `robust`.
    #[target_feature(
        enable = "adx,aes,avx512bitalg,avx512bw,avx512cd,avx512dq,avx512f,avx512ifma,avx512vbmi,avx512vbmi2,avx512vl,avx512vnni,avx512vpopcntdq,bmi1,bmi2,cmpxchg16b,fma,fxsr,gfni,lzcnt,movbe,pclmulqdq,popcnt,rdrand,rdseed,sha,vaes,vpclmulqdq,xsave,xsavec,xsaveopt,xsaves"
    )]
    pub(super) fn certified(
        &self,
        Avx512(simd): Avx512,
        there: __mmask16,
        rays: __m512i,
        spheres: &[Sphere],
        indices: __m512i,
    ) -> (__m512, __mmask16) {
        let number = |lanes| Single16(f32x16::simd_from(simd, lanes));
        let of = |lanes: &Lanes<f32>| number(_mm512_permutexvar_ps(rays, lanes.load()));
        let line = self.wide_rays(Avx512(simd), rays);
        let spheres = gather(spheres, indices);
        let [x, y, z, radius] = spheres.map(|lanes| Double16::widened(number(lanes)));
        let center = Lane3 { x, y, z };

        let guess = self.quadratic(Avx512(simd), rays, spheres).roots().0;
        let Residual { g, h } = line.residual(center, radius, Double16::widened(guess));
        let (g, h) = (g.rounded(), h.rounded());
        let [x, y, z] = self.direction.each_ref().map(of);
        let near = Residual { g, h }.correct(guess, Lane3 { x, y, z }, number(spheres[3]));
        let is_entry = near.is_certain & near.is_near & near.t.simd_gt(of(&self.t_min));
        let none = guess.splat(Hit::NONE_T);
        let t = Single16::select(near.t.simd_lt(of(&self.end)), near.t, none);
        let is_entry_bits = is_entry.to_bitmask() as __mmask16;
        if there & !is_entry_bits == 0 {
            return (t.0.into(), there);
        }

        let answer = line.intersect(center, radius);
        let is_certain = answer.is_certain.narrowed(simd) | is_entry;
        let t = Single16::select(is_entry, t, answer.t.rounded());
        (t.0.into(), is_certain.to_bitmask() as __mmask16)
    }

    /// The rays of sixteen pairs in 64-bit floats.
    #[inline]
    // As for `robust`.
    #[target_feature(
        enable = "adx,aes,avx512bitalg,avx512bw,avx512cd,avx512dq,avx512f,avx512ifma,avx512vbmi,avx512vbmi2,avx512vl,avx512vnni,avx512vpopcntdq,bmi1,bmi2,cmpxchg16b,fma,fxsr,gfni,lzcnt,movbe,pclmulqdq,popcnt,rdrand,rdseed,sha,vaes,vpclmulqdq,xsave,xsavec,xsaveopt,xsaves"
    )]
    fn wide_rays(&self, Avx512(simd): Avx512, rays: __m512i) -> WideRay<Double16<x86::Avx512>> {
        let of = |lanes: &Lanes<f32>| {
            let number = _mm512_permutexvar_ps(rays, lanes.load());
            Double16::widened(Single16(f32x16::simd_from(simd, number)))
        };
        let [x, y, z] = self.direction.each_ref().map(of);
        let direction = Lane3 { x, y, z };
        let [x, y, z] = self.origin.each_ref().map(of);
        WideRay {
            origin: Lane3 { x, y, z },
            direction,
            t_min: of(&self.t_min),
            t_max: of(&self.end),
        }
    }

    /// A ray as it was taken, up to its [end](Ray::end).
    pub(super) fn ray(&self, ray: usize) -> Ray {
        let ray = ray % LANES;
        let of = |lanes: &[Lanes<f32>; 3]| Vec3::from_array(lanes.each_ref().map(|of| of.0[ray]));
        Ray::within(
            of(&self.origin),
            of(&self.direction),
            self.t_min.0[ray],
            self.end.0[ray],
        )
    }
}

/// Centres and radii of sixteen spheres, which must exist.
#[inline]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn gather(spheres: &[Sphere], indices: __m512i) -> [__m512; 4] {
    let at = _mm512_slli_epi32::<2>(indices);
    [0, 1, 2, 3].map(|row| {
        let at = _mm512_add_epi32(at, _mm512_set1_epi32(row));
        // SAFETY: four floats a sphere, and the spheres exist.
        unsafe { _mm512_i32gather_ps::<4>(at, spheres.as_ptr().cast()) }
    })
}
