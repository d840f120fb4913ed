//! [`Shadow`]: a shadow ray, and the light that it brings. Runs on the GPU and on the CPU.

use glam::Vec3;

use super::place::Place;
use crate::hit::Hit;
use crate::ray::Ray;

/// Light that a vertex scatters into the path, unless something is in the way of its ray.
#[derive(Clone, Copy, Debug)]
pub struct Shadow {
    /// From the vertex, up to where the light is.
    pub ray: Ray,
    /// The index of the sphere that the ray leaves, and does not meet again.
    pub left: u32,
    /// The light; zero if there is none, and nothing to ask.
    pub light: Vec3,
    /// How many times it was scattered, the vertex included: see
    /// [`Path::receive`](super::Path::receive).
    pub scatterings: u32,
}

impl Shadow {
    /// Without light.
    pub(super) const NONE: Self = Self {
        ray: Ray {
            origin: Vec3::ZERO,
            t_min: f32::MIN_POSITIVE,
            direction: Vec3::ZERO,
            t_max: 0.0,
        },
        left: Hit::NONE_SPHERE,
        light: Vec3::ZERO,
        scatterings: 1,
    };

    /// Light from `direction` that starts `distance` away from the place. A ray that goes into the
    /// sphere that it leaves, and ends beyond it, brings none.
    #[inline]
    pub(super) fn new(place: &Place, direction: Vec3, distance: f32, light: Vec3) -> Self {
        if place.exit(direction) < distance {
            return Self::NONE;
        }
        Self {
            ray: Ray::within(place.surface.point, direction, f32::MIN_POSITIVE, distance),
            left: place.sphere,
            light,
            scatterings: 1,
        }
    }

    /// Light that nothing is in the way of: its ray is empty.
    #[inline]
    pub(super) fn certain(light: Vec3) -> Self {
        Self {
            light,
            ..Self::NONE
        }
    }

    /// The same, scattered so many times.
    #[inline]
    pub(super) fn scattered(self, scatterings: u32) -> Self {
        Self {
            scatterings,
            ..self
        }
    }

    /// Whether there is light.
    #[inline]
    #[must_use]
    pub fn is_some(&self) -> bool {
        // Written so that NaN counts.
        !((self.light.x == 0.0) & (self.light.y == 0.0) & (self.light.z == 0.0))
    }
}
