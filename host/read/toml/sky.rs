//! The table `[sky]`.

use glam::Vec3;
use serde::Deserialize;
use toml::Spanned;

use super::reader::Reader;
use super::value::Value;
use crate::error::{Error, Result};
use crate::read::environment;
use crate::scene::limits;
use crate::scene::surroundings::{Sun, Surroundings};

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct SkyTable {
    pub(super) horizon: Option<Spanned<Value>>,
    pub(super) zenith: Option<Spanned<Value>>,
    pub(super) sun_direction: Option<Spanned<Value>>,
    pub(super) sun_size: Option<Spanned<Value>>,
    pub(super) sun_irradiance: Option<Spanned<Value>>,
    pub(super) image: Option<Spanned<Value>>,
    pub(super) strength: Option<Spanned<Value>>,
    pub(super) rotation: Option<Spanned<Value>>,
}

impl Reader<'_> {
    pub(super) fn sky(&self, table: &Spanned<SkyTable>) -> Result<Surroundings> {
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
        let sun = self.sun(sky)?;
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
        let rotation = match &sky.rotation {
            Some(value) if image.is_none() => {
                return Err(self
                    .wrong(
                        value,
                        "the sky has no image to turn",
                        "rotation without image",
                        "add `image`, or remove `rotation`",
                    )
                    .into());
            }
            Some(value) => self.number("rotation", value, limits::ROTATION)?,
            None => 0.0,
        };
        // A single colour is that of the whole sky; without any the sky is black.
        let one = horizon.or(zenith).unwrap_or(Vec3::ZERO);
        Ok(Surroundings {
            horizon: horizon.unwrap_or(one),
            zenith: zenith.unwrap_or(one),
            sun,
            image,
            rotation,
        })
    }

    /// The sun, if the table has one.
    fn sun(&self, sky: &SkyTable) -> Result<Option<Sun>> {
        let Some(direction) = &sky.sun_direction else {
            return match &sky.sun_irradiance {
                None => Ok(None),
                Some(irradiance) => Err(self
                    .wrong(
                        irradiance,
                        "the sun has no direction",
                        "a sun without sun_direction",
                        "add sun_direction, the direction towards the sun",
                    )
                    .into()),
            };
        };
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
            irradiance: match &sky.sun_irradiance {
                Some(irradiance) => self.color("sun_irradiance", irradiance, limits::IRRADIANCE)?,
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
        Ok(Some(sun))
    }
}

/// The angular diameter of the sun seen from the Earth, in degrees.
const DEFAULT_SUN_SIZE: f32 = 0.53;
