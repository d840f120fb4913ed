//! Vectors that implement the kernel's [`Lane`]: sixteen, eight and four 32-bit floats, and sixteen
//! 64-bit floats.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use fearless_simd::{
    Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, f64x8, mask32x16, mask64x8,
};
#[cfg(target_arch = "x86_64")]
use fearless_simd::{f32x8, mask32x8};
use glam::{Vec3, Vec4};
use spherule_kernel::accel::slabs::BoxLane;
use spherule_kernel::lane::{Lane, Lane3};

/// The lanes of a vector.
pub(crate) const LANES: usize = 16;

/// Sixteen 32-bit floats.
#[derive(Clone, Copy)]
pub(crate) struct Single16<S: Simd>(pub(crate) f32x16<S>);

/// Eight 32-bit floats.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
pub(crate) struct Single8<S: Simd>(pub(crate) f32x8<S>);

/// Sixteen 64-bit floats: the first eight, then the last eight.
#[derive(Clone, Copy)]
pub(crate) struct Double16<S: Simd>(f64x8<S>, f64x8<S>);

/// A mask of [`Double16`].
#[derive(Clone, Copy)]
pub(crate) struct DoubleMask<S: Simd>(mask64x8<S>, mask64x8<S>);

impl<S: Simd> Single16<S> {
    #[inline(always)]
    pub(crate) fn load(simd: S, values: &[f32; LANES]) -> Self {
        Self(f32x16::load_array_ref(simd, values))
    }

    #[inline(always)]
    pub(crate) fn store(self, values: &mut [f32; LANES]) {
        self.0.store_array(values);
    }
}

impl<S: Simd> Double16<S> {
    #[inline(always)]
    pub(crate) fn splat(simd: S, value: f64) -> Self {
        let all = f64x8::splat(simd, value);
        Self(all, all)
    }

    /// Widens sixteen 32-bit floats.
    #[inline(always)]
    pub(crate) fn widened(values: Single16<S>) -> Self {
        let (first, last) = values.0.simd.widen_f32x16(values.0);
        Self(first, last)
    }

    /// Rounds to 32 bits.
    #[inline(always)]
    pub(crate) fn rounded(self) -> Single16<S> {
        Single16(self.0.simd.narrow_f64x8(self.0, self.1))
    }
}

impl<S: Simd> DoubleMask<S> {
    /// The mask for [`Single16`].
    #[inline(always)]
    pub(crate) fn narrowed(self, simd: S) -> mask32x16<S> {
        mask32x16::from_bitmask(simd, self.0.to_bitmask() | self.1.to_bitmask() << 8)
    }
}

macro_rules! operators {
    ($($operation:ident $function:ident),*) => {
        $(
            impl<S: Simd> $operation for Single16<S> {
                type Output = Self;

                #[inline(always)]
                fn $function(self, other: Self) -> Self {
                    Self(self.0.$function(other.0))
                }
            }

            #[cfg(target_arch = "x86_64")]
            impl<S: Simd> $operation for Single8<S> {
                type Output = Self;

                #[inline(always)]
                fn $function(self, other: Self) -> Self {
                    Self(self.0.$function(other.0))
                }
            }

            impl $operation for Four {
                type Output = Self;

                #[inline(always)]
                fn $function(self, other: Self) -> Self {
                    Self(self.0.$function(other.0))
                }
            }

            impl<S: Simd> $operation for Double16<S> {
                type Output = Self;

                #[inline(always)]
                fn $function(self, other: Self) -> Self {
                    Self(self.0.$function(other.0), self.1.$function(other.1))
                }
            }
        )*
    };
}

operators!(Add add, Sub sub, Mul mul, Div div);

impl<S: Simd> Neg for Double16<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl<S: Simd> BitAnd for DoubleMask<S> {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0, self.1 & other.1)
    }
}

impl<S: Simd> BitOr for DoubleMask<S> {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0, self.1 | other.1)
    }
}

impl<S: Simd> Not for DoubleMask<S> {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0, !self.1)
    }
}

