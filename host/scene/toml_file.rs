//! Scenes in TOML, read with spans so that a mistake points at its line and column.

use std::collections::BTreeMap;
use std::path::Path;

use glam::Vec3;
use serde::Deserialize;
use spherule_kernel::fog::Fog;
use spherule_kernel::{Material, Sphere};
use toml::Spanned;

use super::limits::{self, Range};
use super::surroundings::{FogBall, Lens, PointLight, Sun, Surroundings, Tonemap};
use super::{Scene, View, World, environment, molecule, text::read_text};
use crate::error::{Error, Place, Result, SceneError};

/// The angle across the sun as it is seen from the Earth, in degrees.
const DEFAULT_SUN_SIZE: f32 = 0.53;

/// The file as written; every value keeps its span.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    image: ImageTable,
    camera: Option<Spanned<CameraTable>>,
    #[serde(default)]
    materials: BTreeMap<String, Spanned<MaterialTable>>,
    #[serde(default, rename = "sphere")]
    spheres: Vec<Spanned<SphereTable>>,
    particles: Option<ParticlesTable>,
    #[serde(default, rename = "light")]
    lights: Vec<LightTable>,
    sky: Option<Spanned<SkyTable>>,
    fog: Option<Spanned<FogTable>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct ImageTable {
    width: Option<Spanned<i64>>,
    height: Option<Spanned<i64>>,
    background: Option<Spanned<Vec<f64>>>,
    transparent: Option<bool>,
    samples: Option<Spanned<i64>>,
    max_bounces: Option<Spanned<i64>>,
    ambient_occlusion: Option<Spanned<f64>>,
    seed: Option<Spanned<i64>>,
    exposure: Option<Spanned<f64>>,
    tonemap: Option<TonemapName>,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "lowercase")]
