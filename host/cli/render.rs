//! `spherule render`: from a file to an image.

use std::fmt::Write as _;
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
use crate::film::agreement::{Agreement, Compared};
use crate::film::compare::{Comparison, Tolerance};
use crate::film::denoise::Denoiser;
use crate::plural::count_of;
use crate::read::text::uncompressed;
use crate::render::paths::{Reached, StoppedBy};
use crate::render::{Rendered, Settings, estimate, render};
use crate::scene::Scene;
use crate::shown::shown_path;
use crate::write::same::{refuse_clashes, refuse_inputs};
use crate::write::{Format, Output, ReservedMemory};

/// What `--stats` writes.
#[derive(Debug, Serialize)]
struct Stats {
    device: String,
    backend: &'static str,
    precision: &'static str,
    spheres: usize,
    /// Shapes beside the spheres.
    shapes: usize,
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
    #[serde(skip_serializing_if = "Option::is_none")]
    denoise: Option<f64>,
    encode: f64,
    total: f64,
}

#[derive(Debug, Serialize)]
struct Check {
    against: String,
    #[serde(flatten)]
    comparison: Comparison,
    #[serde(skip_serializing_if = "Option::is_none")]
    agreement: Option<Agreement>,
    passed: bool,
}

/// How long the parts of the command took that the renderer does not time.
struct Took {
    load: Duration,
    opening: Duration,
    /// If the image was denoised.
    denoise: Option<Duration>,
    encode: Duration,
    total: Duration,
}

impl Stats {
    fn of(
        scene: &Scene,
        settings: &Settings,
        device: &Device,
        rendered: &Rendered,
        took: &Took,
        check: Option<Check>,
    ) -> Self {
        let timings = &rendered.timings;
        let trace = timings.trace.as_secs_f64();
        let is_shown =
            |effect| rendered.reached.is_some() && settings.effects.shown(effect).any(effect);
        Self {
            device: device.name(),
            backend: device.backend(),
            precision: settings.rung.name(),
            spheres: scene.world.spheres.len(),
            shapes: scene.world.shapes.len(),
            width: scene.width,
            height: scene.height,
            rays: rendered.rays,
            traced_pixels: rendered.traced,
            effects: scene
                .called_effects()
                .iter()
                .filter(|called| is_shown(called.effect))
                .map(|called| called.name)
                .collect(),
            sampling: rendered.reached,
            seconds: Seconds {
                load: took.load.as_secs_f64(),
                compile: timings.compile.as_secs_f64(),
                setup: (took.opening + timings.setup).as_secs_f64(),
                trace,
                readback: timings.readback.as_secs_f64(),
                denoise: took.denoise.map(|denoise| denoise.as_secs_f64()),
                encode: took.encode.as_secs_f64(),
                total: took.total.as_secs_f64(),
            },
            mrays_per_s: rendered.rays as f64 / trace.max(1e-9) * 1e-6,
            depth_range: rendered.image.depth_range(),
            check,
        }
    }
}

/// Where the results go.
struct Outputs {
    image: Output,
    stats: Option<Output>,
}

impl Outputs {
    fn of(arguments: &RenderArguments) -> Result<Self> {
        let image = arguments
            .output
            .clone()
            .unwrap_or_else(|| default_output(&arguments.input));
        let outputs = Self {
            image: Output::image(&image)?,
            stats: arguments.stats.as_deref().map(Output::new).transpose()?,
        };
        refuse_clashes(&outputs.all())?;
        refuse_inputs(&outputs.all(), std::slice::from_ref(&arguments.input))?;
        Ok(outputs)
    }

    fn all(&self) -> Vec<&Output> {
        std::iter::once(&self.image).chain(&self.stats).collect()
    }
}

