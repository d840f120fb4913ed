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
