//! A tree over lights: chooses one by what it may give to a point. Runs on the GPU and on the CPU.
//!
//! The more a light may give, the likelier it is chosen: from the top of the tree down, a child is
//! chosen by its power, its distance, and how it lies to the surface (A. Conty Estevez and C.
//! Kulla, Importance sampling of many lights with adaptive tree splitting, Proc. ACM Comput. Graph.
//! 1 (2018), without its splitting; lights here shine alike in all directions).
//!
//! L lights make a tree of the entries 1 to 2L − 1. The children of entry i are 2i and 2i + 1; the
//! entries from L on are the lights, the ones before are of kind [`Light::NODE`]. Lights without a
//! place follow, the sun say, of equal probabilities. Some fields have other meanings than in a
//! list of lights:
//!
//! | field | meaning |
//! | --- | --- |
//! | `position`, `height` | centre and radius of a ball around all that shines |
//! | `probability` | the power |
//! | `cumulative` of entry 0 | the probability that a light of the tree is chosen |
//! | `sphere` of entry 0 | 2L, or 1 without a tree: where the lights without a place begin |
//! | `sphere` of a point | `u32::MAX` |
//! | `leaf` of entry L + k | which entry is the k-th of the spheres, in order of index |

use glam::Vec3;
// On the CPU, std has `f32::sqrt`.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use super::Light;
use crate::arithmetic::elements::{Bisection, read};

/// The least cosine that counts, so that rounding makes no light impossible that gives a little.
const LEAST_COSINE: f32 = 1.0 / 1024.0;
/// The least and the largest power over squared distance, so that sums and quotients are normal.
const LEAST: f32 = 1e-30;
const MOST: f32 = 1e37;

/// A measure of what the lights in an entry may give to a surface at `point` whose normal on the
/// side of the path is `facing`; zero for a point in fog. It is above zero.
///
/// The power, over the square of the distance, times the largest cosine that a direction into the
/// ball may have. Where the ball is nearer than its radius, the radius counts as the distance.
#[inline]
fn importance(entry: &Light, point: Vec3, facing: Vec3) -> f32 {
    let towards = entry.position - point;
    let squared = towards.dot(towards);
    let radius = entry.height;
    let nearest = (radius * radius).max(f32::MIN_POSITIVE);
    let mut cosine = 1.0;
    if (squared > nearest) & (facing.dot(facing) > 0.0) {
        // cos(θ − γ), where the ball fills directions up to the angle γ around one at θ from the
        // normal.
        let squared_sine = nearest / squared;
        let edge = (1.0 - squared_sine).sqrt();
        let middle = (facing.dot(towards) / squared.sqrt()).clamp(-1.0, 1.0);
        if middle < edge {
            let aside = ((1.0 - middle * middle) * squared_sine).sqrt();
            cosine = (middle * edge + aside).max(LEAST_COSINE);
        }
    }
    cosine * (entry.probability / squared.max(nearest)).clamp(LEAST, MOST)
}

/// The probability that the first child of entry `parent` is chosen rather than the second.
#[inline]
fn first_share(lights: &[Light], parent: usize, point: Vec3, facing: Vec3) -> f32 {
    let first = importance(&read(lights, 2 * parent), point, facing);
    let second = importance(&read(lights, 2 * parent + 1), point, facing);
    first / (first + second)
}

/// The light that `u` chooses for a place, with the probability of that.
#[inline]
#[must_use]
pub fn choose(lights: &[Light], point: Vec3, facing: Vec3, u: f32) -> Light {
    let top = read(lights, 0);
    let (end, local) = (top.sphere as usize, top.cumulative);
    if u >= local {
        let probability = read(lights, end).probability;
        let place = (u - local) / probability.max(f32::MIN_POSITIVE);
        let last = lights.len().max(end + 1) - 1;
        return read(lights, end.wrapping_add(place as usize).min(last));
    }
    let mut u = u / local;
    let mut probability = local;
    let mut index = 1;
    while 2 * index < end {
        let share = first_share(lights, index, point, facing);
        if u < share {
            u /= share;
            probability *= share;
            index *= 2;
        } else {
            u = (u - share) / (1.0 - share).max(f32::MIN_POSITIVE);
            probability *= 1.0 - share;
            index = 2 * index + 1;
        }
    }
    Light {
        probability,
        ..read(lights, index)
    }
}

/// The probability that [`choose`] chooses the sphere with this index for a place; zero if it is no
/// light.
#[inline]
#[must_use]
pub fn probability_of(lights: &[Light], sphere: u32, point: Vec3, facing: Vec3) -> f32 {
    let top = read(lights, 0);
    let count = top.sphere as usize / 2;
    let mut search = Bisection::below(count);
    while search.is_open() {
        let leaf = ordered(lights, count, search.middle());
        search.narrow(read(lights, leaf).sphere >= sphere);
    }
    let leaf = ordered(lights, count, search.low.min(count.max(1) - 1));
    if read(lights, leaf).sphere != sphere {
        return 0.0;
    }
    // From the light up to the top.
    let mut probability = top.cumulative;
    let mut index = leaf;
    while index > 1 {
        let share = first_share(lights, index / 2, point, facing);
        probability *= if index & 1 == 0 { share } else { 1.0 - share };
        index /= 2;
    }
    probability
}

