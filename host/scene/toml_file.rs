//! Scenes in TOML, read with spans so that a mistake points at its line and column.

mod split;
mod value;

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use glam::Vec3;
use rayon::prelude::*;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use spherule_kernel::fog::Fog;
use spherule_kernel::{Material, Sphere};
use toml::Spanned;

use super::formats::{self, Contents, Format};
use super::limits;
use super::surroundings::{FogBall, Lens, PointLight, Sun, Surroundings, Tonemap};
use super::{Scene, View, World, environment, molecule, text::read_text};
use crate::error::{Error, Place, Result, SceneError};
use crate::plural::count_of;
use crate::shown::{shown, shown_up_to};
use split::{Batch, Piece, Split};
use value::{DATE, Value, said};

/// The angle across the sun as it is seen from the Earth, in degrees.
const DEFAULT_SUN_SIZE: f32 = 0.53;

/// The file as written, but for its `[[sphere]]` tables; every value keeps its span.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    image: ImageTable,
    camera: Option<Spanned<CameraTable>>,
    #[serde(default)]
    materials: BTreeMap<String, Spanned<MaterialTable>>,
    /// Spheres in one list, `sphere = [{ center = … }, …]`.
    #[serde(default, rename = "sphere")]
    spheres: Vec<Spanned<SphereTable>>,
    particles: Option<ParticlesTable>,
    #[serde(default, rename = "light")]
    lights: Vec<LightTable>,
    sky: Option<Spanned<SkyTable>>,
    fog: Option<Spanned<FogTable>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct ImageTable {
    width: Option<Spanned<Value>>,
    height: Option<Spanned<Value>>,
    background: Option<Spanned<Value>>,
    transparent: Option<Spanned<Value>>,
    samples: Option<Spanned<Value>>,
    max_bounces: Option<Spanned<Value>>,
    ambient_occlusion: Option<Spanned<Value>>,
    seed: Option<Spanned<Value>>,
    exposure: Option<Spanned<Value>>,
    tonemap: Option<Spanned<Value>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct CameraTable {
    eye: Spanned<Value>,
    target: Spanned<Value>,
    up: Option<Spanned<Value>>,
    vertical_fov: Option<Spanned<Value>>,
    aperture: Option<Spanned<Value>>,
    focus_distance: Option<Spanned<Value>>,
    shutter: Option<Spanned<Value>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct MaterialTable {
    kind: Spanned<Value>,
    color: Option<Spanned<Value>>,
    roughness: Option<Spanned<Value>>,
    index: Option<Spanned<Value>>,
    absorption: Option<Spanned<Value>>,
    thickness: Option<Spanned<Value>>,
    strength: Option<Spanned<Value>>,
}

#[derive(Clone, Copy, PartialEq)]
enum MaterialKind {
    Diffuse,
    Metal,
    Glass,
    Emissive,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct SphereTable {
    center: Spanned<Value>,
    radius: Spanned<Value>,
    material: Option<Spanned<Value>>,
    velocity: Option<Spanned<Value>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct LightTable {
    position: Spanned<Value>,
    intensity: Spanned<Value>,
    radius: Option<Spanned<Value>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct SkyTable {
    horizon: Option<Spanned<Value>>,
    zenith: Option<Spanned<Value>>,
    sun_direction: Option<Spanned<Value>>,
    sun_size: Option<Spanned<Value>>,
    sun_irradiance: Option<Spanned<Value>>,
    image: Option<Spanned<Value>>,
    strength: Option<Spanned<Value>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct FogTable {
    extinction: Spanned<Value>,
    albedo: Option<Spanned<Value>>,
    anisotropy: Option<Spanned<Value>>,
    center: Option<Spanned<Value>>,
    radius: Option<Spanned<Value>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct ParticlesTable {
    file: Spanned<Value>,
}

/// Reads the scene at `path`; files that it names count from its directory.
pub(super) fn load(path: &Path) -> Result<Scene> {
    parse(path, read_text(path)?)
}

/// Makes a scene of `text`, the content of the file at `path`.
///
/// # Errors
///
/// [`Error::Scene`] with the place of the mistake.
pub fn parse(path: &Path, text: String) -> Result<Scene> {
    let split = Split::of(&text);
    let reader = Reader {
        path,
        text: &text,
        pieces: &split.others,
    };
    if split.others_length() > MAX_TEXT {
        let last = Piece::whole(text.len()..text.len());
        return Err(Reader {
            path,
            text: &text,
            pieces: &[last],
        }
        .wrong_at(
            0..0,
            format!("the file is longer than {MAX_TEXT} bytes beside its [[sphere]] tables"),
            "ends here",
            "write spheres as [[sphere]] tables, or put them into a file of [particles]",
        )
        .into());
    }
    let others: String = split
        .others
        .iter()
        .map(|piece| &text[piece.range.clone()])
        .collect();
    let file: File = reader.read(&others)?;
    drop(others);
    if let Some(sphere) = split.spheres.first()
        && !file.spheres.is_empty()
    {
        let place = Piece::whole(sphere.range.clone());
        return Err(Reader {
            path,
            text: &text,
            pieces: &[place],
        }
        .wrong_at(
            0.."[[sphere]]".len(),
            "there is a list of spheres already",
            "a table of another",
            "write all spheres as [[sphere]] tables, or all in one list",
        )
        .into());
    }
    reader.scene(file, &split.spheres)
}

/// The most bytes of a file beside its `[[sphere]]` tables, and of one of those: parsing takes some
/// fifty times as many.
const MAX_TEXT: usize = 1 << 24;
const MAX_TABLE: usize = 1 << 16;
/// Batches of `[[sphere]]` tables that are parsed, each by a thread, before what they say is kept:
/// what a parser takes for a table is forty times as long as the table.
const AT_ONCE: usize = 64;

/// Some `[[sphere]]` tables.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Spheres {
    sphere: Vec<Spanned<SphereTable>>,
}

fn help_for_toml(message: &str) -> String {
    if message.contains("unknown field") {
        "check the spelling; docs/scenes.md lists every key".into()
    } else if message.contains("missing field") {
        "add it; docs/scenes.md lists every key".into()
    } else {
        "the README shows a whole scene; tables are [name], spheres are [[sphere]], texts stand in quotes".into()
    }
}

/// serde's words, and the parser's, in plain ones.
fn plain(message: &str) -> String {
    let mut message = message.to_owned();
    if message.contains(DATE) {
        return "this is a date or time, not a table".into();
    }
    for (theirs, ours) in [
        ("invalid type: ", "this is "),
        (", expected a sequence", ", not a list"),
        (", expected a table", ", not a table"),
        (", expected a map", ", not a table"),
        ("integer `", "the whole number `"),
        ("floating point `", "the number `"),
        ("boolean `", "`"),
        ("this is string ", "this is the text "),
        ("this is map", "this is a table"),
        ("this is sequence", "this is a list"),
        ("recursion limit", "a key has more than 80 parts"),
    ] {
        message = message.replacen(theirs, ours, 1);
    }
    message
}

/// Checks values, knowing the text that they came from.
#[derive(Clone, Copy)]
struct Reader<'a> {
    path: &'a Path,
    text: &'a str,
    /// What was parsed, of the text.
    pieces: &'a [Piece],
}

impl Reader<'_> {
    /// Parses a text made of the pieces.
    fn read<T: DeserializeOwned>(&self, text: &str) -> Result<T> {
        toml::from_str(text).map_err(|error| {
            let message = plain(error.message().trim());
            let help = help_for_toml(&message);
            let message = shown_up_to(&message, 400).into_owned();
            // The parser does not say where everything is.
            let Some(span) = error.span() else {
                return SceneError::without_place(self.path, message, help).into();
            };
            self.wrong_at(span, message, "here", help).into()
        })
    }

    fn scene(&self, file: File, spheres: &[Batch]) -> Result<Scene> {
        let lens = match &file.camera {
            Some(camera) => self.lens(camera.get_ref())?,
            None => Lens::default(),
        };
        let mut scene = Scene::new(self.world(&file, spheres, lens.shutter)?);
        scene.lens = lens;
        if let Some(width) = &file.image.width {
            scene.width = self.side("width", width)?;
        }
        if let Some(height) = &file.image.height {
            scene.height = self.side("height", height)?;
        }
        if let Some(background) = &file.image.background {
            scene.background = self.color("background", background, limits::RADIANCE)?;
        }
        if let Some(camera) = &file.camera {
            scene.view = Some(self.view(camera)?);
        }
        self.image(&file.image, &mut scene)?;
        for light in &file.lights {
            self.light(light, &mut scene)?;
        }
        if let Some(sky) = &file.sky {
            scene.sky = Some(self.sky(sky)?);
        }
        if let Some(fog) = &file.fog {
            scene.fog = Some(self.fog(fog.get_ref())?);
        }
        let particles = file.particles.as_ref().map(|table| &table.file);
        let sky = file
            .sky
            .as_ref()
            .and_then(|sky| sky.get_ref().image.as_ref());
        for (key, name) in [("file", particles), ("image", sky)] {
            if let Some(name) = name {
                scene.sources.push(self.beside(self.text(key, name)?));
            }
        }
        Ok(scene)
    }

    /// The file that the scene names: its name counts from the scene's directory.
    fn beside(&self, name: &str) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(name)
    }

    fn image(&self, table: &ImageTable, scene: &mut Scene) -> Result<()> {
        if let Some(transparent) = &table.transparent {
            scene.transparent = match transparent.get_ref() {
                Value::Truth(truth) => *truth,
                _ => return Err(self.not_a("transparent", transparent, "true or false")),
            };
        }
        if let Some(samples) = &table.samples {
            scene.sampling.samples =
                Some(self.whole("samples", samples, 1, limits::MAX_SAMPLES)?);
        }
        if let Some(bounces) = &table.max_bounces {
            scene.sampling.max_bounces =
                self.whole("max_bounces", bounces, 0, limits::MAX_BOUNCES)?;
        }
        if let Some(seed) = &table.seed {
            scene.sampling.seed = self.whole("seed", seed, 0, u32::MAX)?;
        }
        if let Some(distance) = &table.ambient_occlusion {
            scene.sampling.ambient_occlusion =
                Some(self.number("ambient_occlusion", distance, limits::AMBIENT_OCCLUSION)?);
        }
        if let Some(exposure) = &table.exposure {
            scene.develop.exposure = self.number("exposure", exposure, limits::EXPOSURE)?;
        }
        if let Some(tonemap) = &table.tonemap {
            let names = [
                ("clamp", Tonemap::Clamp),
                ("reinhard", Tonemap::Reinhard),
                ("aces", Tonemap::Aces),
            ];
            scene.develop.tonemap = self.one_of("tonemap", tonemap, &names)?;
        }
        Ok(())
    }

    fn lens(&self, camera: &CameraTable) -> Result<Lens> {
        let mut lens = Lens::default();
        if let Some(aperture) = &camera.aperture {
            lens.aperture = self.number("aperture", aperture, limits::APERTURE)?;
        }
        if let Some(distance) = &camera.focus_distance {
            let distance = self.number("focus_distance", distance, limits::FOCUS_DISTANCE)?;
            lens.focus_distance = Some(distance);
        }
        if let Some(shutter) = &camera.shutter {
            let times: Vec<f32> = match shutter.get_ref() {
                Value::List(times, None) => times.iter().map(|time| *time as f32).collect(),
                _ => Vec::new(),
            };
            match times[..] {
                [open, close]
                    if limits::TIME.holds(open) && limits::TIME.holds(close) && open <= close =>
                {
                    lens.shutter = (open, close);
                }
                _ => {
                    return Err(self
                        .wrong(
                            shutter,
                            "the shutter is not a pair of times",
                            "not possible",
                            "give when it opens and when it closes, the earlier first: [0, 0.5]",
                        )
                        .into());
                }
            }
        }
        Ok(lens)
    }

    fn light(&self, table: &LightTable, scene: &mut Scene) -> Result<()> {
        let position = self.vector("position", &table.position)?;
        let intensity = self.color("intensity", &table.intensity, limits::INTENSITY)?;
        let radius = match &table.radius {
            Some(radius) => self.number("radius", radius, limits::LIGHT_RADIUS)?,
            None => 0.0,
        };
        if radius > 0.0 {
            // A sphere of radiance L and radius r has the intensity L π r² from afar.
            let radiance = intensity / (std::f32::consts::PI * radius * radius);
            if !limits::RADIANCE.holds_all(radiance) {
                return Err(self
                    .wrong(
                        &table.intensity,
                        "the light is too bright for its radius",
                        "intensity over π radius² is its radiance",
                        format!(
                            "radiance is at most {:e}: make the radius larger, or leave it out for a point of light",
                            limits::MAX_RADIANCE
                        ),
                    )
                    .into());
            }
            let world = &mut scene.world;
            let id = world.add_named_material("[[light]]", Material::emissive(radiance));
            let sphere = Sphere::new(position, radius);
            self.is_within(&table.position, &sphere, Vec3::ZERO, (0.0, 0.0))?;
            world.add(sphere, id);
        } else {
            scene.lights.push(PointLight {
                position,
                intensity,
            });
        }
        Ok(())
    }

    fn sky(&self, table: &Spanned<SkyTable>) -> Result<Surroundings> {
        let sky = table.get_ref();
        let strength = match &sky.strength {
            Some(strength) => self.number("strength", strength, limits::STRENGTH)?,
            None => 1.0,
        };
        let optional = |name, value: &Option<Spanned<Value>>| {
            value
                .as_ref()
                .map(|value| self.radiance(name, value, strength))
                .transpose()
        };
        let horizon = optional("horizon", &sky.horizon)?;
        let zenith = optional("zenith", &sky.zenith)?;
        let sun = match (&sky.sun_direction, &sky.sun_irradiance) {
            (None, None) => None,
            (Some(direction), irradiance) => {
                let towards = self.vector("sun_direction", direction)?;
                let Some(unit) = towards.as_dvec3().try_normalize() else {
                    return Err(self
                        .wrong(
                            direction,
                            "sun_direction is zero",
                            "no direction",
                            "give the direction towards the sun, for example [1, 2, 0.5]",
                        )
                        .into());
                };
                let sun = Sun {
                    direction: unit.as_vec3(),
                    size: match &sky.sun_size {
                        Some(size) => self.number("sun_size", size, limits::SUN_SIZE)?,
                        None => DEFAULT_SUN_SIZE,
                    },
                    irradiance: match irradiance {
                        Some(irradiance) => {
                            self.color("sun_irradiance", irradiance, limits::IRRADIANCE)?
                        }
                        None => Vec3::splat(std::f32::consts::PI),
                    },
                };
                if !limits::RADIANCE.holds_all(sun.radiance().unwrap_or_default()) {
                    return Err(self
                        .wrong(
                            direction,
                            "the sun is too bright for its size",
                            "sun_irradiance over the solid angle of its disc is its radiance",
                            format!(
                                "radiance is at most {:e}: make sun_size larger, or 0 for a sun without a disc",
                                limits::MAX_RADIANCE
                            ),
                        )
                        .into());
                }
                Some(sun)
            }
            (None, Some(irradiance)) => {
                return Err(self
                    .wrong(
                        irradiance,
                        "the sun has no direction",
                        "a sun without sun_direction",
                        "add sun_direction, the direction towards the sun",
                    )
                    .into());
            }
        };
        let image = sky
            .image
            .as_ref()
            .map(|file| -> Result<_> {
                let path = self.beside(self.text("image", file)?);
                environment::load(&path, strength).map_err(|error| match error {
                    Error::Scene(inner) => self
                        .wrong(file, inner.to_string(), "named here", inner.help)
                        .into(),
                    other => other,
                })
            })
            .transpose()?;
        // One of the two is a sky of one colour; none of them is dark.
        let one = horizon.or(zenith).unwrap_or(Vec3::ZERO);
        Ok(Surroundings {
            horizon: horizon.unwrap_or(one),
            zenith: zenith.unwrap_or(one),
            sun,
            image,
        })
    }

    fn fog(&self, fog: &FogTable) -> Result<FogBall> {
        let albedo = match &fog.albedo {
            Some(albedo) => self.color("albedo", albedo, limits::REFLECTANCE)?,
            None => Vec3::ONE,
        };
        if let (Some(center), None) = (&fog.center, &fog.radius) {
            return Err(self
                .wrong(
                    center,
                    "the fog has a center and no radius",
                    "a ball without a radius",
                    "add radius, or leave center out for fog around everything",
                )
                .into());
        }
        let number = |name, value: &Option<Spanned<Value>>, range, default| match value {
            Some(value) => self.number(name, value, range),
            None => Ok(default),
        };
        Ok(FogBall {
            medium: Fog {
                center: match &fog.center {
                    Some(center) => self.vector("center", center)?,
                    None => Vec3::ZERO,
                },
                radius: number("radius", &fog.radius, limits::RADIUS, 0.0)?,
                albedo,
                extinction: self.number("extinction", &fog.extinction, limits::EXTINCTION)?,
                anisotropy: number("anisotropy", &fog.anisotropy, limits::ANISOTROPY, 0.0)?,
                ..Fog::default()
            },
        })
    }

    /// A material, and the thickness of its shell if it is hollow.
    fn material(&self, table: &Spanned<MaterialTable>) -> Result<(Material, Option<f32>)> {
        let material = table.get_ref();
        let kinds = [
            ("diffuse", MaterialKind::Diffuse),
            ("metal", MaterialKind::Metal),
            ("glass", MaterialKind::Glass),
            ("emissive", MaterialKind::Emissive),
        ];
        let kind = self.one_of("kind", &material.kind, &kinds)?;
        let kind_name = self.text("kind", &material.kind)?;
        // Each key with the kind that has it.
        let keys: [(&str, bool, Option<std::ops::Range<usize>>); 6] = [
            (
                "color",
                kind != MaterialKind::Glass,
                material.color.as_ref().map(Spanned::span),
            ),
            (
                "roughness",
                kind == MaterialKind::Metal,
                material.roughness.as_ref().map(Spanned::span),
            ),
            (
                "index",
                kind == MaterialKind::Glass,
                material.index.as_ref().map(Spanned::span),
            ),
            (
                "absorption",
                kind == MaterialKind::Glass,
                material.absorption.as_ref().map(Spanned::span),
            ),
            (
                "thickness",
                kind == MaterialKind::Glass,
                material.thickness.as_ref().map(Spanned::span),
            ),
            (
                "strength",
                kind == MaterialKind::Emissive,
                material.strength.as_ref().map(Spanned::span),
            ),
        ];
        for (name, allowed, span) in keys {
            if let Some(span) = span
                && !allowed
            {
                return Err(self
                    .wrong(
                        &Spanned::new(span, ()),
                        format!("a material of kind {kind_name} has no {name}"),
                        "not for this kind",
                        "diffuse has color; metal has color and roughness; glass has index, absorption and thickness; emissive has color and strength",
                    )
                    .into());
            }
        }
        let color = || match &material.color {
            Some(color) => Ok(color),
            None => Err(Error::from(self.wrong(
                table,
                "the material has no color",
                "color is missing",
                "add color = [red, green, blue]",
            ))),
        };
        Ok(match kind {
            MaterialKind::Diffuse => (
                Material::diffuse(self.color("color", color()?, limits::REFLECTANCE)?),
                None,
            ),
            MaterialKind::Metal => {
                let roughness = match &material.roughness {
                    Some(roughness) => self.number("roughness", roughness, limits::ROUGHNESS)?,
                    None => 0.0,
                };
                (
                    Material::metal(
                        self.color("color", color()?, limits::REFLECTANCE)?,
                        roughness,
                    ),
                    None,
                )
            }
            MaterialKind::Glass => {
                let index = match &material.index {
                    Some(index) => self.number("index", index, limits::INDEX)?,
                    None => 1.5,
                };
                let absorption = match &material.absorption {
                    Some(absorption) => self.color("absorption", absorption, limits::ABSORPTION)?,
                    None => Vec3::ZERO,
                };
                let thickness = material
                    .thickness
                    .as_ref()
                    .map(|t| self.number("thickness", t, limits::THICKNESS))
                    .transpose()?;
                (Material::glass(index, absorption), thickness)
            }
            MaterialKind::Emissive => {
                let strength = match &material.strength {
                    Some(strength) => self.number("strength", strength, limits::STRENGTH)?,
                    None => 1.0,
                };
                (
                    Material::emissive(self.radiance("color", color()?, strength)?),
                    None,
                )
            }
        })
    }

    /// What a value of this name may not be.
    fn not_a(&self, name: &str, value: &Spanned<Value>, wanted: &str) -> Error {
        let (said, value_kind) = (value.get_ref().said(), value.get_ref());
        let help = match value_kind {
            Value::Text(text)
                if text.trim().parse::<f64>().is_ok() && wanted.contains("number") =>
            {
                "write it without quotes".into()
            }
            Value::Whole(_) | Value::Number(_) if wanted == "a text" => "write it in quotes".into(),
            _ => format!("give {wanted}"),
        };
        self.wrong(
            value,
            format!("{name} is {said}, not {wanted}"),
            format!("not {wanted}"),
            help,
        )
        .into()
    }

    fn text<'v>(&self, name: &str, value: &'v Spanned<Value>) -> Result<&'v str> {
        match value.get_ref() {
            Value::Text(text) => Ok(text),
            _ => Err(self.not_a(name, value, "a text")),
        }
    }

    /// What one of these texts stands for.
    fn one_of<T: Copy>(
        &self,
        name: &str,
        value: &Spanned<Value>,
        texts: &[(&str, T)],
    ) -> Result<T> {
        let text = self.text(name, value)?;
        if let Some((_, meaning)) = texts.iter().find(|(known, _)| *known == text) {
            return Ok(*meaning);
        }
        let known: Vec<String> = texts
            .iter()
            .map(|(text, _)| format!("\"{text}\""))
            .collect();
        Err(self
            .wrong(
                value,
                format!("there is no {name} \"{}\"", shown(text)),
                "not known",
                format!("give one of {}", known.join(", ")),
            )
            .into())
    }

    fn whole(&self, name: &str, value: &Spanned<Value>, low: u32, high: u32) -> Result<u32> {
        let out_of_range = || {
            self.wrong(
                value,
                format!("{name} = {} is not possible", value.get_ref().said()),
                "out of range",
                format!("give a whole number from {low} to {high}"),
            )
            .into()
        };
        match value.get_ref() {
            Value::Whole(whole) => u32::try_from(*whole)
                .ok()
                .filter(|whole| (low..=high).contains(whole))
                .ok_or_else(out_of_range),
            // Integers that have no room in 64 bits.
            Value::Number(number) if number.abs() >= 1e18 => Err(out_of_range()),
            _ => Err(self.not_a(name, value, "a whole number")),
        }
    }

    fn number(&self, name: &str, value: &Spanned<Value>, range: limits::Range) -> Result<f32> {
        let Some(number) = value.get_ref().number() else {
            return Err(self.not_a(name, value, "a number"));
        };
        if range.holds(number as f32) {
            return Ok(number as f32);
        }
        Err(self
            .wrong(
                value,
                format!("{name} = {} is not possible", said(number)),
                "out of range",
                format!("give a number {range}"),
            )
            .into())
    }

    fn world(&self, file: &File, batches: &[Batch], shutter: (f32, f32)) -> Result<World> {
        let mut world = World::default();
        let mut known = Known {
            ids: BTreeMap::new(),
            shutter,
        };
        for (name, material) in &file.materials {
            let (made, thickness) = self.material(material)?;
            let id = world.add_named_material(name, made);
            let hollow = thickness.map(|thickness| {
                let inner = Material::bubble(made.parameter, made.volume);
                (thickness, world.add_named_material(name, inner))
            });
            known.ids.insert(name, (id, hollow));
        }
        let mut grey = None;
        for table in &file.spheres {
            self.sphere(table, &known)?.add_to(&mut world, &mut grey);
        }
        for some in batches.chunks(AT_ONCE) {
            let read: Vec<Result<Vec<Row>>> = some
                .par_iter()
                .map(|batch| self.batch(batch, &known))
                .collect();
            for rows in read {
                for row in rows? {
                    row.add_to(&mut world, &mut grey);
                }
            }
            self.count(&world)?;
        }
        if let Some(particles) = &file.particles {
            world.append(&self.particles(&particles.file)?);
            self.count(&world)?;
        }
        if world.spheres.is_empty() {
            return Err(SceneError::without_place(
                self.path,
                "the scene has no spheres",
                "add a [[sphere]] with center and radius, or [particles] with a file",
            )
            .into());
        }
        Ok(world)
    }

    fn count(&self, world: &World) -> Result<()> {
        if world.spheres.len() <= limits::MAX_SPHERES {
            return Ok(());
        }
        Err(SceneError::without_place(
            self.path,
            format!("the scene has more than {} spheres", limits::MAX_SPHERES),
            "render it in parts",
        )
        .into())
    }

    /// Some `[[sphere]]` tables.
    fn batch(&self, batch: &Batch, known: &Known<'_>) -> Result<Vec<Row>> {
        let last = &self.text[batch.last..batch.range.end];
        if last.len() > MAX_TABLE {
            let before = Batch {
                range: batch.range.start..batch.last,
                last: batch.range.start,
            };
            if !before.range.is_empty() {
                self.batch(&before, known)?;
            }
            return Err(self.long_table(batch.last, last));
        }
        let pieces = [Piece::whole(batch.range.clone())];
        let reader = Reader {
            pieces: &pieces,
            ..*self
        };
        let tables: Spheres = reader.read(&self.text[batch.range.clone()])?;
        let rows = tables
            .sphere
            .iter()
            .map(|table| reader.sphere(table, known));
        rows.collect()
    }

    /// What is wrong with a table that is too long. A bracket or a text that is not closed takes in
    /// what follows; its beginning may say so.
    fn long_table(&self, start: usize, table: &str) -> Error {
        let mut end = MAX_TABLE;
        while !table.is_char_boundary(end) {
            end -= 1;
        }
        let pieces = [Piece::whole(start..start + end)];
        let reader = Reader {
            pieces: &pieces,
            ..*self
        };
        if let Err(Error::Scene(error)) = reader.read::<Spheres>(&table[..end])
            && let Some(place) = &error.place
            && place.span.end < start + end
        {
            return Error::Scene(error);
        }
        let message = format!("this [[sphere]] table has more than {MAX_TABLE} bytes");
        let help = "close the text that is open, or make it shorter";
        let span = 0.."[[sphere]]".len();
        reader.wrong_at(span, message, "begins here", help).into()
    }

    fn sphere(&self, table: &Spanned<SphereTable>, known: &Known<'_>) -> Result<Row> {
        let table = table.get_ref();
        let (material, hollow) = match &table.material {
            Some(value) => {
                let name = self.text("material", value)?;
                let (id, hollow) = *known.ids.get(name).ok_or_else(|| {
                    let names: Vec<&str> = known.ids.keys().copied().collect();
                    self.wrong(
                        value,
                        format!("there is no material \"{}\"", shown(name)),
                        "not defined",
                        if names.is_empty() {
                            format!("define it: [materials.{}] with kind = \"diffuse\" and color = [r, g, b]", shown(name))
                        } else {
                            format!("the scene defines {}", shown(&names.join(", ")))
                        },
                    )
                })?;
                (Some(id), hollow)
            }
            None => (None, None),
        };
        let sphere = Sphere::new(
            self.vector("center", &table.center)?,
            self.number("radius", &table.radius, limits::RADIUS)?,
        );
        let velocity = match &table.velocity {
            Some(velocity) => self.vector("velocity", velocity)?,
            None => Vec3::ZERO,
        };
        self.is_within(&table.center, &sphere, velocity, known.shutter)?;
        let hollow = hollow.map(|(thickness, inner)| {
            let Some(radius) = limits::hollow(sphere.radius(), thickness) else {
                let (message, label, help) = if sphere.radius() <= thickness {
                    (
                        "leaves no hollow",
                        "not more than the thickness",
                        "give a larger radius, or a material without thickness for solid glass",
                    )
                } else {
                    (
                        "is too thin for a 32-bit float",
                        "the hollow's radius rounds to this",
                        "give a thickness of at least a millionth of the radius",
                    )
                };
                let thickness = said(thickness.into());
                let message = format!("the shell of this sphere, {thickness} thick, {message}");
                return Err(self.wrong(&table.radius, message, label, help));
            };
            Ok((Sphere::new(sphere.center(), radius), inner))
        });
        Ok(Row {
            sphere,
            material,
            velocity,
            hollow: hollow.transpose()?,
        })
    }

    fn particles(&self, file: &Spanned<Value>) -> Result<World> {
        let name = self.text("file", file)?;
        let path = self.beside(name);
        let Some(Contents::Atoms(parse)) = Format::of(&path).map(|format| format.contents) else {
            return Err(self
                .wrong(
                    file,
                    format!(
                        "{}: not a kind of particle file that spherule reads",
                        shown(name)
                    ),
                    "unknown kind",
                    format!("give a {} file", formats::extensions(true)),
                )
                .into());
        };
        molecule::load(&path, parse).map_err(|error| match error {
            // A file that is not there is a mistake in the scene; one that is there but wrong
            // says more about itself than its name here does.
            Error::Scene(inner) if inner.place.is_none() => self
                .wrong(file, inner.to_string(), "named here", inner.help)
                .into(),
            other => other,
        })
    }

    fn view(&self, camera: &Spanned<CameraTable>) -> Result<View> {
        let table = camera.get_ref();
        let view = View {
            eye: self.vector("eye", &table.eye)?,
            target: self.vector("target", &table.target)?,
            up: match &table.up {
                Some(up) => self.vector("up", up)?,
                None => Vec3::Y,
            },
            vertical_fov: match &table.vertical_fov {
                Some(fov) => match fov.get_ref().number() {
                    Some(degrees) if limits::is_vertical_fov(degrees) => degrees,
                    Some(degrees) => {
                        return Err(self
                            .wrong(
                                fov,
                                format!("vertical_fov = {} is not possible", said(degrees)),
                                "out of range",
                                "give an angle in degrees above 0 and below 180, for example 40",
                            )
                            .into());
                    }
                    None => return Err(self.not_a("vertical_fov", fov, "a number")),
                },
                None => View::DEFAULT_FOV,
            },
        };
        if view.eye == view.target {
            return Err(self
                .wrong(
                    &table.target,
                    "eye and target are the same point",
                    "same as eye",
                    "the camera looks from eye to target: move one of them",
                )
                .into());
        }
        if view.camera(1.0).is_none() {
            let message = "up is zero or points along the view";
            let help = "give an up that points upwards in the image, for example [0, 1, 0]";
            return Err(match &table.up {
                Some(up) => self.wrong(up, message, "no roll angle follows", help),
                None => self.wrong(camera, message, "up is [0, 1, 0] here", help),
            }
            .into());
        }
        Ok(view)
    }

    fn side(&self, name: &str, value: &Spanned<Value>) -> Result<u32> {
        self.whole(name, value, 1, limits::MAX_IMAGE_SIDE)
    }

    /// A vector in space.
    fn vector(&self, name: &str, value: &Spanned<Value>) -> Result<Vec3> {
        let vector = self.three(name, value)?;
        if !limits::COORDINATE.holds_all(vector) {
            return Err(self
                .wrong(
                    value,
                    format!("{name} is too large"),
                    "out of range",
                    format!(
                        "give numbers {}: use a larger unit of length",
                        limits::COORDINATE
                    ),
                )
                .into());
        }
        Ok(vector)
    }

    /// Refuses a sphere that reaches, or moves, too far.
    fn is_within(
        &self,
        center: &Spanned<Value>,
        sphere: &Sphere,
        velocity: Vec3,
        shutter: (f32, f32),
    ) -> Result<()> {
        if limits::is_within(sphere, velocity, shutter) {
            return Ok(());
        }
        let how = if velocity == Vec3::ZERO {
            "reaches"
        } else {
            "reaches, or moves while the shutter is open,"
        };
        Err(self
            .wrong(
                center,
                format!("this sphere {how} beyond {:e}", limits::MAX_LENGTH),
                "with its radius, too far from the origin",
                "use a larger unit of length",
            )
            .into())
    }

    /// Three finite numbers.
    fn three(&self, name: &str, value: &Spanned<Value>) -> Result<Vec3> {
        let numbers = match value.get_ref() {
            Value::List(numbers, None) => numbers,
            Value::List(_, Some(other)) => {
                return Err(self
                    .wrong(
                        value,
                        format!("{name} holds {other}, not three numbers"),
                        "not three numbers",
                        "give three numbers: [x, y, z], or [red, green, blue]",
                    )
                    .into());
            }
            _ => return Err(self.not_a(name, value, "a list of three numbers")),
        };
        let Ok([x, y, z]) = <[f64; 3]>::try_from(&numbers[..]) else {
            let count = count_of(numbers.len(), "number");
            return Err(self
                .wrong(
                    value,
                    format!("{name} has {count}"),
                    "not three",
                    "give three numbers: [x, y, z], or [red, green, blue]",
                )
                .into());
        };
        let vector = Vec3::new(x as f32, y as f32, z as f32);
        if !vector.is_finite() {
            return Err(self
                .wrong(
                    value,
                    format!("{name} is not finite"),
                    "NaN, infinite or too large",
                    "give three numbers that 32-bit floats can hold",
                )
                .into());
        }
        Ok(vector)
    }

    /// Red, green and blue, each in the range.
    fn color(&self, name: &str, value: &Spanned<Value>, range: limits::Range) -> Result<Vec3> {
        let color = self.three(name, value)?;
        if range.holds_all(color) {
            return Ok(color);
        }
        let (message, label) = if color.min_element() < range.low {
            (format!("{name} has a channel below zero"), "negative")
        } else if range == limits::REFLECTANCE {
            (
                format!("{name} has a channel above one"),
                "gives back more light than it receives",
            )
        } else {
            (
                format!("{name} has a channel above {:e}", range.high),
                "too large",
            )
        };
        let help = if range == limits::REFLECTANCE {
            "give linear red, green and blue between 0 and 1 (divide 8-bit values by 255 and undo the sRGB curve)".into()
        } else {
            format!("give linear red, green and blue, each {range}")
        };
        Err(self.wrong(value, message, label, help).into())
    }

    /// A radiance times a strength.
    fn radiance(&self, name: &str, value: &Spanned<Value>, strength: f32) -> Result<Vec3> {
        let radiance = self.color(name, value, limits::RADIANCE)? * strength;
        if limits::RADIANCE.holds_all(radiance) {
            return Ok(radiance);
        }
        Err(self
            .wrong(
                value,
                format!("{name} times a strength of {strength:e} is too bright"),
                "too large",
                format!(
                    "give a smaller strength: the product is at most {:e}",
                    limits::MAX_RADIANCE
                ),
            )
            .into())
    }

    fn wrong<T>(
        &self,
        value: &Spanned<T>,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) -> Box<SceneError> {
        self.wrong_at(value.span(), message, label, help)
    }

    /// What is wrong with these bytes of what was parsed.
    fn wrong_at(
        &self,
        span: Range<usize>,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) -> Box<SceneError> {
        Box::new(SceneError {
            path: self.path.into(),
            message: message.into(),
            help: help.into(),
            place: Some(Place {
                text: self.text.to_owned(),
                span: self.in_file(span.start)
                    ..self.in_file(span.end).max(self.in_file(span.start)),
                label: label.into(),
            }),
        })
    }

    /// Where in the file a byte is that was parsed.
    fn in_file(&self, at: usize) -> usize {
        let piece = self.pieces.iter().rev().find(|piece| piece.start <= at);
        piece.map_or(at, |piece| piece.range.start + (at - piece.start))
    }
}

/// A material's index, and for hollow spheres how thick they are and the index of what is inside.
type NamedMaterial = (u32, Option<(f32, u32)>);

/// What the spheres of a scene refer to.
struct Known<'a> {
    ids: BTreeMap<&'a str, NamedMaterial>,
    shutter: (f32, f32),
}

