//! [`Surface`]: the geometry at a hit. Runs on the GPU and on the CPU.

use glam::Vec3;

use crate::ray::Ray;
use crate::sphere::Sphere;

/// The point where a ray meets a sphere, and the sphere's outward normal there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// The point, in scene units.
    pub point: Vec3,
    /// The outward unit normal.
    pub normal: Vec3,
}

impl Surface {
    /// The surface of `sphere` where `ray` has the parameter `t`.
    #[inline]
    #[must_use]
    pub fn at(ray: &Ray, t: f32, sphere: Sphere) -> Self {
        let point = ray.at(t);
        // Normalised rather than divided by the radius: the point is on the sphere only up to
        // rounding, and a normal must have length one all the same.
        let normal = (point - sphere.center()).normalize_or_zero();
        Self { point, normal }
    }
}
