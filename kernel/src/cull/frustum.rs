//! [`Frustum`]: four planes around the rays of a rectangle of the film. Runs on the GPU and on the CPU.
//!
//! A camera's rays go along F + x R + y U. Those with x from x₀ on are on one side of the plane through the eye along
//! F + x₀ R and U, whatever y is: of its normal n = (F + x₀ R) × U the product with a ray's direction is (x − x₀) n·R. Three
//! more such planes bound a rectangle. A sphere is beyond a plane, and met by none of the rays, where its centre is by
//! more than its radius: with o = C − O and s = o·n, n of unit length and inward, where s < 0 and s² > r².
//!
//! In 32-bit floats, u = 2⁻²⁴, s is off by 4u|o| for its terms. A plane is taken only where F + x₀ R is at least half as long as its terms
//! would be at a right angle, is apart from U by 30° and more, and n is off the plane across R by as much: then n is off by 17u, and
//! the terms of every direction inside are at most 17 times as long as itself, so that rays leave the plane by 51u|o|.
//! That makes 144u o·o of s². What a rung calls a hit the exact numbers may miss by 24u (o·o + r²), as [`slabs`](crate::accel::slabs) says. r² is
//! therefore taken more by 256u (o·o + r²), and no rung's hit is lost.

use glam::{Vec2, Vec3, Vec4};
// On the CPU, std has `f32::sqrt`.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use crate::camera::Camera;
use crate::sphere::Sphere;

/// 256u.
const SLACK: f32 = 1.0 / (1 << 16) as f32;

/// What bounds the rays through a rectangle of the film.
#[derive(Clone, Copy, Debug)]
pub struct Frustum {
    eye: Vec3,
    left: Plane,
    right: Plane,
    below: Plane,
    above: Plane,
}

/// A plane through the eye, by its inward normal of unit length; or, where rounding might decide which that is, none: zeros.
#[derive(Clone, Copy, Debug)]
pub struct Plane(Vec3);

impl Plane {
    /// Of the four around the rays through the film from `low` to `high`: on the left, on the right, below, above.
    #[inline]
    #[must_use]
    pub fn around(camera: &Camera, low: Vec2, high: Vec2, which: u32) -> Self {
        let is_across = which < 2;
        let is_high = which & 1 == 1;
        let (across, axis) = if is_across {
            (camera.right, camera.up)
        } else {
            (camera.up, camera.right)
        };
        let end = if is_high { high } else { low };
        let offset = across * if is_across { end.x } else { end.y };
        Self::of(
            camera.forward,
            offset,
            axis,
            if is_high { -across } else { across },
        )
    }

    /// As one load.
    #[inline]
    #[must_use]
    pub fn to_vec4(self) -> Vec4 {
        self.0.extend(0.0)
    }

    /// Out of one load.
    #[inline]
    #[must_use]
    pub fn from_vec4(vector: Vec4) -> Self {
        Self(vector.truncate())
    }

    /// Along the ray forward + offset and an axis of the film, with what is towards a direction inside.
    #[inline]
    fn of(forward: Vec3, offset: Vec3, axis: Vec3, towards: Vec3) -> Self {
        let ray = forward + offset;
        let normal = ray.cross(axis);
        let (squared, inward) = (normal.dot(normal), normal.dot(towards));
        let is_long = ray.dot(ray) > 0.25 * (forward.dot(forward) + offset.dot(offset));
        let is_wide = squared > 0.25 * (ray.dot(ray) * axis.dot(axis));
        let is_sure = inward * inward > 0.25 * (squared * towards.dot(towards));
        if is_long & is_wide & is_sure {
            let length = if inward < 0.0 {
                -squared.sqrt()
            } else {
                squared.sqrt()
            };
            Self(normal * (1.0 / length))
        } else {
            Self(Vec3::ZERO)
        }
    }
}

impl Frustum {
    /// Around the rays through the film from `low` to `high`, as [`Camera::film`] counts it.
    #[inline]
    #[must_use]
    pub fn around(camera: &Camera, low: Vec2, high: Vec2) -> Self {
        let of = |which| Plane::around(camera, low, high, which);
        Self::within(camera.eye, [of(0), of(1), of(2), of(3)])
    }

    /// Within the four planes around some rays from an eye.
    #[inline]
    #[must_use]
    pub fn within(eye: Vec3, [left, right, below, above]: [Plane; 4]) -> Self {
        Self {
            eye,
            left,
            right,
            below,
            above,
        }
    }

    /// Whether none of the rays meets the sphere on any rung, for certain.
    #[inline]
    #[must_use]
    pub fn misses(&self, sphere: Sphere) -> bool {
        let o = sphere.center() - self.eye;
        let (oo, rr) = (o.dot(o), sphere.radius() * sphere.radius());
        let across = least(o.dot(self.left.0), o.dot(self.right.0));
        let upwards = least(o.dot(self.below.0), o.dot(self.above.0));
        let farthest = least(across, upwards);
        (farthest < 0.0) & (farthest * farthest > rr + SLACK * (oo + rr))
    }
}

/// The smaller of two; a NaN if that is the first.
#[inline]
fn least(a: f32, b: f32) -> f32 {
    if b < a { b } else { a }
}
