//! Scattering by a diffuse surface, rough metal, plastic or fog. Runs on the GPU and on the CPU.

use glam::Vec3;

use super::random::Numbers;
use super::sampling::{cosine_density, cosine_hemisphere, tangents};
use super::scenery::Scenery;
use crate::accel::traversal::Traversal;
use crate::effects::Effects;
use crate::material::Material;
use crate::material::microfacet::RoughMetal;
use crate::material::plastic::Plastic;
use crate::surface::unit;

/// The lobes.
pub(super) const LAMBERT: u32 = 0;
pub(super) const METAL: u32 = 1;
pub(super) const PHASE: u32 = 2;
pub(super) const PLASTIC: u32 = 3;

/// A place that scatters a path; mirrors and glass are none.
pub(super) struct Vertex {
    /// The lobe, one of the constants.
    pub(super) lobe: u32,
    /// The direction from which the path comes.
    pub(super) incoming: Vec3,
    /// The surface's normal, on the side that the path comes from.
    pub(super) facing: Vec3,
    pub(super) x: Vec3,
    pub(super) y: Vec3,
    pub(super) color: Vec3,
    pub(super) metal: RoughMetal,
    pub(super) plastic: Plastic,
}

impl Vertex {
    /// A vertex with this lobe on a surface of this material. `facing` is the normal on the side of
    /// the path, `incoming` the direction along which the path arrives.
    #[inline]
    pub(super) fn new<T: Traversal>(
        scenery: &Scenery<'_, T>,
        lobe: u32,
        incoming: Vec3,
        facing: Vec3,
        material: &Material,
    ) -> Self {
        // Of lobes that are given in the frame of the surface.
        let has_frame = scenery
            .effects
            .any(Effects::ROUGH_METAL.and(Effects::PLASTIC))
            && (cfg!(target_arch = "spirv") || (lobe == METAL) | (lobe == PLASTIC));
        let (x, y) = if has_frame {
            tangents(facing)
        } else {
            (Vec3::ZERO, Vec3::ZERO)
        };
        let from = -Vec3::new(x.dot(incoming), y.dot(incoming), facing.dot(incoming));
        let (color, alpha, tables) = (material.color, material.parameter, scenery.tables);
        // A GPU's threads would wait for those whose vertex is of metal.
        let may_be_metal = cfg!(target_arch = "spirv") || lobe == METAL;
        Self {
            lobe,
            incoming,
            facing,
            x,
            y,
            color,
            metal: if scenery.effects.any(Effects::ROUGH_METAL) && may_be_metal {
                RoughMetal::new(color, alpha, from, tables)
            } else {
                RoughMetal::NONE
            },
            plastic: if scenery.effects.any(Effects::PLASTIC) && lobe == PLASTIC {
                Plastic::new(color, material.volume.x, alpha, from, tables)
            } else {
                Plastic::NONE
            },
        }
    }

    /// The share of light that is scattered from `to` into the path, times the cosine at a surface;
    /// and the density with which [`Vertex::sample`] chooses `to`.
    #[cfg_attr(target_arch = "spirv", inline)]
    #[cfg_attr(not(target_arch = "spirv"), inline(always))]
    pub(super) fn evaluate<T: Traversal>(&self, scenery: &Scenery<'_, T>, to: Vec3) -> (Vec3, f32) {
        let effects = scenery.effects;
        if effects.any(Effects::FOG) && self.lobe == PHASE {
            let phase = scenery.launch.fog.phase(self.incoming.dot(to));
            (Vec3::splat(phase), phase)
        } else if effects.any(Effects::ROUGH_METAL) && self.lobe == METAL {
            self.metal.evaluate(self.local(to), scenery.tables)
        } else if effects.any(Effects::PLASTIC) && self.lobe == PLASTIC {
            self.plastic.evaluate(self.local(to), scenery.tables)
        } else {
            let density = cosine_density(self.facing.dot(to));
            (self.color * density, density)
        }
    }

    /// Samples a direction in which the path continues.
    #[inline]
    pub(super) fn sample<T: Traversal>(
        &self,
        scenery: &Scenery<'_, T>,
        numbers: &impl Numbers,
    ) -> Vec3 {
        let effects = scenery.effects;
        if effects.any(Effects::FOG) && self.lobe == PHASE {
            scenery
                .launch
                .fog
                .sample(self.incoming, numbers.direction())
        } else if effects.any(Effects::ROUGH_METAL) && self.lobe == METAL {
            self.global(
                self.metal
                    .sample(numbers.direction().u, numbers.others().choice()),
            )
        } else if effects.any(Effects::PLASTIC) && self.lobe == PLASTIC {
            self.global(
                self.plastic
                    .sample(numbers.direction().u, numbers.others().choice()),
            )
        } else {
            cosine_hemisphere(self.facing, numbers.direction())
        }
    }

    /// A direction of the scene, in the frame of the surface.
    #[inline]
    fn local(&self, to: Vec3) -> Vec3 {
        Vec3::new(self.x.dot(to), self.y.dot(to), self.facing.dot(to))
    }

    /// A direction of the surface's frame, in scene coordinates.
    #[inline]
    fn global(&self, to: Vec3) -> Vec3 {
        unit(self.x * to.x + self.y * to.y + self.facing * to.z)
    }
}
