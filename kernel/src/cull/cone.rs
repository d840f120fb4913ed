//! Brute force at a GPU's rate: four operations a test that tell which spheres a rung must be asked about.
//! Runs on the GPU and on the CPU.
//!
//! Seen from an eye outside of it, a sphere fills a cone. With o = C − O, c = o·o − r² and h = o/√c, a line along d
//! that goes forward meets the sphere where d·h ≥ |d|, which is cos θ ≥ √(1 − r²/o·o). h is shared by all rays from one eye,
//! and |d| by all spheres.
//!
//! In 32-bit floats, u = 2⁻²⁴, cos θ is off by 16u at most: o by u, 1/√c by 4u, which are the two units in the last place that Vulkan
//! allows, their product by u, and the sum of the three products by 3u of |d||h|; |d| by 7u, of which 5u are the root's. c is off by 7u (o·o + r²), and
//! what a rung calls a hit the exact numbers may miss by 24u (o·o + r²), as [`slabs`](crate::accel::slabs) says. Roots of numbers up to 1 that are
//! apart by δ are apart by δ/2 and more; c is therefore taken less by 64u (o·o + r²), (64 − 7 − 24)/2 being 16.5, and no rung's hit is passed by. Behind an eye
//! that is outside by as much as that no rung hits.

use glam::{Vec3, Vec4};

use crate::gpu::instructions::inverse_root;
use crate::sphere::Sphere;

/// 64u.
const SLACK: f32 = 1.0 / (1 << 18) as f32;
/// Where a square and its root are far from underflow and overflow.
const SMALLEST: f32 = 1.0 / LARGEST;
const LARGEST: f32 = (1_u128 << 100) as f32;

/// What a sphere fills seen from an eye: h, and what is added to d·h, which decides alone where it is not zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone(Vec4);

impl Cone {
    /// Of a sphere; where the eye is in it, or near, or too far away for 32 bits, all rays meet it.
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

    /// Of no sphere: every ray misses.
    #[inline]
    #[must_use]
    pub fn none() -> Self {
        Self(Vec3::ZERO.extend(-f32::MAX))
    }

    /// As one load.
    #[inline]
    #[must_use]
    pub fn to_vec4(self) -> Vec4 {
        self.0
    }

    /// Out of one load.
    #[inline]
    #[must_use]
    pub fn from_vec4(vector: Vec4) -> Self {
        Self(vector)
    }
}

/// A ray from the eye: d, and |d|.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    direction: Vec3,
    length: f32,
}

impl Sight {
    /// Along a direction, of a length up to 2⁸⁰. Where that or its square is beyond what roots are sure of, every sphere is met.
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

    /// Moves in from the right, by the sign of what is missing, whether the ray misses a sphere for certain.
    #[inline]
    #[must_use]
    pub fn misses(&self, before: u32, cone: Cone) -> u32 {
        let (d, h) = (self.direction, cone.0);
        let reach = d.x * h.x + (d.y * h.y + (d.z * h.z + h.w));
        before << 1 | (reach - self.length).to_bits() >> 31
    }
}
