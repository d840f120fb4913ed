//! Measures the errors of a rung on one family of rays and one device.

use std::fmt;

use rayon::prelude::*;
use serde::Serialize;
use spherule_kernel::precision::certified::{Stage, intersect_in_single, intersect_with_stage};
use spherule_kernel::precision::intersect;
use spherule_kernel::{Hit, Ray, Rung, Sphere, Surface};

use super::oracle::Intersection;
use super::screen;
use crate::device::canary::Canary;
use crate::device::{Access, Device, Gpu, rung};
use crate::error::Result;
use crate::random::Random;
use crate::ulp;

/// The errors of a rung.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RungErrors {
    /// The number of rays.
    pub rays: usize,
    /// The number of rays that truly hit.
    pub hits: usize,
    /// Reported hits that are misses.
    pub false_hits: usize,
    /// Hits that were not reported.
    pub false_misses: usize,
    /// The largest |Δ| / (a r²) of a line that was put on the wrong side of the silhouette.
    pub margin: f64,
    /// The largest error of t, in units in the last place, over the true hits that were reported
    /// and have |c| ≥ 2⁻²⁰ |o|²; `None` without such a hit.
    pub max_ulp: Option<u32>,
    /// The largest error of t, in units in the last place, over all true hits that were reported;
    /// `None` without one.
    pub max_ulp_anywhere: Option<u32>,
    /// Hits whose t is off by more than four units in the last place.
    pub over_4_ulp: usize,
    /// The largest angle between the normal at the reported hit and the true one, in degrees.
    pub normal_degrees: f64,
    /// The number of hits by error. The first bucket counts exact hits; bucket n counts errors of
    /// 2ⁿ⁻² to 2ⁿ⁻¹ − 1 units in the last place (1; 2 and 3; 4 to 7; …).
    pub histogram: Vec<usize>,
    /// The ray and the sphere of the largest error.
    pub worst: Option<Worst>,
}

/// How many tests each step of the certified rung decides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Steps {
    /// 64-bit floats.
    pub wide: usize,
    /// The midpoint between two floats, in pairs of 64-bit floats.
    pub midpoint: usize,
    /// The filter.
    pub filter: usize,
    /// Pairs of floats.
    pub pairs: usize,
    /// Pairs of floats, with c distilled.
    pub distilled_c: usize,
    /// Distillation of everything.
    pub distilled: usize,
}

impl Steps {
    fn count(&mut self, stage: Stage) {
        *match stage {
            Stage::Wide => &mut self.wide,
            Stage::Midpoint => &mut self.midpoint,
            Stage::Filter => &mut self.filter,
            Stage::Pairs => &mut self.pairs,
            Stage::DistilledC => &mut self.distilled_c,
            Stage::Distilled => &mut self.distilled,
        } += 1;
    }
}

impl fmt::Display for Steps {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = [
            ("64-bit floats", self.wide),
            ("pairs of these", self.midpoint),
            ("the filter", self.filter),
            ("pairs", self.pairs),
            ("pairs with c distilled", self.distilled_c),
            ("distillation", self.distilled),
        ];
        let total: f64 = named.iter().map(|(_, count)| *count as f64).sum();
        let mut shown = named.iter().filter(|(_, count)| *count > 0).peekable();
        if shown.peek().is_none() {
            return f.write_str("no test");
        }
        while let Some((name, count)) = shown.next() {
            write!(f, "{name} {:.3} %", 100.0 * *count as f64 / total)?;
            if shown.peek().is_some() {
                f.write_str(", ")?;
            }
        }
        Ok(())
    }
}

/// How many tests each step of the certified rung decides, with 64-bit floats and without.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Escalation {
    /// Tests, each of a ray with its own sphere.
    pub own: Steps,
    /// The same in 32-bit floats alone.
    pub own_in_single: Steps,
    /// Tests of each ray with spheres of other rays, as in a scene.
    pub in_a_scene: Steps,
    /// The same in 32-bit floats alone.
    pub in_a_scene_in_single: Steps,
}

