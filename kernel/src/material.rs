//! [`Material`]: what a sphere looks like. Runs on the GPU and on the CPU.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A diffuse material. Spheres share materials by index, four bytes a sphere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Material {
    /// Reflectance, linear Rec. 709, each channel between 0 and 1.
    pub color: Vec3,
    padding: f32,
}

impl Material {
    /// A diffuse material of this reflectance.
    #[must_use]
    pub const fn diffuse(color: Vec3) -> Self {
        Self {
            color,
            padding: 0.0,
        }
    }
}

const _: () = {
    assert!(size_of::<Material>() == 16);
    assert!(core::mem::offset_of!(Material, color) == 0);
};
