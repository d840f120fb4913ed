//! The tables `[[light]]`.

use glam::Vec3;
use serde::Deserialize;
use spherule_kernel::{Material, Sphere};
use toml::Spanned;

use super::reader::Reader;
use super::value::Value;
use crate::error::Result;
use crate::scene::surroundings::PointLight;
use crate::scene::{Scene, limits};

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct LightTable {
    pub(super) position: Spanned<Value>,
    pub(super) intensity: Spanned<Value>,
    pub(super) radius: Option<Spanned<Value>>,
}

impl Reader<'_> {
    pub(super) fn light(&self, table: &LightTable, scene: &mut Scene) -> Result<()> {
        let position = self.point("position", &table.position)?;
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
}
