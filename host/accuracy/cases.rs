//! The hard cases: named inputs on which ray tracers of spheres go wrong, each with the answer of
//! exact arithmetic.
//!
//! The numbers are those of the catalogue in `docs/numerics.md`. Each case lists the rungs that
//! promise it: the lower rungs show what goes wrong without the promise.

use glam::Vec3;
use serde::Serialize;
use spherule_kernel::{Hit, Ray, Rung, Sphere, Surface};

use super::measure::intersect_all;
use super::oracle::{Intersection, Root};
use crate::device::Device;
use crate::error::Result;
use crate::random::Random;
use crate::ulp;

/// A ray and a sphere, and the answer that is required.
#[derive(Clone, Copy, Debug)]
struct Probe {
    ray: Ray,
    sphere: Sphere,
    must: Must,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Must {
    /// The oracle's answer: a miss, or a hit within this many units in the last place.
    BeTrue(u32),
    /// A miss.
    Miss,
    /// A hit or a miss, but not NaN.
    BeDefined,
    /// The bits of the previous probe's answer, times this power of two.
    EqualLastTimes(f32),
}

/// A hard case.
#[derive(Debug)]
pub struct Case {
    /// Its number in the catalogue.
    pub number: u8,
    /// Its name.
    pub name: &'static str,
    probes: Vec<Probe>,
    promised_by: &'static [Rung],
}

/// A rung's result on a case.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "verdict", content = "example")]
pub enum Verdict {
    /// Right on every input.
    Holds,
    /// Wrong on some input, on a case that the rung does not promise.
    FailsUnpromised(String),
    /// Wrong on some input, on a case that the rung promises.
    Fails(String),
}

impl Verdict {
    /// The verdict for `wrong`, which says what is wrong, if anything.
    #[must_use]
    pub fn of(wrong: Option<String>, promised: bool) -> Self {
        match wrong {
            None => Self::Holds,
            Some(wrong) if promised => Self::Fails(wrong),
            Some(wrong) => Self::FailsUnpromised(wrong),
        }
    }

    /// Whether a promise is broken.
    #[must_use]
    pub fn is_broken(&self) -> bool {
        matches!(self, Self::Fails(_))
    }
}

pub(super) const ALL: &[Rung] = &Rung::ALL;
pub(super) const UPPER: &[Rung] = &[Rung::Compensated, Rung::Double, Rung::Certified];
pub(super) const BOUNDED: &[Rung] = &[
    Rung::Robust,
    Rung::Compensated,
    Rung::Double,
    Rung::Certified,
];
pub(super) const CERTIFIED: &[Rung] = &[Rung::Certified];

impl Case {
    /// The rays of the case, each with its sphere.
    pub fn samples(&self) -> impl Iterator<Item = (Ray, Sphere)> {
        self.probes.iter().map(|probe| (probe.ray, probe.sphere))
    }

    /// Those of which exact arithmetic says what the answer is.
    pub fn decided(&self) -> impl Iterator<Item = (Ray, Sphere)> {
        let is_decided = |probe: &&Probe| matches!(probe.must, Must::BeTrue(_) | Must::Miss);
        let decided = self.probes.iter().filter(is_decided);
        decided.map(|probe| (probe.ray, probe.sphere))
    }

