//! `spherule explain`: which effects a scene calls for, what calls for them, and what each costs on
//! this device.

use std::fmt::{self, Write};
use std::ops::ControlFlow;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use serde::Serialize;
use spherule_kernel::{Effects, Rung};

use super::args::ExplainArguments;
use super::precision::choose_rung;
use super::progress::Bar;
use super::{load, note, write_json};
use crate::choose::DEFAULT_TOLERANCE;
use crate::device::Device;
use crate::error::Result;
use crate::plural::{contents_of, count_of};
use crate::render::EffectChoice;
use crate::render::Settings;
use crate::render::cost::{self, Cost};
use crate::render::fit::{fit, probe};
use crate::scene::Scene;
use crate::shown::shown_path;
use crate::write::Output;
use crate::write::same::refuse_inputs;

#[derive(Debug, Serialize)]
struct ExplainReport {
    scene: String,
    spheres: usize,
    /// Shapes beside the spheres.
    shapes: usize,
    /// Size of the image that was measured.
    width: u32,
    height: u32,
    /// Width and height of the scene's image.
    whole_image: [u32; 2],
    /// Samples a pixel of the image that was measured.
    samples: u32,
    /// Samples a pixel of the scene's image.
    whole_samples: u32,
    max_bounces: u32,
    device: String,
    precision: &'static str,
    why_precision: String,
    /// The kernel's bits of the effects that the scene calls for.
    effect_bits: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<Frame>,
    effects: Vec<Effect>,
}

/// The time of a frame with the scene's own pipeline, and with that of all effects if there was
/// time for it.
#[derive(Debug, Serialize)]
struct Frame {
    own: Cost,
    all_effects: Option<Cost>,
}

#[derive(Debug, Serialize)]
struct Effect {
    name: &'static str,
    /// What calls for it; absent if nothing does.
    #[serde(skip_serializing_if = "Option::is_none")]
    by: Option<String>,
    /// The time of the frame without it, with a pipeline that does not contain it; absent if there
    /// was no time for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    without: Option<Cost>,
}

/// The share of the time limit that measuring plans for. The rest is for finding the size of the
/// image, and for drift.
const SHARE: f64 = 0.6;

pub(super) fn run(arguments: &ExplainArguments) -> Result<ExitCode> {
    // The limit is for the whole command. A requested size is measured in full.
    let until = match arguments.size {
        None => Some(Instant::now() + Duration::from_secs_f64(arguments.time_limit)),
        Some(_) => None,
    };
    let stdout = Output::stdout()?;
    refuse_inputs(&[&stdout], std::slice::from_ref(&arguments.input))?;
    let mut scene = load(&arguments.input)?;
    refuse_inputs(&[&stdout], &scene.sources)?;
    if let Some(size) = arguments.size {
        (scene.width, scene.height) = (size.width, size.height);
    }
    scene.sampling.samples = arguments.samples.or(scene.sampling.samples);
    let (device, why) = Device::open(&arguments.device)?;
    let report = report(arguments, scene, &device, &why, until)?;
    if arguments.json {
        write_json(&stdout, &report)?;
    } else {
        stdout.write(table(&report).as_bytes())?;
    }
    Ok(ExitCode::SUCCESS)
}

fn report(
    arguments: &ExplainArguments,
    mut scene: Scene,
    device: &Device,
    why: &str,
    until: Option<Instant>,
) -> Result<ExplainReport> {
    let chosen = choose_rung(arguments.precision, &scene, DEFAULT_TOLERANCE, device);
    if let Some(warning) = &chosen.warning {
        note(warning);
    }
    let rung = chosen.rung;
    let called = scene.called_effects();
    let own = scene.effects();
    let mut choices = vec![EffectChoice::Auto, EffectChoice::All];
    choices.extend(
        called
            .iter()
            .map(|one| EffectChoice::Only(own.without(one.effect))),
    );
    let whole_image = [scene.width, scene.height];
    let whole_samples = scene.samples();
    let mut costs = if arguments.no_costs {
        Vec::new()
    } else {
        note(&format!("measuring on {} ({why})", device.name()));
        costs(&mut scene, rung, device, &choices, until)?
    };
    let without = costs.split_off(2.min(costs.len()));
    let frame = match costs[..] {
        [Some(own), all_effects] => Some(Frame { own, all_effects }),
        _ => None,
    };
    let effects = Effects::NAMED
        .iter()
        .map(|(effect, name)| {
            let index = called.iter().position(|one| one.effect == *effect);
            Effect {
                name,
                by: index.map(|index| called[index].by.clone()),
                without: index.and_then(|index| without.get(index).copied().flatten()),
            }
        })
        .collect();
    Ok(ExplainReport {
        scene: shown_path(&arguments.input),
        spheres: scene.world.spheres.len(),
        shapes: scene.world.shapes.len(),
        width: scene.width,
        height: scene.height,
        whole_image,
        samples: scene.samples(),
        whole_samples,
        max_bounces: scene.sampling.max_bounces,
        device: device.name(),
        precision: rung.name(),
        why_precision: chosen.why,
        effect_bits: own.to_bits(),
        frame,
        effects,
    })
}

