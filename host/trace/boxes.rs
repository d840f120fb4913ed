//! The test of all eight boxes of a node side by side, by the kernel's [`Boxes`], for any
//! instruction set.

use fearless_simd::{Bytes, Simd, SimdBase, SimdCombine, SimdMask, f32x8, u32x4};
use glam::{UVec4, Vec3};
use spherule_kernel::accel::node::Node;
use spherule_kernel::accel::slabs::{Boxes, Sides as _, Slabs};
use spherule_kernel::lane::{Lane as _, Lane3};

use crate::lanes::Single8;

/// The part of a ray that stays the same from node to node.
pub(super) struct Planes<S: Simd> {
    simd: S,
    inverse: Vec3,
    near: Vec3,
    far: Vec3,
    end: f32,
    /// Which of a node's rows of sides are near planes.
    near_rows: [usize; 3],
}

impl<S: Simd> Planes<S> {
    #[inline(always)]
    pub(super) fn of(simd: S, slabs: &Slabs) -> Self {
        Self {
            simd,
            inverse: slabs.inverse,
            near: slabs.near,
            far: slabs.far,
            end: 0.0,
            near_rows: slabs.near_rows.to_array().map(|row| row as usize),
        }
    }

    /// Sets the end of the ray, as [`Slabs::widened_end`] returns it.
    #[inline(always)]
    pub(super) fn end_at(&mut self, end: f32) {
        self.end = end;
    }

    /// Which of a node's boxes the ray may meet, a bit each, and where it enters them.
    #[inline(always)]
    pub(super) fn meets(&self, node: &Node) -> (u32, f32x8<S>) {
        let simd = self.simd;
        let corner = [node.corner.x, node.corner.y, node.corner.z].map(f32::from_bits);
        let corner = Single8::splat3(simd, Vec3::from_array(corner));
        let inverse = Single8::splat3(simd, self.inverse);
        let from_corner = |first: Vec3| corner.times_plus(inverse, Single8::splat3(simd, first));
        let boxes = Boxes {
            inverse,
            near: from_corner(self.near),
            far: from_corner(self.far),
            end: Single8::splat(simd, self.end),
        };
        let row = |at: usize| {
            // SAFETY: `at` is one of the six rows: near rows are 0 or 3, 1 or 4, 2 or 5, and far
            // ones the others.
            let words: &UVec4 = unsafe { node.sides.get_unchecked(at) };
            let words = u32x4::load_array_ref(simd, words.as_ref());
            Single8((words << 16).combine(words).bitcast::<f32x8<S>>())
        };
        let (near, far) = near_and_far(self.near_rows, row);
        let (enter, leave) = boxes.enter_and_leave(near, far);
        (enter.simd_le(leave).to_bitmask() as u32, enter.0)
    }
}

/// The near and the far sides of boxes, from which of their six rows are near.
#[inline(always)]
pub(super) fn near_and_far<L>(
    [x, y, z]: [usize; 3],
    row: impl Fn(usize) -> L,
) -> (Lane3<L>, Lane3<L>) {
    let of = |x, y, z| Lane3 {
        x: row(x),
        y: row(y),
        z: row(z),
    };
    (of(x, y, z), of(3 - x, 5 - y, 7 - z))
}
