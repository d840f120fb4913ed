//! [`Scenery`]: the constants of a launch of light paths. Runs on the GPU and on the CPU.

use glam::Vec4;

use super::place::Place;
use crate::accel::brute::MovingSpheres;
use crate::accel::traversal::Traversal;
use crate::effects::Effects;
use crate::film::PathLaunch;
use crate::hit::Hit;
use crate::light::Light;
use crate::material::{Material, material_of};
use crate::ray::Ray;
use crate::shape::Shapes;
use crate::shape::among::AtTime;
use crate::sphere::Sphere;
use crate::surface::Surface;

/// The constants of a launch of light paths: how the pipeline was compiled, the parameters of the
/// launch, and the world.
#[derive(Clone, Copy, Debug)]
pub struct Scenery<'a, T> {
    /// The effects that the pipeline holds.
    pub effects: Effects,
    /// The rung, a value of [`Rung::to_u32`](crate::Rung::to_u32).
    pub rung: u32,
    /// The parameters of the launch.
    pub launch: &'a PathLaunch,
    /// Finds hits among the spheres, on this rung.
    pub traversal: T,
    /// The spheres.
    pub spheres: &'a [Sphere],
    /// The shapes beside them.
    pub shapes: Shapes<'a>,
    /// How each sphere moves, in scene units per unit of time.
    pub velocities: &'a [Vec4],
    /// For each sphere and then for each shape, the index of its material.
    pub material_ids: &'a [u32],
    /// The materials.
    pub materials: &'a [Material],
    /// The lights that are sampled.
    pub lights: &'a [Light],
    /// The table of [`Shares`](crate::material::microfacet::Shares), followed by that of
    /// [`Sky`](crate::light::sky::Sky).
    pub tables: &'a [f32],
    /// The channels of the image of the surroundings, three a texel.
    pub texels: &'a [f32],
}

impl<T: Traversal> Scenery<'_, T> {
    /// The spheres where they are at `time`, for a ray that leaves the one with the index `left`.
    #[inline]
    #[must_use]
    pub fn spheres_at(&self, time: f32, left: u32) -> MovingSpheres<'_> {
        MovingSpheres {
            spheres: self.spheres,
            velocities: self.velocities,
            time,
            effects: self.effects,
            left,
            target: Hit::NONE_SPHERE,
        }
    }

    /// The sphere with this index where it is at `time`.
    #[inline]
    #[must_use]
    pub fn sphere(&self, index: usize, time: f32) -> Sphere {
        self.spheres_at(time, Hit::NONE_SPHERE).read(index)
    }

    /// How often a path bounces at most: after the last bounce it may only arrive at a light.
    #[inline]
    pub(super) fn most_bounces(&self) -> u32 {
        // As many as a path counts.
        self.launch.max_bounces.min(0xfffe)
    }

    /// The nearest hit of a ray, among spheres and shapes where they are at `time`, for one that
    /// leaves the one with the index `left`.
    #[inline]
    pub(super) fn nearest_hit(&self, ray: &Ray, left: u32, time: f32) -> Hit {
        let spheres = self.spheres_at(time, left);
        let hit = self.traversal.nearest_hit(ray, &spheres);
        self.or_shape(ray, hit, left, time)
    }

    /// A hit among the spheres, or the hit of a shape if that is nearer.
    #[inline]
    #[must_use]
    pub fn or_shape(&self, ray: &Ray, hit: Hit, left: u32, time: f32) -> Hit {
        let motion = self.motion(time);
        self.shapes.nearest_hit(self.rung, ray, hit, left, motion)
    }

    /// Whether a ray hits a shape: see [`Scenery::or_shape`].
    #[inline]
    #[must_use]
    pub fn is_blocked_by_shape(&self, ray: &Ray, left: u32, time: f32) -> bool {
        let motion = self.motion(time);
        self.shapes.are_hit(self.rung, ray, left, motion)
    }

    #[inline]
    fn motion(&self, time: f32) -> AtTime<'_> {
        AtTime {
            effects: self.effects,
            time,
            velocities: self.velocities,
        }
    }

    /// The place where a ray has a hit.
    #[inline]
    pub(super) fn place(&self, ray: &Ray, hit: Hit, time: f32) -> Place {
        let index = hit.sphere as usize;
        let material = self.material(index);
        if self.shapes.have(hit.sphere) {
            let motion = self.motion(time);
            return Place {
                material,
                radius: 0.0,
                sphere: hit.sphere,
                surface: self.shapes.surface(ray, hit.t, hit.sphere, motion),
            };
        }
        let sphere = self.sphere(index, time);
        Place {
            material,
            radius: sphere.radius(),
            sphere: hit.sphere,
            surface: self.surface(ray, hit.t, sphere),
        }
    }

    /// The surface of a sphere where a ray has the parameter `t`.
    #[inline]
    pub(super) fn surface(&self, ray: &Ray, t: f32, sphere: Sphere) -> Surface {
        let surface = Surface::at(ray, t, sphere);
        if self.effects.any(Effects::LARGE_SPHERES) {
            surface.refined(ray, t, sphere)
        } else {
            surface
        }
    }

    /// The size by which the smaller of two pieces of glass is the medium where both are: the
    /// radius of a sphere, half of the thickness of another shape.
    #[inline]
    pub(super) fn size(&self, index: u32, time: f32) -> f32 {
        if self.shapes.have(index) {
            self.shapes.size(index)
        } else {
            self.sphere(index as usize, time).radius().abs()
        }
    }

    /// The material of the sphere with this index.
    #[inline]
    pub(super) fn material(&self, index: usize) -> Material {
        material_of(index, self.material_ids, self.materials)
    }

    /// Whether anything is in the way of a ray from the sphere with the index `left` up to the one
    /// with the index `target`.
    #[inline]
    pub(super) fn is_blocked(&self, ray: &Ray, left: u32, target: u32, time: f32) -> bool {
        let spheres = MovingSpheres {
            target,
            ..self.spheres_at(time, left)
        };
        self.traversal.is_occluded(ray, &spheres) || self.is_blocked_by_shape(ray, left, time)
    }
}