macro_rules! single {
    ($single:ident, $vector:ident, $mask:ident) => {
        impl<S: Simd> $single<S> {
            #[inline(always)]
            pub(crate) fn splat(simd: S, value: f32) -> Self {
                Self($vector::splat(simd, value))
            }

            /// The same vector in every lane.
            #[inline(always)]
            pub(crate) fn splat3(simd: S, vector: Vec3) -> Lane3<Self> {
                Lane3 {
                    x: Self::splat(simd, vector.x),
                    y: Self::splat(simd, vector.y),
                    z: Self::splat(simd, vector.z),
                }
            }
        }

        impl<S: Simd> Neg for $single<S> {
            type Output = Self;

            #[inline(always)]
            fn neg(self) -> Self {
                Self(-self.0)
            }
        }

        impl<S: Simd> Lane for $single<S> {
            type Mask = $mask<S>;

            const ROUNDOFF: f32 = f32::ROUNDOFF;

            #[inline(always)]
            fn splat(self, value: f32) -> Self {
                Self($vector::splat(self.0.simd, value))
            }

            #[inline(always)]
            fn to_single(self) -> Self {
                self
            }

            #[inline(always)]
            fn abs(self) -> Self {
                Self(self.0.abs())
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                Self(self.0.sqrt())
            }

            #[inline(always)]
            fn mul_add_rough(self, factor: Self, term: Self) -> Self {
                Self(self.0.mul_add(factor.0, term.0))
            }

            #[inline(always)]
            fn mul_sub_rough(self, factor: Self, term: Self) -> Self {
                Self(self.0.mul_sub(factor.0, term.0))
            }

            #[inline(always)]
            fn are_all(mask: Self::Mask) -> bool {
                mask.all_true()
            }

            #[inline(always)]
            fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
                Self(mask.select(yes.0, no.0))
            }

            #[inline(always)]
            fn simd_lt(self, other: Self) -> Self::Mask {
                self.0.simd_lt(other.0)
            }

            #[inline(always)]
            fn simd_le(self, other: Self) -> Self::Mask {
                self.0.simd_le(other.0)
            }

            #[inline(always)]
            fn simd_gt(self, other: Self) -> Self::Mask {
                self.0.simd_gt(other.0)
            }

            #[inline(always)]
            fn simd_ge(self, other: Self) -> Self::Mask {
                self.0.simd_ge(other.0)
            }
        }

        impl<S: Simd> BoxLane for $single<S> {
            #[inline(always)]
            fn larger(self, other: Self) -> Self {
                Self(self.0.max(other.0))
            }

            #[inline(always)]
            fn smaller(self, other: Self) -> Self {
                Self(self.0.min(other.0))
            }
        }
    };
}

single!(Single16, f32x16, mask32x16);
#[cfg(target_arch = "x86_64")]
single!(Single8, f32x8, mask32x8);

impl<S: Simd> Lane for Double16<S> {
    type Mask = DoubleMask<S>;

    const ROUNDOFF: f32 = f64::ROUNDOFF;

    #[inline(always)]
    fn splat(self, value: f32) -> Self {
        Self::splat(self.0.simd, value.into())
    }

    #[inline(always)]
    fn to_single(self) -> Self {
        Self::widened(self.rounded())
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs(), self.1.abs())
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt(), self.1.sqrt())
    }

    #[inline(always)]
    fn are_all(mask: Self::Mask) -> bool {
        mask.0.all_true() && mask.1.all_true()
    }

    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Self(mask.0.select(yes.0, no.0), mask.1.select(yes.1, no.1))
    }

    #[inline(always)]
    fn simd_lt(self, other: Self) -> Self::Mask {
        DoubleMask(self.0.simd_lt(other.0), self.1.simd_lt(other.1))
    }

    #[inline(always)]
    fn simd_le(self, other: Self) -> Self::Mask {
        DoubleMask(self.0.simd_le(other.0), self.1.simd_le(other.1))
    }

    #[inline(always)]
    fn simd_gt(self, other: Self) -> Self::Mask {
        DoubleMask(self.0.simd_gt(other.0), self.1.simd_gt(other.1))
    }

    #[inline(always)]
    fn simd_ge(self, other: Self) -> Self::Mask {
        DoubleMask(self.0.simd_ge(other.0), self.1.simd_ge(other.1))
    }
}

