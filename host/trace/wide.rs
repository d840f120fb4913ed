//! [`Wide`]: how all boxes of a node are tested at once, for any instruction set.

use std::arch::x86_64::{__m256, __m256i};

use spherule_kernel::accel::node::Node;
use spherule_kernel::accel::slabs::Slabs;

use super::search::{Resting, Search};

/// Tests of boxes and spheres with an instruction set. A value is the proof that the machine has
/// it.
pub(super) trait Wide: Copy {
    /// The part of a ray that stays the same from node to node.
    type Planes;

    fn planes(self, slabs: &Slabs) -> Self::Planes;

    /// Sets the end of the ray, as [`Slabs::widened_end`] returns it.
    fn end_at(self, planes: &mut Self::Planes, end: f32);

    /// Which of a node's boxes the ray may meet, a bit each, and where it enters them.
    fn meets(self, planes: &Self::Planes, node: &Node) -> (u32, __m256);

    /// The keys of the boxes that are met, as [`Stack`](super::walk) stores them, the largest
    /// first; then negative ones.
    fn keys(self, met: u32, near: __m256) -> __m256i;

    /// Tests the spheres of a node without nodes as children, if that is better than testing its
    /// boxes. Returns whether it did.
    fn test_all<const ANY: bool, S: Resting + ?Sized>(
        self,
        search: &mut Search,
        spheres: &S,
        node: &Node,
    ) -> bool;
}

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
pub(super) use sort_descending;
