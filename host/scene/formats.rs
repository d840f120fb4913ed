//! [`FORMATS`]: the kinds of files that scenes and particles are read from. What is known of them anywhere, their extensions, what is
//! said where none fits, and the words of the command line, comes from this list.

use std::path::Path;

use super::molecule::{Atom, WrongLine, pdb, xyz};
use super::{Scene, toml_file};
use crate::error::Result;

/// A kind of file.
#[derive(Clone, Copy, Debug)]
pub struct Format {
    /// Its name.
    pub name: &'static str,
    /// The extensions of its files, in lower case.
    pub extensions: &'static [&'static str],
    /// What is in them, and how that is read.
    pub contents: Contents,
}

/// What is in a file, and what reads it.
#[derive(Clone, Copy, Debug)]
pub enum Contents {
    /// A scene, which may name other files.
    Scene(fn(&Path) -> Result<Scene>),
    /// Atoms, out of the file's text.
    Atoms(fn(&str) -> std::result::Result<Vec<Atom>, WrongLine>),
}

/// All of them.
pub const FORMATS: [Format; 3] = [
    Format {
        name: "scene",
        extensions: &["toml"],
        contents: Contents::Scene(toml_file::load),
    },
    Format {
        name: "Protein Data Bank",
        extensions: &["pdb", "ent"],
        contents: Contents::Atoms(pdb::parse),
    },
    Format {
        name: "XYZ",
        extensions: &["xyz", "extxyz"],
        contents: Contents::Atoms(xyz::parse),
    },
];

/// The extension of files that hold another file compressed, which every reader of text takes.
const COMPRESSED: &str = "gz";

impl Format {
    /// The format of a file by its name, where one fits: `c60.xyz`, `C60.XYZ` and `c60.xyz.gz` are XYZ.
    #[must_use]
    pub fn of(path: &Path) -> Option<&'static Self> {
        let found = extension(uncompressed(path));
        FORMATS
            .iter()
            .find(|format| format.extensions.contains(&found.as_str()))
    }

    /// Whether its files hold atoms.
    #[must_use]
    pub fn has_atoms(&self) -> bool {
        matches!(self.contents, Contents::Atoms(_))
    }
}

fn extension(path: &Path) -> String {
    let extension = path.extension().unwrap_or_default();
    extension.to_string_lossy().to_lowercase()
}

/// The name of what a compressed file holds; that of another file as it is.
pub(crate) fn uncompressed(path: &Path) -> &Path {
    match path.file_stem() {
        Some(inner) if extension(path) == COMPRESSED => Path::new(inner),
        _ => path,
    }
}

/// The extensions of formats with atoms, or of those without, as a sentence has them: `.pdb, .ent, .xyz or .extxyz`.
#[must_use]
pub fn extensions(with_atoms: bool) -> String {
    let all: Vec<String> = FORMATS
        .iter()
        .filter(|format| format.has_atoms() == with_atoms)
        .flat_map(|format| format.extensions)
        .map(|extension| format!(".{extension}"))
        .collect();
    match all.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => String::new(),
    }
}

/// What may be given where a scene is asked for: `scene (.toml) or molecule (.pdb, …)`.
#[must_use]
pub fn inputs() -> String {
    format!(
        "scene ({}) or molecule ({}), also compressed (.{COMPRESSED})",
        extensions(false),
        extensions(true)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_told_by_their_names() {
        let name = |path: &str| Format::of(Path::new(path)).map(|format| format.name);
        assert_eq!(name("a.toml"), Some("scene"));
        assert_eq!(name("A.B.PDB"), Some("Protein Data Bank"));
        assert_eq!(name("x/1crn.ent.gz"), Some("Protein Data Bank"));
        assert_eq!(name("c60.extxyz"), Some("XYZ"));
        assert_eq!(name("c60.XYZ.GZ"), Some("XYZ"));
        for none in ["", "toml", "a.png", "a.gz", ".gz", "a.toml.zip", "gz.gz.gz"] {
            assert_eq!(name(none), None, "{none}");
        }
    }

    #[test]
    fn no_extension_is_of_two_formats() {
        let mut all: Vec<&str> = FORMATS
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
        assert_eq!(extensions(true), ".pdb, .ent, .xyz or .extxyz");
        assert_eq!(extensions(false), ".toml");
    }
}
