//! [`Ray`]: a half-open interval of a line. Runs on the GPU and on the CPU.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::hit::Hit;

/// The points `origin + t · direction` for `t_min ≤ t < t_max`.
///
/// The interval is half-open so that "nearer than what was found so far" is one comparison, and so
/// that the first of two equally near spheres wins.
///
/// 32 bytes, with each vector on a 16-byte boundary as std430 requires.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Ray {
    /// Where the ray starts, in scene units.
    pub origin: Vec3,
    /// The start of the interval of `t`, inclusive.
    pub t_min: f32,
    /// The direction. It need not be a unit vector; a ray with a zero vector hits nothing.
    pub direction: Vec3,
    /// The end of the interval of `t`, exclusive.
    pub t_max: f32,
}

impl Ray {
    /// The whole half-line from `origin` along `direction`: `0 ≤ t < f32::MAX`.
    #[inline]
    #[must_use]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self::within(origin, direction, 0.0, f32::MAX)
    }

    /// The part of the line with `t_min ≤ t < t_max`.
    #[inline]
    #[must_use]
    pub fn within(origin: Vec3, direction: Vec3, t_min: f32, t_max: f32) -> Self {
        Self {
            origin,
            t_min,
            direction,
            t_max,
        }
    }

    /// The end of the interval of `t`, cut to [`Hit::NONE_T`], because a hit there could not be
    /// told from no hit.
    #[inline]
    #[must_use]
    pub fn end(&self) -> f32 {
        self.t_max.min(Hit::NONE_T)
    }

    /// The point at parameter `t`.
    #[inline]
    #[must_use]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

const _: () = {
    assert!(size_of::<Ray>() == 32);
    assert!(core::mem::offset_of!(Ray, origin) == 0);
    assert!(core::mem::offset_of!(Ray, t_min) == 12);
    assert!(core::mem::offset_of!(Ray, direction) == 16);
    assert!(core::mem::offset_of!(Ray, t_max) == 28);
};
