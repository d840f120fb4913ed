//! `spherule explain`: which effects a scene calls for, by what, and what each costs here.

use std::fmt::Write;
use std::process::ExitCode;
use std::time::Duration;

use serde::Serialize;
use spherule_kernel::{Effects, Rung};

use super::args::ExplainArguments;
use super::{note, print};
use crate::accuracy::choose::{DEFAULT_TOLERANCE, choose};
use crate::device::Device;
use crate::error::Result;
use crate::kernel_module;
use crate::plural::count_of;
use crate::render::cost::{self, Cost};
use crate::render::fit::fit;
use crate::render::paths::EffectChoice;
use crate::render::{QUIET, Settings, render};
use crate::scene::Scene;
use crate::shown::shown_path;

#[derive(Debug, Serialize)]
struct Report {
    scene: String,
    spheres: usize,
    /// Of the image that was measured.
    width: u32,
    height: u32,
    /// Width and height of the scene's image.
    whole_image: [u32; 2],
    samples: u32,
    max_bounces: u32,
    device: String,
    precision: &'static str,
    why_precision: String,
    /// The kernel's bits of the effects that are called for.
    effect_bits: u32,
    /// Bytes of the SPIR-V module that the pipeline is made of, before the driver specialises it.
    module_bytes: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<Frame>,
    effects: Vec<Effect>,
}

/// The frame by the scene's own pipeline, and by that of all effects.
#[derive(Debug, Serialize)]
struct Frame {
    own: Cost,
    all_effects: Cost,
}

#[derive(Debug, Serialize)]
struct Effect {
    name: &'static str,
    /// What calls for it; absent if nothing does.
    #[serde(skip_serializing_if = "Option::is_none")]
    by: Option<String>,
    /// The frame without it, by a pipeline that does not hold it.
    #[serde(skip_serializing_if = "Option::is_none")]
    without: Option<Cost>,
}

