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
    /// How far, at most, the point is from the sphere, in scene units.
    pub error: f32,
}

impl Surface {
    /// The surface of `sphere` where `ray` has the parameter `t`.
    #[inline]
    #[must_use]
    pub fn at(ray: &Ray, t: f32, sphere: Sphere) -> Self {
        let center = sphere.center();
        let radius = sphere.radius();
        // Relative to the centre from the start: the digits that a large |C| would take from the
        // point are still there for the normal.
        let normal = unit((ray.origin - center) + ray.direction * t);
        // Projected back onto the sphere: what is left of the error does not depend on t. The
        // normal's length is off by 3u, its product with r and the sum by u each, which makes
        // 5u r + u|C| along an axis; √3 axes and a factor of two to spare.
        let point = center + normal * radius;
        let size = center.abs().max_element() + radius.abs();
        Self {
            point,
            normal,
            error: size * (18.0 / (1 << 24) as f32),
        }
    }

    /// The normal on the side that `direction` comes from.
    #[inline]
    #[must_use]
    pub fn facing(&self, direction: Vec3) -> Vec3 {
        if self.normal.dot(direction) > 0.0 {
            -self.normal
        } else {
            self.normal
        }
    }

    /// A ray that leaves the surface along `direction`, on the side of the sphere that the
    /// direction points to, and from outside of the band in which rounding decides what is inside:
    /// it does not hit again what it leaves, however small or large that is.
    #[inline]
    #[must_use]
    pub fn leave(&self, direction: Vec3) -> Ray {
        let outward = if self.normal.dot(direction) >= 0.0 {
            1.0
        } else {
            -1.0
        };
        // Twice, because the sum rounds once more.
        Ray::new(
            self.point + self.normal * (2.0 * self.error * outward),
            direction,
        )
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