    /// The verdict on `rung` for this case on `device`.
    ///
    /// # Errors
    ///
    /// [`RungRefused`](crate::Error::RungRefused) if the canary objects, and the device's errors.
    pub fn judge(&self, device: &Device, rung: Rung) -> Result<Verdict> {
        let samples: Vec<(Ray, Sphere)> = self.samples().collect();
        let answers = intersect_all(device, rung, &samples)?;
        let mut last = 0.0;
        for (probe, found) in self.probes.iter().zip(answers) {
            if let Some(wrong) = probe.objection(found, last) {
                return Ok(Verdict::of(Some(wrong), self.promised_by.contains(&rung)));
            }
            last = found;
        }
        Ok(Verdict::Holds)
    }
}

impl Probe {
    /// What is wrong with an answer, if anything, with the bits of the input's floats.
    fn objection(&self, found: f32, last: f32) -> Option<String> {
        let truth =
            || Intersection::of(&self.ray, &self.sphere).and_then(|exact| exact.nearest(&self.ray));
        let said = |t: Option<f32>| t.map_or("a miss".to_owned(), |t| format!("t = {t:e}"));
        let answer = (found < Hit::NONE_T).then_some(found);
        let complaint = match self.must {
            _ if found.is_nan() => Some("NaN".to_owned()),
            Must::BeDefined => None,
            Must::Miss => answer.map(|_| format!("{}, must miss", said(answer))),
            Must::BeTrue(tolerance) => {
                let truth = truth();
                let right = match (answer, truth) {
                    (None, None) => true,
                    (Some(a), Some(b)) => ulp::distance(a, b) <= tolerance,
                    _ => false,
                };
                (!right).then(|| format!("{}, truth is {}", said(answer), said(truth)))
            }
            Must::EqualLastTimes(factor) => {
                let expected = if last < Hit::NONE_T {
                    last * factor
                } else {
                    last
                };
                (found.to_bits() != expected.to_bits())
                    .then(|| format!("{}, must be {expected:e}", said(answer)))
            }
        }?;
        let bits = |v: Vec3| {
            v.to_array()
                .map(|x| format!("{:08x}", x.to_bits()))
                .join(" ")
        };
        Some(format!(
            "{complaint} (origin {}, direction {}, centre {}, radius {:08x})",
            bits(self.ray.origin),
            bits(self.ray.direction),
            bits(self.sphere.center()),
            self.sphere.radius().to_bits()
        ))
    }
}

/// An entry of the catalogue.
struct Entry {
    number: u8,
    name: &'static str,
    promised_by: &'static [Rung],
    probes: fn(&mut Probes, &mut Random),
}

/// The catalogue, one entry a case. The cases draw from one stream of random numbers in this order:
/// a case that is added last leaves the inputs of the others as they are.
const CATALOGUE: &[Entry] = &[
    Entry {
        number: 1,
        name: "small far sphere",
        promised_by: UPPER,
        probes: |probes, _| {
            for distance in [1e3, 1e4, 1e5, 1e6] {
                for across in [0.0, 0.3, 0.6, 0.9] {
                    probes.truth(
                        ray(v(0.1, 0.2, 0.3), v(0.0, 0.0, -1.0)),
                        v(0.1 + across, 0.2, -distance),
                        1.0,
                    );
                }
            }
        },
    },
    Entry {
        number: 2,
        name: "unit sphere beyond distance 4096",
        promised_by: UPPER,
        probes: |probes, _| {
            for across in [0.0, 0.5, 0.99, 0.999, 1.001, 1.01, 1.5] {
                probes.truth(ahead(), v(across, 0.0, -8192.0), 1.0);
            }
        },
    },
    Entry {
        number: 3,
        name: "ground sphere of radius 1000, camera at 1",
        promised_by: UPPER,
        probes: |probes, random| above_ground(probes, random, 1.0, 1000.0),
    },
    Entry {
        number: 4,
        name: "Earth, camera at 0.1",
        promised_by: CERTIFIED,
        probes: |probes, random| above_ground(probes, random, 0.1, 6.4e6),
    },
    Entry {
        number: 5,
        name: "exactly tangent, Pythagorean",
        promised_by: UPPER,
        probes: |probes, _| {
            for (p, q, r) in [
                (3.0, 4.0, 5.0),
                (5.0, 12.0, 13.0),
                (8.0, 15.0, 17.0),
                (20.0, 21.0, 29.0),
            ] {
                let touch = ray(v(p - 2.0 * q, q + 2.0 * p, 0.0), v(q, -p, 0.0));
                probes.truth(touch, Vec3::ZERO, r);
            }
        },
    },
    Entry {
        number: 6,
        name: "Δ the smallest number above and below zero",
        promised_by: CERTIFIED,
        probes: |probes, _| {
            for (p, q, r) in [
                (3.0_f32, 4.0, 5.0_f32),
                (5.0, 12.0, 13.0),
                (20.0, 21.0, 29.0),
            ] {
                let origin = v(p - 2.0 * q, q + 2.0 * p, 0.0);
                for direction in [
                    v(q, -p, 0.0),
                    v(q.next_up(), -p, 0.0),
                    v(q, -p.next_up(), 0.0),
                    v(q, -p, 1e-12),
                ] {
                    for radius in [r.next_down(), r, r.next_up()] {
                        probes.truth(ray(origin, direction), Vec3::ZERO, radius);
                    }
                }
            }
        },
    },
    Entry {
        number: 7,
        name: "tangency swept from 2⁻⁴ to 2⁻²³",
        promised_by: UPPER,
        probes: |probes, _| {
            for exponent in 4..=23 {
                let radius = 1.0 + 2.0_f32.powi(-exponent);
                let inside = 1.0 - 2.0_f32.powi(-exponent);
                let passing = ray(v(-3.0, 1.0, 0.25), v(1.0, 0.0, 0.0));
                probes.truth(passing, v(0.0, 0.0, 0.25), radius);
                probes.truth(passing, v(0.0, 0.0, 0.25), inside);
            }
        },
    },
    Entry {
        number: 8,
        name: "near root with b² ≫ ac",
        promised_by: UPPER,
        probes: |probes, _| {
            for exponent in 1..=12 {
                let height = 1.1 * 2.0_f32.powi(-exponent);
                let steep = v(0.01, 0.02, -1.0);
                probes.truth(ray(v(0.0, 0.0, 100.0 + height), steep), Vec3::ZERO, 100.0);
            }
        },
    },
    Entry {
        number: 9,
        name: "b = 0 and Δ = 0",
        promised_by: ALL,
        probes: |probes, _| probes.truth(ray(v(0.0, 1.0, 0.0), Vec3::X), Vec3::ZERO, 1.0),
    },
    Entry {
        number: 10,
        name: "c = 0 exactly: the other root",
        promised_by: UPPER,
        probes: |probes, _| {
            for direction in [v(0.0, 0.6, -0.8), v(0.0, 0.0, -1.0)] {
                let leaving = Ray::within(v(0.0, 0.0, 5.0), direction, f32::MIN_POSITIVE, f32::MAX);
                probes.truth(leaving, v(0.0, 0.0, 4.0), 1.0);
            }
        },
    },
    Entry {
        number: 11,
        name: "origin one ulp outside, leaving",
        promised_by: CERTIFIED,
        probes: |probes, _| beside_surface(probes, f32::next_up),
    },
    Entry {
        number: 12,
        name: "origin one ulp inside",
        promised_by: CERTIFIED,
        probes: |probes, _| beside_surface(probes, f32::next_down),
    },
    Entry {
        number: 13,
        name: "ray spawned at a hit: no re-hit",
        promised_by: CERTIFIED,
        probes: |probes, random| {
            // Of the same hits as in the next case.
            for Spawned { ray, sphere, .. } in spawned(&mut random.clone()) {
                probes.add(Must::Miss, ray, sphere.center(), sphere.radius());
            }
        },
    },
    Entry {
        number: 14,
        name: "spawning near the origin and far from it",
        promised_by: CERTIFIED,
        probes: |probes, random| {
            for spawned in spawned(random) {
                // The start stays within 1e-5 of the sphere's distance and radius.
                let sphere = spawned.sphere;
                let most = 1e-5 * (sphere.center().length() + sphere.radius());
                let must = if spawned.shift <= most {
                    Must::BeTrue(1)
                } else {
                    Must::Miss
                };
                probes.add(must, spawned.ray, sphere.center(), sphere.radius());
            }
        },
    },
    Entry {
        number: 15,
        name: "origin at the centre",
        promised_by: UPPER,
        probes: |probes, _| {
            for radius in [1e-3, 0.3, 7.0, 1e6] {
                for direction in [
                    Vec3::X,
                    v(0.0, -2.0, 0.0),
                    v(0.0, 0.0, 0.25),
                    v(1.0, 1.0, 1.0),
                ] {
                    probes.truth(ray(v(2.0, 3.0, 5.0), direction), v(2.0, 3.0, 5.0), radius);
                }
            }
        },
    },
    Entry {
        number: 16,
        name: "inside, looking in and out",
        promised_by: UPPER,
        probes: |probes, random| {
            for _ in 0..64 {
                let origin = random.vec3(-0.5, 0.5);
                probes.truth(ray(origin, random.unit_vec3()), Vec3::ZERO, 1.0);
            }
        },
    },
    Entry {
        number: 17,
        name: "sphere wholly behind",
        promised_by: ALL,
        probes: |probes, random| {
            for _ in 0..64 {
                let center = random.unit_vec3() * 5.0;
                let away = ray(Vec3::ZERO, -center + random.vec3(-1.0, 1.0));
                probes.add(Must::Miss, away, center, 1.0);
            }
        },
    },
    Entry {
        number: 18,
        name: "a root on either side of t_min and t_max",
        promised_by: ALL,
        probes: |probes, _| {
            // The roots are t = 2 and t = 4, exactly.
            for (t_min, t_max) in [
                (0.0, 2.0_f32),
                (0.0, 2.0_f32.next_up()),
                (2.0, 3.0),
                (2.0_f32.next_up(), 4.0),
                (2.0_f32.next_up(), 4.0_f32.next_up()),
                (4.0, 5.0),
                (4.0_f32.next_up(), 5.0),
                (0.0, 1.0),
            ] {
                let within = Ray::within(Vec3::ZERO, Vec3::NEG_Z, t_min, t_max);
                probes.truth(within, v(0.0, 0.0, -3.0), 1.0);
            }
            // The roots are t = −4 and t = −2, exactly.
            for (t_min, t_max) in [
                (-5.0, 0.0_f32),
                (-4.0, -2.0),
                ((-4.0_f32).next_down(), -4.0),
                ((-4.0_f32).next_up(), -2.0),
                ((-4.0_f32).next_up(), (-2.0_f32).next_up()),
                (-3.0, 1.0),
                (-1.0, 1.0),
            ] {
                let within = Ray::within(Vec3::ZERO, Vec3::Z, t_min, t_max);
                probes.truth(within, v(0.0, 0.0, -3.0), 1.0);
            }
        },
    },
    Entry {
        number: 19,
        name: "roots next to each other",
        promised_by: CERTIFIED,
        probes: |probes, _| {
            for t_min in [0.0, 1.0] {
                // A chord so short that its ends are neighbouring floats.
                let skim = Ray::within(v(-1.0, 1.0, 0.0), Vec3::X, t_min, f32::MAX);
                probes.truth(skim, Vec3::ZERO, 1.0);
                probes.truth(skim, Vec3::ZERO, 1.0_f32.next_up());
            }
        },
    },
    Entry {
        number: 20,
        name: "direction times powers of two",
        promised_by: UPPER,
        probes: |probes, random| {
            for _ in 0..16 {
                let origin = random.vec3(-4.0, 4.0);
                let direction = -origin + random.vec3(-0.5, 0.5);
                probes.truth(ray(origin, direction), Vec3::ZERO, 1.0);
                let mut last = 1.0;
                for exponent in [-10, -3, 1, 10] {
                    let factor = 2.0_f32.powi(exponent);
                    probes.add(
                        Must::EqualLastTimes(last / factor),
                        ray(origin, direction * factor),
                        Vec3::ZERO,
                        1.0,
                    );
                    last = factor;
                }
            }
        },
    },
    Entry {
        number: 21,
        name: "|d| = 2^±60",
        promised_by: UPPER,
        probes: |probes, _| {
            for exponent in [-60, 60] {
                let direction = v(0.1, -0.2, -1.0) * 2.0_f32.powi(exponent);
                probes.truth(ray(Vec3::ZERO, direction), v(0.0, 0.0, -3.0), 1.0);
            }
        },
    },
    Entry {
        number: 22,
        name: "d = 0",
        promised_by: ALL,
        probes: |probes, _| {
            let still = ray(v(0.1, 0.0, 0.0), Vec3::ZERO);
            probes.add(Must::Miss, still, Vec3::ZERO, 1.0);
        },
    },
    Entry {
        number: 23,
        name: "axis-aligned direction with −0",
        promised_by: ALL,
        probes: |probes, _| {
            for (zero, minus) in [
                (v(0.0, 0.0, -1.0), v(-0.0, -0.0, -1.0)),
                (v(1.0, 0.0, 0.0), v(1.0, -0.0, -0.0)),
            ] {
                let (zero, minus) = (ray(Vec3::ZERO, zero), ray(Vec3::ZERO, minus));
                for center in [v(0.25, 0.0, -3.0), v(3.0, 0.5, 0.0)] {
                    probes.add(Must::BeDefined, zero, center, 1.0);
                    probes.add(Must::EqualLastTimes(1.0), minus, center, 1.0);
                }
            }
        },
    },
    Entry {
        number: 24,
        name: "coordinates of 1e20 and more: defined",
        promised_by: ALL,
        probes: |probes, _| {
            for size in [1e20, 1e30, 3e38] {
                for center in [v(size, 0.0, 0.0), v(0.0, 0.0, -size)] {
                    probes.add(Must::BeDefined, ahead(), center, size);
                    probes.add(Must::BeDefined, ray(center, Vec3::Y), Vec3::ZERO, 1.0);
                }
            }
        },
    },
    Entry {
        number: 25,
        name: "coordinates of 2²⁴ with r = 1",
        promised_by: UPPER,
        probes: |probes, _| {
            for shift in [0.0, 1.0, 2.0] {
                let center = v(16_777_216.0 + shift, 0.0, -16_777_216.0);
                probes.truth(ray(v(16_777_216.0, 0.0, 0.0), Vec3::NEG_Z), center, 1.0);
            }
        },
    },
    Entry {
        number: 26,
        name: "O − C inexact",
        promised_by: UPPER,
        probes: |probes, random| {
            for _ in 0..32 {
                let origin = random.vec3(-1.0, 1.0) * 1e-3;
                let center = random.unit_vec3() * 1e3;
                let direction = center + random.unit_vec3() * 0.9 - origin;
                probes.truth(ray(origin, direction), center, 1.0);
            }
        },
    },
    Entry {
        number: 27,
        name: "subnormal radius: defined",
        promised_by: ALL,
        probes: |probes, _| {
            probes.add(Must::BeDefined, ahead(), v(0.0, 0.0, -3.0), TINY);
            probes.add(Must::BeDefined, ahead(), v(TINY, 0.0, -3.0), 0.5 * TINY);
        },
    },
    Entry {
        number: 28,
        name: "subnormal coordinates: defined",
        promised_by: ALL,
        probes: |probes, _| {
            for (origin, center) in [
                (v(TINY, 0.0, 0.0), Vec3::ZERO),
                (Vec3::ZERO, v(1.0, TINY, 0.0)),
            ] {
                probes.add(Must::BeDefined, ray(origin, Vec3::X), center, 1.0);
            }
        },
    },
    Entry {
        number: 29,
        name: "r = 0: a point, hit at most where the line meets it",
        promised_by: ALL,
        probes: |probes, _| {
            probes.add(Must::BeDefined, ahead(), v(0.0, 0.0, -3.0), 0.0);
            probes.add(Must::BeDefined, ahead(), Vec3::ZERO, 0.0);
            probes.add(Must::Miss, ahead(), v(0.5, 0.0, -3.0), 0.0);
        },
    },
    Entry {
        number: 31,
        name: "NaN in each field: a miss",
        promised_by: ALL,
        probes: |probes, _| in_each_field(probes, f32::NAN, Must::Miss),
    },
    Entry {
        number: 32,
        name: "infinity in each field: a miss or defined",
        promised_by: ALL,
        probes: |probes, _| in_each_field(probes, f32::INFINITY, Must::BeDefined),
    },
    Entry {
        number: 42,
        name: "sign flips and a common power of two: the same bits",
        promised_by: ALL,
        probes: |probes, random| {
            for _ in 0..16 {
                let (origin, center) = (random.vec3(-4.0, 4.0), random.vec3(-1.0, 1.0));
                let direction = center - origin + random.vec3(-0.5, 0.5);
                probes.add(Must::BeDefined, ray(origin, direction), center, 1.0);
                for flip in [v(-1.0, 1.0, 1.0), v(1.0, -1.0, -1.0)] {
                    let flipped = ray(origin * flip, direction * flip);
                    probes.add(Must::EqualLastTimes(1.0), flipped, center * flip, 1.0);
                }
                let scaled = ray(origin * 8.0, direction * 8.0);
                probes.add(Must::EqualLastTimes(1.0), scaled, center * 8.0, 8.0);
            }
        },
    },
    Entry {
        number: 44,
        name: "Δ or c all but zero: no small product is lost",
        promised_by: CERTIFIED,
        probes: all_but_zero,
    },
    Entry {
        number: 45,
        name: "a root next to an end of the interval: as rounded",
        promised_by: CERTIFIED,
        probes: at_the_ends,
    },
];

/// Intervals that begin or end at a root, or a few units in the last place beside it.
fn at_the_ends(probes: &mut Probes, random: &mut Random) {
    for index in 0..32 {
        let (center, radius) = (random.vec3(-4.0, 4.0), random.log_within(0.01, 100.0));
        // Lines through the sphere, close to its silhouette, and from inside of it.
        let off = [random.within(0.0, 0.9), 1.0 - random.log_within(1e-6, 0.1)][index % 2];
        let from = if index % 3 == 0 { 0.5 } else { 3.0 };
        let out = random.unit_vec3();
        let aside = out.any_orthonormal_vector() * (off * radius);
        let line = ray(center + aside + out * (from * radius), -out);
        let Some(exact) = Intersection::of(&line, &Sphere::new(center, radius)) else {
            continue;
        };
        for root in [Root::Near, Root::Far]
            .into_iter()
            .filter_map(|root| exact.root(root))
        {
            for ulps in -2_i32..=2 {
                let end = f32::from_bits(root.to_bits().wrapping_add_signed(ulps));
                let begins = Ray { t_min: end, ..line };
                let ends = Ray {
                    t_min: f32::MIN,
                    t_max: end,
                    ..line
                };
                probes.add(Must::BeTrue(0), begins, center, radius);
                probes.add(Must::BeTrue(0), ends, center, radius);
            }
        }
    }
}

/// Lines that pass a sphere by 2⁻ⁿ of its radius, or touch it, or start as near to it.
fn all_but_zero(probes: &mut Probes, random: &mut Random) {
    let true_within = Must::BeTrue(1);
    let unit = |exponent: i32| 2.0_f32.powi(exponent);
    // Found by number theory: Δ is a sum of three squares that almost cancels.
    let origin = v(
        -(0x5e_9a0f as f32) * unit(-4),
        0xc5_e55b as f32 * unit(-4),
        -(0x7c_78e9 as f32) * unit(-3),
    );
    let direction = v(
        0x18_2cbb as f32 * unit(-22),
        -(0x80_36f1 as f32) * unit(-23),
        0x3c_9257 as f32 * unit(-22),
    );
    let center = v(
        0x21_3215 as f32 * unit(-3),
        -(0x72_83e9 as f32) * unit(-3),
        0x9a_6f95 as f32 * unit(-4),
    );
    let radius = 0x93_236b as f32 * unit(-33);
    for exponent in [-5, 0, 1] {
        let by = unit(exponent);
        let line = ray(origin * by, direction);
        probes.add(true_within, line, center * by, radius * by);
    }
    // Both roots are negative, or c is 2⁻¹⁵² of its terms.
    let beside = ray(v(unit(20), unit(-10), 0.0), Vec3::X);
    probes.add(true_within, beside, Vec3::ZERO, unit(20));
    let above = ray(v(-unit(20), 0.0, unit(-56)), v(unit(-10), 0.0, 0.0));
    let above = Ray {
        t_min: unit(-125),
        ..above
    };
    probes.add(true_within, above, Vec3::ZERO, unit(20));
    for exponent in [-20, -40, -60, -75] {
        let off = unit(exponent);
        let along_x = |off: f32| ray(v(-2.0, 1.0, off), Vec3::X);
        probes.add(true_within, along_x(off), Vec3::ZERO, 1.0);
        probes.add(true_within, along_x(0.0), Vec3::ZERO, 1.0);
        // Along turned axes all components of the difference cancel.
        for _ in 0..16 {
            let parts = [(); 4].map(|()| random.within(-9.0, 9.0).round());
            let ([along, up, aside], n) = turned_axes(parts);
            if n > 0.0 {
                let line = ray(up - along * 2.0, along);
                probes.add(true_within, line, aside * off, n);
                probes.add(true_within, line, Vec3::ZERO, n);
            }
        }
    }
}

/// The axes turned by a quaternion of these parts, and their length, the sum of the parts' squares:
/// of whole parts all are whole numbers, and what is computed along them is a sum of many products.
///
/// L. Euler, Problema algebraicum, Novi Comm. Acad. Sci. Petrop. 15 (1771).
#[must_use]
pub fn turned_axes([w, x, y, z]: [f32; 4]) -> ([Vec3; 3], f32) {
    let (ww, xx, yy, zz) = (w * w, x * x, y * y, z * z);
    let axes = [
        v(
            ww + xx - yy - zz,
            2.0 * (x * y + w * z),
            2.0 * (x * z - w * y),
        ),
        v(
            2.0 * (x * y - w * z),
            ww - xx + yy - zz,
            2.0 * (y * z + w * x),
        ),
        v(
            2.0 * (x * z + w * y),
            2.0 * (y * z - w * x),
            ww - xx - yy + zz,
        ),
    ];
    (axes, ww + xx + yy + zz)
}

/// The cases with a single ray and a single sphere.
#[must_use]
pub fn catalogue() -> Vec<Case> {
    let mut random = Random::new(42);
    let case = |entry: &Entry| {
        let mut probes = Probes(Vec::new());
        (entry.probes)(&mut probes, &mut random);
        Case {
            number: entry.number,
            name: entry.name,
            probes: probes.0,
            promised_by: entry.promised_by,
        }
    };
    CATALOGUE.iter().map(case).collect()
}

/// Collects the probes of one case.
struct Probes(Vec<Probe>);

impl Probes {
    fn add(&mut self, must: Must, ray: Ray, center: Vec3, radius: f32) {
        self.0.push(Probe {
            ray,
            sphere: Sphere::new(center, radius),
            must,
        });
    }

