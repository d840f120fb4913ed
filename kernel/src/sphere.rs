//! [`Sphere`]: a centre and a radius. Runs on the GPU and on the CPU.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

/// A sphere, stored as one [`Vec4`] so that a GPU fetches it with a single 16-byte load.
///
/// The host builds the world from this type and uploads it unchanged.
///
/// ```
/// use spherule_kernel::{Ray, Sphere, glam::Vec3};
///
/// let sphere = Sphere::new(Vec3::new(0.0, 0.0, -3.0), 0.5);
/// let ray = Ray::new(Vec3::ZERO, Vec3::NEG_Z);
/// assert_eq!(sphere.intersect(&ray), 2.5);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Sphere {
    center_radius: Vec4,
}

impl Sphere {
    /// A sphere with this centre and this radius, both in scene units.
    ///
    /// The radius should be positive; [`Sphere::is_valid`] checks. A sphere that is not valid is
    /// still safe to trace: rays either miss it, or hit it as if its radius were positive.
    #[inline]
    #[must_use]
    pub const fn new(center: Vec3, radius: f32) -> Self {
        Self {
            center_radius: Vec4::new(center.x, center.y, center.z, radius),
        }
    }

    /// The centre, in scene units.
    #[inline]
    #[must_use]
    pub fn center(&self) -> Vec3 {
        self.center_radius.truncate()
    }

    /// The radius, in scene units.
    #[inline]
    #[must_use]
    pub fn radius(&self) -> f32 {
        self.center_radius.w
    }

    /// Centre (x, y, z) and radius (w) as one vector.
    #[inline]
    #[must_use]
    pub const fn to_vec4(self) -> Vec4 {
        self.center_radius
    }

    /// Whether the centre is finite and the radius is finite and above zero.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.center_radius.is_finite() && self.radius() > 0.0
    }

    /// Whether `point` is inside the sphere or on its surface.
    #[inline]
    #[must_use]
    pub fn contains(&self, point: Vec3) -> bool {
        let from_center = point - self.center();
        from_center.dot(from_center) <= self.radius() * self.radius()
    }
}

const _: () = {
    assert!(size_of::<Sphere>() == 16);
    assert!(core::mem::offset_of!(Sphere, center_radius) == 0);
};
