//! [`Light`]: a light, and how it is sampled from a point. Runs on the GPU and on the CPU.
//!
//! Spheres of light are sampled by the solid angle that they fill: P. Shirley, C. Wang and K.
//! Zimmerman, Monte Carlo techniques for direct lighting calculations, ACM Trans. Graph. 15 (1996).

pub mod sky;
pub mod tree;

use core::f32::consts::{FRAC_1_PI, TAU};

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};
// On the CPU, std has `f32::sqrt`.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use crate::arithmetic::elements::read;
use crate::path::sampling::{cone, cone_density, uniform_sphere};
use crate::sphere::Sphere;

/// A light that is sampled. One is chosen at a time, by its probability. In a [tree] of
/// lights some fields mean something else.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Light {
    /// A point's place; the unit vector towards the sun.
    pub position: Vec3,
    /// The kind, one of the constants.
    pub kind: u32,
    /// A point's radiant intensity, the sun's radiance or, if it has no extent, its irradiance, a
    /// sphere's radiance.
    pub color: Vec3,
    /// The probability that this light or one before it is chosen.
    pub cumulative: f32,
    /// The probability that this light is chosen.
    pub probability: f32,
    /// A sphere's index in the world.
    pub sphere: u32,
    /// One minus the cosine of the angle between the sun's middle and its edge; zero for a sun
    /// without extent.
    pub height: f32,
    /// In a [tree] of lights, the entry of another light.
    pub leaf: u32,
}

impl Light {
    /// A point of light.
    pub const POINT: u32 = 0;
    /// A sphere of the world that glows.
    pub const SPHERE: u32 = 1;
    /// The sun.
    pub const SUN: u32 = 2;
    /// The image of the surroundings.
    pub const ENVIRONMENT: u32 = 3;
    /// Several lights of a [tree].
    pub const NODE: u32 = 4;

    /// A point of light of this radiant intensity, per steradian.
    #[must_use]
    pub fn point(position: Vec3, intensity: Vec3) -> Self {
        Self {
            position,
            color: intensity,
            kind: Self::POINT,
            ..Self::default()
        }
    }

    /// The sphere of the world with this index and this radiance.
    #[must_use]
    pub fn sphere(index: u32, radiance: Vec3) -> Self {
        Self {
            sphere: index,
            color: radiance,
            kind: Self::SPHERE,
            ..Self::default()
        }
    }

    /// A sun in the direction of this unit vector. With a `height` above zero, 1 − cos of the angle
    /// between its middle and its edge, `color` is its radiance; with zero, its irradiance.
    #[must_use]
    pub fn sun(direction: Vec3, height: f32, color: Vec3) -> Self {
        Self {
            position: direction,
            height,
            color,
            kind: Self::SUN,
            ..Self::default()
        }
    }

    /// The image of the surroundings.
    #[must_use]
    pub fn environment() -> Self {
        Self {
            kind: Self::ENVIRONMENT,
            ..Self::default()
        }
    }
}

/// The light that `u` chooses: the first whose cumulative probability exceeds it. Without lights,
/// one of probability zero.
#[inline]
#[must_use]
pub(crate) fn choose(lights: &[Light], u: f32) -> Light {
    let mut low = 0;
    let mut high = lights.len().max(1) - 1;
    while low < high {
        let middle = low + (high - low) / 2;
        if u < read(lights, middle).cumulative {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    read(lights, low)
}

/// A direction in which a sphere is seen from `point`, and its density; the whole sphere of
/// directions from inside.
#[inline]
#[must_use]
pub fn sample_sphere(sphere: Sphere, point: Vec3, u: Vec2) -> (Vec3, f32) {
    let towards = sphere.center() - point;
    let squared = towards.dot(towards);
    let height = cone_height(sphere, squared);
    if height > 0.0 {
        let direction = cone(towards / squared.sqrt(), height, u);
        (direction, cone_density(height))
    } else {
        (uniform_sphere(u), 0.25 * FRAC_1_PI)
    }
}

/// The density of [`sample_sphere`] in a direction that meets the sphere.
#[inline]
#[must_use]
pub fn sphere_density(sphere: Sphere, point: Vec3) -> f32 {
    let towards = sphere.center() - point;
    let height = cone_height(sphere, towards.dot(towards));
    if height > 0.0 {
        cone_density(height)
    } else {
        0.25 * FRAC_1_PI
    }
}

/// 1 − cos of the angle between the middle and the edge of the cap of a lamp from which any light
/// reaches a ball. Not above zero if there is
/// none. Where a lamp's normal is n, light reaches what is above its tangent plane, and a ball of
/// radius r has points there if (C − L) · n + r > ρ.
#[inline]
#[must_use]
pub fn cap_height(lamp: Sphere, ball: Sphere) -> f32 {
    let apart = (ball.center() - lamp.center()).length();
    let edge = (lamp.radius().abs() - ball.radius().abs()) / apart.max(f32::MIN_POSITIVE);
    1.0 - edge.max(-1.0)
}

/// 1 − cos of the angle between the middle and the edge of a sphere seen from the distance whose
/// square is given; zero from inside. Without cancellation for small angles.
#[inline]
fn cone_height(sphere: Sphere, squared_distance: f32) -> f32 {
    let squared_sine = sphere.radius() * sphere.radius() / squared_distance;
    if squared_sine < 1.0 {
        squared_sine / (1.0 + (1.0 - squared_sine).sqrt())
    } else {
        0.0
    }
}

/// The solid angle of a cone of this height.
#[inline]
#[must_use]
pub fn solid_angle(height: f32) -> f32 {
    TAU * height
}

const _: () = assert!(size_of::<Light>() == 48);
