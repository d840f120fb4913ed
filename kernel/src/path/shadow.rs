//! [`Shadow`]: a shadow ray, and the light that it brings. Runs on the GPU and on the CPU.

use glam::Vec3;

use super::place::Place;
use super::scenery::Scenery;
use crate::accel::traversal::Traversal;
use crate::effects::Effects;
use crate::hit::Hit;
use crate::precision::intersect;
use crate::ray::Ray;
use crate::sphere::Sphere;

/// The end of a ray that does not get to its light.
const BLOCKED: f32 = -1.0;

/// Light that a vertex scatters into the path, unless something is in the way of its ray.
#[derive(Clone, Copy, Debug)]
pub struct Shadow {
    /// From the vertex, up to where the light is.
    pub ray: Ray,
    /// The index of the sphere that the ray leaves, and does not meet again.
    pub left: u32,
    /// The index of the lamp's sphere up to which the ray goes; [`Hit::NONE_SPHERE`] for another
    /// light.
    pub target: u32,
    /// The same, as long as the ray's end does not say where that sphere begins.
    pub lamp: u32,
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
        target: Hit::NONE_SPHERE,
        lamp: Hit::NONE_SPHERE,
        light: Vec3::ZERO,
        scatterings: 1,
    };

    /// From a place on, up to where the ray meets the sphere again that it leaves, if it does.
    #[inline]
    pub(super) fn towards(place: &Place, direction: Vec3) -> Self {
        let exit = place.exit(direction);
        Self {
            ray: Ray::within(place.surface.point, direction, f32::MIN_POSITIVE, exit),
            left: place.sphere,
            ..Self::NONE
        }
    }

    /// The same up to a light that is so far away. There is none if the ray ends before.
    #[inline]
    #[must_use]
    pub fn up_to(self, distance: f32) -> Self {
        let mut shadow = self;
        shadow.lamp = Hit::NONE_SPHERE;
        if self.ray.t_max < distance {
            shadow.light = Vec3::ZERO;
            shadow.ray.t_max = BLOCKED;
        } else {
            shadow.ray.t_max = distance;
        }
        shadow
    }

    /// The same up to where the lamp's sphere begins, if that is not known yet.
    #[inline]
    pub(super) fn up_to_lamp<T: Traversal>(self, scenery: &Scenery<'_, T>, time: f32) -> Self {
        if scenery.effects.any(Effects::SOFT_SHADOWS) && self.lamp != Hit::NONE_SPHERE {
            let lamp = scenery.sphere(self.lamp as usize, time);
            let t = intersect(scenery.rung, lamp, &self.whole_ray());
            self.up_to(self.distance(lamp, t))
        } else {
            self
        }
    }

    /// The whole half-line of the ray.
    #[inline]
    #[must_use]
    pub fn whole_ray(&self) -> Ray {
        Ray {
            t_max: Hit::NONE_T,
            ..self.ray
        }
    }

    /// How far away the lamp's sphere begins, which the [whole ray](Shadow::whole_ray) hits at `t`.
    /// The interval of a ray is half-open: one that ends there does not meet the lamp.
    #[inline]
    #[must_use]
    pub fn distance(&self, lamp: Sphere, t: f32) -> f32 {
        if t < Hit::NONE_T {
            return t;
        }
        // The direction is one in which the sphere is seen, but for rounding, and the ray passes it
        // by: up to where the sphere is nearest.
        let towards = lamp.center() - self.ray.origin;
        towards.length() - lamp.radius().abs()
    }

    /// The ray with this light, unless it ends before it arrives at any.
    #[inline]
    pub(super) fn carrying(self, light: Vec3) -> Self {
        if self.ray.t_max == BLOCKED {
            self
        } else {
            Self { light, ..self }
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
