//! `spherule accuracy`: measures the errors and the time of each rung on each family of rays.

use std::fmt::Write;
use std::ops::ControlFlow;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use serde::Serialize;
use spherule_kernel::{Ray, Rung, Sphere};

use super::args::{AccuracyArguments, Subject};
use super::progress::Bar;
use super::{load, note, write_json};
use crate::accuracy::families::Family;
use crate::accuracy::frames::{self, Frame};
use crate::accuracy::measure::{Escalation, RungErrors, intersect_all, judge, self_hits};
use crate::accuracy::price::{self, Price};
use crate::accuracy::samples::{self, Plan, Step};
use crate::accuracy::{report, scene_rays};
use crate::device::Device;
use crate::device::canary::Canary;
use crate::error::{Result, SceneError};
use crate::film::denoise::Denoiser;
use crate::memory;
use crate::plural::count_of;
use crate::render::fit::{fit, probe};
use crate::render::{Progress, QUIET, Settings};
use crate::scene::Scene;
use crate::shown::shown_path;
use crate::ulp;
use crate::write::Output;
use crate::write::same::{refuse_clashes, refuse_inputs};

/// Everything that was measured, as the JSON output has it.
#[derive(Debug, Serialize)]
pub(super) struct AccuracyReport {
    device: String,
    /// The requested number; each family has its own count.
    rays_a_family: u32,
    seed: u64,
    refused: Vec<(&'static str, String)>,
    families: Vec<FamilyReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    frames: Option<FramesReport>,
    /// Width and height of the image that `samples` measure.
    #[serde(skip_serializing_if = "Option::is_none")]
    samples_image: Option<[u32; 2]>,
    /// Samples a pixel of the reference image.
    #[serde(skip_serializing_if = "Option::is_none")]
    reference_samples: Option<u32>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    samples: Vec<Step>,
}

/// Whole frames of a scene file.
#[derive(Debug, Serialize)]
struct FramesReport {
    scene: String,
    spheres: usize,
    width: u32,
    height: u32,
    rungs: Vec<Frame>,
}

#[derive(Debug, Serialize)]
struct FamilyReport {
    family: &'static str,
    /// How many tests each stage of the certified rung decides.
    escalation: Escalation,
    rungs: Vec<RungReport>,
}

#[derive(Debug, Serialize)]
struct RungReport {
    rung: &'static str,
    price: Price,
    measured: RungErrors,
    /// Rays that left a hit outwards and hit the same sphere again.
    self_hits: usize,
}

const SEED: u64 = 2026;
/// The most samples of `--samples`; the reference has more.
const MOST_SAMPLES: u32 = 256;
/// The memory for a ray of a family with its sphere, its answer, and the ray that leaves the hit.
const BYTES_PER_RAY: u64 = 3 * size_of::<(Ray, Sphere)>() as u64;
/// The share of the time limit that `--samples` plans for. The rest is for finding the size of the
/// image, and for drift.
const SHARE: f64 = 0.8;

/// Where the report goes.
struct Outputs {
    html: Option<Output>,
    json: Option<Output>,
    stdout: Option<Output>,
}

impl Outputs {
    fn of(arguments: &AccuracyArguments) -> Result<Self> {
        let html = arguments.output.as_deref().map(Output::new).transpose()?;
        let json = arguments.json.as_deref().map(Output::new).transpose()?;
        // Output for a program must not be mixed with a table.
        let to_stdout = html.iter().chain(&json).any(Output::is_stdout);
        let stdout = (!to_stdout).then(Output::stdout).transpose()?;
        let outputs = Self { html, json, stdout };
        refuse_clashes(&outputs.all())?;
        Ok(outputs)
    }

    fn all(&self) -> Vec<&Output> {
        self.html
            .iter()
            .chain(&self.json)
            .chain(&self.stdout)
            .collect()
    }

