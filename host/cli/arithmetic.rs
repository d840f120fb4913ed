//! What a device does to arithmetic, as `spherule check` prints it.

use std::fmt::Write;

use serde::Serialize;
use spherule_kernel::Rung;

use crate::device::Device;
use crate::device::canary::{Canary, Share};
#[cfg(feature = "gpu")]
use crate::device::rung;
use crate::error::Result;
use crate::ulp;

/// What a device does to arithmetic.
#[derive(Debug, Serialize)]
pub(super) struct Arithmetic {
    device: String,
    /// Why this device was opened.
    why: String,
    /// The driver's name and version; empty for the CPU.
    driver: String,
    pub(super) canary: Canary,
    /// How many 64-bit floats a GPU multiplies in the time of one of 32 bits.
    f64_rate: Option<f64>,
    /// The rungs that the device's arithmetic is not enough for, and why.
    refused: Vec<(&'static str, String)>,
}

impl Arithmetic {
    /// Measures a device.
    ///
    /// # Errors
    ///
    /// The device's errors.
    pub(super) fn of(device: &Device, why: String) -> Result<Self> {
        let canary = Canary::on(device)?;
        let refused = Rung::ALL
            .into_iter()
            .filter_map(|rung| canary.objection(rung).map(|why| (rung.name(), why)));
        let (driver, f64_rate) = match device {
            Device::Cpu => (String::new(), None),
            Device::Gpu(gpu) => (gpu.driver().to_owned(), rung::f64_rate(gpu)?),
        };
        Ok(Self {
            device: device.name(),
            why,
            driver,
            refused: refused.collect(),
            canary,
            f64_rate,
        })
    }

    /// A line for each finding.
    pub(super) fn table(&self) -> String {
        let mut text = String::new();
        let canary = &self.canary;
        let share = |share: Share| format!("{:>6} of {}", share.exact, share.tried);
        let wide = |found: Option<Share>| found.map_or("no 64-bit floats".into(), share);
        // Writing to a String cannot fail.
        let _ = write!(text, "{} ({}", self.device, self.why);
        if !self.driver.is_empty() {
            let _ = write!(text, "; driver {}", self.driver);
        }
        text.push_str(")\n\nIts arithmetic\n");
        let rows = [
            ("sums with an exact error term", share(canary.sums)),
            ("products with an exact error term", share(canary.products)),
            ("splits into exact halves", share(canary.splits)),
            (
                "quotients rounded correctly",
                worst(share(canary.quotients), canary.quotient_ulps),
            ),
            (
                "square roots rounded correctly",
                worst(share(canary.roots), canary.root_ulps),
            ),
            ("64-bit results correct", wide(canary.wide)),
            (
                "64-bit sums with an exact error term",
                wide(canary.wide_sums),
            ),
            (
                "64-bit products with an exact error term",
                wide(canary.wide_products),
            ),
            ("NaN differs from itself", yes_no(canary.finds_nan).into()),
            ("keeps subnormals", yes_no(canary.keeps_subnormals).into()),
        ];
        for (what, result) in rows {
            let _ = writeln!(text, "  {what:40} {result}");
        }
        if let Some(rate) = self.f64_rate {
            let _ = writeln!(
                text,
                "  {:40} {rate:.2} of 32-bit floats",
                "rate of 64-bit floats"
            );
        }
        for (rung, why) in &self.refused {
            let _ = writeln!(text, "  {rung} is refused here: {why}");
        }
        text
    }

    /// The row of the table of known devices in `docs/numerics.md`.
    pub(super) fn row(&self) -> String {
        let canary = &self.canary;
        let wide = |found: Option<Share>| found.map_or("none".into(), percent);
        let rate = match self.f64_rate {
            Some(rate) => format!("{rate:.2}"),
            None => "–".into(),
        };
        let cells = [
            if self.driver.is_empty() {
                self.device.clone()
            } else {
                format!("{}, {}", self.device, self.driver)
            },
            percent(canary.sums),
            percent(canary.products),
            worst(percent(canary.quotients), canary.quotient_ulps),
            worst(percent(canary.roots), canary.root_ulps),
            wide(canary.wide),
            wide(canary.wide_sums),
            wide(canary.wide_products),
            rate,
            yes_no(canary.keeps_subnormals).into(),
        ];
        format!("| {} |", cells.join(" | "))
    }
}

fn percent(share: Share) -> String {
    if share.is_whole() {
        "all".into()
    } else {
        let percent = 100.0 * share.exact as f64 / share.tried.max(1) as f64;
        format!("{percent:.1} %")
    }
}

/// A share, and the largest error in units in the last place.
fn worst(share: String, ulps: u32) -> String {
    if ulps == 0 {
        return share;
    }
    let shown = ulp::shown(Some(ulps));
    if shown == ulps.to_string() {
        format!("{share}, worst {shown} ulp")
    } else {
        format!("{share}, worst {shown} right")
    }
}

fn yes_no(yes: bool) -> &'static str {
    if yes { "yes" } else { "no" }
}
