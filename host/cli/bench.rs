//! `spherule bench`: measures the speed of rays of every kind.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde::Serialize;

use super::args::BenchArguments;
use super::{note, print, write_json};
use crate::accel::Acceleration;
use crate::bench::export::{self, export};
use crate::bench::limit::Limit;
use crate::bench::measure::{Plan, Speed, WorldSpeeds, measure};
use crate::bench::rays::RaySets;
use crate::bench::scenes::{BenchScene, Source};
use crate::bench::verify::{Verified, verify};
use crate::device::Device;
use crate::error::Result;
use crate::scene::Scene;
use crate::shown::shown_path;
use crate::trace::CpuTracer;
use crate::write::Output;
use crate::write::same::{refuse_clashes, refuse_inputs};
use spherule_kernel::Rung;

/// The JSON output.
#[derive(Serialize)]
struct BenchReport<'a> {
    device: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    limit: Option<Limit>,
    scenes: &'a [WorldSpeeds],
}

pub(super) fn run(arguments: &BenchArguments) -> Result<ExitCode> {
    let size = arguments.size;
    let json = arguments.json.as_deref().map(Output::new).transpose()?;
    let plan = Plan {
        rung: arguments.precision,
        acceleration: arguments.acceleration.into(),
        rounds: arguments.rounds as usize,
    };
    let names = names(arguments);
    // Every name, and the memory that it needs, is checked before anything is measured.
    let sources = names
        .iter()
        .map(|name| source(name))
        .collect::<Result<Vec<_>>>()?;
    RaySets::check_room(size.width, size.height)?;
    let folders = match &arguments.export {
        Some(folder) => export::folders(folder, &sources)?,
        None => Vec::new(),
    };
    let outputs = outputs(json, &folders)?;
    let json = arguments.json.as_ref().and(outputs.first());
    let outputs: Vec<&Output> = outputs.iter().collect();
    refuse_clashes(&outputs)?;
    let scenes = scenes(arguments, &names, sources, &outputs)?;
    if !folders.is_empty() {
        return export_all(arguments, plan, scenes, &folders);
    }
    let (device, why) = Device::open(&arguments.device)?;
    note(&format!("{} ({why})", device.name()));
    if arguments.verify {
        return compare(arguments, &device, scenes);
    }
    measure_all(arguments, plan, &device, scenes, json)
}

/// The names of the scenes that are measured.
fn names(arguments: &BenchArguments) -> Vec<OsString> {
    if !arguments.scene.is_empty() {
        return arguments.scene.clone();
    }
    let all = BenchScene::ALL.map(BenchScene::name);
    // Making it takes longer than all the others together.
    all.into_iter()
        .filter(|name| *name != "R10M")
        .map(Into::into)
        .collect()
}

/// Everything that is written: the JSON output first, if there is one.
fn outputs(json: Option<Output>, folders: &[PathBuf]) -> Result<Vec<Output>> {
    let mut outputs: Vec<Output> = json.into_iter().collect();
    // Tables go to stdout, unless output for a program does.
    if !outputs.iter().any(Output::is_stdout) && folders.is_empty() {
        outputs.push(Output::stdout()?);
    }
    for folder in folders {
        export::prepare(folder)?;
        outputs.extend(export::outputs(folder)?);
    }
    Ok(outputs)
}

/// The scenes, once it is certain that there is room for each and that no output is one of their
/// files.
fn scenes(
    arguments: &BenchArguments,
    names: &[OsString],
    sources: Vec<Source>,
    outputs: &[&Output],
) -> Result<Vec<Named>> {
    for source in &sources {
        match source {
            Source::Made(scene) => scene.check_room()?,
            Source::File(file) => refuse_inputs(outputs, std::slice::from_ref(file))?,
        }
    }
    names
        .iter()
        .zip(sources)
        .map(|(name, source)| {
            let name = shown_path(Path::new(name));
            let scene = Named::new(name, source, arguments)?;
            if let Some((scene, _)) = &scene.read {
                refuse_inputs(outputs, &scene.sources)?;
            }
            Ok(scene)
        })
        .collect()
}

/// Writes the scenes, their rays and their hits into a folder each.
fn export_all(
    arguments: &BenchArguments,
    plan: Plan,
    scenes: Vec<Named>,
    folders: &[PathBuf],
) -> Result<ExitCode> {
    for (scene, folder) in scenes.into_iter().zip(folders) {
        let name = scene.name.clone();
        let (scene, reach) = scene.take(arguments)?;
        let tracer = CpuTracer::new(&scene.world.spheres, plan.acceleration);
        let sets = RaySets::of(&scene, &tracer, reach)?;
        export(folder, &name, &scene, &sets, &tracer, plan.rung)?;
        note(&format!("wrote {name} to {}", shown_path(folder)));
    }
    Ok(ExitCode::SUCCESS)
}

