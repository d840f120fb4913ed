//! The state of a light path. Runs on the GPU and on the CPU.

use glam::Vec3;

use crate::surface::Surface;

/// The state of a light path.
#[derive(Clone, Copy)]
pub(super) struct Path {
    pub(super) origin: Vec3,
    pub(super) direction: Vec3,
    /// The weight of light that arrives here.
    pub(super) throughput: Vec3,
    /// The light that has arrived so far.
    pub(super) radiance: Vec3,
    /// The absorption per scene unit of the glass that the path is in.
    pub(super) absorption: Vec3,
    /// The density with which the direction was sampled, or zero if no light was sampled.
    pub(super) density: f32,
    pub(super) time: f32,
    pub(super) bounces: u32,
    /// Zero for a path that met nothing but the background.
    pub(super) alpha: f32,
    /// The distance to the first sphere, [`Hit::NONE_T`](crate::Hit::NONE_T) if there was none.
    pub(super) depth: f32,
}

impl Path {
    /// Sends the path off in `direction`, a unit vector that was sampled with this density.
    #[inline]
    pub(super) fn leave(&mut self, surface: &Surface, direction: Vec3, density: f32) {
        self.origin = surface.leave(direction).origin;
        self.direction = direction;
        self.density = density;
        self.bounces += 1;
    }
}

/// Russian roulette: ends dark paths by chance, and raises the weight of those that go on.
#[inline]
pub(super) fn survives(path: &mut Path, u: f32) -> bool {
    let brightest = path.throughput.max_element();
    if brightest <= 0.0 {
        return false;
    }
    if path.bounces > 3 {
        let chance = brightest.clamp(0.05, 1.0);
        path.throughput *= 1.0 / chance;
        return u < chance;
    }
    true
}
