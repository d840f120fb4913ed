//! Hard rays with exact answers as files, for other programs: `docs/hard-rays.md`.
//!
//! | file | holds |
//! | --- | --- |
//! | `hard-rays.json` | the sets, their rays and the answers |
//! | `hard-rays.schema.json` | its JSON schema |
//! | `hard-rays.txt` | the same rays, one a line, for programs without a JSON parser |
//! | `answers-RUNG.txt` | what each rung answers on a device, one line a ray |

use std::fmt::Write;
use std::path::Path;

use serde::Serialize;
use spherule_kernel::{Hit, Ray, Rung, Sphere};

use super::cases::catalogue;
use super::families::Family;
use super::measure::intersect_all;
use super::oracle::Intersection;
use crate::device::Device;
use crate::device::canary::Canary;
use crate::error::{Error, Result};
use crate::memory;
use crate::write::Output;

/// The version of the files' format.
const VERSION: u32 = 1;
/// The first numbers of the families' random numbers; those of `accuracy` are others.
const SEED: u64 = 0x0005_e70f_4a9d;

/// Memory that a ray takes, its texts included, in bytes.
const BYTES_A_RAY: u64 = 2500;

const SCHEMA: &str = include_str!("hard-rays.schema.json");

#[derive(Serialize)]
struct Suite {
    format: &'static str,
    version: u32,
    generator: String,
    licence: &'static str,
    sets: Vec<Set>,
}

/// Rays of one kind.
#[derive(Serialize)]
struct Set {
    name: &'static str,
    /// `case` or `family`.
    kind: &'static str,
    /// The number of a case in the catalogue.
    #[serde(skip_serializing_if = "Option::is_none")]
    number: Option<u8>,
    shape: &'static str,
    rays: Vec<HardRay>,
}

/// A ray, its sphere, and the exact answer. Floats are in the hexadecimal form of C99.
#[derive(Serialize)]
struct HardRay {
    origin: [String; 3],
    direction: [String; 3],
    t_min: String,
    t_max: String,
    center: [String; 3],
    radius: String,
    #[serde(flatten)]
    answer: Answer,
    /// |Δ| / (a r²), how far the line is from touching the sphere; `None` for radius zero.
    margin: Option<f64>,
}

#[derive(Serialize)]
#[serde(tag = "answer", rename_all = "lowercase")]
enum Answer {
    Miss,
    Hit {
        /// The 32-bit float that is nearest to the exact parameter.
        t: String,
        /// The 64-bit floats next to the exact parameter, below and above, or twice itself.
        bracket: [String; 2],
    },
}

/// The outputs in `folder`, which exists, before anything is written.
///
/// # Errors
///
/// [`Error::Output`] for one that cannot be written.
fn outputs(folder: &Path, rungs: &[Rung]) -> Result<(Vec<Output>, Vec<Output>)> {
    let of = |name: &str| Output::new(&folder.join(name));
    let files = ["hard-rays.json", "hard-rays.schema.json", "hard-rays.txt"];
    let answers = rungs.iter().map(|rung| of(&answers_of(*rung)));
    Ok((
        files.into_iter().map(of).collect::<Result<_>>()?,
        answers.collect::<Result<_>>()?,
    ))
}

/// The file with a rung's answers.
fn answers_of(rung: Rung) -> String {
    format!("answers-{}.txt", rung.name())
}

/// Removes the answers that an earlier export left of this rung.
///
/// # Errors
///
/// [`Error::Output`] if there are some and they cannot be removed.
fn remove_answers(folder: &Path, rung: Rung) -> Result<()> {
    let path = folder.join(answers_of(rung));
    match std::fs::remove_file(&path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(Error::Output {
            path,
            reason: format!(
                "holds the answers of an earlier export, and cannot be removed: {error}"
            ),
            help: "name another folder".into(),
        }),
        _ => Ok(()),
    }
}

