//! The hard cases: named inputs on which ray tracers of spheres go wrong, each with the answer of
//! exact arithmetic.
//!
//! The numbers are those of the catalogue in `docs/numerics.md`. Each case lists the rungs that
//! promise it: the lower rungs show what goes wrong without the promise.

use glam::Vec3;
use serde::Serialize;
use spherule_kernel::{Hit, Ray, Rung, Sphere, Surface};

use super::measure::intersect_all;
use super::oracle::Intersection;
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
pub(super) const CERTIFIED: &[Rung] = &[Rung::Certified];

impl Case {
    /// The rays of the case, each with its sphere.
    pub fn samples(&self) -> impl Iterator<Item = (Ray, Sphere)> {
        self.probes.iter().map(|probe| (probe.ray, probe.sphere))
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

/// Collects the probes of one case.
struct Probes(Vec<Probe>);

impl Probes {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn add(mut self, must: Must, ray: Ray, center: Vec3, radius: f32) -> Self {
        self.0.push(Probe {
            ray,
            sphere: Sphere::new(center, radius),
            must,
        });
        self
    }

    fn truth(self, ray: Ray, center: Vec3, radius: f32) -> Self {
        self.add(Must::BeTrue(1), ray, center, radius)
    }

    fn case(self, number: u8, name: &'static str, promised_by: &'static [Rung]) -> Case {
        Case {
            number,
            name,
            probes: self.0,
            promised_by,
        }
    }
}

fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

fn ray(origin: Vec3, direction: Vec3) -> Ray {
    Ray::new(origin, direction)
}

/// The cases with a single ray and a single sphere.
#[must_use]
pub fn catalogue() -> Vec<Case> {
    let mut cases = Vec::new();
    let ahead = ray(Vec3::ZERO, Vec3::NEG_Z);
    let mut random = Random::new(42);

    let mut probes = Probes::new();
    for distance in [1e3, 1e4, 1e5, 1e6] {
        for across in [0.0, 0.3, 0.6, 0.9] {
            probes = probes.truth(
                ray(v(0.1, 0.2, 0.3), v(0.0, 0.0, -1.0)),
                v(0.1 + across, 0.2, -distance),
                1.0,
            );
        }
    }
    cases.push(probes.case(1, "small far sphere", UPPER));

    let mut probes = Probes::new();
    for across in [0.0, 0.5, 0.99, 0.999, 1.001, 1.01, 1.5] {
        probes = probes.truth(ahead, v(across, 0.0, -8192.0), 1.0);
    }
    cases.push(probes.case(2, "unit sphere beyond distance 4096", UPPER));

    let mut probes = Probes::new();
    for _ in 0..32 {
        let down = v(
            random.within(-1.0, 1.0),
            -random.within(0.05, 1.0),
            random.within(-1.0, 1.0),
        );
        probes = probes.truth(ray(v(0.0, 1.0, 0.0), down), v(0.0, -1000.0, 0.0), 1000.0);
    }
    cases.push(probes.case(3, "ground sphere of radius 1000, camera at 1", UPPER));

    let mut probes = Probes::new();
    for _ in 0..32 {
        let down = v(
            random.within(-1.0, 1.0),
            -random.within(0.05, 1.0),
            random.within(-1.0, 1.0),
        );
        probes = probes.truth(ray(v(0.0, 0.1, 0.0), down), v(0.0, -6.4e6, 0.0), 6.4e6);
    }
    cases.push(probes.case(4, "Earth, camera at 0.1", CERTIFIED));

    let mut probes = Probes::new();
    for (p, q, r) in [
        (3.0, 4.0, 5.0),
        (5.0, 12.0, 13.0),
        (8.0, 15.0, 17.0),
        (20.0, 21.0, 29.0),
    ] {
        let touch = ray(v(p - 2.0 * q, q + 2.0 * p, 0.0), v(q, -p, 0.0));
        probes = probes.truth(touch, Vec3::ZERO, r);
    }
    cases.push(probes.case(5, "exactly tangent, Pythagorean", UPPER));

    let mut probes = Probes::new();
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
                probes = probes.truth(ray(origin, direction), Vec3::ZERO, radius);
            }
        }
    }
    cases.push(probes.case(6, "Δ the smallest number above and below zero", CERTIFIED));

    let mut probes = Probes::new();
    for exponent in 4..=23 {
        let radius = 1.0 + 2.0_f32.powi(-exponent);
        let inside = 1.0 - 2.0_f32.powi(-exponent);
        let passing = ray(v(-3.0, 1.0, 0.25), v(1.0, 0.0, 0.0));
        probes = probes.truth(passing, v(0.0, 0.0, 0.25), radius).truth(
            passing,
            v(0.0, 0.0, 0.25),
            inside,
        );
    }
    cases.push(probes.case(7, "tangency swept from 2⁻⁴ to 2⁻²³", UPPER));

    let mut probes = Probes::new();
    for exponent in 1..=12 {
        let height = 1.1 * 2.0_f32.powi(-exponent);
        let steep = v(0.01, 0.02, -1.0);
        probes = probes.truth(ray(v(0.0, 0.0, 100.0 + height), steep), Vec3::ZERO, 100.0);
    }
    cases.push(probes.case(8, "near root with b² ≫ ac", UPPER));

    let still =
        |center, radius| Probes::new().truth(ray(v(0.0, 1.0, 0.0), Vec3::X), center, radius);
    cases.push(still(Vec3::ZERO, 1.0).case(9, "b = 0 and Δ = 0", ALL));

    let on_surface = |direction| {
        Probes::new().truth(
            Ray::within(v(0.0, 0.0, 5.0), direction, f32::MIN_POSITIVE, f32::MAX),
            v(0.0, 0.0, 4.0),
            1.0,
        )
    };
    let mut probes = on_surface(v(0.0, 0.6, -0.8));
    probes.0.extend(on_surface(v(0.0, 0.0, -1.0)).0);
    cases.push(probes.case(10, "c = 0 exactly: the other root", UPPER));

    let mut probes = Probes::new();
    let mut probes_inside = Probes::new();
    for radius in [0.5_f32, 1.0, 3.0, 1000.0] {
        for direction in [v(0.0, 0.0, 1.0), v(0.5, 0.0, 1.0), v(0.0, 0.7, 0.3)] {
            probes = probes.truth(
                ray(v(0.0, 0.0, radius.next_up()), direction),
                Vec3::ZERO,
                radius,
            );
            let inside = ray(v(0.0, 0.0, radius.next_down()), direction);
            probes_inside = probes_inside.truth(inside, Vec3::ZERO, radius);
        }
    }
    cases.push(probes.case(11, "origin one ulp outside, leaving", CERTIFIED));
    cases.push(probes_inside.case(12, "origin one ulp inside", CERTIFIED));

    let (mut probes, mut probes_small) = (Probes::new(), Probes::new());
    for index in 0..400 {
        let small = index % 2 == 0;
        let (place, size) = if small { (0.03, 0.01) } else { (1e5, 1e3) };
        let sphere = Sphere::new(
            random.vec3(-place, place),
            random.log_within(0.1, 1.0) * size,
        );
        let towards = ray(
            sphere.center() + random.unit_vec3() * (4.0 * sphere.radius()),
            Vec3::X,
        );
        let towards = ray(
            towards.origin,
            sphere.center() + random.unit_vec3() * (0.7 * sphere.radius()) - towards.origin,
        );
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
        probes = probes.add(Must::Miss, leaving, sphere.center(), sphere.radius());
        // The start stays within 1e-5 of the sphere's distance and radius.
        let shift = (leaving.origin - surface.point).length();
        let bounded = shift <= 1e-5 * (sphere.center().length() + sphere.radius());
        probes_small = probes_small.add(
            if bounded { Must::BeTrue(1) } else { Must::Miss },
            leaving,
            sphere.center(),
            sphere.radius(),
        );
    }
    cases.push(probes.case(13, "ray spawned at a hit: no re-hit", CERTIFIED));
    cases.push(probes_small.case(14, "spawning near the origin and far from it", CERTIFIED));

    let mut probes = Probes::new();
    for radius in [1e-3, 0.3, 7.0, 1e6] {
        for direction in [
            Vec3::X,
            v(0.0, -2.0, 0.0),
            v(0.0, 0.0, 0.25),
            v(1.0, 1.0, 1.0),
        ] {
            probes = probes.truth(ray(v(2.0, 3.0, 5.0), direction), v(2.0, 3.0, 5.0), radius);
        }
    }
    cases.push(probes.case(15, "origin at the centre", UPPER));

    let mut probes = Probes::new();
    for _ in 0..64 {
        let origin = random.vec3(-0.5, 0.5);
        probes = probes.truth(ray(origin, random.unit_vec3()), Vec3::ZERO, 1.0);
    }
    cases.push(probes.case(16, "inside, looking in and out", UPPER));

    let mut probes = Probes::new();
    for _ in 0..64 {
        let center = random.unit_vec3() * 5.0;
        probes = probes.add(
            Must::Miss,
            ray(Vec3::ZERO, -center + random.vec3(-1.0, 1.0)),
            center,
            1.0,
        );
    }
    cases.push(probes.case(17, "sphere wholly behind", ALL));

    // The roots are t = 2 and t = 4, exactly.
    let mut probes = Probes::new();
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
        probes = probes.truth(
            Ray::within(Vec3::ZERO, Vec3::NEG_Z, t_min, t_max),
            v(0.0, 0.0, -3.0),
            1.0,
        );
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
        probes = probes.truth(
            Ray::within(Vec3::ZERO, Vec3::Z, t_min, t_max),
            v(0.0, 0.0, -3.0),
            1.0,
        );
    }
    cases.push(probes.case(18, "a root on either side of t_min and t_max", ALL));

    let mut probes = Probes::new();
    for near in [true, false] {
        let t_min = if near { 0.0 } else { 1.0 };
        // A chord so short that its ends are neighbouring floats.
        let skim = Ray::within(v(-1.0, 1.0, 0.0), Vec3::X, t_min, f32::MAX);
        probes = probes.truth(skim, Vec3::ZERO, 1.0);
        probes = probes.truth(skim, Vec3::ZERO, 1.0_f32.next_up());
    }
    cases.push(probes.case(19, "roots next to each other", CERTIFIED));

    let mut probes = Probes::new();
    for _ in 0..16 {
        let origin = random.vec3(-4.0, 4.0);
        let direction = -origin + random.vec3(-0.5, 0.5);
        probes = probes.truth(ray(origin, direction), Vec3::ZERO, 1.0);
        let mut last = 1.0;
        for exponent in [-10, -3, 1, 10] {
            let factor = 2.0_f32.powi(exponent);
            probes = probes.add(
                Must::EqualLastTimes(last / factor),
                ray(origin, direction * factor),
                Vec3::ZERO,
                1.0,
            );
            last = factor;
        }
    }
    cases.push(probes.case(20, "direction times powers of two", UPPER));

    let mut probes = Probes::new();
    for exponent in [-60, 60] {
        let direction = v(0.1, -0.2, -1.0) * 2.0_f32.powi(exponent);
        probes = probes.truth(ray(Vec3::ZERO, direction), v(0.0, 0.0, -3.0), 1.0);
    }
    cases.push(probes.case(21, "|d| = 2^±60", UPPER));

    let none = |direction| {
        Probes::new().add(
            Must::Miss,
            ray(v(0.1, 0.0, 0.0), direction),
            Vec3::ZERO,
            1.0,
        )
    };
    cases.push(none(Vec3::ZERO).case(22, "d = 0", ALL));

    let mut probes = Probes::new();
    for (zero, minus) in [
        (v(0.0, 0.0, -1.0), v(-0.0, -0.0, -1.0)),
        (v(1.0, 0.0, 0.0), v(1.0, -0.0, -0.0)),
    ] {
        for center in [v(0.25, 0.0, -3.0), v(3.0, 0.5, 0.0)] {
            probes = probes.add(Must::BeDefined, ray(Vec3::ZERO, zero), center, 1.0);
            probes = probes.add(
                Must::EqualLastTimes(1.0),
                ray(Vec3::ZERO, minus),
                center,
                1.0,
            );
        }
    }
    cases.push(probes.case(23, "axis-aligned direction with −0", ALL));

    let mut probes = Probes::new();
    for size in [1e20, 1e30, 3e38] {
        for center in [v(size, 0.0, 0.0), v(0.0, 0.0, -size)] {
            probes = probes.add(Must::BeDefined, ahead, center, size);
            probes = probes.add(Must::BeDefined, ray(center, Vec3::Y), Vec3::ZERO, 1.0);
        }
    }
    cases.push(probes.case(24, "coordinates of 1e20 and more: defined", ALL));

    let mut probes = Probes::new();
    for shift in [0.0, 1.0, 2.0] {
        let center = v(16_777_216.0 + shift, 0.0, -16_777_216.0);
        probes = probes.truth(ray(v(16_777_216.0, 0.0, 0.0), Vec3::NEG_Z), center, 1.0);
    }
    cases.push(probes.case(25, "coordinates of 2²⁴ with r = 1", UPPER));

    let mut probes = Probes::new();
    for _ in 0..32 {
        let origin = random.vec3(-1.0, 1.0) * 1e-3;
        let center = random.unit_vec3() * 1e3;
        let direction = center + random.unit_vec3() * 0.9 - origin;
        probes = probes.truth(ray(origin, direction), center, 1.0);
    }
    cases.push(probes.case(26, "O − C inexact", UPPER));

    let tiny = f32::from_bits(1 << 10);
    let probes = Probes::new()
        .add(Must::BeDefined, ahead, v(0.0, 0.0, -3.0), tiny)
        .add(Must::BeDefined, ahead, v(tiny, 0.0, -3.0), 0.5 * tiny);
    cases.push(probes.case(27, "subnormal radius: defined", ALL));
    let probes = Probes::new()
        .add(
            Must::BeDefined,
            ray(v(tiny, 0.0, 0.0), Vec3::X),
            Vec3::ZERO,
            1.0,
        )
        .add(
            Must::BeDefined,
            ray(Vec3::ZERO, Vec3::X),
            v(1.0, tiny, 0.0),
            1.0,
        );
    cases.push(probes.case(28, "subnormal coordinates: defined", ALL));

    let probes = Probes::new()
        .add(Must::BeDefined, ahead, v(0.0, 0.0, -3.0), 0.0)
        .add(Must::BeDefined, ahead, Vec3::ZERO, 0.0)
        .add(Must::Miss, ahead, v(0.5, 0.0, -3.0), 0.0);
    cases.push(probes.case(
        29,
        "r = 0: a point, hit at most where the line meets it",
        ALL,
    ));

    for (number, name, bad) in [
        (31, "NaN in each field: a miss", f32::NAN),
        (
            32,
            "infinity in each field: a miss or defined",
            f32::INFINITY,
        ),
    ] {
        let mut probes = Probes::new();
        for field in 0..10 {
            let mut fields = [0.0, 0.0, 0.0, 0.1, 0.2, -1.0, 0.3, 0.0, -3.0, 1.0];
            fields[field] = bad;
            let must = if bad.is_nan() {
                Must::Miss
            } else {
                Must::BeDefined
            };
            let [ox, oy, oz, dx, dy, dz, cx, cy, cz, r] = fields;
            probes = probes.add(must, ray(v(ox, oy, oz), v(dx, dy, dz)), v(cx, cy, cz), r);
        }
        cases.push(probes.case(number, name, ALL));
    }

    let mut probes = Probes::new();
    for _ in 0..16 {
        let (origin, center) = (random.vec3(-4.0, 4.0), random.vec3(-1.0, 1.0));
        let direction = center - origin + random.vec3(-0.5, 0.5);
        probes = probes.add(Must::BeDefined, ray(origin, direction), center, 1.0);
        for flip in [v(-1.0, 1.0, 1.0), v(1.0, -1.0, -1.0)] {
            let flipped = ray(origin * flip, direction * flip);
            probes = probes.add(Must::EqualLastTimes(1.0), flipped, center * flip, 1.0);
        }
        let scaled = ray(origin * 8.0, direction * 8.0);
        probes = probes.add(Must::EqualLastTimes(1.0), scaled, center * 8.0, 8.0);
    }
    cases.push(probes.case(
        42,
        "sign flips and a common power of two: the same bits",
        ALL,
    ));
    cases
}
