//! Brute force at a GPU's rate: two operations a test that tell which spheres a rung must be asked about.
//! Runs on the GPU and on the CPU.
//!
//! Seen from an eye outside of it, a sphere fills a cone. With o = C − O, c = o·o − r² and h = o/√c, a line along d
//! that goes forward meets the sphere where d·h ≥ |d|, which is cos θ ≥ √(1 − r²/o·o). A camera's d is F + x R + y U, so that
//! d·h = x (R·h) + (y (U·h) + F·h): the three products are shared by all rays, the bracket by a row of pixels, and
//! |d| by all spheres.
//!
//! In 32-bit floats, u = 2⁻²⁴, cos θ is off by 48u at most: d and its product by 10u (|F| + |x R| + |y U|), of which
//! the bracket is 2|d| at most for directions that [`Row`] lets pass, |d| by 12u and 1/√c by 16u where a root
//! and a quotient are as bad as Vulkan allows. c is off by 6u (o·o + r²), and what a rung calls a hit the exact numbers may miss by
//! 24u (o·o + r²), as the rungs' modules say. Roots of numbers up to 1 that are apart by δ are apart by δ/2; c is therefore taken less by
//! 128u (o·o + r²), (128 − 6 − 24)/2 being 49, and no rung's hit is passed by. Behind an eye that is
//! outside by as much as that no rung hits.

use glam::{Vec2, Vec3, Vec4};
// On the CPU, std has `f32::sqrt`.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use crate::camera::Camera;
use crate::instructions::larger;
use crate::ray::Ray;
use crate::sphere::Sphere;

/// 128u.
const SLACK: f32 = 1.0 / (1 << 17) as f32;
/// Where c and its root are far from underflow and overflow.
const SMALLEST: f32 = 1.0 / LARGEST;
const LARGEST: f32 = (1_u128 << 100) as f32;

/// What a camera's rays share of a sphere: R·h, U·h and F·h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone(Vec4);

impl Cone {
    /// Of a sphere; one that the eye is in, or near, or too far from for 32 bits is met by all rays.
    #[inline]
    #[must_use]
    pub fn of(sphere: Sphere, camera: &Camera) -> Self {
        let o = sphere.center() - camera.eye;
        let (oo, rr) = (o.dot(o), sphere.radius() * sphere.radius());
        let c = (oo - rr) - SLACK * (oo + rr);
        if (c > SMALLEST) & (c < LARGEST) {
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
    /// |d|; the least of all numbers for a ray that is asked about every sphere.
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
        let of = |x| length(camera, Vec2::new(x, y));
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

    /// The farthest reaches among none.
    #[inline]
    #[must_use]
    pub fn nothing() -> Reach {
        let none = Bits {
            x: i32::MIN,
            y: i32::MIN,
            z: i32::MIN,
            w: i32::MIN,
        };
        Reach(Eight {
            low: none,
            high: none,
        })
    }

    /// The farthest reaches among two more cones.
    #[inline]
    #[must_use]
    pub fn farther(&self, so_far: Reach, first: Cone, second: Cone) -> Reach {
        let (first, second) = (self.reach(first), self.reach(second));
        Reach(Eight {
            low: so_far.0.low.farther(first.low, second.low),
            high: so_far.0.high.farther(first.high, second.high),
        })
    }

    /// Whether any of the rays may meet any of the spheres.
    #[inline]
    #[must_use]
    pub fn may_meet(&self, reach: Reach) -> bool {
        let (low, high) = (reach.0.low, reach.0.high);
        low.reaches(self.lengths.low) | high.reaches(self.lengths.high)
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

/// For each of eight rays, the farthest d·h.
#[derive(Clone, Copy, Debug)]
pub struct Reach(Eight<Bits>);

/// Floats by their bits, compared as integers: that is their order where one of two is not negative, and
/// one of those that are none is above all numbers.
#[derive(Clone, Copy, Debug)]
struct Bits {
    x: i32,
    y: i32,
    z: i32,
    w: i32,
}

impl Bits {
    /// The larger of three, which newer GPUs find by one instruction.
    #[inline]
    fn farther(self, first: Vec4, second: Vec4) -> Self {
        let of = |a, b: f32, c: f32| {
            larger(
                larger(a, b.to_bits().cast_signed()),
                c.to_bits().cast_signed(),
            )
        };
        Self {
            x: of(self.x, first.x, second.x),
            y: of(self.y, first.y, second.y),
            z: of(self.z, first.z, second.z),
            w: of(self.w, first.w, second.w),
        }
    }

    /// Whether any is at least as large as its length. What is no number is.
    #[inline]
    fn reaches(self, lengths: Vec4) -> bool {
        let number = |bits: i32| f32::from_bits(bits.cast_unsigned());
        let is_short = (number(self.x) < lengths.x)
            & (number(self.y) < lengths.y)
            & (number(self.z) < lengths.z)
            & (number(self.w) < lengths.w);
        !is_short
    }
}

/// |d|, or the least of all numbers where R, U and F are so far from a right angle, or so large, that the bound does not hold.
#[inline]
fn length(camera: &Camera, film: Vec2) -> f32 {
    let Ray { direction, .. } = camera.ray(film);
    let across = film.x * film.x * camera.right.dot(camera.right);
    let upwards = film.y * film.y * camera.up.dot(camera.up);
    let parts = camera.forward.dot(camera.forward) + across + upwards;
    let squared = direction.dot(direction);
    // (|F| + |x R| + |y U|)² is at most three times `parts`, and is to be at most four times `squared`.
    if (parts <= squared * 1.33) & (squared > SMALLEST) & (squared < LARGEST) {
        squared.sqrt()
    } else {
        f32::MIN
    }
}
