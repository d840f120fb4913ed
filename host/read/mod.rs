//! Readers of the files that a scene comes from.
//!
//! | module | reads |
//! | --- | --- |
//! | [`toml`] | scenes in TOML, which may name other files |
//! | [`particles`] | atoms, in one of several formats |
//! | [`environment`] | images of the surroundings |
//! | `text` | text files of any size, compressed or not |

pub mod environment;
pub mod particles;
pub(crate) mod text;
pub mod toml;

use std::path::Path;

use crate::error::{Error, Result, SceneError};
use crate::look;
use crate::scene::Scene;
use text::{COMPRESSED, extension, uncompressed};

/// The extension of scenes in TOML.
const SCENE: &str = "toml";

impl Scene {
    /// Reads a scene, or particles in one of the
    /// [`PARTICLE_FORMATS`](particles::PARTICLE_FORMATS).
    ///
    /// # Errors
    ///
    /// [`Error::Scene`] says which file is wrong, where, and how to fix it.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let mut scene = if is_scene(path) {
            toml::load(path)?
        } else if let Some(format) = particles::ParticleFormat::of(path) {
            let atoms = format.load(path)?;
            let origin = look::origin(&atoms).unwrap_or_default();
            let mut scene = Self::new(look::world(&atoms, origin));
            scene.origin = origin;
            scene
        } else {
            return Err(Error::Scene(SceneError::without_place(
                path,
                "not a file format that spherule reads",
                format!("give a {}", inputs()),
            )));
        };
        scene.sources.push(path.into());
        Ok(scene)
    }
}

/// Whether the file's name is that of a scene.
#[must_use]
pub fn is_scene(path: &Path) -> bool {
    extension(uncompressed(path)) == SCENE
}

/// The accepted inputs, for messages: `scene (.toml) or molecule (.pdb, …)`.
#[must_use]
pub fn inputs() -> String {
    let molecules = particles::extensions();
    format!("scene (.{SCENE}) or molecule ({molecules}), also compressed (.{COMPRESSED})")
}