/// Writes the files into `folder`, which exists: the hard cases, and `rays` rays of each family,
/// with what the rungs answer on `device`. Returns how many rays there are. What an earlier export
/// left there of rungs that the device cannot keep is removed.
///
/// # Errors
///
/// [`Error::Output`] for a file that cannot be written,
/// [`Error::OutOfHostMemory`] for too many rays, and the device's
/// errors.
pub fn export(folder: &Path, device: &Device, rays: usize) -> Result<usize> {
    memory::require(
        (rays as u64).saturating_mul(Family::ALL.len() as u64 * BYTES_A_RAY),
        &format!("writing {rays} rays of each family"),
    )?;
    let canary = Canary::on(device)?;
    let (rungs, refused): (Vec<_>, Vec<_>) = Rung::ALL
        .into_iter()
        .partition(|rung| canary.objection(*rung).is_none());
    let (files, answers) = outputs(folder, &rungs)?;
    for rung in refused {
        remove_answers(folder, rung)?;
    }

    let mut samples = Vec::new();
    let mut sets = Vec::new();
    let cases = catalogue();
    let of_cases = cases
        .iter()
        .map(|case| (case.name, Some(case.number), case.decided().collect()));
    let of_families = Family::ALL
        .iter()
        .map(|family| (family.name(), None, family.sample(SEED, rays)));
    for (name, number, rays) in of_cases.chain(of_families) {
        let all: Vec<(Ray, Sphere)> = rays;
        let kept = all.into_iter().filter_map(|sample| {
            let ray = hard_ray(&sample.0, &sample.1)?;
            samples.push(sample);
            Some(ray)
        });
        let rays: Vec<HardRay> = kept.collect();
        if !rays.is_empty() {
            sets.push(Set {
                name,
                kind: if number.is_some() { "case" } else { "family" },
                number,
                shape: "sphere",
                rays,
            });
        }
    }
    let suite = Suite {
        format: "hard-rays",
        version: VERSION,
        generator: format!("spherule {}", env!("CARGO_PKG_VERSION")),
        licence: "CC0-1.0",
        sets,
    };
    let mut json = serde_json::to_string_pretty(&suite).unwrap_or_default();
    json.push('\n');
    for (file, text) in files.iter().zip([&json, SCHEMA, &lines(&suite)]) {
        file.write(text.as_bytes())?;
    }
    for (file, rung) in answers.iter().zip(rungs) {
        let mut text = String::new();
        for t in intersect_all(device, rung, &samples)? {
            // Writing to a String cannot fail.
            let _ = match t {
                Hit::NONE_T => writeln!(text, "miss"),
                t => writeln!(text, "{}", hex(t.into())),
            };
        }
        file.write(text.as_bytes())?;
    }
    Ok(samples.len())
}

/// `None` for a ray that has no direction, or numbers that are not finite.
fn hard_ray(ray: &Ray, sphere: &Sphere) -> Option<HardRay> {
    let exact = Intersection::of(ray, sphere)?;
    let answer = match exact.nearest_root(ray) {
        None => Answer::Miss,
        Some((root, t)) => Answer::Hit {
            t: hex(t.into()),
            bracket: exact.bracket(root)?.map(hex),
        },
    };
    let three = |v: glam::Vec3| v.to_array().map(|x| hex(x.into()));
    Some(HardRay {
        origin: three(ray.origin),
        direction: three(ray.direction),
        t_min: hex(ray.t_min.into()),
        t_max: hex(ray.t_max.into()),
        center: three(sphere.center()),
        radius: hex(sphere.radius().into()),
        answer,
        margin: Some(exact.margin()).filter(|margin| margin.is_finite()),
    })
}

/// A line for each ray: the number of its set, from 0; origin, direction, `t_min`, `t_max`, centre,
/// radius; `miss`, or `hit` with t and its bracket.
fn lines(suite: &Suite) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "# hard-rays {VERSION}, {}", suite.generator);
    for (index, set) in suite.sets.iter().enumerate() {
        let _ = writeln!(text, "# set {index}: {}", set.name);
    }
    // The families are the last sets.
    if let Some(first) = suite.sets.iter().position(|set| set.kind == "family") {
        let _ = writeln!(text, "# families: sets {first} to {}", suite.sets.len() - 1);
    }
    for (index, set) in suite.sets.iter().enumerate() {
        for ray in &set.rays {
            let (o, d, c) = (&ray.origin, &ray.direction, &ray.center);
            let interval = [&ray.t_min, &ray.t_max].map(String::as_str);
            let numbers = [o.join(" "), d.join(" "), interval.join(" "), c.join(" ")];
            let _ = write!(text, "{index} {} {} ", numbers.join(" "), ray.radius);
            let _ = match &ray.answer {
                Answer::Miss => writeln!(text, "miss"),
                Answer::Hit { t, bracket } => writeln!(text, "hit {t} {}", bracket.join(" ")),
            };
        }
    }
    text
}

/// The number in the hexadecimal form of C99, exactly: `0x1.8p+1` is 3.
fn hex(x: f64) -> String {
    let bits = x.to_bits();
    let sign = if x.is_sign_negative() { "-" } else { "" };
    if x == 0.0 {
        return format!("{sign}0x0p+0");
    }
    // No number here is below 2⁻¹⁰²², where a significand has no leading 1.
    let exponent = (bits >> 52 & 0x7ff) as i32 - 1023;
    let digits = format!("{:013x}", bits & 0x000f_ffff_ffff_ffff);
    let digits = digits.trim_end_matches('0');
    let point = if digits.is_empty() { "" } else { "." };
    format!("{sign}0x1{point}{digits}p{exponent:+}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_in_c() {
        let known = [
            (3.0, "0x1.8p+1"),
            (-0.1, "-0x1.999999999999ap-4"),
            (1.0, "0x1p+0"),
            (-0.0, "-0x0p+0"),
            (f64::from(f32::MAX), "0x1.fffffep+127"),
            (f64::from(f32::from_bits(1)), "0x1p-149"),
        ];
        for (number, text) in known {
            assert_eq!(hex(number), text);
        }
    }
}
