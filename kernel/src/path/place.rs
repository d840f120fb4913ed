//! [`Place`]: where a path is scattered. Runs on the GPU and on the CPU.

use glam::Vec3;

use crate::hit::Hit;
use crate::material::Material;
use crate::surface::Surface;

/// The place of a path: on a sphere, or in fog. The surface comes last but for what makes it 32
/// bytes, because naga counts 32 for it.
#[repr(C)]
pub(super) struct Place {
    pub(super) material: Material,
    /// The radius of the sphere; zero on another shape.
    pub(super) radius: f32,
    /// The index of the sphere or shape; [`Hit::NONE_SPHERE`] in fog.
    pub(super) sphere: u32,
    pub(super) surface: Surface,
}

impl Place {
    /// A place in space, for a path that is yet to find one.
    #[inline]
    pub(super) fn none() -> Self {
        Self {
            material: Material::diffuse(Vec3::ONE),
            radius: 0.0,
            sphere: Hit::NONE_SPHERE,
            surface: Surface::NONE,
        }
    }

    /// Where a ray that starts here along `direction`, a unit vector, meets the sphere again: a
    /// chord of length 2r cos θ if it goes into the sphere. A ray that goes out of a sphere does
    /// not meet it again. Neither is asked of a rung: where the ray starts, rounding would answer.
    /// Another shape [is asked](crate::shape::Span::exit), with the rest of them.
    #[inline]
    pub(super) fn exit(&self, direction: Vec3) -> f32 {
        let cosine = self.surface.normal.dot(direction);
        if (cosine < 0.0) & (self.radius != 0.0) {
            -2.0 * self.radius.abs() * cosine
        } else {
            Hit::NONE_T
        }
    }
}