/// A sphere as its table says.
struct Row {
    sphere: Sphere,
    /// Its material; `None` for a grey.
    material: Option<u32>,
    velocity: Vec3,
    /// The hollow in it.
    hollow: Option<(Sphere, u32)>,
}

impl Row {
    /// `grey` is the material of spheres without one, once there is one.
    fn add_to(self, world: &mut World, grey: &mut Option<u32>) {
        let id = self.material.unwrap_or_else(|| {
            let diffuse = Material::diffuse(Vec3::splat(0.5));
            *grey.get_or_insert_with(|| world.add_material(diffuse))
        });
        for (sphere, id) in std::iter::once((self.sphere, id)).chain(self.hollow) {
            if self.velocity == Vec3::ZERO {
                world.add(sphere, id);
            } else {
                world.add_moving(sphere, id, self.velocity);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = r#"
[image]
width = 4
height = 3
background = [0, 0.5, 1]

[camera]
eye = [0, 0, 0]
target = [0, 0, -1]
vertical_fov = 90

[materials.red]
kind = "diffuse"
color = [1, 0, 0]

[[sphere]]
center = [0, 0, -3]
radius = 0.5
material = "red"

[[sphere]]
center = [0, -100.5, -3]
radius = 100
"#;

    fn read(text: &str) -> Result<Scene> {
        parse(Path::new("test.toml"), text.into())
    }

    #[test]
    fn a_whole_scene_is_read() {
        let scene = read(GOOD).expect("a scene");
        assert_eq!((scene.width, scene.height), (4, 3));
        assert_eq!(scene.background, Vec3::new(0.0, 0.5, 1.0));
        assert_eq!(
            scene.world.spheres[1],
            Sphere::new(Vec3::new(0.0, -100.5, -3.0), 100.0)
        );
        assert_eq!(scene.world.materials[0], Material::diffuse(Vec3::X));
        assert_eq!(scene.world.material_ids, [0, 1]);
        assert_eq!(scene.view.expect("a view").vertical_fov, 90.0);
    }

    /// Each mistake, the line it must be found on, and a word of the message.
    #[test]
    fn each_mistake_is_refused_at_its_line() {
        let cases = [
            ("width = 4", "width = 0", 3, "width = 0"),
            (
                "width = 4",
                "width = 4.5",
                3,
                "width is 4.5, not a whole number",
            ),
            (
                "width = 4",
                "width = 99999999999999999999",
                3,
                "width = 1e20",
            ),
            (
                "width = 4",
                "width = [4]",
                3,
                "width is a list, not a whole",
            ),
            ("width = 4", "wdith = 4", 3, "unknown field"),
            ("width = 4", "width = 99999", 3, "99999"),
            ("[0, 0.5, 1]", "[0, -0.5, 1]", 5, "below zero"),
            ("[0, 0.5, 1]", "[0, 0.5]", 5, "2 numbers"),
            ("[camera]", "[lens]", 7, "unknown field"),
            (
                "eye = [0, 0, 0]",
                "eye = [0, nan, 0]",
                8,
                "eye is not finite",
            ),
            (
                "eye = [0, 0, 0]",
                "eye = [0, inf, 0]",
                8,
                "eye is not finite",
            ),
            (
                "eye = [0, 0, 0]",
                "eye = [0, 1e39, 0]",
                8,
                "eye is not finite",
            ),
            ("eye = [0, 0, 0]", "eye = [0, 2e18, 0]", 8, "too large"),
            ("eye = [0, 0, 0]", "eye = [0, 0, 0, 0]", 8, "4 numbers"),
            ("eye = [0, 0, 0]", "", 7, "missing field `eye`"),
            ("target = [0, 0, -1]", "target = [0, 0, 0]", 9, "same point"),
            (
                "target = [0, 0, -1]",
                "target = [0, 9, 0]",
                7,
                "along the view",
            ),
            (
                "vertical_fov = 90",
                "vertical_fov = 180",
                10,
                "vertical_fov = 180",
            ),
            (
                "vertical_fov = 90",
                "vertical_fov = nan",
                10,
                "vertical_fov = NaN",
            ),
            (
                "\"diffuse\"",
                "\"mirror\"",
                13,
                "there is no kind \"mirror\"",
            ),
            ("color = [1, 0, 0]", "color = [1.5, 0, 0]", 14, "above one"),
            ("radius = 0.5", "radius = 0", 18, "radius = 0"),
            ("radius = 0.5", "radius = -1", 18, "radius = -1"),
            ("radius = 0.5", "radius = nan", 18, "radius = NaN"),
            ("radius = 0.5", "radius = 1e-60", 18, "radius = 1e-60"),
            (
                "radius = 0.5",
                "radius = \"0.5\"",
                18,
                "radius is the text \"0.5\", not a number",
            ),
            ("radius = 0.5", "radius = 1e300", 18, "radius = 1e300"),
            (
                "center = [0, 0, -3]",
                "center = [0, true, -3]",
                17,
                "center holds true, not three numbers",
            ),
            (
                "center = [0, 0, -3]",
                "center = {x = 0}",
                17,
                "center is a table, not a list of three numbers",
            ),
            (
                "center = [0, 0, -3]",
                "center = [1]",
                17,
                "center has 1 number",
            ),
            (
                "material = \"red\"",
                "material = 1979-05-27",
                19,
                "material is a date or time, not a text",
            ),
            (
                "center = [0, 0, -3]",
                "center = 2020-01-01",
                17,
                "center is a date or time, not a list of three numbers",
            ),
            (
                "center = [0, 0, -3]",
                "center = [0, 07:32:00, -3]",
                17,
                "center holds a date or time, not three numbers",
            ),
            ("radius = 0.5", "radius = 1e-40", 18, "radius = 1e-40"),
            ("radius = 100", "radius = 1e18", 22, "beyond 1e18"),
            ("[0, 0.5, 1]", "[0, 1e16, 1]", 5, "above 1e15"),
            (
                "material = \"red\"",
                "material = \"blue\"",
                19,
                "no material \"blue\"",
            ),
            (
                "radius = 100",
                "radius = 100\n[particles]\nfile = \"no.pdb\"",
                25,
                "no such file",
            ),
            (
                "radius = 100",
                "radius = 100\n[particles]\nfile = \"no.gro\"",
                25,
                "not a kind",
            ),
            (
                "radius = 100",
                "radius = 100\nradius = 1",
                24,
                "duplicate key",
            ),
        ];
        for (good, bad, line, word) in cases {
            assert!(GOOD.contains(good), "{good}");
            let error = read(&GOOD.replacen(good, bad, 1)).expect_err(bad);
            let Error::Scene(error) = error else {
                panic!("{bad}: {error:?}")
            };
            assert!(error.message.contains(word), "{bad}: {}", error.message);
            assert!(!error.help.is_empty(), "{bad}");
            let place = error.place.as_ref().expect("a place");
            assert_eq!(place.line_column().0, line, "{bad}: {error:?}");
        }
    }

    /// The parser does not say where a key of many parts is; no other place is shown for it.
    #[test]
    fn a_mistake_without_a_place_has_none() {
        let key = ["a"; 100].join(".");
        for text in [format!("{GOOD}\n{key} = 1\n"), format!("\n[{key}]\n")] {
            let error = read(&text).expect_err("a long key");
            let Error::Scene(error) = error else {
                panic!("{error:?}")
            };
            assert!(error.message.contains("more than 80 parts"), "{error}");
            assert!(error.place.is_none(), "{error}");
        }
    }

    /// Each new mistake in a scene of its own: what the scene has besides a sphere, and a word of
    /// the message.
    #[test]
    fn each_key_of_the_effects_refuses_what_it_cannot_be() {
        let cases = [
            ("camera = 5", "this is the whole number `5`, not a table"),
            ("camera = 2020-01-01", "this is a date or time, not a table"),
            ("[image]\nsamples = 0", "samples = 0"),
            ("[image]\nsamples = 65537", "65537"),
            ("[image]\nmax_bounces = -1", "max_bounces = -1"),
            ("[image]\nambient_occlusion = 0", "ambient_occlusion = 0"),
            ("[image]\nseed = -5", "seed = -5"),
            ("[image]\nexposure = 100", "exposure = 100"),
            ("[image]\nexposure = nan", "exposure = NaN"),
            (
                "[image]\ntonemap = \"film\"",
                "there is no tonemap \"film\"",
            ),
            (
                "[image]\ntransparent = 1",
                "transparent is 1, not true or false",
            ),
            (
                "[image]\nsamples = \"4\"",
                "samples is the text \"4\", not a whole number",
            ),
            ("[sky]\nimage = 3", "image is 3, not a text"),
            ("[materials.m]\nkind = true", "kind is true, not a text"),
            (
                "[camera]\neye = [0, 0, 9]\ntarget = [0, 0, 0]\naperture = -1",
                "aperture = -1",
            ),
            (
                "[camera]\neye = [0, 0, 9]\ntarget = [0, 0, 0]\nfocus_distance = 0",
                "focus_distance = 0",
            ),
            (
                "[camera]\neye = [0, 0, 9]\ntarget = [0, 0, 0]\nshutter = [1, 0]",
                "not a pair of times",
            ),
            (
                "[camera]\neye = [0, 0, 9]\ntarget = [0, 0, 0]\nshutter = [1]",
                "not a pair of times",
            ),
            ("[materials.m]\nkind = \"diffuse\"", "has no color"),
            (
                "[materials.m]\nkind = \"diffuse\"\ncolor = [1, 1, 1]\nroughness = 0.5",
                "has no roughness",
            ),
            (
                "[materials.m]\nkind = \"glass\"\ncolor = [1, 1, 1]",
                "has no color",
            ),
            ("[materials.m]\nkind = \"glass\"\nindex = 0", "index = 0"),
            (
                "[materials.m]\nkind = \"glass\"\nabsorption = [-1, 0, 0]",
                "below zero",
            ),
            (
                "[materials.m]\nkind = \"glass\"\nthickness = 0",
                "thickness = 0",
            ),
            (
                "[materials.m]\nkind = \"glass\"\nthickness = 2\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"m\"",
                "leaves no hollow",
            ),
            (
                "[materials.m]\nkind = \"glass\"\nthickness = 1e-9\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"m\"",
                "too thin",
            ),
            (
                "[materials.m]\nkind = \"emissive\"\ncolor = [1e9, 0, 0]\nstrength = 1e9",
                "too bright",
            ),
            (
                "[camera]\neye = [0, 0, 9]\ntarget = [0, 0, 0]\nshutter = [0, 1e9]\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nvelocity = [0, 1e10, 0]",
                "moves",
            ),
            (
                "[materials.m]\nkind = \"metal\"\ncolor = [1, 1, 1]\nroughness = 1.5",
                "roughness = 1.5",
            ),
            (
                "[materials.m]\nkind = \"metal\"\ncolor = [2, 1, 1]",
                "above one",
            ),
            (
                "[materials.m]\nkind = \"emissive\"\ncolor = [1, 1, 1]\nstrength = -1",
                "strength = -1",
            ),
            (
                "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nvelocity = [1, 0]",
                "2 numbers",
            ),
            (
                "[[light]]\nposition = [0, 9, 0]",
                "missing field `intensity`",
            ),
            (
                "[[light]]\nposition = [0, 9, 0]\nintensity = [-1, 0, 0]",
                "below zero",
            ),
            (
                "[[light]]\nposition = [0, 9, 0]\nintensity = [1, 1, 1]\nradius = -1",
                "radius = -1",
            ),
            (
                "[[light]]\nposition = [0, 9, 0]\nintensity = [1e18, 1, 1]\nradius = 1e-15",
                "too bright",
            ),
            ("[sky]\nhorizon = [-1, 0, 0]", "below zero"),
            ("[sky]\nsun_direction = [0, 0, 0]", "sun_direction is zero"),
            ("[sky]\nsun_irradiance = [1, 1, 1]", "no direction"),
            (
                "[sky]\nsun_direction = [0, 1, 0]\nsun_size = 181",
                "sun_size = 181",
            ),
            (
                "[sky]\nsun_direction = [0, 1, 0]\nsun_size = 1e-9",
                "too bright for its size",
            ),
            (
                "[sky]\nzenith = [1e10, 0, 0]\nstrength = 1e10",
                "zenith times a strength",
            ),
            ("[sky]\nimage = \"no.hdr\"", "cannot be opened"),
            ("[sky]\nstrength = -1", "strength = -1"),
            ("[fog]\nalbedo = [1, 1, 1]", "missing field `extinction`"),
            ("[fog]\nextinction = 0", "extinction = 0"),
            (
                "[fog]\nextinction = 1\nalbedo = [2, 0, 0]",
                "albedo has a channel above one",
            ),
            ("[fog]\nextinction = 1\nanisotropy = 1", "anisotropy = 1"),
            ("[fog]\nextinction = 1\nradius = 0", "radius = 0"),
            ("[fog]\nextinction = 1\ncenter = [0, 0, 0]", "no radius"),
        ];
        for (text, word) in cases {
            let text = format!("{text}\n[[sphere]]\ncenter = [0, 0, -3]\nradius = 0.5\n");
            let Err(Error::Scene(error)) = read(&text) else {
                panic!("{text} is read")
            };
            assert!(error.message.contains(word), "{text}: {}", error.message);
            assert!(!error.help.is_empty() && error.place.is_some(), "{text}");
        }
    }

    /// The reader, the schema and the page of keys know the same keys.
    #[test]
    fn the_schema_and_the_docs_list_every_key() {
        let schema: serde_json::Value =
            serde_json::from_str(include_str!("../../scenes/scene.schema.json")).expect("JSON");
        let page = include_str!("../../docs/scenes.md");
        let root = &schema["properties"];
        let tables = [
            ("", &schema["properties"], "[zzz]\n"),
            (
                "[image]",
                &root["image"]["properties"],
                "[image]\nzzz = 1\n",
            ),
            (
                "[camera]",
                &root["camera"]["properties"],
                "[camera]\nzzz = 1\n",
            ),
            (
                "[materials.NAME]",
                &root["materials"]["additionalProperties"]["properties"],
                "[materials.m]\nzzz = 1\n",
            ),
            (
                "[[sphere]]",
                &root["sphere"]["items"]["properties"],
                "[[sphere]]\nzzz = 1\n",
            ),
            (
                "[[light]]",
                &root["light"]["items"]["properties"],
                "[[light]]\nzzz = 1\n",
            ),
            ("[sky]", &root["sky"]["properties"], "[sky]\nzzz = 1\n"),
            ("[fog]", &root["fog"]["properties"], "[fog]\nzzz = 1\n"),
            (
                "[particles]",
                &root["particles"]["properties"],
                "[particles]\nzzz = 1\n",
            ),
        ];
        for (name, properties, wrong) in tables {
            let Err(Error::Scene(error)) = read(wrong) else {
                panic!("{wrong} is read")
            };
            // serde names the fields that it expected.
            let expected = error.message.split_once("expected").expect("names").1;
            let mut reader: Vec<&str> = expected.split('`').skip(1).step_by(2).collect();
            let mut known: Vec<&str> = properties
                .as_object()
                .expect("keys")
                .keys()
                .map(String::as_str)
                .collect();
            reader.sort_unstable();
            known.sort_unstable();
            assert_eq!(reader, known, "{name}");
            if !name.is_empty() {
                let section = page
                    .split("\n## ")
                    .find(|part| part.starts_with(&format!("`{name}`")));
                let section = section.unwrap_or_else(|| panic!("docs/scenes.md has no {name}"));
                for key in known {
                    assert!(section.contains(&format!("| `{key}` |")), "{name} {key}");
                }
            }
        }
    }

    #[test]
    fn a_scene_without_spheres_is_refused() {
        let error = read("[image]\nwidth = 3").expect_err("no spheres");
        assert!(error.to_string().contains("no spheres"));
    }

    /// Where `[[sphere]]` tables stand among others, and how they are written.
    #[test]
    fn a_file_is_split_at_its_headers() {
        let scene = read(
            "\u{feff}[[sphere]] # [[sphere]]\r\ncenter = [ # a [ comment\r\n  1,\r\n[].x, ]\r\n",
        );
        assert!(scene.is_err());
        let scene = read(concat!(
            "\u{feff}[[sphere]] # [[sphere]]\r\ncenter = [ # a [ comment\r\n  1, 0,\r\n0 ]\r\nradius = 1\r\n",
            "  [[ 'sphere' ]]\r\ncenter = [2, 0, 0]\r\nradius = 1\r\nmaterial = \"a [[sphere]]\"\r\n",
            "[materials.\"a [[sphere]]\"]\r\nkind = \"glass\"\r\n",
            "[[\"sphere\"]]\r\ncenter = [3, 0, 0]\r\nradius = 1\r\nmaterial = \"\"\"\r\nb\\n[[sphere]]\"\"\"\r\n",
            "[image]\r\nwidth = 3\r\n",
            "[materials.\"b\\n[[sphere]]\"]\r\nkind = \"glass\"\r\n",
            "[[sphere]]\r\ncenter = [4, 0, 0]\r\nradius = 1",
        ))
        .expect("a scene");
        let places: Vec<f32> = scene.world.spheres.iter().map(|s| s.center().x).collect();
        assert_eq!(places, [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(scene.world.material_ids, [2, 0, 1, 2]);
        assert_eq!(scene.width, 3);
        let list = "sphere = [{ center = [0, 0, 0], radius = 1 }]\n";
        assert_eq!(read(list).expect("a scene").world.spheres.len(), 1);
    }

    /// A mistake among very many spheres is found, and a bracket that is left open does not take in
    /// all of them.
    #[test]
    fn among_many_spheres_a_mistake_is_found() {
        let sphere = |index: usize| format!("[[sphere]]\ncenter = [{index}, 0, 0]\nradius = 1\n");
        let count = 10_000;
        let many: Vec<String> = (0..count).map(sphere).collect();
        let spheres = read(&many.concat()).expect("a scene").world.spheres;
        assert!((0..count).all(|index| spheres[index].center().x == index as f32));
        assert_eq!(spheres.len(), count);
        for (wrong, line, word) in [
            ("radius = -1", 3, "radius = -1"),
            ("radius = 1\nradius = 2", 4, "duplicate key"),
            ("raduis = 1", 3, "unknown field"),
            ("radius = [1", 4, ""),
            ("radius = \"\"\"1", 1, "more than 65536 bytes"),
            ("radius = 1 2", 3, ""),
            (
                "radius = 1\n[sphere.more]\na = 1",
                4,
                "this is a table, not a list",
            ),
            ("radius = 1\n[image]\nsphere = 1", 5, "unknown field"),
        ] {
            let mut many = many.clone();
            many[7000] = many[7000].replace("radius = 1", wrong);
            let Err(Error::Scene(error)) = read(&many.concat()) else {
                panic!("{wrong} is read")
            };
            assert!(error.message.contains(word), "{wrong}: {}", error.message);
            let (found, _) = error.place.as_ref().expect("a place").line_column();
            let expected = 3 * 7000 + line;
            // A bracket that is open is missed in the next line.
            assert!(
                (expected..=expected + 1).contains(&found),
                "{wrong}: {found}"
            );
        }
        let both = format!(
            "sphere = [{{ center = [0, 0, 0], radius = 1 }}]\n{}",
            many[0]
        );
        let error = read(&both).expect_err("two kinds").to_string();
        assert!(
            error.starts_with("test.toml:2:1: there is a list of spheres"),
            "{error}"
        );
        let long = format!("{}x = \"{}\"\n", many[0], "y".repeat(MAX_TEXT));
        let error = read(&format!(
            "[image]\n{}\n{long}",
            "# c\n".repeat(MAX_TEXT / 4)
        ));
        assert!(
            error
                .expect_err("too long")
                .to_string()
                .contains("longer than")
        );
        assert!(
            read(&long)
                .expect_err("too long")
                .to_string()
                .contains("more than 65536 bytes")
        );
    }

    /// Names come out of files as they are, and go to a terminal as it can show them.
    #[test]
    fn messages_hold_no_escapes_and_no_megabytes() {
        let long = "n".repeat(5_000_000);
        let sphere = "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n";
        for text in [
            format!("{sphere}material = \"\\u001b[31m\u{202e}\""),
            format!("{sphere}material = \"{long}\""),
            format!("{sphere}material = \"a\"\n[materials.\"\\u001b{long}\"]\nkind = \"glass\""),
            format!("\"\\u001b{long}\" = 1"),
            format!("[image]\n\"\\u001b{long}\" = 1"),
            format!("[image]\ntonemap = \"\\u001b{long}\""),
            format!("[image]\nwidth = \"\\u001b{long}\""),
            format!("{sphere}[sky]\nimage = \"\\u001b{long}\""),
            format!("{sphere}[particles]\nfile = \"\\u001b{long}.pdb\""),
            format!("{sphere}[particles]\nfile = \"\\u001b{long}\""),
        ] {
            let error = read(&text).expect_err("a refusal");
            let said = format!("{error}{}", error.help());
            let start = &text[..text.len().min(90)];
            assert!(said.len() < 1500, "{start}: {} bytes", said.len());
            assert!(!said.contains(['\u{1b}', '\u{202e}']), "{start}: {said:?}");
        }
    }
}
