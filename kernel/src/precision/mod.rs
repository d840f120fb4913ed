//! The ladder: ways to intersect a ray with a sphere, each with a stated bound and a price. Runs
//! on the GPU and on the CPU.
//!
//! Notation of all of them: o = O − C, a = d·d, b = o·d, c = o·o − r², k = o × d,
//! Δ = b² − ac = a r² − k·k, q = −b − sign(b)·√Δ, u = 2⁻²⁴. The line meets the sphere where Δ ≥ 0,
//! at t = q/a and t = c/q.
//!
//! | rung | arithmetic | what it is for |
//! | --- | --- | --- |
//! | [`textbook`] | f32, the formula of any textbook | the baseline |
//! | [`robust`] | f32, Δ by the perpendicular, roots without cancellation | every day |
//! | [`compensated`] | pairs of f32, about 48 bits | the digits of f64 on any device |
//! | [`double`] | f64 | devices that have f64 |
//! | [`certified`] | f32 with a bound on its error, more digits only where it cannot decide | right answers everywhere |

pub mod certified;
pub mod compensated;
pub mod double;
pub mod robust;
pub mod root;
pub mod textbook;

use glam::Vec3;

use crate::hit::Hit;
use crate::ray::Ray;
use crate::sphere::Sphere;

pub use certified::Certified;
pub use compensated::Compensated;
pub use double::Double;
pub use robust::Robust;
pub use root::Precision;
pub use textbook::Textbook;

/// What arithmetic a rung needs a device to keep. A device on which it is not kept refuses the rung.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// None: sums, products, quotients and roots as they come.
    Nothing,
    /// Exact error terms of sums and products of 32-bit floats.
    ErrorTerms,
    /// 64-bit floats.
    DoubleFloats,
}

/// Makes the enum, and what decides by it, of the list below.
macro_rules! rungs {
    ($($(#[$doc:meta])* $order:ident $name:ident = $value:literal, $text:literal, $summary:literal, $needs:ident;)*) => {
        /// The rungs by name, as hosts and specialisation constants say them.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
        #[repr(u32)]
        pub enum Rung {
            $($(#[$doc])* $name = $value,)*
        }

        impl Rung {
            /// Every rung.
            pub const ALL: [Self; [$($value),*].len()] = [$(Self::$name),*];

            /// The rung's name, as the command line takes it.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$name => $text,)* }
            }

            /// How the rung computes, in a few words.
            #[must_use]
            pub const fn summary(self) -> &'static str {
                match self { $(Self::$name => $summary,)* }
            }

            /// What it needs of a device.
            #[must_use]
            pub const fn needs(self) -> Needs {
                match self { $(Self::$name => Needs::$needs,)* }
            }

            /// Runs `of` compiled for this rung alone.
            #[cfg(not(target_arch = "spirv"))]
            pub fn with<F: OnRung>(self, of: F) -> F::Output {
                match self { $(Self::$name => of.run::<$value>(),)* }
            }
        }

        /// [`Precision::intersect`] of the rung with this value of [`Rung::to_u32`]. The rung is a
        /// constant wherever this is called, so that only one of the branches is compiled. A value that is none hits nothing.
        ///
        /// In a module without 64-bit floats, [`Rung::Double`] hits nothing; hosts give it the module
        /// that has them.
        #[inline]
        #[must_use]
        pub fn intersect(rung: u32, sphere: Sphere, ray: &Ray) -> f32 {
            $(if rung == $value { $name::intersect(sphere, ray) } else)* { Hit::NONE_T }
        }

        /// [`Precision::widening`] of this rung.
        #[inline]
        #[must_use]
        pub fn widening(rung: u32, far: Vec3, smallest_radius: f32) -> f32 {
            $(if rung == $value { $name::widening(far, smallest_radius) } else)* { 0.0 }
        }

        /// Whether the rung takes so long that walks ask it only about the nearest sphere, when it is found.
        #[inline]
        #[must_use]
        pub const fn is_lazy(rung: u32) -> bool {
            !at_once!(is rung; $($order $value,)*)
        }

        /// [`intersect`] of the rungs that are not [lazy](is_lazy); the code of the others is left out.
        #[inline]
        #[must_use]
        pub fn intersect_at_once(rung: u32, sphere: Sphere, ray: &Ray) -> f32 {
            at_once!(rung, sphere, ray; $($order $name = $value,)*)
        }
    };
}

/// Of the list's rungs those that are asked at once.
macro_rules! at_once {
    (is $rung:ident;) => { false };
    (is $rung:ident; lazily $value:literal, $($rest:tt)*) => { at_once!(is $rung; $($rest)*) };
    (is $rung:ident; at_once $value:literal, $($rest:tt)*) => {
        ($rung == $value) | at_once!(is $rung; $($rest)*)
    };
    ($rung:ident, $sphere:ident, $ray:ident;) => { Hit::NONE_T };
    ($rung:ident, $sphere:ident, $ray:ident; lazily $name:ident = $value:literal, $($rest:tt)*) => {
        at_once!($rung, $sphere, $ray; $($rest)*)
    };
    ($rung:ident, $sphere:ident, $ray:ident; at_once $name:ident = $value:literal, $($rest:tt)*) => {
        if $rung == $value {
            $name::intersect($sphere, $ray)
        } else {
            at_once!($rung, $sphere, $ray; $($rest)*)
        }
    };
}

// Each rung: whether walks ask it at once about every sphere that may be hit, or lazily about the nearest; its number and name; how it
// computes; and what it needs of a device. They are in the order of their digits.
rungs! {
    /// [`Textbook`].
    at_once Textbook = 0, "textbook", "The quadratic formula in 32-bit floats", Nothing;
    /// [`Robust`].
    #[default]
    at_once Robust = 1, "robust", "32-bit floats, arranged so that small distant spheres keep their digits", Nothing;
    /// [`Compensated`].
    lazily Compensated = 2, "compensated", "Pairs of 32-bit floats, about 48 bits, on any device", ErrorTerms;
    /// [`Double`].
    lazily Double = 3, "double", "64-bit floats, where the device has them", DoubleFloats;
    /// [`Certified`].
    lazily Certified = 4, "certified", "32-bit floats with a bound on their error, and more digits only where that cannot decide", ErrorTerms;
}

impl Rung {
    /// The specialisation constant that holds the rung.
    pub const SPEC_ID: u32 = 1;

    /// The rung as the kernel's constant.
    #[must_use]
    pub const fn to_u32(self) -> u32 {
        self as u32
    }

    /// Whether hits of the rung are where [`bounds`](crate::cull::bounds) have them: from robust on.
    #[must_use]
    pub const fn is_bounded(self) -> bool {
        self.to_u32() >= Self::Robust.to_u32()
    }
}

/// Something that is compiled for each rung: see [`Rung::with`].
#[cfg(not(target_arch = "spirv"))]
pub trait OnRung {
    /// What comes of it.
    type Output;

    /// Runs it on the rung with this value of [`Rung::to_u32`].
    fn run<const RUNG: u32>(self) -> Self::Output;
}

impl Sphere {
    /// Where `ray` enters the sphere, or leaves it if it starts inside: the smaller root in the
    /// ray's interval, as a parameter along the ray. [`Hit::NONE_T`](crate::Hit::NONE_T) if
    /// there is none. This is the everyday rung of the ladder in [`crate::precision`].
    #[inline]
    #[must_use]
    pub fn intersect(&self, ray: &Ray) -> f32 {
        Robust::intersect(*self, ray)
    }
}
