//! `spherule check`: runs the canary, then every hard case on every rung.

use std::fmt::Write;
use std::process::ExitCode;

use serde::Serialize;
use spherule_kernel::Rung;

use super::args::CheckArguments;
use super::write_json;
use crate::accuracy::cases::{Verdict, catalogue};
use crate::accuracy::scene_cases::SCENE_CASES;
use crate::device::Device;
use crate::device::canary::{Canary, Share};
use crate::error::Result;
use crate::ulp;
use crate::write::Output;

#[derive(Debug, Serialize)]
struct CheckReport {
    device: String,
    why: String,
    canary: Canary,
    refused: Vec<(&'static str, String)>,
    cases: Vec<CaseReport>,
    promises_kept: bool,
}

#[derive(Debug, Serialize)]
struct CaseReport {
    number: u8,
    name: &'static str,
    /// A verdict for each rung that was not refused.
    rungs: Vec<(&'static str, Verdict)>,
}

pub(super) fn run(arguments: &CheckArguments) -> Result<ExitCode> {
    let stdout = Output::stdout()?;
    let (device, why) = Device::open(&arguments.device)?;
    let report = report(&device, why)?;
    if arguments.json {
        write_json(&stdout, &report)?;
    } else {
        stdout.write(table(&report).as_bytes())?;
    }
    Ok(if report.promises_kept {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}

fn report(device: &Device, why: String) -> Result<CheckReport> {
    let canary = Canary::on(device)?;
    let objections = Rung::ALL.map(|rung| (rung, canary.objection(rung)));
    let mut cases = Vec::new();
    let mut promises_kept = true;
    let mut judge = |number, name, verdict: &dyn Fn(Rung) -> Result<Verdict>| -> Result<()> {
        let mut rungs = Vec::new();
        for (rung, objection) in &objections {
            if objection.is_none() {
                let verdict = verdict(*rung)?;
                promises_kept &= !verdict.is_broken();
                rungs.push((rung.name(), verdict));
            }
        }
        cases.push(CaseReport {
            number,
            name,
            rungs,
        });
        Ok(())
    };
    for case in catalogue() {
        judge(case.number, case.name, &|rung| case.judge(device, rung))?;
    }
    for case in SCENE_CASES {
        judge(case.number, case.name, &|rung| case.judge(device, rung))?;
    }
    cases.sort_by_key(|case| case.number);
    Ok(CheckReport {
        device: device.name(),
        why,
        canary,
        refused: objections
            .into_iter()
            .filter_map(|(rung, objection)| objection.map(|why| (rung.name(), why)))
            .collect(),
        cases,
        promises_kept,
    })
}

fn table(report: &CheckReport) -> String {
    let mut text = String::new();
    let share = |share: Share| format!("{:>6} of {}", share.exact, share.tried);
    let canary = &report.canary;
    // Writing to a String cannot fail.
    let _ = writeln!(text, "{} ({})\n", report.device, report.why);
    let _ = writeln!(text, "Its arithmetic");
    let rows = [
        ("sums with an exact error term", share(canary.sums)),
        ("products with an exact error term", share(canary.products)),
        ("splits into exact halves", share(canary.splits)),
        (
            "quotients rounded correctly",
            format!(
                "{}, worst {}",
                share(canary.quotients),
                ulps(canary.quotient_ulps)
            ),
        ),
        (
            "square roots rounded correctly",
            format!("{}, worst {}", share(canary.roots), ulps(canary.root_ulps)),
        ),
        (
            "64-bit results correct",
            canary.wide.map_or("no 64-bit floats".into(), share),
        ),
        ("NaN differs from itself", yes_no(canary.finds_nan).into()),
        ("keeps subnormals", yes_no(canary.keeps_subnormals).into()),
    ];
    for (what, result) in rows {
        let _ = writeln!(text, "  {what:34} {result}");
    }
    for (rung, why) in &report.refused {
        let _ = writeln!(text, "  {rung} is refused here: {why}");
    }

    let _ = writeln!(
        text,
        "\nThe hard cases: ✓ correct, · wrong but not promised, ✗ broken promise\n"
    );
    let _ = write!(text, "{:>4} {:55}", "", "");
    for rung in Rung::ALL {
        let _ = write!(text, " {:>11}", rung.name());
    }
    text.push('\n');
    let mut broken = Vec::new();
    for case in &report.cases {
        let _ = write!(text, "{:>4} {:55}", case.number, case.name);
        for rung in Rung::ALL {
            let found = case.rungs.iter().find(|(name, _)| *name == rung.name());
            let mark = match found {
                None => "refused",
                Some((_, Verdict::Holds)) => "✓",
                Some((_, Verdict::FailsUnpromised(_))) => "·",
                Some((_, Verdict::Fails(why))) => {
                    broken.push(format!(
                        "{} {} on {}: {why}",
                        case.number,
                        case.name,
                        rung.name()
                    ));
                    "✗"
                }
            };
            let _ = write!(text, " {mark:>11}");
        }
        text.push('\n');
    }
    text.push('\n');
    if broken.is_empty() {
        text.push_str("Every promise holds on this device.\n");
    } else {
        let _ = writeln!(text, "Broken promises:\n  {}", broken.join("\n  "));
    }
    text
}

/// An error in units in the last place, or in words if no digit is right.
fn ulps(distance: u32) -> String {
    let shown = ulp::shown(Some(distance));
    if shown == distance.to_string() {
        shown + " ulp"
    } else {
        shown + " right"
    }
}

fn yes_no(yes: bool) -> &'static str {
    if yes { "yes" } else { "no" }
}