impl Escalation {
    /// Counts on the CPU. A GPU decides the same way, up to the rounding of bounds.
    #[must_use]
    pub fn of(samples: &[(Ray, Sphere)]) -> Self {
        type Certified = fn(Sphere, &Ray) -> (f32, Stage);
        let own = |of: Certified| {
            let mut steps = Steps::default();
            for (ray, sphere) in samples {
                steps.count(of(*sphere, ray).1);
            }
            steps
        };
        let in_a_scene = |of: Certified| {
            let mut steps = Steps::default();
            for (ray, _) in samples.iter().take(2000) {
                let mut ray = *ray;
                for (_, sphere) in samples.iter().take(500) {
                    let (t, stage) = of(*sphere, &ray);
                    ray.t_max = ray.t_max.min(t);
                    steps.count(stage);
                }
            }
            steps
        };
        Self {
            own: own(intersect_with_stage),
            own_in_single: own(intersect_in_single),
            in_a_scene: in_a_scene(intersect_with_stage),
            in_a_scene_in_single: in_a_scene(intersect_in_single),
        }
    }
}

impl fmt::Display for Escalation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "certified: tests of rays with their own spheres are decided by {}; without 64-bit floats by {}; against 500 \
             spheres of the family by {}; without 64-bit floats by {}",
            self.own, self.own_in_single, self.in_a_scene, self.in_a_scene_in_single
        )
    }
}

/// An input that can be tried again: the bits of all its floats.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Worst {
    /// Origin and direction.
    pub ray: [u32; 6],
    /// Centre and radius.
    pub sphere: [u32; 4],
    /// The rung's answer.
    pub found: f32,
    /// The true answer.
    pub truth: f32,
}

/// The answer for each ray on this rung and device: the parameter of the hit, or [`Hit::NONE_T`].
///
/// # Errors
///
/// [`RungRefused`](crate::Error::RungRefused) if the canary objects, and the device's errors.
pub fn intersect_all(device: &Device, rung: Rung, samples: &[(Ray, Sphere)]) -> Result<Vec<f32>> {
    match device {
        Device::Cpu => Ok(samples
            .par_iter()
            .map(|(ray, sphere)| intersect(rung.to_u32(), *sphere, ray))
            .collect()),
        Device::Gpu(gpu) => {
            Canary::require_on_gpu(gpu, rung)?;
            intersect_on_gpu(gpu, rung, samples)
        }
    }
}

/// [`intersect_all`] without the canary's check: the answers of the device, right or wrong.
///
/// # Errors
///
/// The device's errors.
pub fn intersect_on_gpu(gpu: &Gpu, rung: Rung, samples: &[(Ray, Sphere)]) -> Result<Vec<f32>> {
    let kernel = gpu.kernel(
        &rung::module(gpu, rung)?,
        "intersect_pairs",
        &[Access::Read, Access::Read, Access::ReadWrite],
    )?;
    let mut answers = Vec::with_capacity(samples.len());
    // Two million rays are 64 MiB, within every device's limit on bindings.
    for samples in samples.chunks(1 << 21) {
        let (rays, spheres): (Vec<Ray>, Vec<Sphere>) = samples.iter().copied().unzip();
        let output = gpu.zeroed::<f32>("parameters", samples.len())?;
        gpu.launch(
            &kernel,
            &[
                gpu.upload("rays", &rays)?.binding(),
                gpu.upload("spheres", &spheres)?.binding(),
                output.binding(),
            ],
            kernel.workgroups_for([samples.len() as u32, 1, 1]),
        )?;
        answers.extend(gpu.read(&output)?);
    }
    Ok(answers)
}

/// Judges the answers of [`intersect_all`] by exact arithmetic.
#[must_use]
pub fn judge(samples: &[(Ray, Sphere)], answers: &[f32]) -> RungErrors {
    samples
        .par_iter()
        .zip(answers)
        .fold(RungErrors::none, |mut measured, ((ray, sphere), found)| {
            measured.add(ray, sphere, *found);
            measured
        })
        .reduce(RungErrors::none, RungErrors::merge)
}

impl RungErrors {
    /// The error, in units in the last place, that this share of the hits does not exceed. Above 1
    /// it is rounded up to the end of a bucket of the histogram, or to the largest error. `None`
    /// without hits.
    #[must_use]
    pub fn ulp_at(&self, share: f64) -> Option<u32> {
        let largest = self.max_ulp_anywhere?;
        let total: f64 = self.histogram.iter().map(|count| *count as f64).sum();
        let mut seen = 0.0;
        for (bucket, count) in self.histogram.iter().enumerate() {
            seen += *count as f64;
            if seen >= share * total {
                let end = 1_u64
                    .checked_shl(bucket as u32)
                    .map_or(u64::MAX, |end| end - 1);
                return Some(u32::try_from(end).map_or(largest, |end| end.min(largest)));
            }
        }
        Some(largest)
    }

