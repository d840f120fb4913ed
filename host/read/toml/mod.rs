//! Reads scenes in TOML, with spans so that errors point at their line and column.

mod camera;
mod fog;
mod image;
mod light;
mod material;
mod particles;
mod reader;
mod shape;
mod sky;
mod sphere;
mod split;
mod value;

use std::collections::BTreeMap;
use std::path::Path;

use glam::DVec3;
use rayon::prelude::*;
use serde::Deserialize;
use spherule_kernel::Material;
use toml::Spanned;

use super::text::read_text;
use crate::error::{Result, SceneError};
use crate::look;
use crate::read::particles::Atom;
use crate::scene::surroundings::Lens;
use crate::scene::{Scene, World, limits, origin};
use camera::CameraTable;
use fog::FogTable;
use image::ImageTable;
use light::LightTable;
use material::MaterialTable;
use particles::ParticlesTable;
use reader::Reader;
use shape::{BoxTable, CapsuleTable, ConeTable, CylinderTable, DiscTable, EllipsoidTable};
use sky::SkyTable;
use sphere::{Known, Row, SphereTable};
use split::{Batch, Piece, SplitText};

/// The file without its `[[sphere]]` tables; every value keeps its span.
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
    #[serde(default, rename = "capsule")]
    capsules: Vec<Spanned<CapsuleTable>>,
    #[serde(default, rename = "cylinder")]
    cylinders: Vec<Spanned<CylinderTable>>,
    #[serde(default, rename = "cone")]
    cones: Vec<Spanned<ConeTable>>,
    #[serde(default, rename = "ellipsoid")]
    ellipsoids: Vec<Spanned<EllipsoidTable>>,
    #[serde(default, rename = "box")]
    boxes: Vec<Spanned<BoxTable>>,
    #[serde(default, rename = "disc")]
    discs: Vec<Spanned<DiscTable>>,
    particles: Option<ParticlesTable>,
    #[serde(default, rename = "light")]
    lights: Vec<LightTable>,
    sky: Option<Spanned<SkyTable>>,
    fog: Option<Spanned<FogTable>>,
}

/// Reads the scene at `path`. Relative names in it start from its directory.
pub(super) fn load(path: &Path) -> Result<Scene> {
    parse(path, read_text(path)?)
}

/// Parses `text`, the content of the file at `path`, into a scene.
///
/// # Errors
///
/// [`Error::Scene`](crate::Error::Scene) with the place of the error.
pub fn parse(path: &Path, text: String) -> Result<Scene> {
    let split = SplitText::of(&text);
    let reader = Reader {
        path,
        text: &text,
        pieces: &split.others,
        origin: DVec3::ZERO,
    };
    if split.others_length() > MAX_TEXT {
        let last = Piece::whole(text.len()..text.len());
        return Err(Reader {
            pieces: &[last],
            ..reader
        }
        .wrong_at(
            0..0,
            format!("the file has more than {MAX_TEXT} bytes besides its [[sphere]] tables"),
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
            pieces: &[place],
            ..reader
        }
        .wrong_at(
            0.."[[sphere]]".len(),
            "there is already a list of spheres",
            "a table of another sphere",
            "write all spheres as [[sphere]] tables, or all in one list",
        )
        .into());
    }
    let atoms = match &file.particles {
        Some(particles) => Some(reader.atoms(&particles.file)?),
        None => None,
    };
    let scene = |origin| Reader { origin, ..reader }.scene(&file, &split.spheres, atoms.as_deref());
    // What the file shows is near the scene's origin, so that 32-bit floats hold it as it is.
    let (origin, unmoved) = match (&file.camera, &atoms) {
        (Some(camera), _) => (reader.origin_near(camera.get_ref()), None),
        (None, Some(atoms)) => (look::origin(atoms), None),
        (None, None) => {
            let unmoved = scene(DVec3::ZERO)?;
            (origin::of(&unmoved.view_or_framed()), Some(unmoved))
        }
    };
    match (origin.map(scene), unmoved) {
        (Some(Ok(moved)), _) => Ok(moved),
        // A scene as large as scenes may be does not fit around every origin.
        (_, Some(unmoved)) => Ok(unmoved),
        _ => scene(DVec3::ZERO),
    }
}

/// The most bytes of a file besides its `[[sphere]]` tables, and of one such table: parsing takes
/// about fifty times as much memory.
const MAX_TEXT: usize = 1 << 24;
/// Batches of `[[sphere]]` tables that are parsed, each by a thread, before their spheres are kept:
/// a parsed table is forty times as large as its text.
const AT_ONCE: usize = 64;

impl Reader<'_> {
    fn scene(&self, file: &File, spheres: &[Batch], atoms: Option<&[Atom]>) -> Result<Scene> {
        let lens = match &file.camera {
            Some(camera) => self.lens(camera.get_ref())?,
            None => Lens::default(),
        };
        let mut scene = Scene::new(self.world(file, spheres, atoms, lens.shutter)?);
        scene.origin = self.origin;
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

    fn world(
        &self,
        file: &File,
        batches: &[Batch],
        atoms: Option<&[Atom]>,
        shutter: (f32, f32),
    ) -> Result<World> {
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
        for table in &file.capsules {
            self.shape(table, &known, &mut world, &mut grey)?;
        }
        for table in &file.cylinders {
            self.shape(table, &known, &mut world, &mut grey)?;
        }
        for table in &file.cones {
            self.shape(table, &known, &mut world, &mut grey)?;
        }
        for table in &file.ellipsoids {
            self.shape(table, &known, &mut world, &mut grey)?;
        }
        for table in &file.boxes {
            self.shape(table, &known, &mut world, &mut grey)?;
        }
        for table in &file.discs {
            self.shape(table, &known, &mut world, &mut grey)?;
        }
        if let Some(atoms) = atoms {
            world.append(&look::world(atoms, self.origin));
            self.count(&world)?;
        }
        if world.spheres.is_empty() && world.shapes.is_empty() {
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
}

#[cfg(test)]
mod tests;
