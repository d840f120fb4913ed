//! [`Canary`]: measures on a device the arithmetic that the upper rungs need, before they are used.
//!
//! Vulkan promises correctly rounded sums and products. It lets a driver divide with an error of
//! 2.5 units in the last place, flush subnormals, fuse and cancel operations. What a driver really
//! does can only be measured. A rung is refused on a device that does not meet its needs.

use serde::Serialize;
use spherule_kernel::Rung;
use spherule_kernel::precision::Needs;
use spherule_kernel::probe::canary::{Operands, Outcome, WideOutcome, sing, sing_wide};

use crate::device::{Access, Device, Gpu, rung};
use crate::error::{Error, Result};
use crate::kernel_module;
use crate::random::Random;
use crate::ulp;

/// The number of operand pairs that are tried.
const COUNT: usize = 1 << 14;

/// How many of the tried results are exact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Share {
    /// How many were exact.
    pub exact: usize,
    /// How many were tried.
    pub tried: usize,
}

impl Share {
    /// Whether all are exact, and there is at least one.
    #[must_use]
    pub fn is_whole(self) -> bool {
        self.tried > 0 && self.exact == self.tried
    }
}

/// What the canary found on a device.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Canary {
    /// Sums and differences whose error term is exact.
    pub sums: Share,
    /// Products whose error term is exact.
    pub products: Share,
    /// Splits into exact halves of 12 bits.
    pub splits: Share,
    /// Quotients that are rounded correctly.
    pub quotients: Share,
    /// The largest error of a quotient, in units in the last place.
    pub quotient_ulps: u32,
    /// Square roots that are rounded correctly.
    pub roots: Share,
    /// The largest error of a square root, in units in the last place.
    pub root_ulps: u32,
    /// Whether NaN differs from itself. No rung depends on it: they take roots only where
    /// comparisons hold that fail for NaN.
    pub finds_nan: bool,
    /// Whether subnormal results are kept. No rung depends on it inside its domain.
    pub keeps_subnormals: bool,
    /// 64-bit results that conform to IEEE 754; `None` without 64-bit floats.
    pub wide: Option<Share>,
    /// Sums in 64 bits whose error term is exact; `None` without 64-bit floats.
    pub wide_sums: Option<Share>,
    /// Products in 64 bits whose error term is exact; `None` without 64-bit floats.
    pub wide_products: Option<Share>,
}

impl Canary {
    /// Runs the canary on `device`.
    ///
    /// # Errors
    ///
    /// The device's errors.
    pub fn on(device: &Device) -> Result<Self> {
        let operands = operands();
        match device {
            Device::Cpu => {
                let outcomes: Vec<Outcome> = operands.iter().map(|o| sing(*o)).collect();
                let wide: Vec<WideOutcome> = operands.iter().map(|o| sing_wide(*o)).collect();
                Ok(Self::judge(&operands, &outcomes, Some(&wide)))
            }
            Device::Gpu(gpu) => Self::on_gpu(gpu),
        }
    }

    /// Fails if the canary objects to `rung` on this GPU. Measures only what the rung needs, which
    /// is nothing for the lower rungs.
    ///
    /// # Errors
    ///
    /// [`Error::RungRefused`], and the device's errors.
    pub fn require_on_gpu(gpu: &Gpu, rung: Rung) -> Result<()> {
        match rung.needs() {
            Needs::Nothing => Ok(()),
            Needs::ErrorTerms | Needs::ErrorTermsAtLeast | Needs::DoubleFloats => {
                let with_f64 = gpu.has_f64() && rung::uses_f64(gpu, rung)?;
                Self::measure(gpu, with_f64)?.require(rung, gpu.name())
            }
        }
    }

    /// Runs the canary on this GPU.
    ///
    /// # Errors
    ///
    /// The device's errors.
    pub fn on_gpu(gpu: &Gpu) -> Result<Self> {
        Self::measure(gpu, gpu.has_f64())
    }

    fn measure(gpu: &Gpu, with_f64: bool) -> Result<Self> {
        let operands = operands();
        let bindings = [Access::Read, Access::ReadWrite];
        let input = gpu.upload("operands", &operands)?;
        let output = gpu.zeroed::<Outcome>("outcomes", operands.len())?;
        let threads = [operands.len() as u32, 1, 1];

        let kernel = gpu.kernel(&kernel_module::f32()?, "measure_arithmetic", &bindings)?;
        gpu.launch(
            &kernel,
            &[input.binding(), output.binding()],
            kernel.workgroups_for(threads),
        )?;
        let outcomes = gpu.read(&output)?;

        let wide = if with_f64 {
            let output = gpu.zeroed::<WideOutcome>("wide outcomes", operands.len())?;
            let kernel =
                gpu.kernel(&kernel_module::f64()?, "measure_wide_arithmetic", &bindings)?;
            gpu.launch(
                &kernel,
                &[input.binding(), output.binding()],
                kernel.workgroups_for(threads),
            )?;
            Some(gpu.read(&output)?)
        } else {
            None
        };
        Ok(Self::judge(&operands, &outcomes, wide.as_deref()))
    }

