//! The arguments, and the help texts.

use std::ffi::OsString;
use std::path::PathBuf;
use std::str::FromStr;

use clap::builder::{OsStringValueParser, PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use spherule_kernel::{Effects, Rung, Shading};

use crate::accel::Acceleration;
use crate::accuracy::families::Family;
use crate::choose::DEFAULT_TOLERANCE;
use crate::device::DeviceChoice;
use crate::error::nearest;
use crate::read;
use crate::render::EffectChoice;
use crate::scene::limits::{MAX_BOUNCES, MAX_IMAGE_SIDE, MAX_SAMPLES};
use crate::shown::shown;
use crate::write::Format;

/// A ray tracer for spheres, whose kernel is Rust on the GPU and on the CPU.
#[derive(Debug, Parser)]
#[command(version, propagate_version = true, arg_required_else_help = true)]
#[command(after_help = "Example: spherule render scenes/two-spheres.toml -o out.png")]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Render a scene or a molecule into an image
    Render(RenderArguments),
    /// List the devices that can render
    Devices(DevicesArguments),
    /// Try this device's arithmetic, and the hard cases on every rung of precision
    Check(CheckArguments),
    /// Measure what each rung of precision gets right, and what it costs in time
    Accuracy(AccuracyArguments),
    /// Say which effects a scene calls for, by what, and what each costs here
    Explain(ExplainArguments),
    /// Measure how fast rays of every kind are here, by worlds from two spheres to ten million
    Bench(BenchArguments),
}

#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
#[command(after_help = "Ctrl-C writes the picture as far as it is.\n\
    Exit codes: 0 done, 1 the render or the check failed, 2 the input is wrong, 128 and a signal's number if that ended it.\n\
    SPHERULE_LOG=debug logs what happens; RAYON_NUM_THREADS=N sets the number of the CPU's threads, \
    SPHERULE_CPU=plain|avx2|avx512 their vector instructions; SPHERULE_OIDN=FILE is Open Image Denoise's library.")]
pub(super) struct RenderArguments {
    #[arg(help = format!("The {}", read::inputs()))]
    pub(super) input: PathBuf,

    /// The image to write: 8-bit PNG, or linear 32-bit float EXR [default: the input's name with
    /// .png, in the current directory]
    #[arg(short, long, value_name = "OUT.png|OUT.exr", value_parser = OsStringValueParser::new().try_map(image_path))]
    pub(super) output: Option<PathBuf>,

    /// The image's size in pixels [default: the scene's, or 1280x720]
    #[arg(long, value_name = "WxH")]
    pub(super) size: Option<Size>,

    /// What renders: auto (the CPU for small images and where there is no real GPU, else that), gpu
    /// (a software one too), cpu, or a part of an adapter's name
    #[arg(long, value_name = "auto|gpu|cpu|NAME", default_value = "auto")]
    pub(super) device: DeviceChoice,

    /// What the image shows of a hit
    #[arg(long, value_parser = shading(), default_value = "lit")]
    pub(super) shade: Shading,

    /// How a ray is intersected with a sphere; the slower ways are right more often
    #[arg(long, value_parser = precision(), default_value = "auto")]
    pub(super) precision: Precision,

    /// What auto precision may be off by, in pixels
    #[arg(long, value_name = "PX", default_value_t = DEFAULT_TOLERANCE, value_parser = tolerance)]
    pub(super) tolerance: f64,

    /// Samples a pixel, for scenes with effects [default: the scene's]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SAMPLES)))]
    pub(super) samples: Option<u32>,

    /// How often light bounces between surfaces before it reaches the one that is seen, at most
    /// [default: the scene's, or 32]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=i64::from(MAX_BOUNCES)))]
    pub(super) max_bounces: Option<u32>,

    /// Another seed is another image of the same expectation [default: the scene's, or 0]
    #[arg(long, value_name = "N")]
    pub(super) seed: Option<u32>,

    /// Which effects the pipeline holds: auto (those that the scene calls for), all (the others
    /// stay idle), none, or a list of names as `spherule explain` prints them (the scene's other
    /// effects are left out)
    #[arg(long, value_name = "auto|all|none|LIST", default_value = "auto", value_parser = effects)]
    pub(super) effects: EffectChoice,

