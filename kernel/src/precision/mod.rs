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
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
pub mod double;
pub mod robust;
pub mod root;
pub mod textbook;

#[cfg(all(target_arch = "spirv", not(feature = "f64")))]
use crate::hit::Hit;
use crate::ray::Ray;
use crate::sphere::Sphere;

pub use certified::Certified;
pub use compensated::Compensated;
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
pub use double::Double;
pub use robust::Robust;
pub use root::Precision;
pub use textbook::Textbook;

/// The rungs by name, as hosts and specialisation constants say them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u32)]
pub enum Rung {
    /// [`Textbook`].
    Textbook = 0,
    /// [`Robust`].
    #[default]
    Robust = 1,
    /// [`Compensated`].
    Compensated = 2,
    /// `Double`.
    Double = 3,
    /// [`Certified`].
    Certified = 4,
}

impl Rung {
    /// Every rung.
    pub const ALL: [Self; 5] = [
        Self::Textbook,
        Self::Robust,
        Self::Compensated,
        Self::Double,
        Self::Certified,
    ];

    /// The rung's name, as the command line takes it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Textbook => "textbook",
            Self::Robust => "robust",
            Self::Compensated => "compensated",
            Self::Double => "double",
            Self::Certified => "certified",
        }
    }

    /// The specialisation constant that holds the rung.
    pub const SPEC_ID: u32 = 1;

    /// The rung as the kernel's constant.
    #[must_use]
    pub const fn to_u32(self) -> u32 {
        self as u32
    }
}

/// [`Precision::intersect`] of the rung with this value of [`Rung::to_u32`]. The rung is a
/// constant wherever this is called, so that only one of the branches is compiled.
///
/// In a module without 64-bit floats, [`Rung::Double`] hits nothing; hosts give it the module
/// that has them.
#[inline]
#[must_use]
pub fn intersect(rung: u32, sphere: Sphere, ray: &Ray) -> f32 {
    const ROBUST: u32 = Rung::Robust.to_u32();
    const COMPENSATED: u32 = Rung::Compensated.to_u32();
    const DOUBLE: u32 = Rung::Double.to_u32();
    const CERTIFIED: u32 = Rung::Certified.to_u32();

    if rung == ROBUST {
        Robust::intersect(sphere, ray)
    } else if rung == COMPENSATED {
        Compensated::intersect(sphere, ray)
    } else if rung == CERTIFIED {
        Certified::intersect(sphere, ray)
    } else if rung == DOUBLE {
        #[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
        return Double::intersect(sphere, ray);
        #[cfg(all(target_arch = "spirv", not(feature = "f64")))]
        return Hit::NONE_T;
    } else {
        Textbook::intersect(sphere, ray)
    }
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
