//! [`Surface`]: the geometry at a hit. Runs on the GPU and on the CPU.

use glam::Vec3;
// On the CPU, std has `f32::sqrt`.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

#[cfg(all(target_arch = "spirv", not(feature = "f64")))]
use crate::arithmetic::DoubleSingle;
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
    /// Where there is none.
    pub const NONE: Self = Self {
        point: Vec3::ZERO,
        normal: Vec3::ZERO,
        error: 0.0,
    };

    /// The surface of `sphere` where `ray` has the parameter `t`.
    #[inline]
    #[must_use]
    pub fn at(ray: &Ray, t: f32, sphere: Sphere) -> Self {
        let center = sphere.center();
        let radius = sphere.radius();
        // Relative to the centre from the start: the digits that a large |C| would take from the
        // point are still there for the normal.
        let outward = (ray.origin - center) + ray.direction * t;
        let (squared, radius_squared) = (outward.dot(outward), radius * radius);
        let is_there = (squared * 4.0 >= radius_squared) & (squared <= radius_squared * 4.0);
        let normal = if is_there {
            unit(outward)
        } else {
            Self::normal_where_entered(ray, sphere)
        };
        // Projected back onto the sphere: what is left of the error does not depend on t.
        let point = center + normal * radius;
        let size = center.abs().max_element() + radius.abs();
        Self {
            point,
            normal,
            error: Self::error(size),
        }
    }

    /// The normal where the ray enters a sphere, from the foot of the perpendicular, for a sphere
    /// so small and so far away that the parameter has no digit of it. Against the ray if the foot
    /// has none either.
    #[inline]
    fn normal_where_entered(ray: &Ray, sphere: Sphere) -> Vec3 {
        let along = unit(ray.direction);
        let o = ray.origin - sphere.center();
        let foot = o - along * o.dot(along);
        let half_chord = (sphere.radius() * sphere.radius() - foot.dot(foot))
            .max(0.0)
            .sqrt();
        let normal = unit(foot - along * half_chord);
        if normal.dot(normal) > 0.0 {
            normal
        } else {
            -along
        }
    }

    /// How far, at most, [`Surface::at`] puts a point beside a sphere whose radius and largest
    /// coordinate add up to `size`.
    ///
    /// The normal's length is off by 3u, its product with r and the sum by u each, which makes
    /// 5u r + u|C| along an axis; √3 axes and a factor of two to spare.
    #[inline]
    #[must_use]
    pub fn error(size: f32) -> f32 {
        size * (18.0 / (1 << 24) as f32)
    }

    /// The same with a point that is nearer to the sphere: off by a few u of its own coordinates,
    /// where u = 2⁻²⁴, however large the sphere is and however far away its centre.
    ///
    /// The ray's point is O + t d. It is beyond the sphere by (|P − C|² − r²) / 2r, along the
    /// normal and up to terms of second order. In pairs of floats this is off by a few u² (|C| +
    /// r), and it is subtracted.
    #[inline]
    #[must_use]
    pub fn refined(self, ray: &Ray, t: f32, sphere: Sphere) -> Self {
        let point = ray.at(t);
        let (beyond, radius) = (beyond(point, sphere), sphere.radius());
        // Squares overflow where radii are beyond 2⁵⁰ or so.
        if beyond.abs() < radius.abs() {
            Self {
                point: point - self.normal * beyond,
                ..self
            }
        } else {
            self
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
    /// it does not hit again what it leaves, however small or large that is. For tracers that know
    /// nothing of where a ray comes from; light paths start at the point itself, and
    /// [pass over](crate::accel::brute::MovingSpheres::left) the sphere.
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

/// How far a point is beyond a sphere, (|P − C|² − r²) / 2r, to within a few u² (|C| + r).
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
#[inline]
fn beyond(point: Vec3, sphere: Sphere) -> f32 {
    let (center, radius) = (sphere.center(), f64::from(sphere.radius()));
    let x = f64::from(point.x) - f64::from(center.x);
    let y = f64::from(point.y) - f64::from(center.y);
    let z = f64::from(point.z) - f64::from(center.z);
    let squares = x * x + y * y + (z * z - radius * radius);
    // The quotient need not be of 64 bits: it is small where it counts.
    squares as f32 / (2.0 * sphere.radius().abs())
}

/// The same in pairs of floats.
#[cfg(all(target_arch = "spirv", not(feature = "f64")))]
#[inline]
fn beyond(point: Vec3, sphere: Sphere) -> f32 {
    let (center, radius) = (sphere.center(), sphere.radius());
    let square = |a: f32, b: f32| {
        let difference = DoubleSingle::difference(a, b);
        difference.times(difference)
    };
    let squares = square(point.x, center.x)
        .plus(square(point.y, center.y))
        .plus(square(point.z, center.z))
        .minus(DoubleSingle::product(radius, radius));
    squares.high / (2.0 * radius.abs())
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