    fn write(&self, report: &AccuracyReport) -> Result<()> {
        if let Some(output) = &self.html {
            output.write(page(report).as_bytes())?;
            note(&format!("wrote {}", shown_path(output.path())));
        }
        if let Some(output) = &self.json {
            write_json(output, report)?;
        }
        if let Some(output) = &self.stdout {
            output.write(table(report).as_bytes())?;
        }
        Ok(())
    }
}

pub(super) fn run(arguments: &AccuracyArguments) -> Result<ExitCode> {
    let started = Instant::now();
    // Errors in the input are reported before any device is opened.
    let outputs = Outputs::of(arguments)?;
    let scene = scene(arguments, &outputs)?;
    memory::require(
        u64::from(arguments.rays) * BYTES_PER_RAY,
        &format!("judging {} rays", arguments.rays),
    )?;
    let (device, why) = Device::open(&arguments.device)?;
    note(&format!("measuring {} ({why})", device.name()));
    let canary = Canary::on(&device)?;
    let mut refused = Vec::new();
    let mut rungs = Vec::new();
    for rung in Rung::ALL {
        match canary.objection(rung) {
            None => rungs.push(rung),
            Some(why) => refused.push((rung.name(), why)),
        }
    }
    let found = find(arguments, scene, &device, &rungs, started)?;
    if let Some(reference) = found.reference_samples
        && found.samples.is_empty()
    {
        note(&format!(
            "nothing is measured: time ran out after {} of the reference, which needs at least {} \
             for a comparison; give a longer --time-limit",
            count_of(reference as usize, "sample"),
            samples::LEAST_REFERENCE,
        ));
        return Ok(ExitCode::FAILURE);
    }
    if found.is_cut {
        note("time ran out before all samples were measured; give a longer --time-limit");
    }
    outputs.write(&AccuracyReport {
        device: device.name(),
        rays_a_family: arguments.rays,
        seed: SEED,
        refused,
        families: found.families,
        frames: found.frames,
        samples_image: found.samples_image,
        reference_samples: found.reference_samples,
        samples: found.samples,
    })?;
    Ok(ExitCode::SUCCESS)
}

/// The scene that is measured, if it is not families of rays.
fn scene(arguments: &AccuracyArguments, outputs: &Outputs) -> Result<Option<Scene>> {
    let path = match (&arguments.samples, &arguments.scene) {
        (Some(path), _) | (None, Some(Subject::Scene(path))) => path,
        (None, Some(Subject::Family(_)) | None) => return Ok(None),
    };
    refuse_inputs(&outputs.all(), std::slice::from_ref(path))?;
    let mut scene = load(path)?;
    refuse_inputs(&outputs.all(), &scene.sources)?;
    scene.require_spheres_alone("accuracy")?;
    if let Some(size) = arguments.size {
        (scene.width, scene.height) = (size.width, size.height);
    }
    if arguments.samples.is_some() && scene.effects().is_empty() {
        return Err(SceneError::without_place(
            path,
            "the scene calls for no effect, so one ray a pixel is exact",
            "give a scene with light or samples, for example scenes/soft-light.toml, or measure its frames with --scene",
        )
        .into());
    }
    Ok(Some(scene))
}

/// What was measured, as [`AccuracyReport`] has it.
#[derive(Default)]
struct Found {
    families: Vec<FamilyReport>,
    frames: Option<FramesReport>,
    samples_image: Option<[u32; 2]>,
    reference_samples: Option<u32>,
    samples: Vec<Step>,
    /// Whether time ran out before all samples were measured.
    is_cut: bool,
}

/// Measures what the arguments ask for. `started` is when the command began.
fn find(
    arguments: &AccuracyArguments,
    scene: Option<Scene>,
    device: &Device,
    rungs: &[Rung],
    started: Instant,
) -> Result<Found> {
    let bar = Bar::new("measuring", false);
    let progress = |done| {
        bar.set(done);
        ControlFlow::Continue(())
    };
    let rays = arguments.rays as usize;
    match (scene, &arguments.scene) {
        (Some(scene), _) if arguments.samples.is_some() => {
            // The limit is for the whole command. A requested size is measured in full.
            let until = match arguments.size {
                None => Some(started + Duration::from_secs_f64(arguments.time_limit)),
                Some(_) => None,
            };
            let denoiser = arguments.denoise.then(Denoiser::open).transpose()?;
            find_samples(scene, device, rungs, denoiser, until, &progress)
        }
        (Some(scene), Some(Subject::Scene(path))) => {
            let samples = scene_rays::sample(&scene, SEED, rays)?;
            let family = measure(device, rungs, "scene", &samples, QUIET)?;
            let frames = FramesReport {
                scene: shown_path(path),
                spheres: scene.world.spheres.len(),
                width: scene.width,
                height: scene.height,
                rungs: frames::measure(device, rungs, &scene, &progress)?,
            };
            Ok(Found {
                families: vec![family],
                frames: Some(frames),
                ..Found::default()
            })
        }
        (_, Some(Subject::Family(only))) => find_families(&[*only], device, rungs, rays, &progress),
        _ => find_families(&Family::ALL, device, rungs, rays, &progress),
    }
}

/// Measures the error of more and more samples a pixel, with fewer pixels if they would not be done
/// at `until`.
fn find_samples(
    mut scene: Scene,
    device: &Device,
    rungs: &[Rung],
    denoiser: Option<Denoiser>,
    until: Option<Instant>,
    progress: Progress<'_>,
) -> Result<Found> {
    // The other rungs are between these in time and in error.
    let ends = [Rung::Robust, Rung::Double, Rung::Certified];
    let rungs: Vec<Rung> = ends.into_iter().filter(|r| rungs.contains(r)).collect();
    let whole = [scene.width, scene.height];
    let compiling = match until {
        Some(until) => fit_samples(&mut scene, device, &rungs, until)?,
        None => Duration::ZERO,
    };
    if whole != [scene.width, scene.height] {
        note(&format!(
            "with {} × {} of {} × {} pixels, to be done in time (--size {2}x{3} measures the whole image)",
            scene.width, scene.height, whole[0], whole[1],
        ));
    }
    let plan = Plan {
        most: MOST_SAMPLES,
        denoiser,
        compiling,
        until,
    };
    let measured = samples::measure(device, &rungs, &scene, plan, progress)?;
    Ok(Found {
        samples_image: Some([scene.width, scene.height]),
        reference_samples: Some(measured.reference),
        samples: measured.steps,
        is_cut: measured.is_cut,
        ..Found::default()
    })
}

/// Measures so many rays of each of these families.
fn find_families(
    wanted: &[Family],
    device: &Device,
    rungs: &[Rung],
    rays: usize,
    progress: Progress<'_>,
) -> Result<Found> {
    let mut families = Vec::new();
    for (index, family) in wanted.iter().enumerate() {
        let samples = family.sample(SEED, rays);
        let progress = |done| progress((index as f64 + done) / wanted.len() as f64);
        let name = family.name();
        families.push(measure(device, rungs, name, &samples, &progress)?);
    }
    Ok(Found {
        families,
        ..Found::default()
    })
}

/// Measures everything about one family of rays.
fn measure(
    device: &Device,
    rungs: &[Rung],
    family: &'static str,
    samples: &[(Ray, Sphere)],
    progress: Progress<'_>,
) -> Result<FamilyReport> {
    let prices = price::measure(device, rungs, samples)?;
    let mut reports = Vec::new();
    for (rung, price) in rungs.iter().zip(prices) {
        let _ = progress((1 + reports.len()) as f64 / (1 + rungs.len()) as f64);
        let answers = intersect_all(device, *rung, samples)?;
        reports.push(RungReport {
            rung: rung.name(),
            price,
            measured: judge(samples, &answers),
            self_hits: self_hits(device, *rung, samples, &answers)?,
        });
    }
    Ok(FamilyReport {
        family,
        escalation: Escalation::of(samples),
        rungs: reports,
    })
}

/// Makes the image of `scene` smaller if what `--samples` renders would not be done at `until`.
/// Returns the time that compiling the pipeline took.
fn fit_samples(
    scene: &mut Scene,
    device: &Device,
    rungs: &[Rung],
    until: Instant,
) -> Result<Duration> {
    // Two, so that the pipeline is that of the following images: a single sample has no
    // antialiasing.
    const SAMPLES: u32 = 2;
    let samples = scene.sampling.samples.replace(SAMPLES);
    let in_all = samples::in_all(rungs.len(), MOST_SAMPLES);
    // The reference takes most of the time, on the highest of the rungs.
    let settings = Settings {
        rung: rungs.last().copied().unwrap_or_default(),
        ..Settings::default()
    };
    let left = until.saturating_duration_since(Instant::now());
    let frame = left.mul_f64(SHARE * f64::from(SAMPLES) / in_all as f64);
    let mut compiling = Duration::ZERO;
    fit(scene, frame, |scene| {
        let (took, compile) = probe(scene, settings, device, until)?;
        compiling = compiling.max(compile);
        Ok(took)
    })?;
    scene.sampling.samples = samples;
    Ok(compiling)
}

fn steps_table(report: &AccuracyReport) -> String {
    let [width, height] = report.samples_image.unwrap_or_default();
    let mut text = format!(
        "{}, {width} × {height} pixels, against {} of another seed\n\n{:12} {:>8} {:>14} {:>10} {:>10} {:>10} {:>12}\n",
        report.device,
        count_of(
            report.reference_samples.unwrap_or_default() as usize,
            "sample"
        ),
        "rung",
        "samples",
        "ms",
        "error",
        "estimate",
        "ꟻLIP",
        "error² × ms",
    );
    for (index, step) in report.samples.iter().enumerate() {
        let is_first = index == 0 || report.samples[index - 1].series() != step.series();
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{:12} {:>8} {:>14.3} {:>8.3} % {:>10} {:>10.5} {:>12.3e}",
            if is_first { step.series() } else { "" },
            step.samples,
            step.milliseconds,
            100.0 * step.error,
            if step.estimate.is_finite() {
                format!("{:.3} %", 100.0 * step.estimate)
            } else {
                "–".into()
            },
            step.flip,
            step.error * step.error * step.milliseconds,
        );
    }
    text.push_str(
        "\nerror: root mean square of the luminance against the image of many samples, over the mean.\n\
         estimate: the render's own, an upper one: it takes the samples for independent, though they are stratified.\n\
         error² × ms is constant if the error falls as 1/√N, and falls if the error falls faster.\n",
    );
    if report.samples.iter().any(|step| step.denoised) {
        text.push_str(
            "denoised: the images of the first rung without their noise, which are biased: their error need not go to zero.\n",
        );
    }
    text
}

