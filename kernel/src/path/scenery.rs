//! [`Scenery`]: the constants of a launch of light paths. Runs on the GPU and on the CPU.

use glam::Vec4;

use crate::accel::brute::MovingSpheres;
use crate::accel::traversal::Traversal;
use crate::effects::Effects;
use crate::film::PathLaunch;
use crate::hit::Hit;
use crate::light::Light;
use crate::material::Material;
use crate::sphere::Sphere;

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
        }
    }

    /// The sphere with this index where it is at `time`.
    #[inline]
    pub(super) fn sphere(&self, index: usize, time: f32) -> Sphere {
        self.spheres_at(time, Hit::NONE_SPHERE).read(index)
    }

    /// How often a path bounces at most: after the last bounce it may only arrive at a light.
    #[inline]
    pub(super) fn most_bounces(&self) -> u32 {
        // As many as a path counts.
        self.launch.max_bounces.min(0xfffe)
    }
}
