//! Random directions and points, made of pairs of uniform random numbers. Runs on the GPU and on
//! the CPU.

use core::f32::consts::{FRAC_1_PI, TAU};

use glam::{Vec2, Vec3};
// On the CPU, std has these functions.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use crate::arithmetic::turn::turn;
use crate::surface::unit;

/// Two random numbers from 0 up to, but not including, 1, of which a direction is made.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pair {
    /// The numbers.
    pub u: Vec2,
    /// The second number as a [turn].
    pub turn: Vec2,
}

impl Pair {
    /// The pair of these numbers.
    #[inline]
    #[must_use]
    pub fn of(u: Vec2) -> Self {
        Self { u, turn: turn(u.y) }
    }
}

/// Two unit vectors that form a right-handed basis with the unit vector `normal` (T. Duff et al.,
/// Building an Orthonormal Basis, Revisited, J. Comput. Graph. Tech. 6 (2017)).
#[inline]
#[must_use]
pub fn tangents(normal: Vec3) -> (Vec3, Vec3) {
    let sign = if normal.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    (
        Vec3::new(
            1.0 + sign * normal.x * normal.x * a,
            sign * b,
            -sign * normal.x,
        ),
        Vec3::new(b, sign + normal.y * normal.y * a, -normal.y),
    )
}

/// A unit vector, uniform over the sphere.
#[inline]
#[must_use]
pub fn uniform_sphere(pair: Pair) -> Vec3 {
    let z = 1.0 - 2.0 * pair.u.x;
    let r = (1.0 - z * z).max(0.0).sqrt();
    (pair.turn * r).extend(z)
}

/// A unit vector about the unit vector `normal` with the density cos θ / π: a point on the unit
/// sphere that touches the surface, seen from where it touches.
#[inline]
#[must_use]
pub fn cosine_hemisphere(normal: Vec3, pair: Pair) -> Vec3 {
    let direction = unit(normal + uniform_sphere(pair));
    // Exactly opposite, once in 2²⁴ times or so.
    if direction.dot(normal) > 0.0 {
        direction
    } else {
        normal
    }
}

/// The density of [`cosine_hemisphere`].
#[inline]
#[must_use]
pub fn cosine_density(cosine: f32) -> f32 {
    cosine.max(0.0) * FRAC_1_PI
}

/// A unit vector uniform in the cone about the unit vector `axis` whose edge is at the cosine
/// 1 − `height`.
#[inline]
#[must_use]
pub fn cone(axis: Vec3, height: f32, pair: Pair) -> Vec3 {
    let below = height * pair.u.x;
    let sine = (below * (2.0 - below)).max(0.0).sqrt();
    let around = pair.turn * sine;
    let (x, y) = tangents(axis);
    unit(x * around.x + y * around.y + axis * (1.0 - below))
}

/// The density of [`cone`], inside of it.
#[inline]
#[must_use]
pub fn cone_density(height: f32) -> f32 {
    1.0 / (TAU * height)
}

/// A point uniform in the unit disc.
#[inline]
#[must_use]
pub fn disc(pair: Pair) -> Vec2 {
    pair.turn * pair.u.x.sqrt()
}

/// The weight of a sample of density `own` where another way would have had the density `other`:
/// the power heuristic (E. Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997,
/// § 9.2.4).
#[inline]
#[must_use]
pub fn power_heuristic(own: f32, other: f32) -> f32 {
    // Of the ratio, so that no square overflows.
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}
