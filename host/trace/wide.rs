//! [`Wide`]: what the walk needs of an instruction set.

use std::arch::x86_64::__m256i;

use fearless_simd::{Simd, f32x8, x86};
use spherule_kernel::accel::node::Node;

use super::avx2::Avx2;
use super::avx512::Avx512;
use super::search::{Resting, Search};
use super::sort::{keys_with_avx2, keys_with_avx512};

/// Sorting of boxes and tests of spheres with an instruction set. A value is the proof that the
/// machine has it.
pub(super) trait Wide: Copy {
    /// The vectors in which boxes are tested.
    type Simd: Simd;

    fn simd(self) -> Self::Simd;

    /// The keys of the boxes that are met, as [`Stack`](super::walk) stores them, the largest
    /// first; then negative ones.
    fn keys(self, met: u32, near: f32x8<Self::Simd>) -> __m256i;

    /// Tests the spheres of a node without nodes as children, if that is better than testing its
    /// boxes. Returns whether it did.
    fn test_all<const ANY: bool, S: Resting + ?Sized>(
        self,
        search: &mut Search,
        spheres: &S,
        node: &Node,
    ) -> bool;
}

impl Wide for Avx2 {
    type Simd = x86::Avx2;

    #[inline(always)]
    fn simd(self) -> x86::Avx2 {
        self.0
    }

    #[inline(always)]
    fn keys(self, met: u32, near: f32x8<x86::Avx2>) -> __m256i {
        // SAFETY: the machine has AVX2.
        unsafe { keys_with_avx2(met, near.into()) }
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

impl Wide for Avx512 {
    type Simd = x86::Avx512;

    #[inline(always)]
    fn simd(self) -> x86::Avx512 {
        self.0
    }

    #[inline(always)]
    fn keys(self, met: u32, near: f32x8<x86::Avx512>) -> __m256i {
        // SAFETY: the machine has AVX-512.
        unsafe { keys_with_avx512(met, near.into()) }
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
