//! [`Cone`]: a test of four operations that tells which spheres a rung must be evaluated for, for
//! brute force at a GPU's rate. Runs on the GPU and on the CPU.
//!
//! Seen from an eye outside of it, a sphere fills a cone. With o = C − O, c = o·o − r² and
//! h = o/√c, a line along d that goes forward meets the sphere where d·h ≥ |d|, which is cos
//! θ ≥ √(1 − r²/o·o). All rays from one eye share h, and all spheres share |d|.
//!
//! In 32-bit floats, with u = 2⁻²⁴:
//!
//! - cos θ is off by 16u at most: o by u; 1/√c by 4u, which are the two units in the last place
//!   that Vulkan allows; their product by u; the sum of the three products by 3u of |d||h|; |d| by
//!   7u, of which 5u are the root's.
//! - c is off by 7u (o·o + r²).
//! - A rung may find a hit that exact arithmetic misses by 24u (o·o + r²), as
//!   [`slabs`](crate::accel::slabs) says.
//! - Roots of numbers up to 1 that are δ apart are at least δ/2 apart.
//!
//! So 64u (o·o + r²) is subtracted from c: (64 − 7 − 24)/2 is 16.5, and no rung's hit is lost. No
//! rung hits a sphere that is behind an eye, if the eye is outside of the sphere by as much as
//! that.

use glam::{Vec3, Vec4};

use crate::gpu::instructions::inverse_root;
use crate::sphere::Sphere;

/// 64u.
const SLACK: f32 = 1.0 / (1 << 18) as f32;
/// Where a square and its root are far from underflow and overflow.
const SMALLEST: f32 = 1.0 / LARGEST;
const LARGEST: f32 = (1_u128 << 100) as f32;

/// The cone that a sphere fills, seen from an eye: h, and a number that is added to d·h. Where that
/// number is not zero, it alone decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone(Vec4);

impl Cone {
    /// The cone of a sphere. If the eye is in the sphere, or near it, or too far away for 32 bits,
    /// all rays meet the cone.
    #[inline]
    #[must_use]
    pub fn of(sphere: Sphere, eye: Vec3) -> Self {
        let o = sphere.center() - eye;
        let (oo, rr) = (o.dot(o), sphere.radius() * sphere.radius());
        let c = (oo - rr) - SLACK * (oo + rr);
        if (c > SMALLEST) & (c < LARGEST) {
            Self((o * inverse_root(c)).extend(0.0))
        } else {
            Self(Vec3::ZERO.extend(f32::MAX))
        }
    }

    /// A cone that every ray misses, for no sphere.
    #[inline]
    #[must_use]
    pub fn none() -> Self {
        Self(Vec3::ZERO.extend(-f32::MAX))
    }

    /// The cone as one vector, for a single 16-byte store.
    #[inline]
    #[must_use]
    pub fn to_vec4(self) -> Vec4 {
        self.0
    }

    /// The cone from the vector that [`Cone::to_vec4`] gave.
    #[inline]
    #[must_use]
    pub fn from_vec4(vector: Vec4) -> Self {
        Self(vector)
    }
}

/// A ray from the eye: its direction d, and |d|.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    direction: Vec3,
    length: f32,
}

impl Sight {
    /// Prepares a ray along a direction, whose length is at most 2⁸⁰. If the square of the length
    /// is too small or too large for the root, the ray counts as meeting every sphere.
    #[inline]
    #[must_use]
    pub fn along(direction: Vec3) -> Self {
        let squared = direction.dot(direction);
        let length = if (squared > SMALLEST) & (squared < LARGEST) {
            squared * inverse_root(squared)
        } else {
            -LARGEST
        };
        Self { direction, length }
    }

    /// Shifts `before` left by one bit and puts in 1 if the ray misses the sphere for certain: the
    /// sign of d·h − |d|.
    #[inline]
    #[must_use]
    pub fn misses(&self, before: u32, cone: Cone) -> u32 {
        let (d, h) = (self.direction, cone.0);
        let reach = d.x * h.x + (d.y * h.y + (d.z * h.z + h.w));
        before << 1 | (reach - self.length).to_bits() >> 31
    }
}
