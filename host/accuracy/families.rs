//! Families of rays, each hard in its own way, from repeatable random numbers.

use glam::{DVec3, Vec3};
use serde::Serialize;
use spherule_kernel::{Ray, Sphere};

use crate::random::Random;

/// A family of rays and spheres.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// Spheres of radius 0.1 to 2 in a room of side 20; half of the rays aim at their sphere.
    Generic,
    /// Spheres at a distance of 10² to 10⁵ radii.
    Far,
    /// A camera 0.1 to 10 above a ground sphere of radius 10³ to 6·10⁶.
    Ground,
    /// Lines that touch the sphere up to 2⁻⁴ … 2⁻³⁰ of its radius, on either side.
    Tangent,
    /// Rays that start on the sphere, up to the rounding of their origin.
    Surface,
    /// Rays that start inside.
    Inside,
}

impl Family {
    /// Every family.
    pub const ALL: [Self; 6] = [
        Self::Generic,
        Self::Far,
        Self::Ground,
        Self::Tangent,
        Self::Surface,
        Self::Inside,
    ];

    /// The family's name in tables and on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Generic => "generic",
            Self::Far => "far",
            Self::Ground => "ground",
            Self::Tangent => "tangent",
            Self::Surface => "surface",
            Self::Inside => "inside",
        }
    }

    /// `count` rays, each with its sphere; the same for the same seed.
    #[must_use]
    pub fn sample(self, seed: u64, count: usize) -> Vec<(Ray, Sphere)> {
        let mut random = Random::new(seed);
        (0..count).map(|_| self.one(&mut random)).collect()
    }

    fn one(self, random: &mut Random) -> (Ray, Sphere) {
        match self {
            Self::Generic => {
                let sphere = Sphere::new(random.vec3(-10.0, 10.0), random.log_within(0.1, 2.0));
                let origin = random.vec3(-10.0, 10.0);
                let aimed = random.next_u32().is_multiple_of(2);
                let direction = if aimed {
                    sphere.center() + random.unit_vec3() * sphere.radius() - origin
                } else {
                    random.unit_vec3()
                };
                (Ray::new(origin, direction), sphere)
            }
            Self::Far => {
                let sphere = Sphere::new(random.vec3(-10.0, 10.0), random.log_within(0.01, 1.0));
                let distance = sphere.radius() * random.log_within(1e2, 1e5);
                let origin = sphere.center() + random.unit_vec3() * distance;
                // The aim is up to a tenth beyond the silhouette.
                let aim = sphere.center() + random.unit_vec3() * (1.1 * sphere.radius());
                (Ray::new(origin, (aim - origin) / distance), sphere)
            }
            Self::Ground => {
                let radius = random.log_within(1e3, 6e6);
                let sphere = Sphere::new(Vec3::new(0.0, -radius, 0.0), radius);
                let height = random.log_within(0.1, 10.0);
                let origin = Vec3::new(random.within(-1.0, 1.0), height, random.within(-1.0, 1.0));
                let mut direction = random.unit_vec3();
                direction.y *= 0.25;
                (Ray::new(origin, direction), sphere)
            }
            Self::Tangent => {
                let sphere = Sphere::new(random.vec3(-4.0, 4.0), random.log_within(0.1, 10.0));
                let normal = random.unit_vec3();
                let along = normal.cross(random.unit_vec3());
                let off = 2.0_f64.powf(-f64::from(random.within(4.0, 30.0)));
                let sign = if random.next_u32().is_multiple_of(2) {
                    1.0
                } else {
                    -1.0
                };
                let touch = sphere.center().as_dvec3()
                    + normal.as_dvec3() * (f64::from(sphere.radius()) * (1.0 + sign * off));
                let back = f64::from(random.within(0.5, 4.0) * sphere.radius());
                let direction = along.as_dvec3().normalize();
                let origin: DVec3 = touch - direction * back;
                (Ray::new(origin.as_vec3(), direction.as_vec3()), sphere)
            }
            Self::Surface => {
                let sphere = Sphere::new(random.vec3(-10.0, 10.0), random.log_within(0.1, 10.0));
                let origin = sphere.center() + random.unit_vec3() * sphere.radius();
                (Ray::new(origin, random.unit_vec3()), sphere)
            }
            Self::Inside => {
                let sphere = Sphere::new(random.vec3(-10.0, 10.0), random.log_within(0.1, 10.0));
                let origin = sphere.center() + random.vec3(-0.5, 0.5) * sphere.radius();
                (Ray::new(origin, random.unit_vec3()), sphere)
            }
        }
    }
}
