//! [`Surface`]: the geometry at a hit. Runs on the GPU and on the CPU.

use glam::Vec3;
// On the CPU, std has `f32::sqrt`.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

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
        let normal = unit(point - sphere.center());
        Self { point, normal }
    }
}

/// The vector at length one, or zero if its squared length is zero, overflows or is not a number.
///
/// glam's own function tests against an infinite literal, which not every shader compiler takes.
#[inline]
#[must_use]
pub fn unit(vector: Vec3) -> Vec3 {
    let squared = vector.dot(vector);
    if (squared > 0.0) & (squared <= f32::MAX) {
        vector / squared.sqrt()
    } else {
        Vec3::ZERO
    }
}