    /// Trace no longer than this many seconds, also in the middle of a sample: pixels that have
    /// none by then show a coarse preview, or nothing in an image of one ray a pixel
    #[arg(long, value_name = "SECONDS", value_parser = positive)]
    pub(super) time_limit: Option<f64>,

    /// Take samples of each tile of 16 × 16 pixels, 16 at least, until its noise is this low: the
    /// pixels' standard error over the tile's mean luminance, 0.01 for 1 %; what is darker than a
    /// sixteenth of the image is measured against that
    #[arg(long, value_name = "TARGET", value_parser = positive)]
    pub(super) noise: Option<f64>,

    /// Remove the noise by Open Image Denoise 2, if its library is here: the image is smooth after
    /// few samples, but biased, and says so
    #[arg(long)]
    pub(super) denoise: bool,

    /// Render on the GPU and on the CPU and compare: fail if more than 0.1 % of the pixels differ
    /// by more than 2/255. Of images of light paths, more may differ, up to 5 %, but no region by
    /// more than chance
    #[arg(long, conflicts_with_all = ["time_limit", "noise", "denoise"])]
    pub(super) check: bool,

    /// Write timings and counts as JSON; - writes to stdout
    #[arg(long, value_name = "FILE.json")]
    pub(super) stats: Option<PathBuf>,

    /// Print nothing but errors
    #[arg(short, long)]
    pub(super) quiet: bool,
}

#[derive(Debug, Args)]
pub(super) struct DevicesArguments {
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "Exit codes: 0 every promise holds, 1 one is broken or the device failed.")]
pub(super) struct CheckArguments {
    /// What to check: auto (a real GPU, else the CPU), gpu, cpu, or a part of an adapter's name
    #[arg(long, value_name = "auto|gpu|cpu|NAME", default_value = "auto")]
    pub(super) device: DeviceChoice,

    /// Only measure what the device's driver does to arithmetic, and print a row for the table of
    /// known devices in docs/numerics.md
    #[arg(long, conflicts_with = "export")]
    pub(super) arithmetic: bool,

    /// Check nothing: write hard rays with their exact answers as files into this folder, for other
    /// programs, and what each rung answers (docs/hard-rays.md)
    #[arg(long, value_name = "FOLDER", conflicts_with = "json")]
    pub(super) export: Option<PathBuf>,

    /// With --export: rays of each family
    #[arg(long, value_name = "N", default_value_t = 1000, requires = "export", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(super) rays: u32,

    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct AccuracyArguments {
    /// What to measure: auto (a real GPU, else the CPU), gpu, cpu, or a part of an adapter's name
    #[arg(long, value_name = "auto|gpu|cpu|NAME", default_value = "auto")]
    pub(super) device: DeviceChoice,

    /// Rays in each family
    #[arg(long, value_name = "N", default_value_t = 200_000, value_parser = clap::value_parser!(u32).range(1000..=100_000_000))]
    pub(super) rays: u32,

    /// Measure this family only (generic, far, ground, tangent, surface or inside), or the rays and
    /// the frames of a scene file
    #[arg(long, value_name = "FAMILY|FILE", value_parser = OsStringValueParser::new().try_map(subject))]
    pub(super) scene: Option<Subject>,

    /// Measure the error of this scene's image as its samples grow, and what they cost
    #[arg(long, value_name = "SCENE.toml", conflicts_with = "scene")]
    pub(super) samples: Option<PathBuf>,

    /// The size of a scene file's frames in pixels [default: the scene's; with --samples
    /// see --time-limit]
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    pub(super) size: Option<Size>,

    /// With --samples: take no longer than about this many seconds, by a smaller image and fewer
    /// samples; where they are too few to judge by, nothing is measured, and the exit code is 1
    #[arg(long, value_name = "SECONDS", value_parser = positive, default_value = "60", conflicts_with_all = ["size", "scene"], requires = "samples")]
    pub(super) time_limit: f64,

    /// With --samples: also measure the images of the first rung denoised, as by `render --denoise`
    #[arg(long, requires = "samples")]
    pub(super) denoise: bool,

    /// Write a report to look at: one HTML page with its plots in it
    #[arg(short, long, value_name = "REPORT.html")]
    pub(super) output: Option<PathBuf>,

    /// Write the numbers as JSON; - writes to stdout
    #[arg(long, value_name = "FILE.json")]
    pub(super) json: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct ExplainArguments {
    #[arg(help = format!("The {}", read::inputs()))]
    pub(super) input: PathBuf,

    /// What to measure: auto (a real GPU, else the CPU), gpu, cpu, or a part of an adapter's name
    #[arg(long, value_name = "auto|gpu|cpu|NAME", default_value = "auto")]
    pub(super) device: DeviceChoice,

    /// How a ray is intersected with a sphere
    #[arg(long, value_parser = precision(), default_value = "auto")]
    pub(super) precision: Precision,

    /// The image's size in pixels [default: the scene's, or smaller: see --time-limit]
    #[arg(long, value_name = "WxH")]
    pub(super) size: Option<Size>,

    /// Samples a pixel [default: the scene's]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SAMPLES)))]
    pub(super) samples: Option<u32>,

    /// Take no longer than about this many seconds, by a smaller image, fewer samples and fewer
    /// runs
    #[arg(long, value_name = "SECONDS", value_parser = positive, default_value = "20", conflicts_with_all = ["size", "no_costs"])]
    pub(super) time_limit: f64,

    /// Only say what is called for; render nothing
    #[arg(long)]
    pub(super) no_costs: bool,

    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
#[command(
    after_help = "Scenes: S2, S46, S500, R10k, R100k, R1M, R10M, L1M, L1M-rotated and X1M; docs/performance.md says what they are.\n\
    R10M takes about 3 GB of memory."
)]
pub(super) struct BenchArguments {
    /// What to measure: auto (a real GPU, else the CPU), gpu, cpu, or a part of an adapter's name
    #[arg(long, value_name = "auto|gpu|cpu|NAME", default_value = "auto")]
    pub(super) device: DeviceChoice,

