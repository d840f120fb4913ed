//! [`Shape`]: what a ray may hit beside spheres. Runs on the GPU and on the CPU.
//!
//! | module | holds |
//! | --- | --- |
//! | [`capsule`] | [`Capsule`]: all points within a radius of a segment |
//! | [`cylinder`] | [`Cylinder`]: a cylinder with flat ends |
//! | [`ellipsoid`] | [`Ellipsoid`]: a sphere that is stretched along three axes |
//! | [`cuboid`] | [`Cuboid`]: a box, turned any way |
//! | [`cone`] | [`Cone`]: a cone with flat ends, cut off or up to its tip |
//! | [`disc`] | [`Disc`]: a flat disc |
//! | `axis`, `frame` | what shapes with an axis share, and those with a rotation |
//! | [`span`] | [`Span`]: the part of a line that is in a convex shape |
//! | [`among`] | [`Shapes`]: the shapes of a world, and how rays find them |
//!
//! Each shape is a type of its own, with its formulas in its own file. A world keeps them as
//! [`Shape`], 48 bytes each, so that one buffer and one tree hold them all. The kinds that a world
//! has are a set, [`Kinds`], a constant of the pipeline: the code of other kinds is left out.
//!
//! # The ladder
//!
//! | rung | for a shape |
//! | --- | --- |
//! | `textbook` | the formula as it is published, in 32-bit floats |
//! | `robust` | [`Solid::span`] in 32-bit floats: the line's origin moved to where it is nearest to the shape, discriminants from perpendiculars |
//! | `double` | the same in 64-bit floats, its answer rounded once |
//!
//! `compensated` and `certified` are for spheres: hosts refuse them for worlds with other shapes.

pub mod among;
mod axis;
pub mod capsule;
pub mod cone;
pub mod cuboid;
pub mod cylinder;
pub mod disc;
pub mod ellipsoid;
mod frame;
pub mod span;

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

use crate::lane::Lane3;
use crate::precision::Rung;
use crate::ray::Ray;
#[cfg(not(target_arch = "spirv"))]
use crate::sphere::Sphere;
use crate::surface::Surface;

pub use among::Shapes;
pub use capsule::Capsule;
pub use cone::Cone;
pub use cuboid::Cuboid;
pub use cylinder::Cylinder;
pub use disc::Disc;
pub use ellipsoid::Ellipsoid;
pub use span::Span;

/// A convex shape.
pub trait Solid: Copy {
    /// The line's part in the shape, for a line with origin `o` and direction `d`, in lanes.
    fn span<L: crate::lane::Lane>(&self, o: Lane3<L>, d: Lane3<L>) -> Span<L>;

    /// The same in 32-bit floats by the formula as it is published.
    fn textbook_span(&self, ray: &Ray) -> Span<f32>;

    /// The surface where `ray` has the parameter `t`.
    fn surface(&self, ray: &Ray, t: f32) -> Surface;

    /// The shape elsewhere.
    #[must_use]
    fn moved(&self, by: Vec3) -> Self;

    /// Whether a point is in the shape or on its surface.
    fn contains(&self, point: Vec3) -> bool;

    /// Half of the thickness where it is thinnest, in scene units.
    fn thickness(&self) -> f32;
}

/// What a host asks of a shape.
#[cfg(not(target_arch = "spirv"))]
pub trait Measures {
    /// The lowest and the highest coordinates, rounded outwards.
    fn bounds(&self) -> (Vec3, Vec3);

    /// Whether every number is finite, and every length that must be is above zero.
    fn is_valid(&self) -> bool;

    /// Two balls whose convex hull holds the shape.
    fn hull(&self) -> [Sphere; 2];

    /// The sphere, if the shape is one.
    fn as_sphere(&self) -> Option<Sphere> {
        None
    }
}

/// A shape of any kind, as worlds keep it: three vectors, the last number of which is the kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Shape {
    pub(crate) first: Vec4,
    pub(crate) second: Vec4,
    pub(crate) third: Vec4,
}

/// A set of kinds of shapes, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Kinds(u32);

impl Kinds {
    /// The number of the specialisation constant that holds the set that the pipeline is compiled
    /// for.
    pub const SPEC_ID: u32 = 6;

