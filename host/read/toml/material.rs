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

/// A material, and for hollow glass how thick its shell is.
type Made = (Material, Option<f32>);

/// A kind of material: its name, the keys that it has, and how they become one.
struct Kind {
    name: &'static str,
    keys: &'static [&'static str],
    make: fn(&Reader<'_>, &Spanned<MaterialTable>) -> Result<Made>,
}

const KINDS: [Kind; 5] = [
    Kind {
        name: "diffuse",
        keys: &["color"],
        make: diffuse,
    },
    Kind {
        name: "metal",
        keys: &["color", "roughness"],
        make: metal,
    },
    Kind {
        name: "plastic",
        keys: &["color", "roughness", "index"],
        make: plastic,
    },
    Kind {
        name: "glass",
        keys: &["index", "absorption", "thickness"],
        make: glass,
    },
    Kind {
        name: "emissive",
        keys: &["color", "strength"],
        make: emissive,
    },
];

impl MaterialTable {
    /// Every key but the kind, with its value if it is given.
    fn keys(&self) -> [(&'static str, Option<&Spanned<Value>>); 6] {
        [
            ("color", self.color.as_ref()),
            ("roughness", self.roughness.as_ref()),
            ("index", self.index.as_ref()),
            ("absorption", self.absorption.as_ref()),
            ("thickness", self.thickness.as_ref()),
            ("strength", self.strength.as_ref()),
        ]
    }
}

impl Reader<'_> {
    pub(super) fn material(
        &self,
        table: &Spanned<MaterialTable>,
    ) -> Result<(Material, Option<f32>)> {
        let material = table.get_ref();
        let names: Vec<(&str, &Kind)> = KINDS.iter().map(|kind| (kind.name, kind)).collect();
        let kind = self.one_of("kind", &material.kind, &names)?;
        for (name, value) in material.keys() {
            if let Some(value) = value
                && !kind.keys.contains(&name)
            {
                let kinds = KINDS.map(|kind| format!("{} has {}", kind.name, listed(kind.keys)));
                return Err(self
                    .wrong(
                        value,
                        format!("a material of kind {} has no {name}", kind.name),
                        "not for this kind",
                        kinds.join("; "),
                    )
                    .into());
            }
        }
        (kind.make)(self, table)
    }

    fn color_of<'t>(&self, table: &'t Spanned<MaterialTable>) -> Result<&'t Spanned<Value>> {
        table.get_ref().color.as_ref().ok_or_else(|| {
            Error::from(self.wrong(
                table,
                "the material has no color",
                "color is missing",
                "add color = [red, green, blue]",
            ))
        })
    }

    /// A number, if it is given.
    fn number_or(
        &self,
        name: &str,
        value: Option<&Spanned<Value>>,
        range: limits::Range,
        otherwise: f32,
    ) -> Result<f32> {
        value.map_or(Ok(otherwise), |value| self.number(name, value, range))
    }
}

/// Some keys, as a sentence has them.
fn listed(keys: &[&str]) -> String {
    match keys {
        [] => "none".into(),
        [one] => (*one).into(),
        [others @ .., last] => format!("{} and {last}", others.join(", ")),
    }
}

fn diffuse(reader: &Reader<'_>, table: &Spanned<MaterialTable>) -> Result<Made> {
    let color = reader.color_of(table)?;
    let color = reader.color("color", color, limits::REFLECTANCE)?;
    Ok((Material::diffuse(color), None))
}

fn metal(reader: &Reader<'_>, table: &Spanned<MaterialTable>) -> Result<Made> {
    let keys = table.get_ref();
    let roughness = keys.roughness.as_ref();
    let roughness = reader.number_or("roughness", roughness, limits::ROUGHNESS, 0.0)?;
    let color = reader.color_of(table)?;
    let color = reader.color("color", color, limits::REFLECTANCE)?;
    Ok((Material::metal(color, roughness), None))
}

fn plastic(reader: &Reader<'_>, table: &Spanned<MaterialTable>) -> Result<Made> {
    let keys = table.get_ref();
    let roughness = keys.roughness.as_ref();
    let roughness = reader.number_or("roughness", roughness, limits::ROUGHNESS, 0.0)?;
    let index = reader.number_or("index", keys.index.as_ref(), limits::COAT_INDEX, 1.5)?;
    let color = reader.color_of(table)?;
    let color = reader.color("color", color, limits::REFLECTANCE)?;
    Ok((Material::plastic(color, roughness, index), None))
}

fn glass(reader: &Reader<'_>, table: &Spanned<MaterialTable>) -> Result<Made> {
    let keys = table.get_ref();
    let index = reader.number_or("index", keys.index.as_ref(), limits::INDEX, 1.5)?;
    let absorption = match &keys.absorption {
        Some(absorption) => reader.color("absorption", absorption, limits::ABSORPTION)?,
        None => Vec3::ZERO,
    };
    let thickness = keys.thickness.as_ref();
    let thickness = thickness
        .map(|value| reader.number("thickness", value, limits::THICKNESS))
        .transpose()?;
    Ok((Material::glass(index, absorption), thickness))
}

fn emissive(reader: &Reader<'_>, table: &Spanned<MaterialTable>) -> Result<Made> {
    let strength = table.get_ref().strength.as_ref();
    let strength = reader.number_or("strength", strength, limits::STRENGTH, 1.0)?;
    let radiance = reader.radiance("color", reader.color_of(table)?, strength)?;
    Ok((Material::emissive(radiance), None))
}
