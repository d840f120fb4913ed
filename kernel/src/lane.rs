//! [`Lane`]: the numbers that formulas are written in. Runs on the GPU and on the CPU.
//!
//! A formula over `L: Lane` is written once for all processors: `L` is `f32` or `f64` on the GPU
//! and for single rays, and a vector of either in the CPU's packets. The host implements the trait
//! for vectors. Each operation is rounded as IEEE 754 says, and none is fused with another, so that
//! a lane of a vector has the same bits as a single number. The exceptions are
//! [`Lane::mul_add_rough`] and [`Lane::mul_sub_rough`], which are for bounds. A GPU's driver may
//! fuse and simplify all but [`Lane::add_strict`], [`Lane::sub_strict`] and [`Lane::mul_strict`].

use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use glam::Vec3;

use crate::arithmetic::strict::{add, mul, sub};
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
use crate::arithmetic::strict::{add_wide, mul_wide, sub_wide};

/// A number, or several side by side.
pub trait Lane:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The result of a comparison: a `bool` for each number.
    type Mask: Copy
        + BitAnd<Output = Self::Mask>
        + BitOr<Output = Self::Mask>
        + Not<Output = Self::Mask>;

    /// The unit roundoff u: half of the distance from one to the next number.
    const ROUNDOFF: f32;

    /// This number in each lane; `self` says only how many lanes there are.
    fn splat(self, value: f32) -> Self;
    /// Rounded to a 32-bit float.
    fn to_single(self) -> Self;
    /// The absolute value.
    fn abs(self) -> Self;
    /// The square root; NaN below zero.
    fn sqrt(self) -> Self;
    /// `self < other`; false for NaN, as are the three below.
    fn simd_lt(self, other: Self) -> Self::Mask;
    /// `self ≤ other`.
    fn simd_le(self, other: Self) -> Self::Mask;
    /// `self > other`.
    fn simd_gt(self, other: Self) -> Self::Mask;
    /// `self ≥ other`.
    fn simd_ge(self, other: Self) -> Self::Mask;
    /// The sum, rounded once, whatever a driver would make of it: for rounding errors.
    #[inline(always)]
    fn add_strict(self, other: Self) -> Self {
        self + other
    }
    /// The difference, as [`Lane::add_strict`].
    #[inline(always)]
    fn sub_strict(self, other: Self) -> Self {
        self - other
    }
    /// The product, as [`Lane::add_strict`].
    #[inline(always)]
    fn mul_strict(self, other: Self) -> Self {
        self * other
    }
    /// `self · factor + term`, rounded once or twice, whichever is faster; for bounds that hold
    /// either way.
    #[inline(always)]
    fn mul_add_rough(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }
    /// `self · factor − term`, as [`Lane::mul_add_rough`].
    #[inline(always)]
    fn mul_sub_rough(self, factor: Self, term: Self) -> Self {
        self * factor - term
    }
    /// Whether the mask is true in every lane.
    fn are_all(mask: Self::Mask) -> bool;
    /// `yes` where the mask is true, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// As [`Lane::select`], for pairs that single numbers compute only if they are selected: a
    /// processor predicts most branches.
    #[inline(always)]
    fn choose_pair(
        mask: Self::Mask,
        yes: impl FnOnce() -> (Self, Self),
        no: impl FnOnce() -> (Self, Self),
    ) -> (Self, Self) {
        let (yes, no) = (yes(), no());
        (
            Self::select(mask, yes.0, no.0),
            Self::select(mask, yes.1, no.1),
        )
    }
}

/// A single number, of which [`DoubleWord`](crate::arithmetic::DoubleWord)s are made.
pub trait Word: Lane<Mask = bool> {
    /// 2ˢ + 1, where s is half of the bits of a significand, rounded up: what T. J. Dekker splits
    /// numbers by.
    const SPLITTER: Self;
}