/// Four 32-bit floats, with the instructions that every processor has.
#[derive(Clone, Copy)]
pub(crate) struct Four(pub(crate) Vec4);

/// A mask of [`Four`].
#[derive(Clone, Copy)]
pub(crate) struct FourMask(u32);

impl FourMask {
    /// The mask as bits, the first lane lowest.
    #[inline(always)]
    pub(crate) fn bits(self) -> u32 {
        self.0
    }
}

impl Neg for Four {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl BitAnd for FourMask {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for FourMask {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl Not for FourMask {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0 & 0xf)
    }
}

impl Lane for Four {
    type Mask = FourMask;

    const ROUNDOFF: f32 = f32::ROUNDOFF;

    #[inline(always)]
    fn splat(self, value: f32) -> Self {
        Self(Vec4::splat(value))
    }

    #[inline(always)]
    fn to_single(self) -> Self {
        self
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(Vec4::from_array(self.0.to_array().map(f32::sqrt)))
    }

    #[inline(always)]
    fn simd_lt(self, other: Self) -> FourMask {
        FourMask(self.0.cmplt(other.0).bitmask())
    }

    #[inline(always)]
    fn simd_le(self, other: Self) -> FourMask {
        FourMask(self.0.cmple(other.0).bitmask())
    }

    #[inline(always)]
    fn simd_gt(self, other: Self) -> FourMask {
        FourMask(self.0.cmpgt(other.0).bitmask())
    }

    #[inline(always)]
    fn simd_ge(self, other: Self) -> FourMask {
        FourMask(self.0.cmpge(other.0).bitmask())
    }

    #[inline(always)]
    fn are_all(mask: FourMask) -> bool {
        mask.0 == 0xf
    }

    #[inline(always)]
    fn select(mask: FourMask, yes: Self, no: Self) -> Self {
        let of = |lane: usize| {
            if mask.0 >> lane & 1 == 1 {
                yes.0[lane]
            } else {
                no.0[lane]
            }
        };
        Self(Vec4::new(of(0), of(1), of(2), of(3)))
    }
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};
    use spherule_kernel::precision::double;

    use super::*;
    use crate::cpu::InstructionSet;
    use crate::random::Random;

    /// Ordinary numbers, and those at which arithmetic has special cases.
    fn numbers(random: &mut Random) -> [f32; LANES] {
        const ODD: [f32; 8] = [
            0.0,
            -0.0,
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::MAX,
            1e-42,
            1.0,
        ];
        std::array::from_fn(|_| {
            let odd = ODD[(random.within(0.0, 8.0) as usize).min(7)];
            if random.within(0.0, 1.0) < 0.3 {
                odd
            } else {
                random.within(-2.0, 2.0)
            }
        })
    }

    /// One result for each operation.
    #[inline(always)]
    fn each<L: Lane>(a: L, b: L) -> [L; 13] {
        let one = a.splat(1.0);
        let zero = a.splat(0.0);
        let of = |mask| L::select(mask, one, zero);
        [
            a + b,
            a - b,
            a * b,
            a / b,
            -a,
            a.abs(),
            a.sqrt(),
            of(a.simd_lt(b)),
            of(a.simd_le(b)),
            of(a.simd_gt(b)),
            of(!a.simd_ge(b)),
            of(a.simd_lt(b) | a.simd_gt(b) & b.simd_ge(zero)),
            L::select(a.simd_lt(b), a, b),
        ]
    }