/// The cost of each of `choices`, in an image that is made smaller if that would not be done at
/// `until`.
fn costs(
    scene: &mut Scene,
    rung: Rung,
    device: &Device,
    choices: &[EffectChoice],
    until: Option<Instant>,
) -> Result<Vec<Option<Cost>>> {
    let settings = Settings {
        rung,
        ..Settings::default()
    };
    let mut compiling = Duration::ZERO;
    if let Some(until) = until {
        let left = until.saturating_duration_since(Instant::now());
        let frame = left.mul_f64(SHARE / cost::frames(choices.len()) as f64);
        fit(scene, frame, |scene| {
            let (took, compile) = probe(scene, settings, device, until)?;
            compiling = compiling.max(compile);
            tracing::debug!(
                "a frame of {} × {} pixels and {} samples: {took:.1?} of {frame:.1?}",
                scene.width,
                scene.height,
                scene.samples()
            );
            Ok(took)
        })?;
    }
    let bar = Bar::new("measuring", false);
    let progress = |done| {
        bar.set(done);
        ControlFlow::Continue(())
    };
    cost::measure(
        scene, settings, device, choices, compiling, until, &progress,
    )
}

/// The text for what was not measured.
const NOT_MEASURED: &str = "no time left to measure it";

fn table(report: &ExplainReport) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = add_scene(&mut text, report);
    if let Some(frame) = &report.frame {
        let _ = add_frame(&mut text, frame);
    }
    let _ = add_called(&mut text, report);
    let _ = add_idle(&mut text, report);
    text
}

/// What is rendered, on what, and how much of it was measured.
fn add_scene(text: &mut String, report: &ExplainReport) -> fmt::Result {
    let [width, height] = report.whole_image;
    writeln!(
        text,
        "{}: {}, {width} × {height} pixels, {}, at most {}\n{}, precision {} ({})",
        report.scene,
        contents_of(report.spheres, report.shapes),
        count_of(report.whole_samples as usize, "sample"),
        count_of(report.max_bounces as usize, "bounce"),
        report.device,
        report.precision,
        report.why_precision,
    )?;
    if (report.whole_image, report.whole_samples) == ([report.width, report.height], report.samples)
    {
        return Ok(());
    }
    writeln!(
        text,
        "measured with {} × {} pixels and {}, to be done in time (--size {width}x{height} measures the whole image)",
        report.width,
        report.height,
        count_of(report.samples as usize, "sample"),
    )
}

/// The time of a frame, and how long its pipeline took to compile.
fn add_frame(text: &mut String, frame: &Frame) -> fmt::Result {
    let spread = |cost: &Cost| {
        format!(
            "{:.3} ± {:.3} ms",
            cost.milliseconds,
            0.5 * (cost.slowest - cost.fastest)
        )
    };
    write!(text, "a frame takes {}; ", spread(&frame.own))?;
    match &frame.all_effects {
        Some(all) => writeln!(
            text,
            "with the pipeline of all effects {}, {:.2} times as long",
            spread(all),
            all.milliseconds / frame.own.milliseconds,
        ),
        None => writeln!(text, "with the pipeline of all effects: {NOT_MEASURED}"),
    }?;
    if frame.own.compile_milliseconds > 0.0 {
        writeln!(
            text,
            "the pipeline was compiled in {:.0} ms{}",
            frame.own.compile_milliseconds,
            frame.all_effects.map_or_else(String::new, |all| format!(
                ", that of all effects in {:.0} ms",
                all.compile_milliseconds
            )),
        )?;
    }
    Ok(())
}

/// The effects that the scene calls for, each with its cost and with what calls for it.
fn add_called(text: &mut String, report: &ExplainReport) -> fmt::Result {
    let called: Vec<&Effect> = report.effects.iter().filter(|e| e.by.is_some()).collect();
    if called.is_empty() {
        text.push_str("\nThe scene calls for no effect: one ray a pixel renders it.\n");
    } else {
        let head = if report.frame.is_some() {
            "frame without it"
        } else {
            ""
        };
        writeln!(text, "\n{:24} {head:26}  called for by", "Effect")?;
    }
    for effect in called {
        let cost = match (&effect.without, &report.frame) {
            (Some(without), Some(frame)) => format!(
                "{:10.3} ms, {:>+6.1} %",
                without.milliseconds,
                100.0 * (without.milliseconds / frame.own.milliseconds - 1.0),
            ),
            (None, Some(_)) => NOT_MEASURED.into(),
            (_, None) => String::new(),
        };
        writeln!(
            text,
            "  {:22} {cost:26} {}",
            effect.name,
            effect.by.as_deref().unwrap_or_default()
        )?;
    }
    Ok(())
}

/// The names of the effects that nothing calls for.
fn add_idle(text: &mut String, report: &ExplainReport) -> fmt::Result {
    writeln!(text, "\nNot called for, and not in the pipeline:")?;
    let mut line = String::from(" ");
    for effect in report.effects.iter().filter(|e| e.by.is_none()) {
        if line.len() + effect.name.len() > 100 {
            writeln!(text, "{line}")?;
            line = String::from(" ");
        }
        write!(line, " {}", effect.name)?;
    }
    writeln!(text, "{line}")
}