    #[arg(long, value_name = "NAME|FILE", help = format!(
        "Measure this scene only: a name, or a {}; may be given again [default: all but R10M]",
        read::inputs()
    ))]
    pub(super) scene: Vec<OsString>,

    /// The image's size in pixels
    #[arg(long, value_name = "WxH", default_value = "1920x1080")]
    pub(super) size: Size,

    /// How a ray is intersected with a sphere
    #[arg(long, value_parser = rung(), default_value = "robust")]
    pub(super) precision: Rung,

    /// Whether spheres stand in a tree: auto where it pays, tree always, brute-force never
    #[arg(long, value_enum, default_value = "auto")]
    pub(super) acceleration: AccelerationChoice,

    /// Do not measure what the device does at most, and say no shares of it
    #[arg(long)]
    pub(super) no_limit: bool,

    /// How often each kind of ray is timed; the median counts
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(super) rounds: u32,

    /// Write the numbers as JSON; - writes to stdout
    #[arg(long, value_name = "FILE.json")]
    pub(super) json: Option<PathBuf>,

    /// Measure nothing: trace rays of every kind with the tree and against every sphere, on every
    /// rung, and compare
    #[arg(long, conflicts_with_all = ["json", "export", "precision", "acceleration"])]
    pub(super) verify: bool,

    /// Measure nothing: write the scene's spheres, rays and hits as files into this folder, for
    /// other programs; of several scenes each has a folder in it, called as the scene or its file
    #[arg(
        long,
        value_name = "FOLDER",
        requires = "scene",
        conflicts_with = "json"
    )]
    pub(super) export: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum AccelerationChoice {
    /// A tree where there are enough spheres for one to pay
    Auto,
    /// A tree always
    Tree,
    /// Each ray against every sphere
    BruteForce,
}

impl From<AccelerationChoice> for Acceleration {
    fn from(choice: AccelerationChoice) -> Self {
        match choice {
            AccelerationChoice::Auto => Self::Auto,
            AccelerationChoice::Tree => Self::Tree,
            AccelerationChoice::BruteForce => Self::BruteForce,
        }
    }
}

/// What `accuracy` measures.
#[derive(Clone, Debug)]
pub(super) enum Subject {
    Family(Family),
    Scene(PathBuf),
}

fn subject(text: OsString) -> Result<Subject, String> {
    let Some(text) = text.to_str() else {
        return Ok(Subject::Scene(text.into()));
    };
    let family = Family::ALL.into_iter().find(|family| family.name() == text);
    match family {
        Some(family) => Ok(Subject::Family(family)),
        None if text.contains('.') => Ok(Subject::Scene(text.into())),
        None => {
            let names: Vec<&str> = Family::ALL.iter().map(|family| family.name()).collect();
            Err(format!(
                "there is no family `{}`{} Give one of {}, or a {}",
                shown(text),
                did_you_mean(text, &names),
                names.join(", "),
                read::inputs()
            ))
        }
    }
}

