//! The table `[particles]`.

use serde::Deserialize;
use toml::Spanned;

use super::reader::Reader;
use super::value::Value;
use crate::error::{Error, Result};
use crate::look;
use crate::read::particles::{self, ParticleFormat};
use crate::scene::World;
use crate::shown::shown;

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct ParticlesTable {
    pub(super) file: Spanned<Value>,
}

impl Reader<'_> {
    pub(super) fn particles(&self, file: &Spanned<Value>) -> Result<World> {
        let name = self.text("file", file)?;
        let path = self.beside(name);
        let Some(format) = ParticleFormat::of(&path) else {
            return Err(self
                .wrong(
                    file,
                    format!("{}: not a particle format that spherule reads", shown(name)),
                    "unknown format",
                    format!("give a {} file", particles::extensions()),
                )
                .into());
        };
        let atoms = format.load(&path).map_err(|error| match error {
            // A missing file is an error in the scene. For an invalid one, the place in the file
            // says more than its name here.
            Error::Scene(inner) if inner.place.is_none() => self
                .wrong(file, inner.to_string(), "named here", inner.help)
                .into(),
            other => other,
        })?;
        Ok(look::world(&atoms))
    }
}