/// Measures the scenes, and prints and writes what was measured.
fn measure_all(
    arguments: &BenchArguments,
    plan: Plan,
    device: &Device,
    scenes: Vec<Named>,
    json: Option<&Output>,
) -> Result<ExitCode> {
    let size = arguments.size;
    // Output for a program must not be mixed with tables.
    let to_stdout = json.is_some_and(Output::is_stdout);
    let show = |text: &str| if to_stdout { Ok(()) } else { print(text) };
    let mut limit = None;
    if !arguments.no_limit {
        let measured = limit.insert(Limit::of(device)?);
        show(&format!(
            "at most {:.0} · 10⁹ operations and {:.0} · 10⁹ bytes a second\n",
            measured.operations_per_s * 1e-9,
            measured.bytes_per_s * 1e-9,
        ))?;
    }
    show(&head(size.width, size.height, plan, limit.is_some()))?;
    let mut all = Vec::new();
    for scene in scenes {
        let name = scene.name.clone();
        let (scene, reach) = scene.take(arguments)?;
        let measured = measure(device, &name, &scene, reach, plan, limit.as_ref())?;
        show(&row(&measured))?;
        all.push(measured);
    }
    if let Some(output) = json {
        let report = BenchReport {
            device: device.name(),
            limit,
            scenes: &all,
        };
        write_json(output, &report)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// A scene that is measured.
struct Named {
    name: String,
    source: Source,
    /// The scene of a file. A file may be a pipe, so it is read only once, before anything is
    /// written or measured.
    read: Option<(Scene, f32)>,
}

impl Named {
    fn new(name: String, source: Source, arguments: &BenchArguments) -> Result<Self> {
        let size = arguments.size;
        let read = match source {
            Source::Made(_) => None,
            Source::File(_) => Some(source.load(size.width, size.height)?),
        };
        Ok(Self { name, source, read })
    }

    /// The scene, and the length of its ambient rays in scene units.
    fn take(self, arguments: &BenchArguments) -> Result<(Scene, f32)> {
        let size = arguments.size;
        match self.read {
            Some(read) => Ok(read),
            None => self.source.load(size.width, size.height),
        }
    }
}

/// The scene with this name, which may not be valid Unicode if it is a file's.
fn source(name: &OsStr) -> Result<Source> {
    match name.to_str() {
        None if Path::new(name).is_file() => Ok(Source::File(PathBuf::from(name))),
        _ => Source::named(&name.to_string_lossy()),
    }
}

/// Compares the tree's hits with those of testing every sphere.
fn compare(arguments: &BenchArguments, device: &Device, scenes: Vec<Named>) -> Result<ExitCode> {
    let mut all = Verified::default();
    print(&format!(
        "{:<12} {:<12} {:>10} {:>10} {:>10}\n",
        "scene", "precision", "rays", "differing", "ties"
    ))?;
    for scene in scenes {
        let name = scene.name.clone();
        let (scene, reach) = scene.take(arguments)?;
        let tracer = CpuTracer::new(&scene.world.spheres, Acceleration::Auto);
        let sets = RaySets::of(&scene, &tracer, reach)?;
        for rung in Rung::ALL {
            if rung == Rung::Double && !device.has_f64() {
                continue;
            }
            let verified = verify(device, &scene, &sets, rung)?;
            print(&format!(
                "{name:<12} {:<12} {:>10} {:>10} {:>10}\n",
                rung.name(),
                verified.rays,
                verified.differing,
                verified.ties
            ))?;
            all.rays += verified.rays;
            all.differing += verified.differing;
            all.ties += verified.ties;
        }
    }
    let passed = all.differing == 0;
    print(&format!(
        "{}: {} rays, {} differ\n",
        if passed {
            "no hit is lost"
        } else {
            "HITS DIFFER"
        },
        all.rays,
        all.differing
    ))?;
    Ok(if passed {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}

fn head(width: u32, height: u32, plan: Plan, has_limit: bool) -> String {
    format!(
        "{width} x {height}, precision {}, medians of {} {}; Mrays/s of each kind, ± half of the range in per cent{}\n\
         {:<12} {:>9} {:>5}  {:>20} {:>20} {:>20} {:>20}  {:>10} {:>6}\n",
        plan.rung.name(),
        plan.rounds,
        if plan.rounds == 1 { "round" } else { "rounds" },
        if has_limit {
            ", share of the limit"
        } else {
            ""
        },
        "scene",
        "spheres",
        "tree",
        "primary",
        "shadow",
        "ambient",
        "incoherent",
        "build, M/s",
        "bytes"
    )
}

fn row(measured: &WorldSpeeds) -> String {
    let rays = |speed: &Speed| {
        if speed.rays == 0 {
            "-".to_owned()
        } else {
            let share = speed.share_of_limit.map(|share| format!(" {share:.2}"));
            format!(
                "{:.1} ±{:>2.0}%{}",
                speed.mrays_per_s,
                100.0 * speed.spread,
                share.unwrap_or_default()
            )
        }
    };
    let of = &measured.rays;
    let build = if measured.has_tree {
        format!("{:.2}", measured.build.spheres_per_s * 1e-6)
    } else {
        "-".into()
    };
    format!(
        "{:<12} {:>9} {:>5}  {:>20} {:>20} {:>20} {:>20}  {build:>10} {:>6.1}\n",
        measured.scene,
        measured.spheres,
        if measured.has_tree { "yes" } else { "no" },
        rays(&of.primary),
        rays(&of.shadow),
        rays(&of.ambient),
        rays(&of.incoherent),
        measured.bytes_per_sphere,
    )
}