/// The entry of the `k`-th of `count` lights, in the order of the spheres' indices.
#[inline]
fn ordered(lights: &[Light], count: usize, k: usize) -> usize {
    read(lights, count + k).leaf as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four spheres and a point, in a tree, and two lights without a place.
    fn lights() -> [Light; 12] {
        let light = |position: Vec3, height: f32, probability: f32, sphere: u32| Light {
            position,
            height,
            probability,
            sphere,
            kind: if sphere == u32::MAX {
                Light::POINT
            } else {
                Light::SPHERE
            },
            ..Light::default()
        };
        let node = |position: Vec3, height: f32, probability: f32| Light {
            kind: Light::NODE,
            ..light(position, height, probability, 0)
        };
        let far = Light {
            kind: Light::SUN,
            probability: 0.25,
            ..Light::default()
        };
        let mut lights = [
            Light {
                cumulative: 0.5,
                sphere: 10,
                ..Light::default()
            },
            node(Vec3::ZERO, 9.0, 21.0),
            node(Vec3::X * 3.0, 3.0, 10.0),
            node(Vec3::X * -5.0, 3.0, 11.0),
            node(Vec3::X * 5.0, 1.0, 3.0),
            light(Vec3::X, 0.5, 7.0, 20),
            light(Vec3::X * -3.0, 0.1, 8.0, 3),
            light(Vec3::X * -7.0, 0.0, 3.0, u32::MAX),
            light(Vec3::X * 5.5, 0.5, 1.0, 7),
            light(Vec3::X * 4.5, 0.5, 2.0, 40),
            far,
            far,
        ];
        for (k, leaf) in [6, 8, 5, 9, 7].into_iter().enumerate() {
            lights[5 + k].leaf = leaf;
        }
        lights
    }

    fn places() -> [(Vec3, Vec3); 5] {
        [
            (Vec3::new(0.0, -2.0, 0.0), Vec3::Y),
            (Vec3::new(4.0, 0.1, 0.3), Vec3::X),
            (Vec3::new(-40.0, 0.0, 1.0), Vec3::new(0.0, 0.6, 0.8)),
            (Vec3::new(-3.0, 0.05, 0.0), Vec3::ZERO),
            (Vec3::new(1e6, 1e6, 0.0), -Vec3::Y),
        ]
    }

    /// Each light is chosen as often as it is said to be, and the probabilities add up to one.
    #[test]
    #[cfg_attr(miri, ignore = "millions of choices take Miri hours")]
    fn choices_have_their_probabilities() {
        const COUNT: u32 = 1 << 18;
        let lights = lights();
        for (point, facing) in places() {
            let mut sum = 0.0;
            for index in [5_usize, 6, 8, 9, 7, 10] {
                let of = lights[index];
                let mut found = 0;
                let mut probability = 0.0;
                for i in 0..COUNT {
                    let u = (f64::from(i) + 0.5) / f64::from(COUNT);
                    let chosen = choose(&lights, point, facing, u as f32);
                    if (chosen.kind, chosen.sphere) == (of.kind, of.sphere) {
                        found += 1;
                        probability = chosen.probability;
                    }
                }
                // Both lights without a place are alike.
                let times = if of.kind == Light::SUN { 2.0 } else { 1.0 };
                let share = f64::from(found) / f64::from(COUNT);
                let expected = f64::from(probability) * times;
                assert!((share - expected).abs() < 4.0 / f64::from(COUNT), "{of:?}");
                if of.kind == Light::SPHERE {
                    let other = probability_of(&lights, of.sphere, point, facing);
                    assert!((other - probability).abs() <= 1e-6 * other, "{of:?}");
                }
                sum += expected;
            }
            assert!((sum - 1.0).abs() < 1e-5, "{point} {sum}");
        }
    }

    #[test]
    fn other_spheres_are_no_lights() {
        let lights = lights();
        let (point, facing) = places()[0];
        for sphere in [0, 4, 10, 19, 21, 41, u32::MAX - 1] {
            assert_eq!(probability_of(&lights, sphere, point, facing), 0.0);
        }
        for none in [&[][..], &[Light::default()]] {
            assert_eq!(probability_of(none, 0, point, facing), 0.0);
            assert_eq!(choose(none, point, facing, 0.5), Light::default());
        }
    }

    /// A light is chosen rarely only where it gives little: behind the surface, or far away.
    #[test]
    fn what_gives_more_is_likelier() {
        let lights = lights();
        let chance = |sphere, point, facing| probability_of(&lights, sphere, point, facing);
        let near = Vec3::new(1.0, 0.7, 0.0);
        assert!(chance(20, near, -Vec3::Y) > 0.35);
        assert!(chance(20, Vec3::new(2.0, 0.0, 0.0), Vec3::X) < 0.02);
        assert!(chance(3, Vec3::new(-2.5, 0.0, 0.0), -Vec3::X) > 0.4);
    }
}
