//! Brute force at a GPU's rate: three operations a test that tell which spheres a rung must be asked about.
//! Runs on the GPU and on the CPU.
//!
//! Seen from an eye outside of it, a sphere fills a cone. With o = C − O, c = o·o − r² and h = o/√c, a line along d
//! that goes forward meets the sphere where d·h ≥ |d|, which is cos θ ≥ √(1 − r²/o·o). A camera's d is F + x R + y U, so that
//! d·h = x (R·h) + (y (U·h) + F·h): the three products are shared by all rays, the bracket by a row of pixels, and
//! |d| by all spheres.
//!
//! In 32-bit floats, u = 2⁻²⁴, cos θ is off by 53u at most: d and its product by 10u (|F| + |x R| + |y U|), of which
//! the bracket is 2|d| at most for cameras that [`is_square`]; |d| by 17u, as |d|² is summed up of terms that are together 1.25 |d|² at most, and off by 22u of
//! them; and 1/√c by 16u where a root and a quotient are as bad as Vulkan allows. c is off by 6u (o·o + r²), and what a rung calls a hit the exact
//! numbers may miss by 24u (o·o + r²), as the rungs' modules say. Roots of numbers up to 1 that are apart by δ are apart by δ/2; c is therefore taken
//! less by 160u (o·o + r²), (160 − 6 − 24)/2 being 65, and no rung's hit is passed by. Behind an eye that is
//! outside by as much as that no rung hits.

use glam::{Vec2, Vec3, Vec4};
// On the CPU, std has `f32::sqrt`.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use crate::camera::Camera;
use crate::sphere::Sphere;

/// 160u.
const SLACK: f32 = 1.25 / (1 << 17) as f32;
/// Where c and its root are far from underflow and overflow.
const SMALLEST: f32 = 1.0 / LARGEST;
const LARGEST: f32 = (1_u128 << 100) as f32;
/// Where products of the squares of a camera's axes are.
const SMALLEST_AXIS: f32 = 1.0 / LARGEST_AXIS;
const LARGEST_AXIS: f32 = (1_u64 << 40) as f32;

/// Whether the bounds hold for a camera's rays through the film: its axes are within 6° of right angles, so that (|F| + |x R| + |y U|)² is at most
/// 4|d|², and neither tiny nor huge.
#[inline]
#[must_use]
pub fn is_square(camera: &Camera) -> bool {
    let (forward, right, up) = (camera.forward, camera.right, camera.up);
    let (ff, rr, uu) = (forward.dot(forward), right.dot(right), up.dot(up));
    let (fr, fu, ru) = (forward.dot(right), forward.dot(up), right.dot(up));
    (fr * fr <= 0.01 * (ff * rr))
        & (fu * fu <= 0.01 * (ff * uu))
        & (ru * ru <= 0.01 * (rr * uu))
        & (ff > SMALLEST_AXIS)
        & (ff + rr + uu < LARGEST_AXIS)
}

/// What a camera's rays share of a sphere: R·h, U·h and F·h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone(Vec4);

impl Cone {
    /// Of a sphere, if the camera [`is_square`]; otherwise, and where the eye is in a sphere, or near, or too far away for 32 bits, all rays
    /// meet it.
    #[inline]
    #[must_use]
    pub fn of(sphere: Sphere, camera: &Camera, is_square: bool) -> Self {
        let o = sphere.center() - camera.eye;
        let (oo, rr) = (o.dot(o), sphere.radius() * sphere.radius());
        let c = (oo - rr) - SLACK * (oo + rr);
        if is_square & (c > SMALLEST) & (c < LARGEST) {
            let along = Vec3::new(camera.right.dot(o), camera.up.dot(o), camera.forward.dot(o));
            Self((along * (1.0 / c.sqrt())).extend(0.0))
        } else {
            Self(Vec4::new(0.0, 0.0, f32::MAX, 0.0))
        }
    }

    /// Of no sphere: every ray misses.
    #[inline]
    #[must_use]
    pub fn none() -> Self {
        Self(Vec4::ZERO)
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

/// Eight rays of one row of pixels.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    y: f32,
    x: Eight<Vec4>,
    /// |d|.
    lengths: Eight<Vec4>,
}

/// Two halves of eight values.
#[derive(Clone, Copy, Debug)]
struct Eight<T> {
    low: T,
    high: T,
}

impl Row {
    /// Rays through the film, as [`Camera::film`] counts it: at eight x, four in each vector, and at `y`.
    #[inline]
    #[must_use]
    pub fn of(camera: &Camera, low: Vec4, high: Vec4, y: f32) -> Self {
        // |d|² = (M + x R)·(M + x R), M what the row shares.
        let (middle, right) = (camera.forward + camera.up * y, camera.right);
        let (mm, mr, rr) = (
            middle.dot(middle),
            2.0 * middle.dot(right),
            right.dot(right),
        );
        // Of cameras that are not square rounding may make it negative; any number does for them.
        let of = |x: f32| (mm + x * (mr + x * rr)).abs().sqrt();
        let all = |x: Vec4| Vec4::new(of(x.x), of(x.y), of(x.z), of(x.w));
        Self {
            y,
            x: Eight { low, high },
            lengths: Eight {
                low: all(low),
                high: all(high),
            },
        }
    }

    /// d·h for each of the rays.
    #[inline]
    fn reach(&self, cone: Cone) -> Eight<Vec4> {
        let shared = Vec4::splat(self.y * cone.0.y + cone.0.z);
        let across = Vec4::splat(cone.0.x);
        Eight {
            low: self.x.low * across + shared,
            high: self.x.high * across + shared,
        }
    }

    /// Which rays may meet which of four spheres: bit 31 − 8 i − k is ray k and sphere i.
    #[inline]
    #[must_use]
    pub fn candidates(&self, cones: [Cone; 4]) -> u32 {
        let [first, second, third, fourth] = cones;
        let misses = self.misses(0, first);
        let misses = self.misses(misses, second);
        let misses = self.misses(misses, third);
        !self.misses(misses, fourth)
    }

    /// Moves in whether each ray misses, by the signs of what is missing.
    #[inline]
    fn misses(&self, before: u32, cone: Cone) -> u32 {
        let reach = self.reach(cone);
        let missing = |bits: u32, by: f32| bits << 1 | by.to_bits() >> 31;
        let four =
            |bits: u32, by: Vec4| missing(missing(missing(missing(bits, by.x), by.y), by.z), by.w);
        let low = four(before, reach.low - self.lengths.low);
        four(low, reach.high - self.lengths.high)
    }

    /// Where on the film ray k goes.
    #[inline]
    #[must_use]
    pub fn film(&self, k: u32) -> Vec2 {
        let half = if k < 4 { self.x.low } else { self.x.high };
        let pair = if k & 2 == 0 {
            Vec2::new(half.x, half.y)
        } else {
            Vec2::new(half.z, half.w)
        };
        Vec2::new(if k & 1 == 0 { pair.x } else { pair.y }, self.y)
    }
}