    fn judge(operands: &[Operands], outcomes: &[Outcome], wide: Option<&[WideOutcome]>) -> Self {
        let mut canary = Self {
            sums: Share::default(),
            products: Share::default(),
            splits: Share::default(),
            quotients: Share::default(),
            quotient_ulps: 0,
            roots: Share::default(),
            root_ulps: 0,
            finds_nan: true,
            keeps_subnormals: true,
            wide: None,
            wide_sums: None,
            wide_products: None,
        };
        let count = |share: &mut Share, right: bool| {
            share.exact += usize::from(right);
            share.tried += 1;
        };
        for (Operands { a, b }, outcome) in operands.iter().zip(outcomes) {
            if a.is_nan() {
                canary.finds_nan &= outcome.equals_itself == 0;
                continue;
            }
            // f64 holds the sums of these floats, and all their products, exactly.
            let (wide_a, wide_b) = (f64::from(*a), f64::from(*b));
            let holds = |pair: [f32; 2], exact: f64| {
                pair[0] == exact as f32 && f64::from(pair[0]) + f64::from(pair[1]) == exact
            };
            count(
                &mut canary.sums,
                holds(outcome.sum, wide_a + wide_b) && holds(outcome.difference, wide_a - wide_b),
            );
            count(
                &mut canary.products,
                holds(outcome.product, wide_a * wide_b),
            );
            let [high, low] = outcome.halves;
            let fits = |half: f32| (half.to_bits() & 0x0fff) == 0;
            count(
                &mut canary.splits,
                high + low == *a && fits(high) && fits(low),
            );
            let distance = ulp::distance(outcome.quotient, a / b);
            count(&mut canary.quotients, distance == 0);
            canary.quotient_ulps = canary.quotient_ulps.max(distance);
            let distance = ulp::distance(outcome.root, a.abs().sqrt());
            count(&mut canary.roots, distance == 0);
            canary.root_ulps = canary.root_ulps.max(distance);
            let small = a * 2.0_f32.powi(-100);
            if small.is_subnormal() {
                canary.keeps_subnormals &= outcome.small_product == small.to_bits();
            }
        }
        if let Some(wide) = wide {
            let [mut share, mut sums, mut products] = [Share::default(); 3];
            for (operands, outcome) in operands.iter().zip(wide) {
                if operands.a.is_nan() {
                    continue;
                }
                let expected = sing_wide(*operands);
                let near = |found: f64, right: f64| {
                    found == right || (found / right - 1.0).abs() <= 2.0 * f64::EPSILON
                };
                count(
                    &mut share,
                    outcome.sum == expected.sum
                        && outcome.product == expected.product
                        && near(outcome.quotient, expected.quotient)
                        && near(outcome.root, expected.root),
                );
                count(&mut sums, outcome.large_sum == expected.large_sum);
                count(&mut products, outcome.large_square == expected.large_square);
            }
            canary.wide = Some(share);
            canary.wide_sums = Some(sums);
            canary.wide_products = Some(products);
        }
        canary
    }

    /// The reason why `rung` cannot be used on this device; `None` if it can.
    #[must_use]
    pub fn objection(&self, rung: Rung) -> Option<String> {
        let broken = |what: &str, share: Share| {
            format!(
                "the error terms of {what} are exact in {} of {} tries: the driver rearranges them",
                share.exact, share.tried
            )
        };
        let of_wide = |share: Share| {
            (!share.is_whole()).then(|| {
                format!(
                    "64-bit results are right in {} of {} tries",
                    share.exact, share.tried
                )
            })
        };
        let of_error_terms = || {
            if !self.sums.is_whole() {
                Some(broken("sums", self.sums))
            } else if !self.products.is_whole() {
                Some(broken("products", self.products))
            // One correction squares the relative error, which is at most 2⁻¹⁹ here: that of pairs
            // of floats is 2⁻³⁸ then.
            } else if self.quotient_ulps > 16 || self.root_ulps > 16 {
                Some(format!(
                    "quotients are off by up to {} ulp and square roots by up to {}, too many for one correction",
                    self.quotient_ulps, self.root_ulps
                ))
            } else {
                None
            }
        };
        match rung.needs() {
            Needs::Nothing => None,
            Needs::ErrorTerms => of_error_terms(),
            Needs::ErrorTermsAtLeast => {
                let of_terms = |what, share: Option<Share>| {
                    share
                        .filter(|share| !share.is_whole())
                        .map(|share| broken(what, share))
                };
                of_error_terms()
                    .or_else(|| self.wide.and_then(of_wide))
                    .or_else(|| of_terms("sums in 64 bits", self.wide_sums))
                    .or_else(|| of_terms("products in 64 bits", self.wide_products))
            }
            Needs::DoubleFloats => match self.wide {
                None => Some("the device has no 64-bit floats".into()),
                Some(share) => of_wide(share),
            },
        }
    }

