//! [`Chain`]: what a path has met since it left a vertex, as far as a connection by a sphere might
//! have found the same. Runs on the GPU and on the CPU.

use glam::Vec3;

use super::ball::{HOLLOW, MIRROR, SOLID};
use crate::hit::Hit;

/// What a path has met since it left a vertex. It holds no vector, because naga would count 32
/// bytes for it where rust-gpu counts 24.
#[derive(Clone, Copy, Debug)]
pub(in crate::path) struct Chain {
    /// The point that it left.
    x: f32,
    y: f32,
    z: f32,
    /// The density of its direction there, times the shares of light that glass let through.
    pub(in crate::path) density: f32,
    /// The index of the first sphere that it met.
    pub(in crate::path) caster: u32,
    /// One of the constants, or [`FRESH`] plus the number of refractions.
    stage: u32,
}

/// No connection finds this path.
const LOST: u32 = 0;
/// It has met nothing yet.
const FRESH: u32 = 1;
/// It has met a mirror.
const MIRRORED: u32 = 8;

/// What stands for a kind of [`Ball`](super::ball::Ball) where there is none.
pub(in crate::path) const NO_KIND: u32 = u32::MAX;

impl Chain {
    /// That of a path that no connection finds.
    pub(in crate::path) const LOST: Self = Self {
        x: 0.0,
        y: 0.0,
        z: 0.0,
        density: 0.0,
        caster: Hit::NONE_SPHERE,
        stage: LOST,
    };

    /// That of a path that leaves a vertex outside of glass with this density.
    #[inline]
    pub(in crate::path) fn fresh(vertex: Vec3, density: f32) -> Self {
        Self {
            x: vertex.x,
            y: vertex.y,
            z: vertex.z,
            density,
            stage: FRESH,
            ..Self::LOST
        }
    }

    /// The point that the path left.
    #[inline]
    pub(in crate::path) fn vertex(&self) -> Vec3 {
        Vec3::new(self.x, self.y, self.z)
    }

    /// The path is refracted by a sphere that lets this share of light through.
    #[inline]
    pub(in crate::path) fn refract(&mut self, sphere: u32, is_outside: bool, share: f32) {
        self.density *= share;
        if is_outside {
            // From outside only as the first.
            self.stage = if self.stage == FRESH { FRESH + 1 } else { LOST };
            self.caster = sphere;
        } else if (self.stage > FRESH) & (self.stage < FRESH + 4) {
            self.stage += 1;
        } else {
            self.stage = LOST;
        }
    }

    /// The path is mirrored by a sphere.
    #[inline]
    pub(in crate::path) fn mirror(&mut self, sphere: u32) {
        self.stage = if self.stage == FRESH { MIRRORED } else { LOST };
        self.caster = sphere;
    }

    /// What light did at the caster if now, outside of all glass, it meets a lamp; [`NO_KIND`] if
    /// it met none, or others. In glass that casts caustics there is but its own hollow, so that
    /// which spheres refracted the path follows from how many did.
    #[inline]
    pub(in crate::path) fn kind(&self) -> u32 {
        if self.stage == FRESH + 2 {
            SOLID
        } else if self.stage == FRESH + 4 {
            HOLLOW
        } else if self.stage == MIRRORED {
            MIRROR
        } else {
            NO_KIND
        }
    }
}
