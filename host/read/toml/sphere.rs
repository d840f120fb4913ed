//! The tables `[[sphere]]`. There may be millions, so threads parse them in batches.

use serde::Deserialize;
use std::collections::BTreeMap;

use glam::Vec3;
use spherule_kernel::{Material, Sphere};
use toml::Spanned;

use super::reader::Reader;
use super::split::{Batch, Piece};
use super::value::Value;
use super::value::said;
use crate::error::{Error, Result, SceneError};
use crate::scene::{World, limits};
use crate::shown::shown;

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct SphereTable {
    pub(super) center: Spanned<Value>,
    pub(super) radius: Spanned<Value>,
    pub(super) material: Option<Spanned<Value>>,
    pub(super) velocity: Option<Spanned<Value>>,
}

/// A batch of `[[sphere]]` tables.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Spheres {
    pub(super) sphere: Vec<Spanned<SphereTable>>,
}

impl Reader<'_> {
    /// Reads a batch of `[[sphere]]` tables.
    pub(super) fn batch(&self, batch: &Batch, known: &Known<'_>) -> Result<Vec<Row>> {
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

    /// The error for a table that is too long. An open bracket or text swallows what follows it;
    /// then the error at its beginning is returned.
    pub(super) fn long_table(&self, start: usize, table: &str) -> Error {
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

    pub(super) fn sphere(&self, table: &Spanned<SphereTable>, known: &Known<'_>) -> Result<Row> {
        let table = table.get_ref();
        let (material, hollow) = match &table.material {
            Some(value) => {
                let (id, hollow) = self.named_material(value, known)?;
                (Some(id), hollow)
            }
            None => (None, None),
        };
        let sphere = Sphere::new(
            self.point("center", &table.center)?,
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

    /// The material with the name that a table gives.
    pub(super) fn named_material(
        &self,
        value: &Spanned<Value>,
        known: &Known<'_>,
    ) -> Result<NamedMaterial> {
        let name = self.text("material", value)?;
        let named = known.ids.get(name).copied();
        named.ok_or_else(|| {
            let names: Vec<&str> = known.ids.keys().copied().collect();
            let help = if names.is_empty() {
                format!(
                    "define it: [materials.{}] with kind = \"diffuse\" and color = [r, g, b]",
                    shown(name)
                )
            } else {
                format!("the scene defines {}", shown(&names.join(", ")))
            };
            let message = format!("there is no material \"{}\"", shown(name));
            self.wrong(value, message, "not defined", help).into()
        })
    }

    /// The error for what reaches, or moves, too far.
    pub(super) fn too_far(
        &self,
        place: &Spanned<Value>,
        what: &str,
        velocity: Vec3,
    ) -> Box<SceneError> {
        let how = if velocity == Vec3::ZERO {
            "reaches"
        } else {
            "reaches, or moves while the shutter is open,"
        };
        self.wrong(
            place,
            format!("this {what} {how} beyond {:e}", limits::MAX_LENGTH),
            "with its radius, too far from the origin",
            "use a larger unit of length",
        )
    }

    /// Fails for a sphere that reaches, or moves, too far.
    pub(super) fn is_within(
        &self,
        center: &Spanned<Value>,
        sphere: &Sphere,
        velocity: Vec3,
        shutter: (f32, f32),
    ) -> Result<()> {
        if limits::is_within(sphere, velocity, shutter) {
            return Ok(());
        }
        Err(self.too_far(center, "sphere", velocity).into())
    }
}

const MAX_TABLE: usize = 1 << 16;

/// A material's index; for hollow spheres also the thickness and the index of the inner material.
pub(super) type NamedMaterial = (u32, Option<(f32, u32)>);

/// What the spheres of a scene refer to.
pub(super) struct Known<'a> {
    pub(super) ids: BTreeMap<&'a str, NamedMaterial>,
    pub(super) shutter: (f32, f32),
}

impl Known<'_> {
    /// The material of what has none: `grey`, once it exists.
    pub(super) fn grey(world: &mut World, grey: &mut Option<u32>) -> u32 {
        let diffuse = Material::diffuse(Vec3::splat(0.5));
        *grey.get_or_insert_with(|| world.add_material(diffuse))
    }
}

/// A sphere as its table describes it.
pub(super) struct Row {
    pub(super) sphere: Sphere,
    /// The index of its material; `None` for grey.
    pub(super) material: Option<u32>,
    pub(super) velocity: Vec3,
    /// The inner sphere of a hollow one, and its material.
    pub(super) hollow: Option<(Sphere, u32)>,
}

impl Row {
    /// Adds the sphere to `world`. `grey` is the material of spheres without one, once it exists.
    pub(super) fn add_to(self, world: &mut World, grey: &mut Option<u32>) {
        let id = self.material.unwrap_or_else(|| Known::grey(world, grey));
        for (sphere, id) in std::iter::once((self.sphere, id)).chain(self.hollow) {
            if self.velocity == Vec3::ZERO {
                world.add(sphere, id);
            } else {
                world.add_moving(sphere, id, self.velocity);
            }
        }
    }
}
