//! Families of rays and shapes beside spheres, each hard in its own way, and the errors of a rung
//! on them.

use std::f32::consts::TAU;

use glam::{Quat, Vec3};
use rayon::prelude::*;
use spherule_kernel::shape::{Capsule, Cone, Cuboid, Cylinder, Disc, Ellipsoid, Kinds, Shape};
use spherule_kernel::{Hit, Ray, Rung};

use super::shape_oracle::Exact;
use crate::device::canary::Canary;
use crate::device::{Access, Device, Gpu, rung};
use crate::error::Result;
use crate::random::Random;
use crate::ulp;

/// A shape of a kind that the oracle decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Known {
    /// A capsule.
    Capsule(Capsule),
    /// A cylinder.
    Cylinder(Cylinder),
    /// An ellipsoid.
    Ellipsoid(Ellipsoid),
    /// A box.
    Box(Cuboid),
    /// A cone.
    Cone(Cone),
    /// A disc.
    Disc(Disc),
}

impl Known {
    /// As worlds keep it.
    #[must_use]
    pub fn shape(&self) -> Shape {
        match *self {
            Self::Capsule(shape) => shape.into(),
            Self::Cylinder(shape) => shape.into(),
            Self::Ellipsoid(shape) => shape.into(),
            Self::Box(shape) => shape.into(),
            Self::Cone(shape) => shape.into(),
            Self::Disc(shape) => shape.into(),
        }
    }

    /// What the oracle says.
    #[must_use]
    pub fn exact(&self) -> &dyn Exact {
        match self {
            Self::Capsule(shape) => shape,
            Self::Cylinder(shape) => shape,
            Self::Ellipsoid(shape) => shape,
            Self::Box(shape) => shape,
            Self::Cone(shape) => shape,
            Self::Disc(shape) => shape,
        }
    }
}

/// A family of rays and shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Shapes of sizes 0.1 to 2, eight times as long as thick at most, in a room of side 20; most
    /// rays aim at their shape.
    Generic,
    /// Shapes at a distance of 10² to 10⁵ times their size.
    Far,
    /// Rays that are parallel to the shape's first axis up to 10⁻¹ … 10⁻⁷.
    Along,
    /// Shapes a hundred to ten thousand times as long as thick.
    Thin,
    /// Rays that pass the silhouette at 10⁻² … 10⁻⁷ of the size.
    Grazing,
    /// Rays that start inside.
    Inside,
}

impl Family {
    /// Every family.
    pub const ALL: [Self; 6] = [
        Self::Generic,
        Self::Far,
        Self::Along,
        Self::Thin,
        Self::Grazing,
        Self::Inside,
    ];

    /// `count` rays, each with its shape of this kind; the same for the same seed.
    #[must_use]
    pub fn sample(self, kind: Kinds, seed: u64, count: usize) -> Vec<(Ray, Known)> {
        let mut random = Random::new(seed);
        (0..count).map(|_| self.one(kind, &mut random)).collect()
    }

    fn one(self, kind: Kinds, random: &mut Random) -> (Ray, Known) {
        let center = random.vec3(-10.0, 10.0);
        let size = random.log_within(0.1, 2.0);
        let thin = match self {
            Self::Thin => random.log_within(1e-4, 1e-2),
            _ => random.log_within(0.125, 1.0),
        };
        let rotation = turn(random);
        // The first axis is the long one.
        let long = rotation * Vec3::X * size;
        let (start, end, radius) = (center - long, center + long, size * thin);
        let half = Vec3::new(size, size * thin, size * random.log_within(thin, 1.0));
        let known = if kind == Kinds::CAPSULE {
            Known::Capsule(Capsule::new(start, end, radius))
        } else if kind == Kinds::CYLINDER {
            Known::Cylinder(Cylinder::new(start, end, radius))
        } else if kind == Kinds::ELLIPSOID {
            Known::Ellipsoid(Ellipsoid::new(center, half, rotation))
        } else if kind == Kinds::CONE {
            let other = if random.next_u32().is_multiple_of(4) {
                0.0
            } else {
                size * random.log_within(thin, 1.0)
            };
            Known::Cone(Cone::new(start, end, radius, other))
        } else if kind == Kinds::DISC {
            Known::Disc(Disc::new(center, rotation * Vec3::X, size))
        } else {
            Known::Box(Cuboid::new(center, half, rotation))
        };
        // A point inside, and one about on the surface: from the one towards another is across.
        let inside = center + rotation * (random.vec3(-0.5, 0.5) * half);
        let aim = match self {
            Self::Grazing => {
                let off = 1.0 + random.log_within(1e-7, 1e-2) * sign(random);
                let around = Quat::from_axis_angle(Vec3::X, random.within(0.0, TAU)) * Vec3::Y;
                center
                    + rotation
                        * (Vec3::X * (random.within(-0.9, 0.9) * size)
                            + around * (size * thin * off))
            }
            _ => inside + rotation * (random.unit_vec3() * half * random.within(0.0, 1.5)),
        };
        let distance = match self {
            Self::Far => size * random.log_within(1e2, 1e5),
            _ => size * random.log_within(0.5, 20.0),
        };
        let away = match self {
            Self::Along => {
                (long / size + random.unit_vec3() * random.log_within(1e-7, 1e-1)).normalize()
                    * sign(random)
            }
            _ => random.unit_vec3(),
        };
        let origin = match self {
            Self::Inside => inside,
            _ => aim - away * distance,
        };
        let direction = match self {
            Self::Inside => random.unit_vec3(),
            _ => (aim - origin) / distance,
        };
        (Ray::new(origin, direction), known)
    }
}