    /// No kind: a world of spheres.
    pub const NONE: Self = Self(0);

    /// The set with these bits; bits that stand for no kind are dropped.
    #[inline]
    #[must_use]
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits & Self::ALL.0)
    }

    /// The bits of the set, the value of the specialisation constant.
    #[inline]
    #[must_use]
    pub const fn to_bits(self) -> u32 {
        self.0
    }

    /// Whether the set is empty.
    #[inline]
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The kinds of both sets.
    #[inline]
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether the set has the kind with this number. If it is the only one, every shape is of it.
    #[inline]
    const fn has(self, kind: u32) -> bool {
        self.0 >> kind & 1 == 1
    }
}

/// Generates [`Kinds`] and every function that depends on the kind, from the list below.
macro_rules! shapes {
    ($($(#[$doc:meta])* $constant:ident, $name:ident = $value:literal, $text:literal;)*) => {
        impl Kinds {
            $($(#[$doc])* pub const $constant: Self = Self(1 << $value);)*

            /// Every kind.
            pub const ALL: Self = Self($((1 << $value))|*);

            /// Each kind with its name, as scene files have it.
            #[cfg(not(target_arch = "spirv"))]
            pub const NAMED: &[(Self, &'static str)] = &[$((Self::$constant, $text)),*];
        }

        $(impl $name {
            pub(crate) const KIND: u32 = $value;

            /// Where `ray` meets the surface first within its interval, on this rung, as a
            /// parameter along the ray; [`Hit::NONE_T`](crate::Hit::NONE_T) if it does not.
            #[cfg(not(target_arch = "spirv"))]
            #[must_use]
            pub fn intersect(&self, rung: Rung, ray: &Ray) -> f32 {
                let kinds = Kinds::$constant;
                self.to_shape().span(rung.to_u32(), kinds, ray).first(ray)
            }
        })*

        impl Shape {
            /// Runs a method of the shape's own type. A shape of no kind is one of the first.
            #[inline]
            fn surface_of_kind(&self, kinds: Kinds, ray: &Ray, t: f32) -> Surface {
                $(if self.is_of(kinds, $value) {
                    return $name::from_shape(self).surface(ray, t);
                })*
                Surface::NONE
            }

            #[inline]
            fn textbook_span_of_kind(&self, kinds: Kinds, ray: &Ray) -> Span<f32> {
                $(if self.is_of(kinds, $value) {
                    return $name::from_shape(self).textbook_span(ray);
                })*
                Span::none(0.0)
            }

            #[inline]
            fn robust_span_of_kind(&self, kinds: Kinds, ray: &Ray) -> Span<f32> {
                let (o, d) = (Lane3::of(ray.origin), Lane3::of(ray.direction));
                $(if self.is_of(kinds, $value) {
                    return $name::from_shape(self).span(o, d);
                })*
                Span::none(0.0)
            }

            #[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
            #[inline]
            fn double_span_of_kind(&self, kinds: Kinds, ray: &Ray) -> Span<f32> {
                let (o, d) = (Lane3::of(ray.origin).widened(), Lane3::of(ray.direction).widened());
                $(if self.is_of(kinds, $value) {
                    return $name::from_shape(self).span(o, d).narrowed();
                })*
                Span::none(0.0)
            }

            #[inline]
            fn moved_of_kind(&self, kinds: Kinds, by: Vec3) -> Self {
                $(if self.is_of(kinds, $value) {
                    return $name::from_shape(self).moved(by).to_shape();
                })*
                *self
            }

            /// The lowest and the highest coordinates, rounded outwards.
            #[cfg(not(target_arch = "spirv"))]
            #[must_use]
            pub fn bounds(&self) -> (Vec3, Vec3) {
                match self.kind() {
                    $($value => $name::from_shape(self).bounds(),)*
                    _ => (Vec3::ZERO, Vec3::ZERO),
                }
            }

            #[inline]
            fn thickness_of_kind(&self, kinds: Kinds) -> f32 {
                $(if self.is_of(kinds, $value) {
                    return $name::from_shape(self).thickness();
                })*
                0.0
            }

            /// Whether a point is in the shape or on its surface.
            #[cfg(not(target_arch = "spirv"))]
            #[must_use]
            pub fn contains(&self, point: Vec3) -> bool {
                match self.kind() {
                    $($value => $name::from_shape(self).contains(point),)*
                    _ => false,
                }
            }

            /// Whether there is such a kind, every number is finite, and every length that must be
            /// is above zero.
            #[cfg(not(target_arch = "spirv"))]
            #[must_use]
            pub fn is_valid(&self) -> bool {
                match self.kind() {
                    $($value => $name::from_shape(self).is_valid(),)*
                    _ => false,
                }
            }

            /// Two balls whose convex hull holds the shape.
            #[cfg(not(target_arch = "spirv"))]
            #[must_use]
            pub fn hull(&self) -> [Sphere; 2] {
                match self.kind() {
                    $($value => $name::from_shape(self).hull(),)*
                    _ => [Sphere::default(); 2],
                }
            }

            /// The sphere, if the shape is one.
            #[cfg(not(target_arch = "spirv"))]
            #[must_use]
            pub fn as_sphere(&self) -> Option<Sphere> {
                match self.kind() {
                    $($value => $name::from_shape(self).as_sphere(),)*
                    _ => None,
                }
            }

            /// The name of the kind, as scene files have it.
            #[cfg(not(target_arch = "spirv"))]
            #[must_use]
            pub fn name(&self) -> &'static str {
                match self.kind() {
                    $($value => $text,)*
                    _ => "shape of no kind",
                }
            }
        }

        $(impl From<$name> for Shape {
            fn from(shape: $name) -> Self {
                shape.to_shape()
            }
        })*
    };
}

// Each shape: the constant of its kind, its type, its number, and its name.
shapes! {
    /// [`Capsule`].
    CAPSULE, Capsule = 0, "capsule";
    /// [`Cylinder`].
    CYLINDER, Cylinder = 1, "cylinder";
    /// [`Ellipsoid`].
    ELLIPSOID, Ellipsoid = 2, "ellipsoid";
    /// [`Cuboid`].
    BOX, Cuboid = 3, "box";
    /// [`Cone`].
    CONE, Cone = 4, "cone";
    /// [`Disc`].
    DISC, Disc = 5, "disc";
}

impl Shape {
    /// The number of the shape's kind.
    #[inline]
    fn kind(&self) -> u32 {
        self.third.w as u32
    }

    /// Whether the shape, one of these kinds, is of the kind with this number.
    #[inline]
    fn is_of(&self, kinds: Kinds, kind: u32) -> bool {
        kinds.has(kind) && ((kinds.to_bits() == 1 << kind) | (self.kind() == kind))
    }

    /// The set of the shape's kind alone.
    #[cfg(not(target_arch = "spirv"))]
    #[must_use]
    pub fn kinds(&self) -> Kinds {
        Kinds::from_bits(1_u32.checked_shl(self.kind()).unwrap_or(0))
    }

    /// The part of a ray's line that is in the shape, on this rung (a value of [`Rung::to_u32`]).
    /// `kinds` are those that there are.
    #[inline]
    #[must_use]
    pub fn span(&self, rung: u32, kinds: Kinds, ray: &Ray) -> Span<f32> {
        if rung == Rung::Textbook.to_u32() {
            return self.textbook_span_of_kind(kinds, ray);
        }
        #[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
        if rung != Rung::Robust.to_u32() {
            return self.double_span_of_kind(kinds, ray);
        }
        self.robust_span_of_kind(kinds, ray)
    }

    /// The surface where `ray` has the parameter `t`.
    #[inline]
    #[must_use]
    pub fn surface(&self, kinds: Kinds, ray: &Ray, t: f32) -> Surface {
        self.surface_of_kind(kinds, ray, t)
    }

    /// [`Solid::thickness`].
    #[inline]
    #[must_use]
    pub fn thickness(&self, kinds: Kinds) -> f32 {
        self.thickness_of_kind(kinds)
    }

    /// The shape elsewhere.
    #[inline]
    #[must_use]
    pub fn moved(&self, kinds: Kinds, by: Vec3) -> Self {
        self.moved_of_kind(kinds, by)
    }
}

const _: () = {
    assert!(size_of::<Shape>() == 48);
    assert!(core::mem::offset_of!(Shape, second) == 16);
    assert!(core::mem::offset_of!(Shape, third) == 32);
};