fn table(report: &AccuracyReport) -> String {
    if !report.samples.is_empty() {
        return steps_table(report);
    }
    let mut text = format!(
        "{}, {} rays a family\n\n{:9} {:12} {:>17} {:>9} {:>12} {:>11} {:>7} {:>7} {:>8} {:>8} {:>8}\n",
        report.device,
        report.rays_a_family,
        "family",
        "rung",
        "ns a test",
        "× robust",
        "max ulp",
        "p99.99",
        "false",
        "missed",
        "margin",
        "self",
        "normal°",
    );
    for family in &report.families {
        let robust = family
            .rungs
            .iter()
            .find(|rung| rung.rung == Rung::Robust.name())
            .map_or(f64::NAN, |rung| rung.price.nanoseconds);
        for (index, rung) in family.rungs.iter().enumerate() {
            let (price, measured) = (&rung.price, &rung.measured);
            // Writing to a String cannot fail.
            let _ = writeln!(
                text,
                "{:9} {:12} {:>8} ± {:<7} {:>8.2} {:>12} {:>11} {:>7} {:>7} {:>8} {:>8} {:>8}",
                if index == 0 { family.family } else { "" },
                rung.rung,
                digits(price.nanoseconds),
                digits(0.5 * (price.slowest - price.fastest)),
                price.nanoseconds / robust,
                ulp::shown(measured.max_ulp_anywhere),
                ulp::shown(measured.ulp_at(0.9999)),
                measured.false_hits,
                measured.false_misses,
                if measured.margin > 0.0 {
                    format!("{:.1e}", measured.margin)
                } else {
                    "–".into()
                },
                rung.self_hits,
                format!("{:.1e}", measured.normal_degrees),
            );
        }
        let _ = writeln!(text, "{:9} {}\n", "", family.escalation);
    }
    for (rung, why) in &report.refused {
        let _ = writeln!(text, "{rung} is refused here: {why}");
    }
    if let Some(frames) = &report.frames {
        text.push_str(&frames_table(frames));
    }
    text.push_str(
        "ulp: error of t in units in the last place, over the hits, or \"no digit\" if no digit is right.\n\
         false, missed: reported hits that are misses, hits that were not found. margin: the largest |Δ| / (a r²)\n\
         on the wrong side of a silhouette. self: rays that leave a hit outwards and hit its sphere again.\n\
         normal°: the largest error of the normal.\n",
    );
    text
}