    fn none() -> Self {
        Self {
            rays: 0,
            hits: 0,
            false_hits: 0,
            false_misses: 0,
            margin: 0.0,
            max_ulp: None,
            max_ulp_anywhere: None,
            over_4_ulp: 0,
            normal_degrees: 0.0,
            histogram: vec![0; 34],
            worst: None,
        }
    }

    fn add(&mut self, ray: &Ray, sphere: &Sphere, found: f32) {
        let truth = screen::nearest(ray, sphere);
        let says_hit = found < Hit::NONE_T;
        self.rays += 1;
        self.hits += usize::from(truth.is_some());
        match truth {
            None if says_hit => self.false_hits += 1,
            Some(_) if !says_hit => self.false_misses += 1,
            _ => {}
        }
        if says_hit != truth.is_some() {
            // If the line is on the right side of the silhouette, but its roots are on the wrong
            // side of the interval's end, that says nothing about Δ.
            if let Some(exact) = Intersection::of(ray, sphere)
                && exact.meets() != says_hit
            {
                self.margin = self.margin.max(exact.margin());
            }
            return;
        }
        let Some(truth) = truth else { return };
        let off = ulp::distance(found, truth);
        self.over_4_ulp += usize::from(off > 4);
        self.normal_degrees = self
            .normal_degrees
            .max(normal_error(ray, sphere, found, truth).to_degrees());
        self.histogram[(u32::BITS - off.leading_zeros()) as usize] += 1;
        if has_digits_of_c(ray, sphere) {
            self.max_ulp = self.max_ulp.max(Some(off));
        }
        if Some(off) > self.max_ulp_anywhere {
            self.max_ulp_anywhere = Some(off);
            self.worst = Some(Worst {
                ray: [ray.origin, ray.direction]
                    .map(|v| v.to_array().map(f32::to_bits))
                    .as_flattened()
                    .try_into()
                    .unwrap_or_default(),
                sphere: [
                    sphere.center().x.to_bits(),
                    sphere.center().y.to_bits(),
                    sphere.center().z.to_bits(),
                    sphere.radius().to_bits(),
                ],
                found,
                truth,
            });
        }
    }

    fn merge(self, other: Self) -> Self {
        let worst = if other.max_ulp_anywhere > self.max_ulp_anywhere {
            other.worst
        } else {
            self.worst
        };
        Self {
            rays: self.rays + other.rays,
            hits: self.hits + other.hits,
            false_hits: self.false_hits + other.false_hits,
            false_misses: self.false_misses + other.false_misses,
            margin: self.margin.max(other.margin),
            max_ulp: self.max_ulp.max(other.max_ulp),
            max_ulp_anywhere: self.max_ulp_anywhere.max(other.max_ulp_anywhere),
            over_4_ulp: self.over_4_ulp + other.over_4_ulp,
            normal_degrees: self.normal_degrees.max(other.normal_degrees),
            histogram: self
                .histogram
                .iter()
                .zip(&other.histogram)
                .map(|(a, b)| a + b)
                .collect(),
            worst,
        }
    }
}

/// The angle between the kernel's normal at `found` and the normal at `truth`, in radians.
fn normal_error(ray: &Ray, sphere: &Sphere, found: f32, truth: f32) -> f64 {
    let normal = Surface::at(ray, found, *sphere).normal.as_dvec3();
    let o = ray.origin.as_dvec3() - sphere.center().as_dvec3();
    let exact = (o + ray.direction.as_dvec3() * f64::from(truth)).normalize_or_zero();
    normal.cross(exact).length().atan2(normal.dot(exact))
}

/// Starts a ray outwards, in a random direction, from every reported hit. Returns how many of them
/// hit the same sphere again on this rung and device.
///
/// # Errors
///
/// As [`intersect_all`].
pub fn self_hits(
    device: &Device,
    rung: Rung,
    samples: &[(Ray, Sphere)],
    answers: &[f32],
) -> Result<usize> {
    let mut random = Random::new(1);
    let leaving: Vec<(Ray, Sphere)> = samples
        .iter()
        .zip(answers)
        .filter(|(_, t)| **t < Hit::NONE_T)
        .map(|((ray, sphere), t)| {
            let surface = Surface::at(ray, *t, *sphere);
            let direction = random.unit_vec3();
            let outwards = if direction.dot(surface.normal) < 0.0 {
                -direction
            } else {
                direction
            };
            (surface.leave(outwards), *sphere)
        })
        .collect();
    if leaving.is_empty() {
        return Ok(0);
    }
    let again = intersect_all(device, rung, &leaving)?;
    Ok(again.iter().filter(|t| **t < Hit::NONE_T).count())
}

