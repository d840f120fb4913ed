//! `spherule check`: runs the canary, then every hard case on every rung.

use std::fmt::Write;
use std::process::ExitCode;

use serde::Serialize;
use spherule_kernel::Rung;

use super::args::CheckArguments;
use super::arithmetic::Arithmetic;
use super::write_json;
use crate::accuracy::cases::{Verdict, catalogue};
use crate::accuracy::hard_rays;
use crate::accuracy::scene_cases::SCENE_CASES;
use crate::device::Device;
use crate::error::Result;
use crate::write::{Output, create_folder};

#[derive(Debug, Serialize)]
struct CheckReport {
    #[serde(flatten)]
    arithmetic: Arithmetic,
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
    if let Some(folder) = &arguments.export {
        create_folder(folder)?;
        let rays = hard_rays::export(folder, &device, arguments.rays as usize)?;
        let text = format!("wrote {rays} rays into {}\n", folder.display());
        stdout.write(text.as_bytes())?;
        return Ok(ExitCode::SUCCESS);
    }
    let arithmetic = Arithmetic::of(&device, why)?;
    if arguments.arithmetic {
        if arguments.json {
            write_json(&stdout, &arithmetic)?;
        } else {
            let text = format!(
                "{}\nFor the table in docs/numerics.md, What drivers do:\n{}\n",
                arithmetic.table(),
                arithmetic.row()
            );
            stdout.write(text.as_bytes())?;
        }
        return Ok(ExitCode::SUCCESS);
    }
    let report = report(&device, arithmetic)?;
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

fn report(device: &Device, arithmetic: Arithmetic) -> Result<CheckReport> {
    let objections = Rung::ALL.map(|rung| (rung, arithmetic.canary.objection(rung)));
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
        arithmetic,
        cases,
        promises_kept,
    })
}

fn table(report: &CheckReport) -> String {
    let mut text = report.arithmetic.table();
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