fn frames_table(frames: &FramesReport) -> String {
    let mut text = format!(
        "{}: {}, {} × {} pixels\n\n{:12} {:>18} {:>9} {:>18} {:>9}\n",
        frames.scene,
        count_of(frames.spheres, "sphere"),
        frames.width,
        frames.height,
        "rung",
        "ms a frame",
        "× robust",
        "pixels differ",
        "ꟻLIP",
    );
    let robust = frames
        .rungs
        .iter()
        .find(|frame| frame.rung == Rung::Robust.name())
        .map_or(f64::NAN, |frame| frame.milliseconds);
    for frame in &frames.rungs {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{:12} {:>9.3} ± {:<6.3} {:>9.2} {:>8} {:>7.3} % {:>9.6}",
            frame.rung,
            frame.milliseconds,
            0.5 * (frame.slowest - frame.fastest),
            frame.milliseconds / robust,
            frame.differing,
            100.0 * frame.differing as f64 / frame.pixels.max(1) as f64,
            frame.flip,
        );
    }
    text.push_str(
        "against the CPU's image on certified: pixels off by more than two 255ths, or hit where it misses.\n\n",
    );
    text
}

/// About three digits, from picoseconds to microseconds.
fn digits(nanoseconds: f64) -> String {
    match nanoseconds {
        x if x >= 100.0 => format!("{x:.0}"),
        x if x >= 1.0 => format!("{x:.2}"),
        x => format!("{x:.5}"),
    }
}

fn page(report: &AccuracyReport) -> String {
    let families: Vec<report::FamilyResults<'_>> = report
        .families
        .iter()
        .map(|family| report::FamilyResults {
            name: family.family,
            note: family.escalation.to_string(),
            rungs: family
                .rungs
                .iter()
                .map(|rung| report::Row {
                    rung: rung.rung,
                    price: rung.price,
                    measured: &rung.measured,
                })
                .collect(),
        })
        .collect();
    report::page(
        &report.device,
        report.rays_a_family,
        &families,
        report
            .frames
            .as_ref()
            .map(|frames| (frames.scene.as_str(), frames.rungs.as_slice())),
        &report.samples,
        &table(report),
    )
}
