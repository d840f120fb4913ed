//! [`Shading`]: what the image shows of a hit. Runs on the GPU and on the CPU.

use glam::Vec3;

use crate::hit::Hit;
use crate::material::Material;
use crate::ray::Ray;
use crate::surface::{Surface, unit};

/// The quantity that a pixel holds, which decides how image files hold it.
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
    /// Whether a pixel without a hit shows the background; if not, it is transparent.
    #[must_use]
    pub const fn has_background(self) -> bool {
        match self {
            Self::Light | Self::Color => true,
            Self::Vector | Self::Distance | Self::Index => false,
        }
    }
}

/// A hit that is shown. It holds values, because naga takes no structs of pointers.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// The ray.
    pub ray: Ray,
    /// Its hit.
    pub hit: Hit,
    /// The surface at the hit.
    pub surface: Surface,
    /// The material of the sphere.
    pub material: Material,
    /// The index of the sphere's material; in [`Shading::Id`], the index of the sphere in the
    /// scene.
    pub tag: u32,
}

/// Makes the enum and its functions from the list below.
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

            /// A description of a few words.
            #[must_use]
            pub const fn summary(self) -> &'static str {
                match self { $(Self::$name => $summary,)* }
            }

            /// The quantity that its pixels hold.
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

        /// The numbers of a pixel that shows this hit. `shading` is a value of [`Shading::to_u32`];
        /// any other gives zeros.
        #[inline]
        #[must_use]
        pub fn shade(shading: u32, seen: Seen) -> Vec3 {
            $(if shading == $value { $show(seen) } else)* { Vec3::ZERO }
        }
    };
}

// Each mode has its number and name, what it shows, the quantity, and the function that computes
// it.
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
}

/// Code that is compiled for each mode: see [`Shading::with`].
#[cfg(not(target_arch = "spirv"))]
pub trait OnShading {
    /// The result.
    type Output;

    /// Runs it for the mode with this value of [`Shading::to_u32`].
    fn run<const SHADING: u32>(self) -> Self::Output;
}

/// Lambert's law with a lamp at the eye. The absolute value lights the inside of a sphere that the
/// eye is in.
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
