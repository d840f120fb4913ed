//! [`Material`]: the material of a sphere. Runs on the GPU and on the CPU.

pub mod microfacet;
pub mod optics;
pub mod plastic;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::arithmetic::elements::read;

/// A material. Spheres share materials by index, four bytes a sphere.
///
/// 32 bytes; what the numbers mean depends on the kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Material {
    /// Diffuse: the reflectance. Metal: the reflectance at normal incidence. Plastic: the
    /// reflectance of the base. Linear Rec. 709, each channel between 0 and 1.
    pub color: Vec3,
    /// The kind, one of the constants.
    pub kind: u32,
    /// Emissive: the radiance. Glass: the absorption per scene unit. Plastic: the refractive index
    /// of the coat, in each component.
    pub volume: Vec3,
    /// Metal, plastic: GGX's α. Glass: the refractive index inside over that outside.
    pub parameter: f32,
}

impl Material {
    /// Reflects diffusely, by Lambert's law.
    pub const DIFFUSE: u32 = 0;
    /// Metal, smooth or rough.
    pub const METAL: u32 = 1;
    /// Glass inside of the sphere.
    pub const GLASS: u32 = 2;
    /// Glass outside of the sphere and none inside: the inner side of hollow glass.
    pub const BUBBLE: u32 = 3;
    /// Glows, the same in all directions, and reflects nothing.
    pub const EMISSIVE: u32 = 4;
    /// A diffuse base under a clear coat.
    pub const PLASTIC: u32 = 5;

    /// A diffuse material of this reflectance.
    #[must_use]
    pub const fn diffuse(color: Vec3) -> Self {
        Self {
            color,
            kind: Self::DIFFUSE,
            volume: Vec3::ZERO,
            parameter: 0.0,
        }
    }

    /// A metal of this reflectance, with a roughness from 0, a mirror, to 1; α is the square of
    /// the roughness.
    #[must_use]
    pub const fn metal(color: Vec3, roughness: f32) -> Self {
        Self {
            color,
            kind: Self::METAL,
            volume: Vec3::ZERO,
            parameter: roughness * roughness,
        }
    }

    /// Glass of this refractive index and this absorption per scene unit.
    #[must_use]
    pub const fn glass(index: f32, absorption: Vec3) -> Self {
        Self {
            color: Vec3::ONE,
            kind: Self::GLASS,
            volume: absorption,
            parameter: index,
        }
    }

    /// A hollow in glass of this refractive index and this absorption per scene unit.
    #[must_use]
    pub const fn bubble(index: f32, absorption: Vec3) -> Self {
        Self {
            color: Vec3::ONE,
            kind: Self::BUBBLE,
            volume: absorption,
            parameter: 1.0 / index,
        }
    }

    /// Plastic: a diffuse base of this reflectance under a clear coat of this refractive index. The
    /// roughness goes from 0, polished, to 1; α is its square.
    #[must_use]
    pub const fn plastic(color: Vec3, roughness: f32, index: f32) -> Self {
        Self {
            color,
            kind: Self::PLASTIC,
            volume: Vec3::splat(index),
            parameter: roughness * roughness,
        }
    }

    /// A material that glows with this radiance.
    #[must_use]
    pub const fn emissive(radiance: Vec3) -> Self {
        Self {
            color: Vec3::ZERO,
            kind: Self::EMISSIVE,
            volume: radiance,
            parameter: 0.0,
        }
    }
}

impl Material {
    /// Whether it is glass, solid or hollow.
    #[must_use]
    pub const fn is_glass(&self) -> bool {
        (self.kind == Self::GLASS) | (self.kind == Self::BUBBLE)
    }
}

/// The material of the sphere with this index; an index beyond `materials`
/// selects its last entry.
#[inline]
#[must_use]
pub fn material_of(sphere: usize, material_ids: &[u32], materials: &[Material]) -> Material {
    if sphere < material_ids.len() && !materials.is_empty() {
        let id = read(material_ids, sphere) as usize;
        read(materials, id.min(materials.len() - 1))
    } else {
        Material::diffuse(Vec3::ONE)
    }
}

const _: () = {
    assert!(size_of::<Material>() == 32);
    assert!(core::mem::offset_of!(Material, kind) == 12);
    assert!(core::mem::offset_of!(Material, volume) == 16);
    assert!(core::mem::offset_of!(Material, parameter) == 28);
};