    /// [`Canary::objection`] as an error.
    ///
    /// # Errors
    ///
    /// [`Error::RungRefused`] if there is an objection.
    pub fn require(&self, rung: Rung, device: &str) -> Result<()> {
        match self.objection(rung) {
            None => Ok(()),
            Some(reason) => Err(Error::RungRefused {
                rung,
                device: device.into(),
                reason,
            }),
        }
    }
}

/// Pairs whose sums need 24 to 48 bits, pairs whose quotients and roots are arbitrary, small
/// numbers, and NaN.
fn operands() -> Vec<Operands> {
    let mut random = Random::new(0x5eed);
    (0..COUNT)
        .map(|index| match index % 16 {
            // Small enough that 2⁻¹⁰⁰ times it is subnormal.
            0 => Operands {
                a: random.within(1.0, 2.0) * 2.0_f32.powi(-30),
                b: random.within(1.0, 2.0) * 2.0_f32.powi(-30),
            },
            1 => Operands {
                a: f32::NAN,
                b: 1.0,
            },
            _ => {
                // Exponents at most 27 apart, so that f64 holds the sum exactly.
                let sign = if random.next_u32().is_multiple_of(2) {
                    1.0
                } else {
                    -1.0
                };
                let exponent = (random.next_u32() % 28) as i32;
                Operands {
                    a: random.within(1.0, 2.0) * sign,
                    b: random.within(1.0, 2.0) * 2.0_f32.powi(-exponent),
                }
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cpu_keeps_to_ieee_754() {
        let canary = Canary::on(&Device::Cpu).expect("the CPU");
        for share in [
            canary.sums,
            canary.products,
            canary.splits,
            canary.quotients,
            canary.roots,
            canary.wide.expect("the CPU has 64-bit floats"),
        ] {
            assert!(share.is_whole(), "{canary:?}");
        }
        assert!(canary.finds_nan && canary.keeps_subnormals);
        for rung in Rung::ALL {
            assert_eq!(canary.objection(rung), None);
        }
    }

    /// The canary notices every defect that it is made to find.
    #[test]
    fn a_broken_device_is_noticed() {
        let operands = operands();
        let good: Vec<Outcome> = operands.iter().map(|o| sing(*o)).collect();
        let with = |change: fn(&mut Outcome)| {
            let mut bad = good.clone();
            bad.iter_mut().for_each(change);
            Canary::judge(&operands, &bad, None)
        };
        let no_error_of_sums = with(|outcome| outcome.sum[1] = 0.0);
        assert!(
            no_error_of_sums
                .objection(Rung::Compensated)
                .is_some_and(|why| why.contains("sums"))
        );
        let no_error_of_products = with(|outcome| outcome.product[1] = 0.0);
        assert!(
            no_error_of_products
                .objection(Rung::Compensated)
                .is_some_and(|why| why.contains("products"))
        );
        assert!(!with(|outcome| outcome.halves[1] = 0.0).splits.is_whole());
        let coarse = with(|outcome| outcome.quotient *= 1.0001);
        assert!(
            coarse
                .objection(Rung::Compensated)
                .is_some_and(|why| why.contains("quotients"))
        );
        assert!(!with(|outcome| outcome.equals_itself = 1).finds_nan);
        assert!(!with(|outcome| outcome.small_product = 0).keeps_subnormals);
        assert!(with(|_| ()).objection(Rung::Double).is_some());

        let wide: Vec<WideOutcome> = operands.iter().map(|o| sing_wide(*o)).collect();
        let with_wide = |change: fn(&mut WideOutcome)| {
            let mut bad = wide.clone();
            bad.iter_mut().for_each(change);
            Canary::judge(&operands, &good, Some(&bad)).objection(Rung::Certified)
        };
        assert_eq!(with_wide(|_| ()), None);
        for (objection, what) in [
            (
                with_wide(|outcome| outcome.large_sum[1] = 0.0),
                "sums in 64",
            ),
            (
                with_wide(|outcome| outcome.large_square[1] = 0.0),
                "products in 64",
            ),
        ] {
            assert!(objection.is_some_and(|why| why.contains(what)), "{what}");
        }
    }
}
