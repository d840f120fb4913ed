//! [`Scenery`]: the constants of a launch of light paths. Runs on the GPU and on the CPU.

use glam::Vec4;

use crate::accel::brute::MovingSpheres;
use crate::accel::traversal::Traversal;
use crate::effects::Effects;
use crate::film::PathLaunch;
use crate::hit::Hit;
use crate::light::Light;
use crate::material::{Material, material_of};
use crate::ray::Ray;
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
    /// How each sphere moves, in scene units per unit of time.
    pub velocities: &'a [Vec4],
    /// For each sphere, the index of its material.
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
        self.traversal.is_occluded(ray, &spheres)
    }
}