    /// With each instruction set of this machine, every lane of a vector has the bits of the same
    /// operation on single numbers; any NaN equals any other.
    #[test]
    fn lanes_are_single_numbers() {
        #[inline(always)]
        fn with<S: Simd>(simd: S, a: &[f32; LANES], b: &[f32; LANES]) -> [[f32; LANES]; 27] {
            let mut all = [[0.0; LANES]; 27];
            let singles = each(Single16::load(simd, a), Single16::load(simd, b));
            let doubles = each(
                Double16::widened(Single16::load(simd, a)),
                Double16::widened(Single16::load(simd, b)),
            );
            for (at, (single, double)) in singles.into_iter().zip(doubles).enumerate() {
                single.store(&mut all[at]);
                double.rounded().store(&mut all[13 + at]);
            }
            let mask = Double16::widened(Single16::load(simd, a))
                .simd_lt(Double16::widened(Single16::load(simd, b)));
            let (one, zero) = (Single16::splat(simd, 1.0), Single16::splat(simd, 0.0));
            Single16::select(mask.narrowed(simd), one, zero).store(&mut all[26]);
            all
        }
        let mut random = Random::new(7);
        let mut sets = 0;
        for instructions in InstructionSet::ALL {
            let Some(level) = instructions.level() else {
                continue;
            };
            sets += 1;
            for _ in 0..2000 {
                let (a, b) = (numbers(&mut random), numbers(&mut random));
                let all = dispatch!(level, simd => with(simd, &a, &b));
                for lane in 0..LANES {
                    let singles = each(a[lane], b[lane]);
                    let doubles = each(f64::from(a[lane]), f64::from(b[lane]));
                    let is_less = if a[lane] < b[lane] { 1.0 } else { 0.0 };
                    let expected = singles
                        .into_iter()
                        .chain(doubles.map(|double| double as f32))
                        .chain([is_less]);
                    for (at, expected) in expected.enumerate() {
                        let found = all[at][lane];
                        assert!(
                            found.to_bits() == expected.to_bits()
                                || (found.is_nan() && expected.is_nan()),
                            "{instructions}, operation {at} of {} and {}: {found} {expected}",
                            a[lane],
                            b[lane]
                        );
                    }
                }
            }
        }
        assert!(sets > 0);
    }

    #[test]
    fn four_are_single_numbers() {
        let mut random = Random::new(9);
        for _ in 0..2000 {
            let (a, b) = (numbers(&mut random), numbers(&mut random));
            let of = |all: &[f32; LANES]| Four(Vec4::new(all[0], all[1], all[2], all[3]));
            let found = each(of(&a), of(&b));
            for lane in 0..4 {
                for (at, expected) in each(a[lane], b[lane]).into_iter().enumerate() {
                    let found = found[at].0[lane];
                    assert!(
                        found.to_bits() == expected.to_bits()
                            || (found.is_nan() && expected.is_nan()),
                        "operation {at} of {} and {}: {found} {expected}",
                        a[lane],
                        b[lane]
                    );
                }
            }
        }
    }

    /// The corrections for GPUs without exact quotients give all digits of a float.
    #[test]
    fn quotients_and_roots_are_the_nearest_numbers() {
        let level = Level::baseline();
        let mut random = Random::new(8);
        for _ in 0..1000 {
            let a: [f32; LANES] = std::array::from_fn(|_| random.within(0.1, 9.0));
            let found = dispatch!(level, simd => {
                let a = Double16::widened(Single16::load(simd, &a));
                // As poor as a root and a quotient of 32 bits.
                let rough = |a: Double16<_>| a + a * a.splat(1e-7);
                let (one, root) = (a.splat(1.0), a.sqrt());
                let mut found = [[0.0; LANES]; 2];
                let precise = double::square_root(a, rough(root), rough(one / root));
                precise.rounded().store(&mut found[0]);
                double::quotient(one, a, rough(one / a)).rounded().store(&mut found[1]);
                found
            });
            for lane in 0..LANES {
                let a = f64::from(a[lane]);
                assert_eq!(
                    [found[0][lane], found[1][lane]],
                    [a.sqrt() as f32, (1.0 / a) as f32]
                );
            }
        }
    }
}