enum TonemapName {
    Clamp,
    Reinhard,
    Aces,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraTable {
    eye: Spanned<Vec<f64>>,
    target: Spanned<Vec<f64>>,
    up: Option<Spanned<Vec<f64>>>,
    vertical_fov: Option<Spanned<f64>>,
    aperture: Option<Spanned<f64>>,
    focus_distance: Option<Spanned<f64>>,
    shutter: Option<Spanned<Vec<f64>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MaterialTable {
    kind: MaterialKind,
    color: Option<Spanned<Vec<f64>>>,
    roughness: Option<Spanned<f64>>,
    index: Option<Spanned<f64>>,
    absorption: Option<Spanned<Vec<f64>>>,
    thickness: Option<Spanned<f64>>,
    strength: Option<Spanned<f64>>,
}

#[derive(Deserialize, Clone, Copy, PartialEq, Debug)]
#[serde(rename_all = "lowercase")]
enum MaterialKind {
    Diffuse,
    Metal,
    Glass,
    Emissive,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SphereTable {
    center: Spanned<Vec<f64>>,
    radius: Spanned<f64>,
    material: Option<Spanned<String>>,
    velocity: Option<Spanned<Vec<f64>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LightTable {
    position: Spanned<Vec<f64>>,
    intensity: Spanned<Vec<f64>>,
    radius: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SkyTable {
    horizon: Option<Spanned<Vec<f64>>>,
    zenith: Option<Spanned<Vec<f64>>>,
    sun_direction: Option<Spanned<Vec<f64>>>,
    sun_size: Option<Spanned<f64>>,
    sun_irradiance: Option<Spanned<Vec<f64>>>,
    image: Option<Spanned<String>>,
    strength: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FogTable {
    extinction: Spanned<f64>,
    albedo: Option<Spanned<Vec<f64>>>,
    anisotropy: Option<Spanned<f64>>,
    center: Option<Spanned<Vec<f64>>>,
    radius: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ParticlesTable {
    file: Spanned<String>,
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
    let file: File = match toml::from_str(&text) {
        Ok(file) => file,
        Err(error) => {
            let span = error.span().unwrap_or(0..text.len().min(1));
            let message = error.message().trim().to_owned();
            return Err(Error::Scene(Box::new(SceneError {
                path: path.into(),
                help: help_for_toml(&message),
                place: Some(Place {
                    text,
                    span,
                    label: "here".into(),
                }),
                message,
            })));
        }
    };
    Reader { path, text }.scene(file)
}

fn help_for_toml(message: &str) -> String {
    if message.contains("unknown field") {
        "check the spelling; docs/scenes.md lists every key".into()
    } else if message.contains("unknown variant") {
        "materials are of kind \"diffuse\", \"metal\", \"glass\" or \"emissive\"; a tonemap is \"clamp\", \"reinhard\" or \"aces\"".into()
    } else if message.contains("missing field") {
        "add it; docs/scenes.md lists every key".into()
    } else {
        "the README shows a whole scene; tables are [name], spheres are [[sphere]], strings stand in quotes".into()
    }
}

/// Checks values, knowing the text that they came from.
struct Reader<'a> {
    path: &'a Path,
    text: String,
}

impl Reader<'_> {
    fn scene(&self, file: File) -> Result<Scene> {
        let lens = match &file.camera {
            Some(camera) => self.lens(camera.get_ref())?,
            None => Lens::default(),
        };
        let mut scene = Scene::new(self.world(&file, lens.shutter)?);
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
        Ok(scene)
    }

    fn image(&self, table: &ImageTable, scene: &mut Scene) -> Result<()> {
        scene.transparent = table.transparent.unwrap_or(false);
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
        scene.develop.tonemap = match table.tonemap {
            None | Some(TonemapName::Clamp) => Tonemap::Clamp,
            Some(TonemapName::Reinhard) => Tonemap::Reinhard,
            Some(TonemapName::Aces) => Tonemap::Aces,
        };
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
            let times: Vec<f32> = shutter.get_ref().iter().map(|time| *time as f32).collect();
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
        let optional = |name, value: &Option<Spanned<Vec<f64>>>| {
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
            .map(|file| {
                let path = self
                    .path
                    .parent()
                    .unwrap_or(Path::new(""))
                    .join(file.get_ref());
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
        let number = |name, value: &Option<Spanned<f64>>, range, default| match value {
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
        let kind = material.kind;
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
                        format!("a material of kind {kind:?} has no {name}").to_lowercase(),
                        "not for this kind",
                        "diffuse has color; metal has color and roughness; glass has index, absorption and thickness;                          emissive has color and strength",
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

    fn whole(&self, name: &str, value: &Spanned<i64>, low: u32, high: u32) -> Result<u32> {
        u32::try_from(*value.get_ref())
            .ok()
            .filter(|whole| (low..=high).contains(whole))
            .ok_or_else(|| {
                self.wrong(
                    value,
                    format!("{name} = {} is not possible", value.get_ref()),
                    "out of range",
                    format!("give a whole number from {low} to {high}"),
                )
                .into()
            })
    }

    fn number(&self, name: &str, value: &Spanned<f64>, range: Range) -> Result<f32> {
        let number = *value.get_ref() as f32;
        if range.holds(number) {
            return Ok(number);
        }
        Err(self
            .wrong(
                value,
                format!("{name} = {} is not possible", value.get_ref()),
                "out of range",
                format!("give a number {range}"),
            )
            .into())
    }

    fn world(&self, file: &File, shutter: (f32, f32)) -> Result<World> {
        let mut world = World::default();
        let mut ids = BTreeMap::new();
        for (name, material) in &file.materials {
            let (made, thickness) = self.material(material)?;
            let id = world.add_named_material(name, made);
            let hollow = thickness.map(|thickness| {
                let inner = Material::bubble(made.parameter, made.volume);
                (thickness, world.add_named_material(name, inner))
            });
            ids.insert(name.as_str(), (id, hollow));
        }
        let mut default_id = None;
        for table in &file.spheres {
            let table = table.get_ref();
            let (id, hollow) = match &table.material {
                Some(name) => *ids.get(name.get_ref().as_str()).ok_or_else(|| {
                    let known: Vec<&str> = ids.keys().copied().collect();
                    self.wrong(
                        name,
                        format!("there is no material \"{}\"", name.get_ref()),
                        "not defined",
                        if known.is_empty() {
                            format!("define it: [materials.{}] with kind = \"diffuse\" and color = [r, g, b]", name.get_ref())
                        } else {
                            format!("the scene defines {}", known.join(", "))
                        },
                    )
                })?,
                None => {
                    let grey = Material::diffuse(Vec3::splat(0.5));
                    (
                        *default_id.get_or_insert_with(|| world.add_material(grey)),
                        None,
                    )
                }
            };
            let sphere = Sphere::new(
                self.vector("center", &table.center)?,
                self.number("radius", &table.radius, limits::RADIUS)?,
            );
            let velocity = match &table.velocity {
                Some(velocity) => self.vector("velocity", velocity)?,
                None => Vec3::ZERO,
            };
            self.is_within(&table.center, &sphere, velocity, shutter)?;
            let mut add = |sphere, id| {
                if velocity == Vec3::ZERO {
                    world.add(sphere, id);
                } else {
                    world.add_moving(sphere, id, velocity);
                }
            };
            add(sphere, id);
            if let Some((thickness, inner)) = hollow {
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
                    let message = format!("the shell of this sphere, {thickness} thick, {message}");
                    return Err(self.wrong(&table.radius, message, label, help).into());
                };
                add(Sphere::new(sphere.center(), radius), inner);
            }
        }
        if let Some(particles) = &file.particles {
            world.append(&self.particles(&particles.file)?);
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

    fn particles(&self, file: &Spanned<String>) -> Result<World> {
        let named = Path::new(file.get_ref());
        let path = self.path.parent().unwrap_or(Path::new("")).join(named);
        if !molecule::is_molecule(&super::extension(&path)) {
            return Err(self
                .wrong(
                    file,
                    format!(
                        "{}: not a kind of particle file that spherule reads",
                        file.get_ref()
                    ),
                    "unknown kind",
                    "give a .pdb, .ent or .xyz file",
                )
                .into());
        }
        molecule::load(&path).map_err(|error| match error {
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
                Some(fov) if limits::is_vertical_fov(*fov.get_ref()) => *fov.get_ref(),
                Some(fov) => {
                    return Err(self
                        .wrong(
                            fov,
                            format!(
                                "a vertical_fov of {} degrees is not possible",
                                fov.get_ref()
                            ),
                            "out of range",
                            "give an angle in degrees above 0 and below 180, for example 40",
                        )
                        .into());
                }
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

    fn side(&self, name: &str, value: &Spanned<i64>) -> Result<u32> {
        self.whole(name, value, 1, limits::MAX_IMAGE_SIDE)
    }

    /// A vector in space.
    fn vector(&self, name: &str, value: &Spanned<Vec<f64>>) -> Result<Vec3> {
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
        center: &Spanned<Vec<f64>>,
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
    fn three(&self, name: &str, value: &Spanned<Vec<f64>>) -> Result<Vec3> {
        let Ok([x, y, z]) = <[f64; 3]>::try_from(value.get_ref().as_slice()) else {
            return Err(self
                .wrong(
                    value,
                    format!("{name} has {} numbers", value.get_ref().len()),
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
    fn color(&self, name: &str, value: &Spanned<Vec<f64>>, range: Range) -> Result<Vec3> {
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
    fn radiance(&self, name: &str, value: &Spanned<Vec<f64>>, strength: f32) -> Result<Vec3> {
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
        Box::new(SceneError {
            path: self.path.into(),
            message: message.into(),
            help: help.into(),
            place: Some(Place {
                text: self.text.clone(),
                span: value.span(),
                label: label.into(),
            }),
        })
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
            ("width = 4", "width = 4.5", 3, "invalid type"),
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
            ("vertical_fov = 90", "vertical_fov = 180", 10, "180 degrees"),
            ("vertical_fov = 90", "vertical_fov = nan", 10, "NaN degrees"),
            ("\"diffuse\"", "\"mirror\"", 13, "unknown variant"),
            ("color = [1, 0, 0]", "color = [1.5, 0, 0]", 14, "above one"),
            ("radius = 0.5", "radius = 0", 18, "radius = 0"),
            ("radius = 0.5", "radius = -1", 18, "radius = -1"),
            ("radius = 0.5", "radius = nan", 18, "radius = NaN"),
            ("radius = 0.5", "radius = 1e-60", 18, "radius = 0.000"),
            ("radius = 0.5", "radius = \"0.5\"", 18, "invalid type"),
            ("radius = 0.5", "radius = 1e-40", 18, "radius = 0.000"),
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

    /// Each new mistake in a scene of its own: what the scene has besides a sphere, and a word of
    /// the message.
    #[test]
    fn each_key_of_the_effects_refuses_what_it_cannot_be() {
        let cases = [
            ("[image]\nsamples = 0", "samples = 0"),
            ("[image]\nsamples = 65537", "65537"),
            ("[image]\nmax_bounces = -1", "max_bounces = -1"),
            ("[image]\nambient_occlusion = 0", "ambient_occlusion = 0"),
            ("[image]\nseed = -5", "seed = -5"),
            ("[image]\nexposure = 100", "exposure = 100"),
            ("[image]\nexposure = nan", "exposure = NaN"),
            ("[image]\ntonemap = \"film\"", "unknown variant"),
            ("[image]\ntransparent = 1", "invalid type"),
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
}
