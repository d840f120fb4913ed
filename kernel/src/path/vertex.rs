//! Where a path is scattered: by a diffuse surface, by rough metal, or by fog. Runs on the GPU and on the CPU.

use glam::{Vec2, Vec3};

use super::sampling::{cosine_density, cosine_hemisphere};
use super::scenery::Scenery;
use crate::accel::traversal::Traversal;
use crate::effects::Effects;
use crate::material::microfacet::RoughMetal;
use crate::surface::unit;

/// How a vertex scatters.
pub(super) const LAMBERT: u32 = 0;
pub(super) const METAL: u32 = 1;
pub(super) const PHASE: u32 = 2;

/// Where a path is scattered, other than at a mirror or at glass.
pub(super) struct Vertex {
    /// One of the constants.
    pub(super) lobe: u32,
    /// The direction from which the path comes.
    pub(super) incoming: Vec3,
    /// The surface's normal, on the side that the path comes from.
    pub(super) facing: Vec3,
    pub(super) x: Vec3,
    pub(super) y: Vec3,
    pub(super) color: Vec3,
    pub(super) metal: RoughMetal,
}

impl Vertex {
    /// How much light is scattered from `to` into the path, times the cosine at a surface; and the
    /// density with which [`Vertex::sample`] chooses `to`.
    #[inline]
    pub(super) fn evaluate<T: Traversal>(&self, scenery: &Scenery<'_, T>, to: Vec3) -> (Vec3, f32) {
        let effects = scenery.effects;
        if effects.any(Effects::FOG) && self.lobe == PHASE {
            let phase = scenery.launch.fog.phase(self.incoming.dot(to));
            (Vec3::splat(phase), phase)
        } else if effects.any(Effects::ROUGH_METAL) && self.lobe == METAL {
            let local = Vec3::new(self.x.dot(to), self.y.dot(to), self.facing.dot(to));
            self.metal.evaluate(local, scenery.tables)
        } else {
            let density = cosine_density(self.facing.dot(to));
            (self.color * density, density)
        }
    }

    /// A direction to continue in.
    #[inline]
    pub(super) fn sample<T: Traversal>(
        &self,
        scenery: &Scenery<'_, T>,
        u: Vec2,
        choice: f32,
    ) -> Vec3 {
        let effects = scenery.effects;
        if effects.any(Effects::FOG) && self.lobe == PHASE {
            scenery.launch.fog.sample(self.incoming, u)
        } else if effects.any(Effects::ROUGH_METAL) && self.lobe == METAL {
            let to = self.metal.sample(u, choice);
            unit(self.x * to.x + self.y * to.y + self.facing * to.z)
        } else {
            cosine_hemisphere(self.facing, u)
        }
    }
}