macro_rules! scalar {
    ($float:ty, $add:ident, $sub:ident, $mul:ident, $splitter:literal, $bits:literal) => {
        impl Word for $float {
            const SPLITTER: Self = $splitter;
        }

        impl Lane for $float {
            type Mask = bool;

            const ROUNDOFF: f32 = 1.0 / (1_u64 << $bits) as f32;

            #[inline(always)]
            fn splat(self, value: f32) -> Self {
                value.into()
            }

            #[inline(always)]
            fn add_strict(self, other: Self) -> Self {
                $add(self, other)
            }

            #[inline(always)]
            fn sub_strict(self, other: Self) -> Self {
                $sub(self, other)
            }

            #[inline(always)]
            fn mul_strict(self, other: Self) -> Self {
                $mul(self, other)
            }

            #[inline(always)]
            fn to_single(self) -> Self {
                Self::from(self as f32)
            }

            #[inline(always)]
            fn abs(self) -> Self {
                <$float>::abs(self)
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                #[cfg(target_arch = "spirv")]
                return spirv_std::num_traits::Float::sqrt(self);
                #[cfg(not(target_arch = "spirv"))]
                <$float>::sqrt(self)
            }

            #[inline(always)]
            fn simd_lt(self, other: Self) -> bool {
                self < other
            }

            #[inline(always)]
            fn simd_le(self, other: Self) -> bool {
                self <= other
            }

            #[inline(always)]
            fn simd_gt(self, other: Self) -> bool {
                self > other
            }

            #[inline(always)]
            fn simd_ge(self, other: Self) -> bool {
                self >= other
            }

            #[inline(always)]
            fn are_all(mask: bool) -> bool {
                mask
            }

            #[inline(always)]
            fn select(mask: bool, yes: Self, no: Self) -> Self {
                if mask { yes } else { no }
            }

            #[inline(always)]
            fn choose_pair(
                mask: bool,
                yes: impl FnOnce() -> (Self, Self),
                no: impl FnOnce() -> (Self, Self),
            ) -> (Self, Self) {
                if mask { yes() } else { no() }
            }
        }
    };
}

scalar!(f32, add, sub, mul, 4097.0, 24);
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
scalar!(f64, add_wide, sub_wide, mul_wide, 134_217_729.0, 53);

/// Three coordinates in lanes.
#[derive(Clone, Copy, Debug)]
pub struct Lane3<L> {
    /// Along the first axis.
    pub x: L,
    /// Along the second axis.
    pub y: L,
    /// Along the third axis.
    pub z: L,
}

impl<L: Lane> Lane3<L> {
    /// The dot product, summed in the order of the axes.
    #[inline(always)]
    #[must_use]
    pub fn dot(self, other: Self) -> L {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// The dot product by [`Lane::mul_add_rough`].
    #[inline(always)]
    #[must_use]
    pub fn dot_rough(self, other: Self) -> L {
        let yz = self.y.mul_add_rough(other.y, self.z * other.z);
        self.x.mul_add_rough(other.x, yz)
    }

    /// The cross product.
    #[inline(always)]
    #[must_use]
    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    /// The sum.
    #[inline(always)]
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            x: self.x + other.x,
            y: self.y + other.y,
            z: self.z + other.z,
        }
    }

    /// The difference.
    #[inline(always)]
    #[must_use]
    pub fn minus(self, other: Self) -> Self {
        Self {
            x: self.x - other.x,
            y: self.y - other.y,
            z: self.z - other.z,
        }
    }

    /// Each coordinate times a number.
    #[inline(always)]
    #[must_use]
    pub fn scaled(self, factor: L) -> Self {
        Self {
            x: self.x * factor,
            y: self.y * factor,
            z: self.z * factor,
        }
    }

    /// `self − other · factor`.
    #[inline(always)]
    #[must_use]
    pub fn minus_scaled(self, other: Self, factor: L) -> Self {
        Self {
            x: self.x - other.x * factor,
            y: self.y - other.y * factor,
            z: self.z - other.z * factor,
        }
    }
}

impl Lane3<f32> {
    /// The coordinates of a vector.
    #[inline(always)]
    #[must_use]
    pub fn of(vector: Vec3) -> Self {
        Self {
            x: vector.x,
            y: vector.y,
            z: vector.z,
        }
    }

    /// In 64 bits.
    #[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
    #[inline(always)]
    #[must_use]
    pub fn widened(self) -> Lane3<f64> {
        Lane3 {
            x: self.x.into(),
            y: self.y.into(),
            z: self.z.into(),
        }
    }

    /// The vector with these coordinates.
    #[inline(always)]
    #[must_use]
    pub fn to_vec3(self) -> Vec3 {
        Vec3::new(self.x, self.y, self.z)
    }
}
