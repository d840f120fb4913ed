//! Checks values, and reports errors with their place.

use std::ops::Range;
use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3};
use serde::de::DeserializeOwned;
use toml::Spanned;

use super::split::Piece;
use super::value::{DATE, Value, said};
use crate::error::{Error, Place, Result, SceneError};
use crate::plural::count_of;
use crate::scene::limits;
use crate::shown::{shown, shown_up_to};

/// Checks values of a text.
#[derive(Clone, Copy)]
pub(super) struct Reader<'a> {
    pub(super) path: &'a Path,
    pub(super) text: &'a str,
    /// The parts of the text that were parsed.
    pub(super) pieces: &'a [Piece],
    /// The point of the file's coordinates that becomes the scene's origin.
    pub(super) origin: DVec3,
}

impl Reader<'_> {
    /// Parses a text that was joined from the pieces.
    pub(super) fn read<T: DeserializeOwned>(&self, text: &str) -> Result<T> {
        toml::from_str(text).map_err(|error| {
            let message = plain(error.message().trim());
            let help = help_for_toml(&message);
            let message = shown_up_to(&message, 400).into_owned();
            // The parser does not give every error a place.
            let Some(span) = error.span() else {
                return SceneError::without_place(self.path, message, help).into();
            };
            self.wrong_at(span, message, "here", help).into()
        })
    }

    /// The path of a file that the scene names; relative names start from the scene's directory.
    pub(super) fn beside(&self, name: &str) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(name)
    }

    /// A value that is true or false.
    pub(super) fn truth(&self, name: &str, value: &Spanned<Value>) -> Result<bool> {
        match value.get_ref() {
            Value::Truth(truth) => Ok(*truth),
            _ => Err(self.not_a(name, value, "true or false")),
        }
    }

    /// The error for a value that is not what is `wanted`.
    pub(super) fn not_a(&self, name: &str, value: &Spanned<Value>, wanted: &str) -> Error {
        let (said, value_kind) = (value.get_ref().said(), value.get_ref());
        let help = match value_kind {
            Value::Text(text)
                if text.trim().parse::<f64>().is_ok() && wanted.contains("number") =>
            {
                "write it without quotes".into()
            }
            Value::Whole(_) | Value::Number(_) if wanted == "a text" => "write it in quotes".into(),
            _ => format!("give {wanted}"),
        };
        self.wrong(
            value,
            format!("{name} is {said}, not {wanted}"),
            format!("not {wanted}"),
            help,
        )
        .into()
    }

    pub(super) fn text<'v>(&self, name: &str, value: &'v Spanned<Value>) -> Result<&'v str> {
        match value.get_ref() {
            Value::Text(text) => Ok(text),
            _ => Err(self.not_a(name, value, "a text")),
        }
    }

    /// The meaning of one of these texts.
    pub(super) fn one_of<T: Copy>(
        &self,
        name: &str,
        value: &Spanned<Value>,
        texts: &[(&str, T)],
    ) -> Result<T> {
        let text = self.text(name, value)?;
        if let Some((_, meaning)) = texts.iter().find(|(known, _)| *known == text) {
            return Ok(*meaning);
        }
        let known: Vec<String> = texts
            .iter()
            .map(|(text, _)| format!("\"{text}\""))
            .collect();
        Err(self
            .wrong(
                value,
                format!("there is no {name} \"{}\"", shown(text)),
                "unknown",
                format!("give one of {}", known.join(", ")),
            )
            .into())
    }

    pub(super) fn whole(
        &self,
        name: &str,
        value: &Spanned<Value>,
        low: u32,
        high: u32,
    ) -> Result<u32> {
        let out_of_range = || {
            self.wrong(
                value,
                format!("{name} = {} is not possible", value.get_ref().said()),
                "out of range",
                format!("give a whole number from {low} to {high}"),
            )
            .into()
        };
        match value.get_ref() {
            Value::Whole(whole) => u32::try_from(*whole)
                .ok()
                .filter(|whole| (low..=high).contains(whole))
                .ok_or_else(out_of_range),
            // Integers that do not fit into 64 bits.
            Value::Number(number) if number.abs() >= 1e18 => Err(out_of_range()),
            _ => Err(self.not_a(name, value, "a whole number")),
        }
    }

    pub(super) fn number(
        &self,
        name: &str,
        value: &Spanned<Value>,
        range: limits::Range,
    ) -> Result<f32> {
        let Some(number) = value.get_ref().number() else {
            return Err(self.not_a(name, value, "a number"));
        };
        if range.holds(number as f32) {
            return Ok(number as f32);
        }
        Err(self
            .wrong(
                value,
                format!("{name} = {} is not possible", said(number)),
                "out of range",
                format!("give a number {range}"),
            )
            .into())
    }

    pub(super) fn side(&self, name: &str, value: &Spanned<Value>) -> Result<u32> {
        self.whole(name, value, 1, limits::MAX_IMAGE_SIDE)
    }

    /// Three numbers within the range of coordinates.
    pub(super) fn vector(&self, name: &str, value: &Spanned<Value>) -> Result<Vec3> {
        Ok(self.coordinates(name, value)?.as_vec3())
    }

    /// A point, in the coordinates of the scene.
    pub(super) fn point(&self, name: &str, value: &Spanned<Value>) -> Result<Vec3> {
        Ok((self.coordinates(name, value)? - self.origin).as_vec3())
    }

    /// As [`Reader::vector`], and in the coordinates of the file, not yet rounded.
    pub(super) fn coordinates(&self, name: &str, value: &Spanned<Value>) -> Result<DVec3> {
        let vector = self.numbers(name, value)?;
        if !limits::COORDINATE.holds_all(vector.as_vec3()) {
            return Err(self
                .wrong(
                    value,
                    format!("{name} is too large"),
                    "out of range",
                    format!(
                        "give numbers {}: use a larger unit of length",
                        limits::COORDINATE
                    ),
                )
                .into());
        }
        Ok(vector)
    }

    /// Three finite numbers.
    fn three(&self, name: &str, value: &Spanned<Value>) -> Result<Vec3> {
        Ok(self.numbers(name, value)?.as_vec3())
    }

    /// Three numbers that are finite as 32-bit floats, too, not yet rounded.
    fn numbers(&self, name: &str, value: &Spanned<Value>) -> Result<DVec3> {
        let numbers = match value.get_ref() {
            Value::List(numbers, None) => numbers,
            Value::List(_, Some(other)) => {
                return Err(self
                    .wrong(
                        value,
                        format!("{name} holds {other}, not three numbers"),
                        "not three numbers",
                        "give three numbers: [x, y, z], or [red, green, blue]",
                    )
                    .into());
            }
            _ => return Err(self.not_a(name, value, "a list of three numbers")),
        };
        let Ok(vector) = <[f64; 3]>::try_from(&numbers[..]).map(DVec3::from_array) else {
            let count = count_of(numbers.len(), "number");
            return Err(self
                .wrong(
                    value,
                    format!("{name} has {count}"),
                    "not three",
                    "give three numbers: [x, y, z], or [red, green, blue]",
                )
                .into());
        };
        if !vector.as_vec3().is_finite() {
            return Err(self
                .wrong(
                    value,
                    format!("{name} is not finite"),
                    "NaN, infinite or too large",
                    "give three numbers that 32-bit floats can hold",
                )
                .into());
        }
        Ok(vector)
    }

    /// Linear red, green and blue, each within the range.
    pub(super) fn color(
        &self,
        name: &str,
        value: &Spanned<Value>,
        range: limits::Range,
    ) -> Result<Vec3> {
        let color = self.three(name, value)?;
        if range.holds_all(color) {
            return Ok(color);
        }
        let (message, label) = if color.min_element() < range.low {
            (format!("{name} has a channel below zero"), "negative")
        } else if range == limits::REFLECTANCE {
            (
                format!("{name} has a channel above one"),
                "reflects more light than it receives",
            )
        } else {
            (
                format!("{name} has a channel above {:e}", range.high),
                "too large",
            )
        };
        let help = if range == limits::REFLECTANCE {
            "give linear red, green and blue between 0 and 1 (divide 8-bit values by 255 and undo the sRGB curve)".into()
        } else {
            format!("give linear red, green and blue, each {range}")
        };
        Err(self.wrong(value, message, label, help).into())
    }

    /// A radiance times a strength.
    pub(super) fn radiance(
        &self,
        name: &str,
        value: &Spanned<Value>,
        strength: f32,
    ) -> Result<Vec3> {
        let radiance = self.color(name, value, limits::RADIANCE)? * strength;
        if limits::RADIANCE.holds_all(radiance) {
            return Ok(radiance);
        }
        Err(self
            .wrong(
                value,
                format!("{name} times a strength of {strength:e} is too bright"),
                "too large",
                format!(
                    "give a smaller strength: the product is at most {:e}",
                    limits::MAX_RADIANCE
                ),
            )
            .into())
    }

    pub(super) fn wrong<T>(
        &self,
        value: &Spanned<T>,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) -> Box<SceneError> {
        self.wrong_at(value.span(), message, label, help)
    }

    /// The error at these bytes of the parsed text.
    pub(super) fn wrong_at(
        &self,
        span: Range<usize>,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) -> Box<SceneError> {
        Box::new(SceneError {
            path: self.path.into(),
            message: message.into(),
            help: help.into(),
            place: Some(Place {
                text: self.text.to_owned(),
                span: self.in_file(span.start)
                    ..self.in_file(span.end).max(self.in_file(span.start)),
                label: label.into(),
            }),
        })
    }

    /// The position in the file of a byte of the parsed text.
    fn in_file(&self, at: usize) -> usize {
        let piece = self.pieces.iter().rev().find(|piece| piece.start <= at);
        piece.map_or(at, |piece| piece.range.start + (at - piece.start))
    }
}

fn help_for_toml(message: &str) -> String {
    if message.contains("unknown field") {
        "check the spelling; docs/scenes.md lists every key".into()
    } else if message.contains("missing field") {
        "add it; docs/scenes.md lists every key".into()
    } else {
        "the README shows a whole scene; tables are [name], spheres are [[sphere]], texts are in quotes".into()
    }
}

/// The messages of serde and of the parser in plain words.
fn plain(message: &str) -> String {
    let mut message = message.to_owned();
    if message.contains(DATE) {
        return "this is a date or time, not a table".into();
    }
    for (theirs, ours) in [
        ("invalid type: ", "this is "),
        (", expected a sequence", ", not a list"),
        (", expected a table", ", not a table"),
        (", expected a map", ", not a table"),
        ("integer `", "the whole number `"),
        ("floating point `", "the number `"),
        ("boolean `", "`"),
        ("this is string ", "this is the text "),
        ("this is map", "this is a table"),
        ("this is sequence", "this is a list"),
        ("recursion limit", "a key has more than 80 parts"),
    ] {
        message = message.replacen(theirs, ours, 1);
    }
    message
}