pub(super) fn run(arguments: &ExplainArguments) -> Result<ExitCode> {
    let mut scene = Scene::load(&arguments.input)?;
    if let Some(size) = arguments.size {
        (scene.width, scene.height) = (size.width, size.height);
    }
    scene.sampling.samples = arguments.samples.or(scene.sampling.samples);
    let (device, why) = Device::open(&arguments.device)?;
    let (rung, why_precision) = match arguments.precision.rung() {
        Some(rung) => (rung, "asked for".to_owned()),
        None => {
            let choice = choose(&scene, DEFAULT_TOLERANCE, device.has_f64());
            (choice.rung, format!("within {:.1e} pixels", choice.bound))
        }
    };
    let report = report(arguments, scene, &device, why, rung, why_precision)?;
    if arguments.json {
        let text = serde_json::to_string_pretty(&report).unwrap_or_default();
        print(&format!("{text}\n"))?;
    } else {
        print(&table(&report))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn report(
    arguments: &ExplainArguments,
    mut scene: Scene,
    device: &Device,
    why: String,
    rung: Rung,
    why_precision: String,
) -> Result<Report> {
    let called = scene.called_effects();
    let own = scene.effects();
    let mut choices = vec![EffectChoice::Auto, EffectChoice::All];
    choices.extend(
        called
            .iter()
            .map(|one| EffectChoice::Only(own.without(one.effect))),
    );
    let whole_image = [scene.width, scene.height];
    let mut costs = if arguments.no_costs {
        Vec::new()
    } else {
        note(&format!("measuring on {} ({why})", device.name()));
        let settings = Settings {
            rung,
            ..Settings::default()
        };
        if arguments.size.is_none() {
            let frames = cost::frames(choices.len()) as f64;
            let frame = Duration::from_secs_f64(arguments.time_limit / frames);
            fit(&mut scene, frame, |scene| {
                Ok(render(scene, settings, device, QUIET)?.timings.trace)
            })?;
        }
        cost::measure(&scene, settings, device, &choices)?
    };
    let without: Vec<Cost> = costs.drain(2.min(costs.len())..).collect();
    let frame = <[Cost; 2]>::try_from(costs)
        .ok()
        .map(|[own, all_effects]| Frame { own, all_effects });
    let effects = Effects::NAMED
        .iter()
        .map(|(effect, name)| {
            let index = called.iter().position(|one| one.effect == *effect);
            Effect {
                name,
                by: index.map(|index| called[index].by.clone()),
                without: index.and_then(|index| without.get(index).copied()),
            }
        })
        .collect();
    Ok(Report {
        scene: shown_path(&arguments.input),
        spheres: scene.world.spheres.len(),
        width: scene.width,
        height: scene.height,
        whole_image,
        samples: scene.samples(),
        max_bounces: scene.sampling.max_bounces,
        device: device.name(),
        precision: rung.name(),
        why_precision,
        effect_bits: own.to_bits(),
        module_bytes: kernel_module::for_rung(rung)?.words().len() * 4,
        frame,
        effects,
    })
}

fn table(report: &Report) -> String {
    let [width, height] = report.whole_image;
    let mut text = format!(
        "{}: {}, {width} × {height} pixels, {}, at most {}\n{}, precision {} ({})\n",
        report.scene,
        count_of(report.spheres, "sphere"),
        count_of(report.samples as usize, "sample"),
        count_of(report.max_bounces as usize, "bounce"),
        report.device,
        report.precision,
        report.why_precision,
    );
    let spread = |cost: &Cost| {
        format!(
            "{:.3} ± {:.3} ms",
            cost.milliseconds,
            0.5 * (cost.slowest - cost.fastest)
        )
    };
    // Writing to a String cannot fail.
    if report.whole_image != [report.width, report.height] {
        let _ = writeln!(
            text,
            "measured with {} × {} pixels, to be done in time (--size {width}x{height} measures all)",
            report.width, report.height,
        );
    }
    if let Some(frame) = &report.frame {
        let ratio = frame.all_effects.milliseconds / frame.own.milliseconds;
        let _ = writeln!(
            text,
            "a frame takes {}; by the pipeline of all effects {}, {ratio:.2} times as long",
            spread(&frame.own),
            spread(&frame.all_effects),
        );
        if frame.own.compile_milliseconds > 0.0 {
            let _ = writeln!(
                text,
                "the pipeline is made of {} KiB of SPIR-V and was compiled in {:.0} ms, that of all effects in {:.0} ms",
                report.module_bytes / 1024,
                frame.own.compile_milliseconds,
                frame.all_effects.compile_milliseconds,
            );
        }
    }
    let called: Vec<&Effect> = report.effects.iter().filter(|e| e.by.is_some()).collect();
    if called.is_empty() {
        text.push_str("\nThe scene calls for no effect: one ray a pixel shows it.\n");
    } else {
        text.push_str("\nCalled for                frame without it         by\n");
    }
    for effect in called {
        let cost = match (&effect.without, &report.frame) {
            (Some(without), Some(frame)) => format!(
                "{:10.3} ms, {:>+6.1} %",
                without.milliseconds,
                100.0 * (without.milliseconds / frame.own.milliseconds - 1.0),
            ),
            _ => String::new(),
        };
        let _ = writeln!(
            text,
            "  {:22} {cost:24} {}",
            effect.name,
            effect.by.as_deref().unwrap_or_default()
        );
    }
    let idle: Vec<&str> = report
        .effects
        .iter()
        .filter(|effect| effect.by.is_none())
        .map(|effect| effect.name)
        .collect();
    let _ = writeln!(text, "\nNot called for, and not in the pipeline:");
    let mut line = String::from(" ");
    for name in idle {
        if line.len() + name.len() > 100 {
            let _ = writeln!(text, "{line}");
            line = String::from(" ");
        }
        let _ = write!(line, " {name}");
    }
    let _ = writeln!(text, "{line}");
    text
}
