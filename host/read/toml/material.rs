//! The tables `[materials.NAME]`.

use glam::Vec3;
use serde::Deserialize;
use spherule_kernel::Material;
use toml::Spanned;

use super::reader::Reader;
use super::value::Value;
use crate::error::{Error, Result};
use crate::scene::limits;

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct MaterialTable {
    pub(super) kind: Spanned<Value>,
    pub(super) color: Option<Spanned<Value>>,
    pub(super) roughness: Option<Spanned<Value>>,
    pub(super) index: Option<Spanned<Value>>,
    pub(super) absorption: Option<Spanned<Value>>,
    pub(super) thickness: Option<Spanned<Value>>,
    pub(super) strength: Option<Spanned<Value>>,
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum MaterialKind {
    Diffuse,
    Metal,
    Glass,
    Emissive,
}

impl Reader<'_> {
    /// A material, and the thickness of its shell if it is hollow.
    pub(super) fn material(
        &self,
        table: &Spanned<MaterialTable>,
    ) -> Result<(Material, Option<f32>)> {
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
}
