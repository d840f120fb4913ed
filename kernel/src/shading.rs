//! [`Shading`]: what the image shows of a hit. Runs on the GPU and on the CPU.

use glam::Vec3;

use crate::hit::Hit;
use crate::material::Material;
use crate::ray::Ray;
use crate::surface::{Surface, unit};

/// What the numbers of a pixel are, which decides how they are put into a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Linear light, with a background where nothing is hit.
    Light,
    /// A colour that stays as it is, with a background where nothing is hit.
    Color,
    /// A vector of unit length, and nothing where nothing is hit.
    Vector,
    /// A distance in scene units, infinite where nothing is hit.
    Distance,
    /// The index of a sphere, as [`index_of`] reads it, and nothing where nothing is hit.
    Index,
}

impl Quantity {
    /// Whether a pixel where nothing is hit shows the background, instead of being transparent.
    #[must_use]
    pub const fn has_background(self) -> bool {
        match self {
            Self::Light | Self::Color => true,
            Self::Vector | Self::Distance | Self::Index => false,
        }
    }
}

/// A hit, as it is shown. Values, because naga takes no struct of pointers.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// The ray.
    pub ray: Ray,
    /// What it found.
    pub hit: Hit,
    /// The surface there.
    pub surface: Surface,
    /// What it is made of.
    pub material: Material,
    /// What the launch knows the sphere by: the index of its material, or in [`Shading::Id`] its own in the scene.
    pub tag: u32,
}

/// Makes the enum, and what decides by it, of the list below.
macro_rules! shadings {
    ($($(#[$doc:meta])* $name:ident = $value:literal, $text:literal, $summary:literal, $quantity:ident, $show:ident;)*) => {
        /// What the image shows of a hit.
        ///
        /// The mode is fixed before the pipeline is compiled: on the GPU it is a specialisation
        /// constant, on the CPU a constant that each loop is compiled for.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        #[repr(u32)]
        pub enum Shading {
            $($(#[$doc])* $name = $value,)*
        }

        impl Shading {
            /// Every mode.
            pub const ALL: [Self; [$($value),*].len()] = [$(Self::$name),*];

            /// The mode's name, as the command line takes it.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$name => $text,)* }
            }

            /// What it shows, in a few words.
            #[must_use]
            pub const fn summary(self) -> &'static str {
                match self { $(Self::$name => $summary,)* }
            }

            /// What the numbers of its pixels are.
            #[must_use]
            pub const fn quantity(self) -> Quantity {
                match self { $(Self::$name => Quantity::$quantity,)* }
            }

            /// Runs `of` compiled for this mode alone.
            #[cfg(not(target_arch = "spirv"))]
            pub fn with<F: OnShading>(self, of: F) -> F::Output {
                match self { $(Self::$name => of.run::<$value>(),)* }
            }
        }

        /// What a pixel holds of a hit in the mode `shading`, a value of [`Shading::to_u32`]; zeros for a value that is none.
        #[inline]
        #[must_use]
        pub fn shade(shading: u32, seen: Seen) -> Vec3 {
            $(if shading == $value { $show(seen) } else)* { Vec3::ZERO }
        }
    };
}

// Each mode: its number and name; what it shows; what its numbers are; and the function that makes them.
shadings! {
    /// A lamp at the eye and Lambert's cosine law, with the colour of the sphere's material.
    #[default]
    Lit = 0, "lit", "Light: the scene's own, or else a lamp at the eye", Light, lit;
    /// The outward unit normal.
    Normals = 1, "normals", "The surface normal n as the colour n · 0.5 + 0.5 (EXR: n)", Vector, normal;
    /// The distance from the eye, in scene units, in all three channels.
    Depth = 2, "depth", "The distance from the eye: white is near, black is far (EXR: Z in scene units)", Distance, distance;
    /// Pure red.
    Flat = 3, "flat", "Red where there is a hit", Color, red;
    /// Which sphere: its index in the scene.
    Id = 4, "id", "Which sphere: a colour for each (EXR: id, its index in the scene)", Index, index;
}

impl Shading {
    /// The specialisation constant of the `render` entry point that holds the mode.
    pub const SPEC_ID: u32 = 0;

    /// The mode as the kernel's constant.
    #[must_use]
    pub const fn to_u32(self) -> u32 {
        self as u32
    }

    /// Whether the pixels are measurements rather than light: they go into an image file as they are, with no transfer curve.
    #[must_use]
    pub const fn is_data(self) -> bool {
        !matches!(self.quantity(), Quantity::Light)
    }
}

/// Something that is compiled for each mode: see [`Shading::with`].
#[cfg(not(target_arch = "spirv"))]
pub trait OnShading {
    /// What comes of it.
    type Output;

    /// Runs it for the mode with this value of [`Shading::to_u32`].
    fn run<const SHADING: u32>(self) -> Self::Output;
}

/// Lambert with the light where the eye is. The absolute value lights the inside of a sphere that the eye is in.
#[inline]
fn lit(seen: Seen) -> Vec3 {
    let cosine = seen.surface.normal.dot(unit(seen.ray.direction));
    seen.material.color * cosine.abs()
}

#[inline]
fn normal(seen: Seen) -> Vec3 {
    seen.surface.normal
}

#[inline]
fn distance(seen: Seen) -> Vec3 {
    Vec3::splat(seen.hit.t * seen.ray.direction.length())
}

#[inline]
fn red(_: Seen) -> Vec3 {
    Vec3::X
}

/// The lower and the upper half of the index: floats hold each exactly.
#[inline]
fn index(seen: Seen) -> Vec3 {
    Vec3::new((seen.tag & 0xffff) as f32, (seen.tag >> 16) as f32, 0.0)
}

/// The index that a pixel of [`Shading::Id`] holds.
#[inline]
#[must_use]
pub fn index_of(color: Vec3) -> u32 {
    (color.y as u32) << 16 | (color.x as u32 & 0xffff)
}
