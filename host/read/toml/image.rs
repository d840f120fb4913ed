//! The table `[image]`.

use serde::Deserialize;
use toml::Spanned;

use super::reader::Reader;
use super::value::Value;
use crate::error::Result;
use crate::scene::surroundings::Tonemap;
use crate::scene::{Scene, limits};

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct ImageTable {
    pub(super) width: Option<Spanned<Value>>,
    pub(super) height: Option<Spanned<Value>>,
    pub(super) background: Option<Spanned<Value>>,
    pub(super) transparent: Option<Spanned<Value>>,
    pub(super) samples: Option<Spanned<Value>>,
    pub(super) max_bounces: Option<Spanned<Value>>,
    pub(super) ambient_occlusion: Option<Spanned<Value>>,
    pub(super) seed: Option<Spanned<Value>>,
    pub(super) exposure: Option<Spanned<Value>>,
    pub(super) tonemap: Option<Spanned<Value>>,
}

impl Reader<'_> {
    pub(super) fn image(&self, table: &ImageTable, scene: &mut Scene) -> Result<()> {
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
}