fn sign(random: &mut Random) -> f32 {
    if random.next_u32().is_multiple_of(2) {
        1.0
    } else {
        -1.0
    }
}

/// Any rotation.
fn turn(random: &mut Random) -> Quat {
    Quat::from_axis_angle(random.unit_vec3(), random.within(-3.0, 3.0))
}

/// The errors of a rung on a family.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShapeErrors {
    /// How many rays hit, as the oracle says.
    pub hits: usize,
    /// How many hits were reported that are misses, and how many were not found.
    pub false_hits: usize,
    /// See `false_hits`.
    pub missed: usize,
    /// The largest error of t in units in the last place, where both say that the ray hits.
    pub ulps: u32,
    /// The largest error of a point, as a share of the distance from the ray's origin to the
    /// shape's farthest corner, in units of 2⁻²⁴.
    pub shift: f64,
}

/// Measures a rung on these rays and shapes, all of one kind.
///
/// # Errors
///
/// [`RungRefused`](crate::Error::RungRefused) if the canary objects, and the device's errors.
pub fn measure(device: &Device, rung: Rung, samples: &[(Ray, Known)]) -> Result<ShapeErrors> {
    let answers = intersect_shapes(device, rung, samples)?;
    let one = |((ray, known), found): (&(Ray, Known), &f32)| {
        let truth = known.exact().exact_hit(ray);
        let found = (*found < Hit::NONE_T).then_some(*found);
        let mut errors = ShapeErrors {
            hits: usize::from(truth.is_some()),
            ..ShapeErrors::default()
        };
        match (truth, found) {
            (Some(truth), Some(found)) => {
                errors.ulps = ulp::distance(found, truth);
                let (low, high) = known.shape().bounds();
                let far = (low - ray.origin).abs().max((high - ray.origin).abs());
                let error = (f64::from(found) - f64::from(truth)).abs();
                let length = f64::from(ray.direction.length());
                errors.shift = error * length / f64::from(far.length()) * f64::from(1_u32 << 24);
            }
            (Some(_), None) => errors.missed = 1,
            (None, Some(_)) => errors.false_hits = 1,
            (None, None) => {}
        }
        errors
    };
    Ok(samples
        .par_iter()
        .zip(&answers)
        .map(one)
        .reduce(ShapeErrors::default, |a, b| ShapeErrors {
            hits: a.hits + b.hits,
            false_hits: a.false_hits + b.false_hits,
            missed: a.missed + b.missed,
            ulps: a.ulps.max(b.ulps),
            shift: a.shift.max(b.shift),
        }))
}

/// The answer for each ray on this rung and device: the parameter of the hit, or [`Hit::NONE_T`].
///
/// # Errors
///
/// As [`measure`].
pub fn intersect_shapes(device: &Device, rung: Rung, samples: &[(Ray, Known)]) -> Result<Vec<f32>> {
    match device {
        Device::Cpu => Ok(samples
            .par_iter()
            .map(|(ray, known)| {
                let shape = known.shape();
                shape.span(rung.to_u32(), shape.kinds(), ray).first(ray)
            })
            .collect()),
        Device::Gpu(gpu) => {
            Canary::require_on_gpu(gpu, rung)?;
            intersect_on_gpu(gpu, rung, samples)
        }
    }
}

fn intersect_on_gpu(gpu: &Gpu, on: Rung, samples: &[(Ray, Known)]) -> Result<Vec<f32>> {
    let shapes = samples.iter().map(|(_, known)| known.shape());
    let kinds = shapes.fold(Kinds::NONE, |kinds, shape| kinds.and(shape.kinds()));
    let module = rung::module(gpu, on)?.specialise(Kinds::SPEC_ID, kinds.to_bits())?;
    let access = [Access::Read, Access::Read, Access::ReadWrite];
    let kernel = gpu.kernel(&module, "intersect_shapes", &access)?;
    let mut answers = Vec::with_capacity(samples.len());
    for samples in samples.chunks(1 << 20) {
        let rays: Vec<Ray> = samples.iter().map(|(ray, _)| *ray).collect();
        let shapes: Vec<Shape> = samples.iter().map(|(_, known)| known.shape()).collect();
        let output = gpu.zeroed::<f32>("parameters", samples.len())?;
        let (rays, shapes) = (gpu.upload("rays", &rays)?, gpu.upload("shapes", &shapes)?);
        gpu.launch(
            &kernel,
            &[rays.binding(), shapes.binding(), output.binding()],
            kernel.workgroups_for([samples.len() as u32, 1, 1]),
        )?;
        answers.extend(gpu.read(&output)?);
    }
    Ok(answers)
}
