//! [`Shading`]: from a hit to a colour. Runs on the GPU and on the CPU.

use glam::Vec3;

use crate::material::Material;
use crate::ray::Ray;
use crate::surface::{Surface, unit};

/// What the image shows of a hit.
///
/// The mode is fixed before the pipeline is compiled: on the GPU it is a specialisation
/// constant, on the CPU a constant that each loop is compiled for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u32)]
pub enum Shading {
    /// A lamp at the eye and Lambert's cosine law, with the colour of the sphere's material.
    #[default]
    Lit = 0,
    /// The outward unit normal n, as n · 0.5 + 0.5.
    Normals = 1,
    /// The distance from the eye, in scene units, in all three channels.
    Depth = 2,
    /// Pure red.
    Flat = 3,
}

impl Shading {
    /// The specialisation constant of the `render` entry point that holds the mode.
    pub const SPEC_ID: u32 = 0;

    /// The mode as the kernel's constant.
    #[must_use]
    pub const fn to_u32(self) -> u32 {
        self as u32
    }

    /// Whether the colours are measurements rather than light: normals, depth and flat red go
    /// into an image file as they are, with no transfer curve.
    #[must_use]
    pub const fn is_data(self) -> bool {
        !matches!(self, Self::Lit)
    }
}

const LIT: u32 = Shading::Lit.to_u32();
const NORMALS: u32 = Shading::Normals.to_u32();
const DEPTH: u32 = Shading::Depth.to_u32();

/// The colour of a surface point seen along `ray` at parameter `t`, in the mode `shading`, a
/// value of [`Shading::to_u32`].
#[inline]
#[must_use]
pub fn shade(shading: u32, ray: &Ray, t: f32, surface: &Surface, material: &Material) -> Vec3 {
    if shading == LIT {
        // Lambert with the light where the eye is. The absolute value lights the inside of a
        // sphere that the eye is in.
        let cosine = surface.normal.dot(unit(ray.direction));
        material.color * cosine.abs()
    } else if shading == NORMALS {
        surface.normal * 0.5 + Vec3::splat(0.5)
    } else if shading == DEPTH {
        Vec3::splat(t * ray.direction.length())
    } else {
        Vec3::X
    }
}
