//! The table `[particles]`.

use serde::Deserialize;
use toml::Spanned;

use super::reader::Reader;
use super::value::Value;
use crate::error::{Error, Result};
use crate::read::particles::{self, Atom, ParticleFormat};
use crate::shown::shown;

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct ParticlesTable {
    pub(super) file: Spanned<Value>,
}

impl Reader<'_> {
    /// The atoms of a file of particles.
    pub(super) fn atoms(&self, file: &Spanned<Value>) -> Result<Vec<Atom>> {
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
        format.load(&path).map_err(|error| match error {
            // A missing file is an error in the scene. For an invalid one, the place in the file
            // says more than its name here.
            Error::Scene(inner) if inner.place.is_none() => self
                .wrong(file, inner.to_string(), "named here", inner.help)
                .into(),
            other => other,
        })
    }
}