    fn truth(&mut self, ray: Ray, center: Vec3, radius: f32) {
        self.add(Must::BeTrue(1), ray, center, radius);
    }
}

fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

fn ray(origin: Vec3, direction: Vec3) -> Ray {
    Ray::new(origin, direction)
}

fn ahead() -> Ray {
    ray(Vec3::ZERO, Vec3::NEG_Z)
}

/// A subnormal number.
const TINY: f32 = f32::from_bits(1 << 10);

/// Rays downwards from this height above a sphere that is the ground.
fn above_ground(probes: &mut Probes, random: &mut Random, height: f32, radius: f32) {
    for _ in 0..32 {
        let down = v(
            random.within(-1.0, 1.0),
            -random.within(0.05, 1.0),
            random.within(-1.0, 1.0),
        );
        probes.truth(ray(v(0.0, height, 0.0), down), v(0.0, -radius, 0.0), radius);
    }
}

/// Rays outwards from beside a surface: `next` makes the distance from the centre of the radius.
fn beside_surface(probes: &mut Probes, next: fn(f32) -> f32) {
    for radius in [0.5_f32, 1.0, 3.0, 1000.0] {
        for direction in [v(0.0, 0.0, 1.0), v(0.5, 0.0, 1.0), v(0.0, 0.7, 0.3)] {
            let beside = ray(v(0.0, 0.0, next(radius)), direction);
            probes.truth(beside, Vec3::ZERO, radius);
        }
    }
}

/// A ray that leaves a hit outwards, the sphere that was hit, and how far from the point of the hit
/// the ray starts.
struct Spawned {
    ray: Ray,
    sphere: Sphere,
    shift: f32,
}

/// Rays that leave hits of spheres, of small ones near the origin and of large ones far from it in
/// turn.
fn spawned(random: &mut Random) -> Vec<Spawned> {
    let mut all = Vec::new();
    for index in 0..400 {
        let small = index % 2 == 0;
        let (place, size) = if small { (0.03, 0.01) } else { (1e5, 1e3) };
        let sphere = Sphere::new(
            random.vec3(-place, place),
            random.log_within(0.1, 1.0) * size,
        );
        let origin = sphere.center() + random.unit_vec3() * (4.0 * sphere.radius());
        let aim = sphere.center() + random.unit_vec3() * (0.7 * sphere.radius());
        let towards = ray(origin, aim - origin);
        let t = sphere.intersect(&towards);
        if t == Hit::NONE_T {
            continue;
        }
        let surface = Surface::at(&towards, t, sphere);
        let away = random.unit_vec3();
        let away = if away.dot(surface.normal) < 0.0 {
            -away
        } else {
            away
        };
        let leaving = surface.leave(away);
        all.push(Spawned {
            ray: leaving,
            sphere,
            shift: (leaving.origin - surface.point).length(),
        });
    }
    all
}

/// A ray and a sphere with this number in each of their fields in turn.
fn in_each_field(probes: &mut Probes, bad: f32, must: Must) {
    for field in 0..10 {
        let mut fields = [0.0, 0.0, 0.0, 0.1, 0.2, -1.0, 0.3, 0.0, -3.0, 1.0];
        fields[field] = bad;
        let [ox, oy, oz, dx, dy, dz, cx, cy, cz, r] = fields;
        probes.add(must, ray(v(ox, oy, oz), v(dx, dy, dz)), v(cx, cy, cz), r);
    }
}
