//! `spherule render`: from a file to an image.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use serde::Serialize;
use spherule_kernel::Shading;

use super::args::RenderArguments;
use super::interrupt::{self, Graceful};
use super::precision::choose_rung;
use super::progress::Bar;
use super::{note, write_json};
use crate::accel::Acceleration;
use crate::device::{Device, DeviceChoice};
use crate::error::{Error, Result};
use crate::film::compare::{Comparison, Tolerance};
use crate::plural::count_of;
use crate::read::text::uncompressed;
use crate::render::paths::{Reached, StoppedBy};
use crate::render::{Rendered, Settings, estimate, render};
use crate::scene::Scene;
use crate::shown::shown_path;
use crate::write::same::{refuse_clashes, refuse_inputs};
use crate::write::{Format, Output, Room};

/// What `--stats` writes.
#[derive(Debug, Serialize)]
struct Stats {
    device: String,
    backend: &'static str,
    precision: &'static str,
    spheres: usize,
    width: u32,
    height: u32,
    /// Camera rays that were traced, one for each sample of each pixel.
    rays: u64,
    /// Pixels that a ray was traced for: all, unless the render was stopped early.
    traced_pixels: u64,
    /// The effects that the image shows.
    effects: Vec<&'static str>,
    /// Samples taken, the noise that was reached, and what ended the render.
    #[serde(skip_serializing_if = "Option::is_none")]
    sampling: Option<Reached>,
    seconds: Seconds,
    mrays_per_s: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    depth_range: Option<(f32, f32)>,
    #[serde(skip_serializing_if = "Option::is_none")]
    check: Option<Check>,
}

#[derive(Debug, Serialize)]
struct Seconds {
    load: f64,
    setup: f64,
    compile: f64,
    trace: f64,
    readback: f64,
    encode: f64,
    total: f64,
}

#[derive(Debug, Serialize)]
struct Check {
    against: String,
    #[serde(flatten)]
    comparison: Comparison,
    passed: bool,
}