pub(super) fn run(arguments: &RenderArguments) -> Result<ExitCode> {
    let started = Instant::now();
    let outputs = Outputs::of(arguments)?;
    let (scene, early, load) = load_and_open(arguments, started);
    let mut scene = scene?;
    refuse_inputs(&outputs.all(), &scene.sources)?;
    apply(arguments, &mut scene);

    let (mut device, why) = choose_device(arguments, &scene, early)?;
    let opening = started.elapsed() - load;
    let other = other_device(arguments, &device)?;
    let denoiser = arguments.denoise.then(Denoiser::open).transpose()?;
    let settings = choose_settings(arguments, &scene, &device, &why);

    // An image that a signal or a time limit cuts has opacities.
    let format = Format::of(outputs.image.path())?;
    let room = ReservedMemory::reserve(format, scene.width, scene.height, true)?;
    // From here on the first signal ends the tracing, and the picture is kept.
    let graceful = Graceful::new();
    let mut rendered = render_or_fall_back(arguments, &scene, settings, &mut device)?;
    if let Some(code) = code_for_nothing(&rendered) {
        return Ok(code);
    }
    // If that fails, the image is written as it is.
    let denoised = match denoiser {
        Some(denoiser) => denoise(arguments, denoiser, &mut rendered),
        None => Ok(None),
    };
    let encoding = Instant::now();
    // What is rendered is written before a signal ends the command.
    rendered.image.save_to(&outputs.image, room)?;
    let encode = encoding.elapsed();
    tracing::debug!(
        "encoded and wrote {}: {encode:.1?}",
        shown_path(outputs.image.path())
    );
    let took = Took {
        load,
        opening,
        denoise: denoised.as_ref().ok().copied().flatten(),
        encode,
        total: started.elapsed(),
    };
    say_what_is_written(arguments, &scene, &outputs.image, &rendered, took.total);

    let check = other
        .filter(|_| interrupt::requested().is_none())
        .map(|other| check(arguments, &scene, settings, &other, &rendered))
        .transpose()?
        .flatten();
    let passed = check.as_ref().is_none_or(|check| check.passed);
    if let Some(output) = &outputs.stats {
        let stats = Stats::of(&scene, &settings, &device, &rendered, &took, check);
        write_json(output, &stats)?;
    }
    drop(graceful);
    if let Some(code) = interrupt::exit_code() {
        return Ok(code);
    }
    denoised?;
    Ok(if passed {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}

fn say(arguments: &RenderArguments, text: &str) {
    if !arguments.quiet {
        note(text);
    }
}

/// A device, and the reason for it.
type Opened = Result<(Device, String)>;

/// Reads the scene, and meanwhile opens the device if that is certain to be needed. Also returns
/// how long after `started` the scene was read.
fn load_and_open(
    arguments: &RenderArguments,
    started: Instant,
) -> (Result<Scene>, Option<Opened>, Duration) {
    std::thread::scope(|scope| {
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
    })
}

/// Puts what the arguments say of the image in place of what the scene says.
fn apply(arguments: &RenderArguments, scene: &mut Scene) {
    if let Some(size) = arguments.size {
        (scene.width, scene.height) = (size.width, size.height);
    }
    let sampling = &mut scene.sampling;
    sampling.samples = arguments.samples.or(sampling.samples);
    sampling.max_bounces = arguments.max_bounces.unwrap_or(sampling.max_bounces);
    sampling.seed = arguments.seed.unwrap_or(sampling.seed);
}

/// The device that was opened early, or else the one that the arguments and the scene call for.
fn choose_device(arguments: &RenderArguments, scene: &Scene, early: Option<Opened>) -> Opened {
    let is_brief = || {
        let threads = rayon::current_num_threads();
        estimate::is_brief(scene, arguments.shade, arguments.effects, threads)
    };
    if arguments.device == DeviceChoice::Auto && !arguments.check && is_brief() {
        Ok((Device::Cpu, "done before a GPU would be open".into()))
    } else {
        early.unwrap_or_else(|| Device::open(&arguments.device))
    }
}

/// The device for `--check`. Opened before the work, so that a check that cannot be is known at
/// once.
fn other_device(arguments: &RenderArguments, device: &Device) -> Result<Option<Device>> {
    Ok(match (device, arguments.check) {
        (_, false) => None,
        (Device::Cpu, true) => Some(Device::open(&DeviceChoice::Gpu)?.0),
        (Device::Gpu(_), true) => Some(Device::Cpu),
    })
}

/// The settings that the arguments and the scene call for. Says which device and which rung are
/// taken, and why, and what of the arguments is without effect.
fn choose_settings(
    arguments: &RenderArguments,
    scene: &Scene,
    device: &Device,
    why: &str,
) -> Settings {
    let chosen = choose_rung(arguments.precision, scene, arguments.tolerance, device);
    say(
        arguments,
        &format!(
            "rendering on {} ({why}), precision {} ({})",
            device.name(),
            chosen.rung.name(),
            chosen.why
        ),
    );
    if let Some(warning) = &chosen.warning {
        say(arguments, warning);
    }
    let settings = Settings {
        shading: arguments.shade,
        rung: chosen.rung,
        acceleration: Acceleration::Auto,
        effects: arguments.effects,
        time_limit: arguments.time_limit.map(Duration::from_secs_f64),
        noise: arguments.noise,
    };
    let asks_for_samples =
        arguments.samples.is_some() || arguments.seed.is_some() || arguments.noise.is_some();
    let shown = settings.effects.shown(scene.effects());
    if asks_for_samples && (settings.shading != Shading::Lit || shown.is_empty()) {
        say(
            arguments,
            "nothing in this image is sampled: --samples, --seed and --noise have no effect",
        );
    }
    settings
}

/// Renders on `device`. Where that was chosen by this command and cannot be relied on for the rung,
/// `device` becomes the CPU.
fn render_or_fall_back(
    arguments: &RenderArguments,
    scene: &Scene,
    settings: Settings,
    device: &mut Device,
) -> Result<Rendered> {
    let rendered = match with_bar(arguments, scene, settings, device) {
        Err(error @ Error::RungRefused { .. })
            if arguments.device == DeviceChoice::Auto && !arguments.check =>
        {
            *device = Device::Cpu;
            say(
                arguments,
                &format!("{error}\nrendering on {} instead", device.name()),
            );
            with_bar(arguments, scene, settings, device)?
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
    Ok(rendered)
}

/// Where nothing was rendered that could be written: says so, and returns the exit code.
fn code_for_nothing(rendered: &Rendered) -> Option<ExitCode> {
    if rendered.traced > 0 {
        return None;
    }
    if let Some(code) = interrupt::exit_code() {
        note("interrupted before the first pixel was done: nothing is written");
        return Some(code);
    }
    // Where there are samples there is a preview.
    if rendered.reached.is_some() {
        return None;
    }
    note(
        "the time was up before the first pixel was done: nothing is written; give a longer --time-limit",
    );
    Some(ExitCode::FAILURE)
}

/// Removes the noise of the samples, and says so. Returns how long that took, if there was any.
fn denoise(
    arguments: &RenderArguments,
    mut denoiser: Denoiser,
    rendered: &mut Rendered,
) -> Result<Option<Duration>> {
    let pixels = u64::from(rendered.image.width()) * u64::from(rendered.image.height());
    let why_not = match rendered.reached {
        None => "nothing in this image is sampled: --denoise has no effect",
        Some(_) if rendered.traced < pixels => "not denoised: some pixels have no sample yet",
        Some(_) => {
            let started = Instant::now();
            denoiser.denoise(&mut rendered.image)?;
            let took = started.elapsed();
            let text = format!("denoised by {} in {}", denoiser.name(), human(took));
            say(arguments, &text);
            return Ok(Some(took));
        }
    };
    say(arguments, why_not);
    Ok(None)
}

fn say_what_is_written(
    arguments: &RenderArguments,
    scene: &Scene,
    output: &Output,
    rendered: &Rendered,
    total: Duration,
) {
    let image = &rendered.image;
    if let Some((near, far)) = image.depth_range() {
        say(
            arguments,
            &format!("depth from {near} (white) to {far} (black) scene units"),
        );
    }
    let extent = extent(rendered);
    let path = shown_path(output.path());
    if interrupt::requested().is_some() && !rendered.is_complete() {
        note(&format!("interrupted: wrote {path} with {extent}"));
        return;
    }
    say(
        arguments,
        &format!(
            "wrote {path}: {} × {} pixels{}{extent}, {}, {}",
            image.width(),
            image.height(),
            if extent.is_empty() { "" } else { ", " },
            scene.world.contents(),
            human(total),
        ),
    );
}

/// Whether the device is opened while the file is read: it is a GPU for certain, and there is a
/// file. What `auto` takes depends on what is in it.
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
        let bound = if reached.is_upper_estimate {
            " at most"
        } else {
            ""
        };
        format!(", noise{bound} {:.2} %", 100.0 * reached.noise)
    };
    let samples = count_of(reached.samples as usize, "sample");
    let samples = if reached.is_upper_estimate || reached.samples == reached.most_samples {
        format!("{samples} a pixel")
    } else {
        format!(
            "{} to {} samples a pixel, {:.1} in the mean",
            reached.samples, reached.most_samples, reached.mean_samples
        )
    };
    format!("{samples}{by}{noise}")
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
    let (first, second) = (&rendered.image, &again.image);
    let (tolerance, agreement) = match rendered.reached {
        Some(reached) => {
            let tolerance = Tolerance::of_paths(reached.samples);
            (tolerance, Agreement::of(first, second))
        }
        None => (Tolerance::default(), None),
    };
    let comparison = Comparison::of(first, second, tolerance).ok_or_else(|| Error::Image {
        path: PathBuf::new(),
        reason: "the two paths made images of different sizes".into(),
        help: "this is a mistake of spherule's; please report it".into(),
    })?;
    let check = Check {
        against: other.name(),
        passed: comparison.is_within() && agreement.as_ref().is_none_or(Agreement::is_within),
        comparison,
        agreement,
    };
    say(arguments, &check.text());
    Ok(Some(check))
}

impl Check {
    /// What was compared, and what came of it.
    fn text(&self) -> String {
        let Comparison {
            largest,
            mean,
            differing,
            pixels,
            tolerance,
        } = self.comparison;
        let result = if self.passed {
            "check passed"
        } else {
            "CHECK FAILED"
        };
        let mut text = format!(
            "{result}: against {}, largest difference {largest:.2}/255, mean {mean:.5}/255, \
             {differing} of {pixels} pixels off by more than {}/255 (limit {:.1} %)",
            self.against,
            tolerance.channel,
            tolerance.share * 100.0,
        );
        if let Some(Agreement {
            worst,
            limit,
            regions,
        }) = &self.agreement
        {
            let compared = match worst.compared {
                Compared::Mean => "the mean light",
                Compared::Brighter => "the number of brighter pixels",
            };
            // Writing to a String cannot fail.
            let _ = write!(
                text,
                "; of {regions} regions, {} × {} pixels at ({}, {}) differ most: by {:.1} standard \
                 errors in {compared}, {} (limit {limit:.1})",
                worst.width,
                worst.height,
                worst.x,
                worst.y,
                worst.errors,
                worst.channel.name(),
            );
        }
        text
    }
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
