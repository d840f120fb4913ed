//! The table `[fog]`.

use glam::Vec3;
use serde::Deserialize;
use spherule_kernel::fog::Fog;
use toml::Spanned;

use super::reader::Reader;
use super::value::Value;
use crate::error::Result;
use crate::scene::limits;
use crate::scene::surroundings::FogBall;

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct FogTable {
    pub(super) extinction: Spanned<Value>,
    pub(super) albedo: Option<Spanned<Value>>,
    pub(super) anisotropy: Option<Spanned<Value>>,
    pub(super) center: Option<Spanned<Value>>,
    pub(super) radius: Option<Spanned<Value>>,
}

impl Reader<'_> {
    pub(super) fn fog(&self, fog: &FogTable) -> Result<FogBall> {
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
                    Some(center) => self.point("center", center)?,
                    None => (-self.origin).as_vec3(),
                },
                radius: number("radius", &fog.radius, limits::RADIUS, 0.0)?,
                albedo,
                extinction: self.number("extinction", &fog.extinction, limits::EXTINCTION)?,
                anisotropy: number("anisotropy", &fog.anisotropy, limits::ANISOTROPY, 0.0)?,
                ..Fog::default()
            },
        })
    }
}