/// A mode of shading by its name.
fn shading() -> impl TypedValueParser<Value = Shading> {
    let names = Shading::ALL.map(|it| PossibleValue::new(it.name()).help(it.summary()));
    PossibleValuesParser::new(names)
        .map(|name| named(&Shading::ALL, Shading::name, &name).unwrap_or_default())
}

/// A rung by its name, or `auto` for the one that the scene calls for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Precision(pub(super) Option<Rung>);

fn precision() -> impl TypedValueParser<Value = Precision> {
    let auto = PossibleValue::new("auto")
        .help("The cheapest whose bound keeps this scene within the tolerance");
    let names = std::iter::once(auto).chain(rungs());
    PossibleValuesParser::new(names).map(|name| Precision(named(&Rung::ALL, Rung::name, &name)))
}

/// A rung by its name.
fn rung() -> impl TypedValueParser<Value = Rung> {
    PossibleValuesParser::new(rungs())
        .map(|name| named(&Rung::ALL, Rung::name, &name).unwrap_or_default())
}

fn rungs() -> impl Iterator<Item = PossibleValue> {
    Rung::ALL
        .into_iter()
        .map(|it| PossibleValue::new(it.name()).help(it.summary()))
}

/// The one of a list that has this name.
fn named<T: Copy>(all: &[T], name_of: fn(T) -> &'static str, name: &str) -> Option<T> {
    all.iter().copied().find(|it| name_of(*it) == name)
}

/// The end of "there is no …", where one of the names is like it.
fn did_you_mean(text: &str, names: &[&str]) -> String {
    nearest(text, names.iter().copied())
        .map_or_else(|| ".".into(), |name| format!("; did you mean `{name}`?"))
}

fn effects(text: &str) -> Result<EffectChoice, String> {
    match text {
        "auto" => return Ok(EffectChoice::Auto),
        "all" => return Ok(EffectChoice::All),
        "none" => return Ok(EffectChoice::Only(Effects::NONE)),
        _ => {}
    }
    let mut set = Effects::NONE;
    for name in text.split(',') {
        let found = Effects::NAMED
            .iter()
            .find(|(_, known)| *known == name.trim());
        match found {
            Some((effect, _)) => set = set.and(*effect),
            None => {
                let known: Vec<&str> = Effects::NAMED.iter().map(|(_, name)| *name).collect();
                let likely = did_you_mean(name.trim(), &known);
                return Err(format!(
                    "there is no effect `{}`{likely} Give auto, all, none, or some of {}, separated by commas",
                    shown(name.trim()),
                    known.join(", ")
                ));
            }
        }
    }
    Ok(EffectChoice::Only(set))
}

fn positive(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|number: &f64| *number > 0.0 && *number <= 1e9)
        .ok_or_else(|| "give a number above zero and up to 1e9".into())
}

fn tolerance(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|pixels: &f64| *pixels > 0.0 && *pixels <= 1e9)
        .ok_or_else(|| "give a number of pixels above zero and up to 1e9, for example 0.1".into())
}

/// An image's size, written `1280x720`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Size {
    pub(super) width: u32,
    pub(super) height: u32,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |text: &str| {
            text.parse()
                .ok()
                .filter(|side| (1..=MAX_IMAGE_SIDE).contains(side))
        };
        text.split_once(['x', 'X', '×'])
            .and_then(|(width, height)| {
                Some(Self {
                    width: side(width)?,
                    height: side(height)?,
                })
            })
            .ok_or_else(|| {
                format!(
                    "give width and height, each from 1 to {MAX_IMAGE_SIDE}, for example 1280x720"
                )
            })
    }
}

fn image_path(name: OsString) -> Result<PathBuf, String> {
    let path = PathBuf::from(name);
    match Format::of(&path) {
        Ok(_) => Ok(path),
        Err(error) => Err(error.help()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn sizes_are_read_or_refused() {
        assert_eq!(
            "17x13".parse(),
            Ok(Size {
                width: 17,
                height: 13
            })
        );
        for bad in ["", "17", "17x", "0x1", "1x70000", "-1x1", "1.5x1", "axb"] {
            assert!(bad.parse::<Size>().is_err(), "{bad}");
        }
    }
}