/// Whether |c| ≥ 2⁻²⁰ |o|²: the origin is far enough from the surface for c to keep its digits.
fn has_digits_of_c(ray: &Ray, sphere: &Sphere) -> bool {
    let o = ray.origin.as_dvec3() - sphere.center().as_dvec3();
    let oo = o.dot(o);
    let c = oo - f64::from(sphere.radius()).powi(2);
    c.abs() >= oo * 2.0_f64.powi(-20)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::families::Family;
    use spherule_kernel::precision::compensated::Quadratic;

    /// The judge finds every mistake that it is made to find.
    #[test]
    fn mistakes_are_found() {
        let samples = Family::Inside.sample(3, 2000);
        let right = intersect_all(&Device::Cpu, Rung::Certified, &samples).expect("the CPU");
        let judged = |answers: &[f32]| judge(&samples, answers);
        let clean = judged(&right);
        assert_eq!(
            (clean.false_hits, clean.false_misses, clean.hits),
            (0, 0, 2000)
        );
        assert!(clean.max_ulp <= Some(1) && clean.ulp_at(1.0) <= Some(1));

        let off: Vec<f32> = right
            .iter()
            .map(|t| t.next_up().next_up().next_up())
            .collect();
        assert!(judged(&off).max_ulp >= Some(2));
        let missed: Vec<f32> = right.iter().map(|_| Hit::NONE_T).collect();
        let none = judged(&missed);
        assert_eq!(none.false_misses, 2000);
        // Without a hit there is no error, which is not the same as an error of zero.
        assert_eq!(
            (none.max_ulp, none.max_ulp_anywhere, none.ulp_at(0.5)),
            (None, None, None)
        );

        let outside: Vec<(Ray, Sphere)> = Family::Generic
            .sample(4, 2000)
            .into_iter()
            .filter(|(ray, sphere)| screen::nearest(ray, sphere).is_none())
            .collect();
        assert_eq!(
            judge(&outside, &vec![1.0; outside.len()]).false_hits,
            outside.len()
        );
    }

    /// The histogram's buckets are wide, but no percentile exceeds the largest error.
    #[test]
    fn a_percentile_is_at_most_the_largest_error() {
        for family in Family::ALL {
            let samples = family.sample(8, 2000);
            for rung in Rung::ALL {
                let answers = intersect_all(&Device::Cpu, rung, &samples).expect("the CPU");
                let judged = judge(&samples, &answers);
                assert_eq!(judged.ulp_at(1.0), judged.max_ulp_anywhere);
                assert!(judged.ulp_at(0.9999) <= judged.max_ulp_anywhere);
            }
        }
    }

    /// If the sign of q is swapped, the other root comes out, and the judge finds it.
    #[test]
    fn a_swapped_root_is_found() {
        let samples = Family::Generic.sample(5, 2000);
        let swapped: Vec<f32> = samples
            .iter()
            .map(|(ray, sphere)| {
                let quadratic = Quadratic::of(*sphere, ray);
                if quadratic.discriminant.high >= 0.0 {
                    let (near, far) = quadratic.roots();
                    spherule_kernel::precision::root::choose_root(far, near, ray)
                } else {
                    Hit::NONE_T
                }
            })
            .collect();
        assert!(judge(&samples, &swapped).max_ulp > Some(1000));
    }

    /// If the low part of o is dropped, the digits are lost on the ground, where O − C is inexact.
    #[test]
    fn a_deleted_low_part_is_found() {
        let samples = Family::Ground.sample(6, 2000);
        let rounded: Vec<(Ray, Sphere)> = samples
            .iter()
            .map(|(ray, sphere)| {
                let moved = Ray {
                    origin: ray.origin - sphere.center(),
                    ..*ray
                };
                (moved, Sphere::new(glam::Vec3::ZERO, sphere.radius()))
            })
            .collect();
        let answers = intersect_all(&Device::Cpu, Rung::Compensated, &rounded).expect("the CPU");
        assert!(judge(&samples, &answers).max_ulp > Some(1000));
    }
}
