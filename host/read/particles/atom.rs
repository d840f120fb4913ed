//! [`Atom`], and errors in a line of a molecule file.

use std::path::Path;

use glam::DVec3;

use super::elements::Element;
use crate::error::{Error, Place, SceneError};
use crate::scene::limits::MAX_LENGTH;

/// An atom of a molecule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Atom {
    /// The position, in ångström.
    pub position: DVec3,
    /// The element.
    pub element: &'static Element,
}

/// Whether an atom may have this coordinate. Near the limit its radius is smaller than the spacing
/// of floats.
pub(super) fn is_coordinate(number: f64) -> bool {
    number.abs() < f64::from(MAX_LENGTH)
}

/// The help for coordinates out of range.
pub(super) const TOO_FAR: &str = "give coordinates in ångström, below 1e18";

/// An error in a line of a molecule file.
#[derive(Debug)]
pub struct WrongLine {
    /// The number of the line, counted from zero.
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
