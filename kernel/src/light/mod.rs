//! [`Light`]: a light, and how it is sampled from a point. Runs on the GPU and on the CPU.
//!
//! Spheres of light are sampled by the solid angle that they fill: P. Shirley, C. Wang and K.
//! Zimmerman, Monte Carlo techniques for direct lighting calculations, ACM Trans. Graph. 15 (1996).

pub mod sky;
pub mod tree;

use core::f32::consts::TAU;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
// On the CPU, std has `f32::sqrt`.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use crate::arithmetic::elements::{Bisection, read};
use crate::path::sampling::{Pair, cone, cone_density};
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
/// one of probability zero. And where `u` is among the numbers that choose that light, from 0 up to
/// 1: a random number, too.
#[inline]
#[must_use]
pub(crate) fn choose(lights: &[Light], u: f32) -> (Light, f32) {
    let mut search = Bisection::below(lights.len().max(1) - 1);
    while search.is_open() {
        search.narrow(u < read(lights, search.middle()).cumulative);
    }
    let chosen = search.low;
    let light = read(lights, chosen);
    let below = if chosen > 0 {
        read(lights, chosen - 1).cumulative
    } else {
        0.0
    };
    let share = (u - below) / (light.cumulative - below).max(f32::MIN_POSITIVE);
    (light, share.clamp(0.0, BELOW_ONE))
}

/// The largest number below 1.
const BELOW_ONE: f32 = 1.0 - 1.0 / (1 << 24) as f32;

/// A direction in which a sphere is seen from `point`, and its density; the whole sphere of
/// directions from inside.
#[inline]
#[must_use]
pub fn sample_sphere(sphere: Sphere, point: Vec3, pair: Pair) -> (Vec3, f32) {
    let towards = sphere.center() - point;
    let squared = towards.dot(towards);
    let height = cone_height(sphere, squared);
    let axis = if squared > 0.0 {
        towards / squared.sqrt()
    } else {
        Vec3::Z
    };
    (cone(axis, height, pair), cone_density(height))
}

/// The density of [`sample_sphere`] in a direction that meets the sphere.
#[inline]
#[must_use]
pub fn sphere_density(sphere: Sphere, point: Vec3) -> f32 {
    let towards = sphere.center() - point;
    cone_density(cone_height(sphere, towards.dot(towards)))
}

/// 1 − cos of the angle between the middle and the edge of the cap of a lamp from which any light
/// reaches a ball. Not above zero if there is none. Where a lamp's normal is n, light reaches what
/// is above its tangent plane, and a ball of radius r has points there if (C − L) · n + r > ρ.
#[inline]
#[must_use]
pub fn cap_height(lamp: Sphere, ball: Sphere) -> f32 {
    let apart = (ball.center() - lamp.center()).length();
    let edge = (lamp.radius().abs() - ball.radius().abs()) / apart.max(f32::MIN_POSITIVE);
    1.0 - edge.max(-1.0)
}

/// 1 − cos of the angle between the middle and the edge of a sphere seen from the distance whose
/// square is given; from inside 2, which makes all directions a cone. Without cancellation for
/// small angles, and without a branch.
#[inline]
fn cone_height(sphere: Sphere, squared_distance: f32) -> f32 {
    let squared_sine = sphere.radius() * sphere.radius() / squared_distance;
    let height = squared_sine / (1.0 + (1.0 - squared_sine).max(0.0).sqrt());
    if squared_sine < 1.0 {
        // So that its density is a number.
        height.max(f32::MIN_POSITIVE)
    } else {
        2.0
    }
}

/// The solid angle of a cone of this height.
#[inline]
#[must_use]
pub fn solid_angle(height: f32) -> f32 {
    TAU * height
}

const _: () = assert!(size_of::<Light>() == 48);

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;

    fn lights<const N: usize>(cumulative: [f32; N]) -> [Light; N] {
        cumulative.map(|cumulative| Light {
            cumulative,
            ..Light::default()
        })
    }

    /// What is left of the number that chooses a light goes evenly from 0 up to 1, for each light.
    #[test]
    fn what_a_choice_leaves_is_a_random_number() {
        const STEPS: u32 = 1 << 14;
        let lights = lights([0.1, 0.1, 0.75, 1.0]);
        let mut seen = [[0_u32; 4]; 4];
        for step in 0..STEPS {
            let (light, left) = choose(&lights, step as f32 / STEPS as f32);
            let index = lights.iter().position(|other| other == &light);
            assert!((0.0..1.0).contains(&left), "{left}");
            seen[index.expect("one of them")][(left * 4.0) as usize] += 1;
        }
        for (index, share) in [0.1, 0.0, 0.65, 0.25].into_iter().enumerate() {
            for count in seen[index] {
                let expected = 0.25 * share * STEPS as f32;
                assert!((count as f32 - expected).abs() <= 2.0, "{index}: {count}");
            }
        }
    }

    /// Numbers beyond the last light, and no lights, choose something.
    #[test]
    fn every_number_chooses() {
        let lights = lights([0.5, 0.999]);
        assert_eq!(choose(&lights, 0.9999).0, lights[1]);
        let (none, left) = choose(&[], 0.3);
        assert!(none.probability == 0.0 && (0.0..1.0).contains(&left));
    }

    /// The density of a lamp's directions is one over the solid angle in which it is seen; from
    /// inside, over that of all directions, which have no mean.
    #[test]
    fn a_lamp_is_sampled_where_it_is_seen() {
        let lamp = Sphere::new(Vec3::new(0.0, 3.0, 0.0), 1.0);
        for (point, solid) in [
            (Vec3::ZERO, TAU * (1.0 - (8.0_f32 / 9.0).sqrt())),
            (lamp.center(), 2.0 * TAU),
            (Vec3::new(0.5, 3.0, 0.0), 2.0 * TAU),
        ] {
            assert!((sphere_density(lamp, point) * solid - 1.0).abs() < 1e-5);
            let mut mean = Vec3::ZERO;
            for step in 0..1024 {
                let u = Vec2::new(step as f32 + 0.5, (step * 37 % 1024) as f32 + 0.5) / 1024.0;
                let (direction, density) = sample_sphere(lamp, point, Pair::of(u));
                assert!((density * solid - 1.0).abs() < 1e-5);
                assert!((direction.length() - 1.0).abs() < 1e-5);
                mean += direction / 1024.0;
            }
            // The mean cosine of a cone is that of the middle of its height.
            let expected = 1.0 - solid / (2.0 * TAU);
            assert!((mean.length() - expected).abs() < 1e-2, "{mean}");
        }
        // Too small to be seen.
        let (_, density) =
            sample_sphere(Sphere::new(Vec3::Y, 0.0), Vec3::ZERO, Pair::of(Vec2::ZERO));
        assert!(density.is_finite());
    }
}
