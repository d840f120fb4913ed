//! [`PARTICLE_FORMATS`]: the formats of particle files. Extensions, error messages and help texts
//! come from this list. Readers know nothing of a look.

mod atom;
pub mod elements;
pub mod pdb;
pub mod xyz;

use std::path::Path;

use super::text::{extension, read_text, uncompressed};
use crate::error::{Error, Result, SceneError};
use crate::plural::count_of;
use crate::scene::limits::MAX_SPHERES;

pub use atom::{Atom, WrongLine};

/// A file format.
#[derive(Clone, Copy, Debug)]
pub struct ParticleFormat {
    /// The format's name.
    pub name: &'static str,
    /// The extensions of its files, in lower case.
    pub extensions: &'static [&'static str],
    /// Reads the atoms out of a file's text.
    pub parse: fn(&str) -> std::result::Result<Vec<Atom>, WrongLine>,
}

/// Every format.
pub const PARTICLE_FORMATS: [ParticleFormat; 2] = [
    ParticleFormat {
        name: "Protein Data Bank",
        extensions: &["pdb", "ent"],
        parse: pdb::parse,
    },
    ParticleFormat {
        name: "XYZ",
        extensions: &["xyz", "extxyz"],
        parse: xyz::parse,
    },
];

impl ParticleFormat {
    /// The format that fits the file's name, if there is one: `c60.xyz`, `C60.XYZ` and `c60.xyz.gz`
    /// are XYZ.
    #[must_use]
    pub fn of(path: &Path) -> Option<&'static Self> {
        let found = extension(uncompressed(path));
        PARTICLE_FORMATS
            .iter()
            .find(|format| format.extensions.contains(&found.as_str()))
    }

    /// Reads the atoms of the file at `path`.
    ///
    /// # Errors
    ///
    /// [`Error::Scene`] with the line that is wrong, or if there are more atoms than a scene may
    /// have.
    pub fn load(&self, path: &Path) -> Result<Vec<Atom>> {
        let text = read_text(path)?;
        match (self.parse)(&text) {
            Ok(atoms) if atoms.len() > MAX_SPHERES => Err(Error::Scene(SceneError::without_place(
                path,
                format!(
                    "the file has {}, more than {MAX_SPHERES}",
                    count_of(atoms.len(), "atom")
                ),
                "render it in parts",
            ))),
            Ok(atoms) => Ok(atoms),
            Err(wrong) => Err(wrong.into_error(path, text)),
        }
    }
}

/// The extensions of all formats, for messages: `.pdb, .ent, .xyz or .extxyz`.
#[must_use]
pub fn extensions() -> String {
    let all: Vec<String> = PARTICLE_FORMATS
        .iter()
        .flat_map(|format| format.extensions)
        .map(|extension| format!(".{extension}"))
        .collect();
    match all.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_told_by_their_names() {
        let name = |path: &str| ParticleFormat::of(Path::new(path)).map(|format| format.name);
        assert_eq!(name("A.B.PDB"), Some("Protein Data Bank"));
        assert_eq!(name("x/1crn.ent.gz"), Some("Protein Data Bank"));
        assert_eq!(name("c60.extxyz"), Some("XYZ"));
        assert_eq!(name("c60.XYZ.GZ"), Some("XYZ"));
        for none in [
            "",
            "toml",
            "a.png",
            "a.gz",
            ".gz",
            "a.toml",
            "a.xyz.zip",
            "gz.gz.gz",
        ] {
            assert_eq!(name(none), None, "{none}");
        }
    }

    #[test]
    fn no_extension_is_of_two_formats() {
        let mut all: Vec<&str> = PARTICLE_FORMATS
            .iter()
            .flat_map(|it| it.extensions)
            .copied()
            .collect();
        let count = all.len();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), count);
        assert!(
            all.iter()
                .all(|extension| *extension == extension.to_lowercase())
        );
        assert_eq!(extensions(), ".pdb, .ent, .xyz or .extxyz");
    }
}
