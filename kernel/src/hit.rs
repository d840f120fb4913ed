//! [`Hit`]: the nearest intersection of a ray. Runs on the GPU and on the CPU.

use bytemuck::{Pod, Zeroable};

/// The nearest intersection of a ray with a world of spheres, or no hit.
///
/// No hit is encoded in finite numbers, because shader compilers may assume that infinities and NaN
/// do not occur.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Hit {
    /// The parameter along the ray; [`Hit::NONE_T`] for no hit.
    pub t: f32,
    /// The index of the sphere; [`Hit::NONE_SPHERE`] for no hit. Among spheres and other shapes the
    /// indices of shapes follow those of spheres.
    pub sphere: u32,
}

impl Hit {
    /// The parameter that stands for "no hit": the largest finite number.
    pub const NONE_T: f32 = f32::MAX;
    /// The parameter that stands for "not decided yet": see
    /// [`DEFERRING`](crate::precision::DEFERRING).
    pub const DEFERRED_T: f32 = -f32::MAX;
    /// The index that stands for "no sphere".
    pub const NONE_SPHERE: u32 = u32::MAX;
    /// No hit.
    pub const NONE: Self = Self {
        t: Self::NONE_T,
        sphere: Self::NONE_SPHERE,
    };

    /// Whether there is a hit.
    #[inline]
    #[must_use]
    pub fn is_some(&self) -> bool {
        self.sphere != Self::NONE_SPHERE
    }

    /// Whether that is left to a second launch: see [`DEFERRING`](crate::precision::DEFERRING).
    #[inline]
    #[must_use]
    pub fn is_deferred(&self) -> bool {
        self.t == Self::DEFERRED_T
    }
}

impl Default for Hit {
    fn default() -> Self {
        Self::NONE
    }
}

const _: () = {
    assert!(size_of::<Hit>() == 8);
    assert!(core::mem::offset_of!(Hit, t) == 0);
    assert!(core::mem::offset_of!(Hit, sphere) == 4);
};
