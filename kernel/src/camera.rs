//! [`Camera`]: a pinhole camera. Runs on the GPU and on the CPU.

use bytemuck::{Pod, Zeroable};
use glam::{UVec2, Vec2, Vec3};

use crate::hit::Hit;
use crate::ray::Ray;

/// A pinhole camera with square pixels.
///
/// The image plane is at distance one: `forward` is a unit vector, and `right` and `up` are half
/// the image's width and height there. So the parameter of a hit along a ray from [`Camera::ray`]
/// is the hit's depth along `forward`, in scene units.
///
/// 64 bytes, each vector on a 16-byte boundary.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Camera {
    /// The pinhole, in scene units.
    pub eye: Vec3,
    padding_eye: f32,
    /// The unit vector from the eye to the centre of the image.
    pub forward: Vec3,
    padding_forward: f32,
    /// The vector from the centre of the image plane to the middle of its right edge.
    pub right: Vec3,
    padding_right: f32,
    /// The vector from the centre of the image plane to the middle of its upper edge.
    pub up: Vec3,
    padding_up: f32,
}

impl Camera {
    /// A camera from its parts, which must be as the fields say.
    #[must_use]
    pub const fn from_basis(eye: Vec3, forward: Vec3, right: Vec3, up: Vec3) -> Self {
        Self {
            eye,
            padding_eye: 0.0,
            forward,
            padding_forward: 0.0,
            right,
            padding_right: 0.0,
            up,
            padding_up: 0.0,
        }
    }

    /// The ray through the point `film`: (−1, 1) is the upper left corner of the image, (0, 0) its
    /// centre and (1, −1) its lower right corner.
    ///
    /// The ray starts just after the eye (`t_min` is the smallest normal f32, so that a depth
    /// of exactly zero never occurs), and its direction is not normalised.
    #[inline]
    #[must_use]
    pub fn ray(&self, film: Vec2) -> Ray {
        Ray::within(
            self.eye,
            self.forward + self.right * film.x + self.up * film.y,
            f32::MIN_POSITIVE,
            Hit::NONE_T,
        )
    }

    /// The ray through the centre of `pixel` of an image of `size` pixels; (0, 0) is the upper
    /// left pixel.
    #[inline]
    #[must_use]
    pub fn pixel_ray(&self, pixel: UVec2, size: UVec2) -> Ray {
        self.ray(Self::film(pixel, size))
    }

    /// The centre of `pixel` in the coordinates of [`Camera::ray`].
    #[inline]
    #[must_use]
    pub fn film(pixel: UVec2, size: UVec2) -> Vec2 {
        // Computed in integers up to the one division, so that the centre of an image of odd size
        // is exactly (0, 0) and opposite pixels are exact mirror images. Below 2²³ pixels a side,
        // the integers are exact in f32.
        let twice = |middle: u32| middle.wrapping_mul(2).wrapping_add(1) as f32;
        let x = twice(pixel.x) - size.x as f32;
        let y = size.y as f32 - twice(pixel.y);
        Vec2::new(x / size.x as f32, y / size.y as f32)
    }
}

/// Builds a camera from what a scene says about it; for the host.
#[cfg(not(target_arch = "spirv"))]
mod look_at {
    use glam::{DVec3, Vec3};

    use super::Camera;

    impl Camera {
        /// A camera at `eye` that looks at `target`, with `up` pointing upwards in the image.
        /// `vertical_fov` is the angle in radians between the image's lower and upper edge, and
        /// `aspect` is its width divided by its height. Computed in f64.
        ///
        /// `None` if `eye` equals `target`, `up` is zero or along the view, `vertical_fov` is not
        /// between zero and π, `aspect` is not positive, or a number is not finite.
        #[must_use]
        pub fn look_at(
            eye: Vec3,
            target: Vec3,
            up: Vec3,
            vertical_fov: f64,
            aspect: f64,
        ) -> Option<Self> {
            let finite = eye.is_finite() && target.is_finite() && up.is_finite();
            let fov_in_range = vertical_fov > 0.0 && vertical_fov < core::f64::consts::PI;
            let aspect_in_range = aspect > 0.0 && aspect.is_finite();
            if !(finite && fov_in_range && aspect_in_range) {
                return None;
            }
            let forward = (target.as_dvec3() - eye.as_dvec3()).try_normalize()?;
            let up = up.as_dvec3().try_normalize()?;
            let right = forward.cross(up);
            // With less than about a millionth of a degree between the view and `up`, rounding
            // would decide the camera's roll.
            if right.length_squared() < 1e-16 {
                return None;
            }
            let right = right.normalize();
            let true_up = right.cross(forward);
            let half_height = (0.5 * vertical_fov).tan();
            let to_vec3 = |v: DVec3| v.as_vec3();
            Some(Self::from_basis(
                eye,
                to_vec3(forward),
                to_vec3(right * (half_height * aspect)),
                to_vec3(true_up * half_height),
            ))
        }
    }
}

const _: () = {
    assert!(size_of::<Camera>() == 64);
    assert!(core::mem::offset_of!(Camera, eye) == 0);
    assert!(core::mem::offset_of!(Camera, forward) == 16);
    assert!(core::mem::offset_of!(Camera, right) == 32);
    assert!(core::mem::offset_of!(Camera, up) == 48);
};
