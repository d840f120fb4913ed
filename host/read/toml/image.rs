//! The table `[image]`.

use serde::Deserialize;
use spherule_kernel::filter::Filter;
use toml::Spanned;

use super::reader::Reader;
use super::value::Value;
use crate::error::Result;
use crate::scene::surroundings::Tonemap;
use crate::scene::{GlassShadows, Scene, limits};

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
    pub(super) glass_shadows: Option<Spanned<Value>>,
    pub(super) clamp: Option<Spanned<Value>>,
    pub(super) filter: Option<Spanned<Value>>,
    pub(super) filter_width: Option<Spanned<Value>>,
    pub(super) caustics: Option<Spanned<Value>>,
    pub(super) seed: Option<Spanned<Value>>,
    pub(super) exposure: Option<Spanned<Value>>,
    pub(super) tonemap: Option<Spanned<Value>>,
}

impl Reader<'_> {
    pub(super) fn image(&self, table: &ImageTable, scene: &mut Scene) -> Result<()> {
        if let Some(transparent) = &table.transparent {
            scene.transparent = self.truth("transparent", transparent)?;
        }
        if let Some(caustics) = &table.caustics {
            scene.sampling.caustics = self.truth("caustics", caustics)?;
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
        if let Some(shadows) = &table.glass_shadows {
            let names = [("dark", GlassShadows::Dark), ("clear", GlassShadows::Clear)];
            scene.sampling.glass_shadows = self.one_of("glass_shadows", shadows, &names)?;
        }
        if let Some(clamp) = &table.clamp {
            scene.sampling.clamp = Some(self.number("clamp", clamp, limits::CLAMP)?);
        }
        if let Some(filter) = &table.filter {
            scene.sampling.filter = self.one_of("filter", filter, &Filter::NAMED)?;
        }
        if let Some(width) = &table.filter_width {
            scene.sampling.filter.width =
                self.number("filter_width", width, limits::FILTER_WIDTH)?;
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