pub(super) fn run(arguments: &RenderArguments) -> Result<ExitCode> {
    let started = Instant::now();
    let say = |text: &str| {
        if !arguments.quiet {
            note(text);
        }
    };

    let output = arguments
        .output
        .clone()
        .unwrap_or_else(|| default_output(&arguments.input));
    let output = Output::image(&output)?;
    let stats = arguments.stats.as_deref().map(Output::new).transpose()?;
    let outputs: Vec<&Output> = std::iter::once(&output).chain(&stats).collect();
    refuse_clashes(&outputs)?;
    refuse_inputs(&outputs, std::slice::from_ref(&arguments.input))?;
    let (scene, early, load) = std::thread::scope(|scope| {
        let open = || Device::open(&arguments.device);
        // Without a thread for it the device is opened afterwards.
        let opener = opens_early(arguments)
            .then(|| std::thread::Builder::new().spawn_scoped(scope, open).ok())
            .flatten();
        let scene = super::load(&arguments.input);
        let load = started.elapsed();
        let early = opener.map(|opener| {
            opener
                .join()
                .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        });
        (scene, early, load)
    });
    let mut scene = scene?;
    refuse_inputs(&outputs, &scene.sources)?;
    if let Some(size) = arguments.size {
        (scene.width, scene.height) = (size.width, size.height);
    }
    let sampling = &mut scene.sampling;
    sampling.samples = arguments.samples.or(sampling.samples);
    sampling.max_bounces = arguments.max_bounces.unwrap_or(sampling.max_bounces);
    sampling.seed = arguments.seed.unwrap_or(sampling.seed);

    let is_brief = || {
        let threads = rayon::current_num_threads();
        estimate::is_brief(&scene, arguments.shade, arguments.effects, threads)
    };
    let (mut device, why) =
        if arguments.device == DeviceChoice::Auto && !arguments.check && is_brief() {
            (Device::Cpu, "done before a GPU would be open".into())
        } else {
            early.unwrap_or_else(|| Device::open(&arguments.device))?
        };
    let opening = started.elapsed() - load;
    // Opened before the work, so that a check that cannot be is known at once.
    let other = match (&device, arguments.check) {
        (_, false) => None,
        (Device::Cpu, true) => Some(Device::open(&DeviceChoice::Gpu)?.0),
        (Device::Gpu(_), true) => Some(Device::Cpu),
    };
    let chosen = choose_rung(arguments.precision, &scene, arguments.tolerance, &device);
    let rung = chosen.rung;
    say(&format!(
        "rendering on {} ({why}), precision {} ({})",
        device.name(),
        rung.name(),
        chosen.why
    ));
    if let Some(warning) = &chosen.warning {
        say(warning);
    }
    let settings = Settings {
        shading: arguments.shade,
        rung,
        acceleration: Acceleration::Auto,
        effects: arguments.effects,
        time_limit: arguments.time_limit.map(Duration::from_secs_f64),
        noise: arguments.noise,
    };

    let asks_for_samples =
        arguments.samples.is_some() || arguments.seed.is_some() || arguments.noise.is_some();
    let shown = settings.effects.shown(scene.effects());
    if asks_for_samples && (settings.shading != Shading::Lit || shown.is_empty()) {
        say("nothing in this image is sampled: --samples, --seed and --noise have no effect");
    }

    // An image that a signal or a time limit cuts has opacities.
    let room = Room::reserve(Format::of(output.path())?, scene.width, scene.height, true)?;
    // From here on the first signal ends the tracing, and the picture is kept.
    let graceful = Graceful::new();
    let rendered = match with_bar(arguments, &scene, settings, &device) {
        Err(error @ Error::RungRefused { .. })
            if arguments.device == DeviceChoice::Auto && !arguments.check =>
        {
            device = Device::Cpu;
            say(&format!("{error}\nrendering on {} instead", device.name()));
            with_bar(arguments, &scene, settings, &device)?
        }
        done => done?,
    };
    let timings = &rendered.timings;
    tracing::debug!(
        "set up (tree, tables, upload; compiling {:.1?} of it): {:.1?}; traced: {:.1?}; read back: {:.1?}",
        timings.compile,
        timings.setup,
        timings.trace,
        timings.readback
    );
    if rendered.traced == 0
        && let Some(code) = interrupt::exit_code()
    {
        note("interrupted before the first pixel was done: nothing is written");
        return Ok(code);
    }
    // Where there are samples there is a preview.
    if rendered.traced == 0 && rendered.reached.is_none() {
        note(
            "the time was up before the first pixel was done: nothing is written; give a longer --time-limit",
        );
        return Ok(ExitCode::FAILURE);
    }
    let image = &rendered.image;
    let encoding = Instant::now();
    // What is rendered is written before a signal ends the command.
    image.save_to(&output, room)?;
    let encode = encoding.elapsed();
    tracing::debug!(
        "encoded and wrote {}: {encode:.1?}",
        shown_path(output.path())
    );
    let total = started.elapsed();

    if let Some((near, far)) = image.depth_range() {
        say(&format!(
            "depth from {near} (white) to {far} (black) scene units"
        ));
    }
    let extent = extent(&rendered);
    let is_interrupted = interrupt::requested().is_some() && !rendered.is_complete();
    let wrote = format!(
        "wrote {}: {} × {} pixels{}{extent}, {}, {}",
        shown_path(output.path()),
        image.width(),
        image.height(),
        if extent.is_empty() { "" } else { ", " },
        count_of(scene.world.spheres.len(), "sphere"),
        human(total),
    );
    if is_interrupted {
        note(&format!(
            "interrupted: wrote {} with {extent}",
            shown_path(output.path())
        ));
    } else {
        say(&wrote);
    }

    let check = other
        .filter(|_| interrupt::requested().is_none())
        .map(|other| check(arguments, &scene, settings, &other, &rendered))
        .transpose()?
        .flatten();
    let passed = check.as_ref().is_none_or(|check| check.passed);
    if let Some(output) = stats {
        let rays = rendered.rays;
        let trace = rendered.timings.trace.as_secs_f64();
        write_json(
            &output,
            &Stats {
                device: device.name(),
                backend: device.backend(),
                precision: rung.name(),
                spheres: scene.world.spheres.len(),
                width: scene.width,
                height: scene.height,
                rays,
                traced_pixels: rendered.traced,
                effects: scene
                    .called_effects()
                    .iter()
                    .filter(|called| {
                        rendered.reached.is_some()
                            && settings.effects.shown(called.effect).any(called.effect)
                    })
                    .map(|called| called.name)
                    .collect(),
                sampling: rendered.reached,
                seconds: Seconds {
                    load: load.as_secs_f64(),
                    compile: rendered.timings.compile.as_secs_f64(),
                    setup: (opening + rendered.timings.setup).as_secs_f64(),
                    trace,
                    readback: rendered.timings.readback.as_secs_f64(),
                    encode: encode.as_secs_f64(),
                    total: total.as_secs_f64(),
                },
                mrays_per_s: rays as f64 / trace.max(1e-9) * 1e-6,
                depth_range: image.depth_range(),
                check,
            },
        )?;
    }
    drop(graceful);
    if let Some(code) = interrupt::exit_code() {
        return Ok(code);
    }
    Ok(if passed {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}

/// Whether the device is opened while the file is read: it is a GPU for certain, and there is a file. What `auto` takes
/// depends on what is in it.
fn opens_early(arguments: &RenderArguments) -> bool {
    let is_gpu = matches!(arguments.device, DeviceChoice::Gpu | DeviceChoice::Named(_));
    is_gpu && arguments.input.is_file()
}

fn with_bar(
    arguments: &RenderArguments,
    scene: &Scene,
    settings: Settings,
    device: &Device,
) -> Result<Rendered> {
    let bar = Bar::new("rendering", arguments.quiet);
    render(scene, settings, device, &|done| {
        bar.set(done);
        match interrupt::requested() {
            Some(_) => ControlFlow::Break(()),
            None => ControlFlow::Continue(()),
        }
    })
}

/// How far the render came, in samples a pixel or in pixels; nothing if there is nothing to say.
fn extent(rendered: &Rendered) -> String {
    let pixels = u64::from(rendered.image.width()) * u64::from(rendered.image.height());
    if rendered.traced < pixels {
        // Never all of them.
        let percent = (100.0 * rendered.traced as f64 / pixels as f64).floor();
        let rest = match rendered.reached {
            Some(reached) if reached.stopped_by == StoppedBy::TimeLimit => {
                " (the time was up: the others show a coarse preview)"
            }
            None if interrupt::requested().is_none() => {
                " (the time was up: the others are transparent)"
            }
            _ => "",
        };
        return format!("{percent} % of the pixels{rest}");
    }
    let Some(reached) = rendered.reached else {
        return String::new();
    };
    let by = match reached.stopped_by {
        StoppedBy::Samples => String::new(),
        StoppedBy::TimeLimit => " (the time was up)".into(),
        StoppedBy::Noise => " (the noise was low enough)".into(),
        StoppedBy::Interrupted => {
            return format!("{} of {} samples a pixel", reached.samples, reached.asked);
        }
    };
    let noise = if reached.noise.is_infinite() {
        String::new()
    } else {
        format!(", noise {:.2} %", 100.0 * reached.noise)
    };
    let samples = count_of(reached.samples as usize, "sample");
    format!("{samples} a pixel{by}{noise}")
}

/// Renders on the other path and compares; `None` if a signal came first.
fn check(
    arguments: &RenderArguments,
    scene: &Scene,
    settings: Settings,
    other: &Device,
    rendered: &Rendered,
) -> Result<Option<Check>> {
    let again = with_bar(arguments, scene, settings, other)?;
    if !again.is_complete() {
        note("interrupted: the check was not finished");
        return Ok(None);
    }
    let comparison = Comparison::of(&rendered.image, &again.image, Tolerance::default())
        .ok_or_else(|| Error::Image {
            path: PathBuf::new(),
            reason: "the two paths made images of different sizes".into(),
            help: "this is a mistake of spherule's; please report it".into(),
        })?;
    let passed = comparison.is_within();
    if !arguments.quiet {
        note(&format!(
            "{}: against {}, largest difference {:.2}/255, mean {:.5}/255, {} of {} pixels off by more than {}/255 \
             (limit {:.1} %)",
            if passed {
                "check passed"
            } else {
                "CHECK FAILED"
            },
            other.name(),
            comparison.largest,
            comparison.mean,
            comparison.differing,
            comparison.pixels,
            comparison.tolerance.channel,
            comparison.tolerance.share * 100.0,
        ));
    }
    Ok(Some(Check {
        against: other.name(),
        comparison,
        passed,
    }))
}

/// The input's name with `.png`, in the current directory.
fn default_output(input: &Path) -> PathBuf {
    let input = uncompressed(input);
    let mut name = input.file_stem().unwrap_or(input.as_os_str()).to_owned();
    name.push(".png");
    name.into()
}

fn human(duration: Duration) -> String {
    let seconds = duration.as_secs_f64();
    if seconds < 1.0 {
        format!("{:.0} ms", seconds * 1e3)
    } else {
        format!("{seconds:.1} s")
    }
}
