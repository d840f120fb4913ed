//! [`Wide`]: how the boxes of a node are tested side by side, whatever the instructions.

use std::arch::x86_64::{__m256, __m256i};

use spherule_kernel::accel::node::Node;
use spherule_kernel::accel::slabs::Slabs;

use super::search::{Resting, Search};

/// How boxes and spheres are tested: a value is the proof that the machine has the instructions.
pub(super) trait Wide: Copy {
    /// What stays the same of a ray from node to node.
    type Planes;

    fn planes(self, slabs: &Slabs) -> Self::Planes;

    /// Sets the end of the ray, as [`Slabs::widened_end`] has it.
    fn end_at(self, planes: &mut Self::Planes, end: f32);

    /// Which of a node's boxes the ray may meet, a bit each, and where it enters them.
    fn meets(self, planes: &Self::Planes, node: &Node) -> (u32, __m256);

    /// The keys of those of the boxes that are met, as [`Stack`](super::walk) has them, the largest first; behind them negative ones.
    fn keys(self, met: u32, near: __m256) -> __m256i;

    /// Tests the spheres of a node without nodes in it, if that is better than to look at its boxes.
    fn test_all<const ANY: bool, S: Resting + ?Sized>(
        self,
        search: &mut Search,
        spheres: &S,
        node: &Node,
    ) -> bool;
}
