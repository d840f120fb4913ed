//! The ladder of rungs: ways to intersect a ray with a sphere, each with a stated error bound and a
//! cost. Runs on the GPU and on the CPU.
//!
//! All of them use this notation: o = O − C, a = d·d, b = o·d, c = o·o − r², k = o × d,
//! Δ = b² − ac = a r² − k·k, q = −b − sign(b)·√Δ, u = 2⁻²⁴. The line meets the sphere where Δ ≥ 0,
//! at t = q/a and t = c/q.
//!
//! | rung | arithmetic | what it is for |
//! | --- | --- | --- |
//! | [`textbook`] | f32, the quadratic formula as textbooks print it | the baseline |
//! | [`robust`] | f32, Δ from the perpendicular, roots without cancellation | every day |
//! | [`compensated`] | pairs of f32, about 48 bits | about the digits of f64, on any device |
//! | [`double`] | f64 | devices that have f64 |
//! | [`certified`] | f64 or f32 with bounds on their errors, more digits only where they cannot decide | the exact answers, rounded once |

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

/// The arithmetic that a rung needs of a device. A device that does not keep it refuses the rung.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// Nothing beyond ordinary sums, products, quotients and roots.
    Nothing,
    /// Exact error terms of sums and products of 32-bit floats.
    ErrorTerms,
    /// The same; 64-bit floats save time where the device has fast ones.
    ErrorTermsAtLeast,
    /// 64-bit floats.
    DoubleFloats,
}

/// Generates the enum, and every function that depends on the rung, from the list below.
macro_rules! rungs {
    ($($(#[$doc:meta])* $order:ident $name:ident = $value:literal, $text:literal, $summary:literal, $needs:ident;)*) => {
        /// The rungs by name, for hosts and specialisation constants.
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

            /// The arithmetic that the rung needs of a device.
            #[must_use]
            pub const fn needs(self) -> Needs {
                match self { $(Self::$name => Needs::$needs,)* }
            }

            /// Runs `of`, compiled for this rung alone.
            #[cfg(not(target_arch = "spirv"))]
            pub fn with<F: OnRung>(self, of: F) -> F::Output {
                match self { $(Self::$name => of.run::<$value>(),)* }
            }
        }

        /// [`Precision::intersect`] of the rung with this value of [`Rung::to_u32`]. The rung is a
        /// constant wherever this is called, so only one of the branches is compiled. A value that
        /// stands for no rung hits nothing.
        ///
        /// In a module without 64-bit floats, [`Rung::Double`] hits nothing; hosts use the module
        /// that has them.
        #[inline]
        #[must_use]
        pub fn intersect(rung: u32, sphere: Sphere, ray: &Ray) -> f32 {
            $(if rung == $value { $name::intersect(sphere, ray) } else)* { Hit::NONE_T }
        }

        /// [`Precision::widening`] of the rung with this value, in scene units.
        #[inline]
        #[must_use]
        pub fn widening(rung: u32, far: Vec3, smallest_radius: f32) -> f32 {
            $(if rung == $value { $name::widening(far, smallest_radius) } else)*
            if rung == DEFERRING {
                Certified::widening(far, smallest_radius)
            } else {
                0.0
            }
        }

        /// Whether the rung is so slow that walks evaluate it only for the nearest sphere, when
        /// that is found.
        #[inline]
        #[must_use]
        pub const fn is_lazy(rung: u32) -> bool {
            !at_once!(is rung; $($order $value,)*)
        }

        /// [`intersect`] for rungs that are not [lazy](is_lazy); the code of the lazy ones is left
        /// out.
        #[inline]
        #[must_use]
        pub fn intersect_at_once(rung: u32, sphere: Sphere, ray: &Ray) -> f32 {
            at_once!(rung, sphere, ray; $($order $name = $value,)*)
        }
    };
}

/// Picks from the list the rungs that are evaluated at once.
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

// Each rung says whether walks evaluate it at once for every sphere that may be hit, or lazily for
// the nearest; its number and name; how it computes; and what it needs of a device. Rungs are
// ordered by the digits that they keep.
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
    lazily Certified = 4, "certified", "The exact answer, rounded once: few digits with a bound on their error, more only where those cannot decide", ErrorTermsAtLeast;
}

/// A value beside those of [`Rung::to_u32`]: the first steps of [`Certified`], for the first of two
/// launches. Where these do not decide, the answer is [`Hit::DEFERRED_T`], which is before every
/// other, so that it ends a search; a second launch on the whole rung answers those rays. The last
/// steps decide next to no ray, but they would take registers from all.
pub const DEFERRING: u32 = Rung::ALL.len() as u32;

/// [`intersect`], or the first steps of certified if the rung is [`DEFERRING`].
#[inline]
#[must_use]
pub fn intersect_or_defer(rung: u32, sphere: Sphere, ray: &Ray) -> f32 {
    if rung == DEFERRING {
        certified::intersect_or_defer(sphere, ray)
    } else {
        intersect(rung, sphere, ray)
    }
}

/// [`intersect_or_defer`] for a ray that certainly enters the sphere, first and within its interval
/// but for the end: between two parameters.
#[inline]
#[must_use]
pub fn entry_or_defer(rung: u32, sphere: Sphere, ray: &Ray, low: f32, high: f32) -> f32 {
    if rung == DEFERRING {
        certified::entry_or_defer(sphere, ray, low + 0.5 * (high - low))
    } else {
        intersect(rung, sphere, ray)
    }
}

/// The number of the specialisation constant that is 1 in the second of two launches, which does
/// nothing but what the first [deferred](DEFERRING).
pub const SECOND_SPEC_ID: u32 = 5;

impl Rung {
    /// The number of the specialisation constant that holds the rung.
    pub const SPEC_ID: u32 = 1;

    /// The rung as the value of the specialisation constant.
    #[must_use]
    pub const fn to_u32(self) -> u32 {
        self as u32
    }

    /// Whether [`bounds`](crate::cull::bounds) hold for the rung: from robust up.
    #[must_use]
    pub const fn is_bounded(self) -> bool {
        self.to_u32() >= Self::Robust.to_u32()
    }
}

/// A computation that is compiled for each rung; see [`Rung::with`].
#[cfg(not(target_arch = "spirv"))]
pub trait OnRung {
    /// The result of the computation.
    type Output;

    /// Runs the computation on the rung with this value of [`Rung::to_u32`].
    fn run<const RUNG: u32>(self) -> Self::Output;
}

impl Sphere {
    /// Where `ray` enters the sphere, or leaves it if it starts inside: the smaller root in the
    /// ray's interval, as a parameter along the ray. [`Hit::NONE_T`](crate::Hit::NONE_T) if there
    /// is none. This is [`Rung::Robust`], the default rung.
    #[inline]
    #[must_use]
    pub fn intersect(&self, ray: &Ray) -> f32 {
        Robust::intersect(*self, ray)
    }
}
