//! [`Atom`], and what may be wrong with a line that has one.

use std::path::Path;

use glam::Vec3;

use super::elements::Element;
use crate::error::{Error, Place, SceneError};
use crate::scene::limits::MAX_LENGTH;

/// An atom of a molecule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Atom {
    /// Where it is, in ångström.
    pub position: Vec3,
    /// What it is.
    pub element: &'static Element,
}

/// Whether an atom may be so far from the origin, along an axis; its radius is less than what the
/// largest floats below the limit are apart.
pub(super) fn is_coordinate(number: f32) -> bool {
    number.abs() < MAX_LENGTH
}

/// What is said of coordinates that are none.
pub(super) const TOO_FAR: &str = "coordinates are in ångström, and below 1e18";

/// What is wrong with a line of a molecule file.
#[derive(Debug)]
pub struct WrongLine {
    /// The line, counted from zero.
    pub(super) line: usize,
    message: String,
    label: &'static str,
    help: &'static str,
}

impl WrongLine {
    pub(super) fn new(
        line: usize,
        message: impl Into<String>,
        label: &'static str,
        help: &'static str,
    ) -> Self {
        Self {
            line,
            message: message.into(),
            label,
            help,
        }
    }

    pub(super) fn into_error(self, path: &Path, text: String) -> Error {
        let start = text
            .split_inclusive('\n')
            .take(self.line)
            .map(str::len)
            .sum::<usize>()
            .min(text.len());
        let length = text[start..]
            .find(['\r', '\n'])
            .unwrap_or(text.len() - start);
        Error::Scene(Box::new(SceneError {
            path: path.into(),
            message: self.message,
            help: self.help.into(),
            place: Some(Place {
                span: start..start + length,
                text,
                label: self.label.into(),
            }),
        }))
    }
}
