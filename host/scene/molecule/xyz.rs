//! Atoms from the XYZ format: a count, a comment, then one atom a line.
//!
//! An atom is an element (symbol or atomic number) and three coordinates in ångström; what
//! follows on its line is ignored. Of several frames the first is read. The column order of
//! "extended XYZ" is honoured as far as element and position come first, as they do by default.

use glam::Vec3;

use super::elements::{self, Element};
use super::{Atom, WrongLine};
use crate::scene::MAX_LENGTH;

/// Reads the atoms of the first frame of an XYZ file.
///
/// # Errors
///
/// The first line that is wrong.
pub fn parse(text: &str) -> Result<Vec<Atom>, WrongLine> {
    let text = text.trim_start_matches('\u{feff}');
    let mut lines = text.lines().enumerate();
    let (_, first) = lines.next().unwrap_or((0, ""));
    let count: usize = first.trim().parse().map_err(|_| {
        WrongLine::new(
            0,
            "an XYZ file starts with the number of its atoms",
            "not a whole number",
            "write the number of atoms on the first line and a comment on the second",
        )
    })?;
    if count == 0 {
        return Err(WrongLine::new(
            0,
            "the file has no atoms",
            "zero atoms",
            "give at least one atom",
        ));
    }
    if let Some((_, comment)) = lines.next()
        && let Some(properties) = comment.split("Properties=").nth(1)
        && !properties
            .trim_start_matches('"')
            .starts_with("species:S:1:pos:R:3")
    {
        return Err(WrongLine::new(
            1,
            "the columns are in an order that spherule does not read",
            "element and position do not come first",
            "write the file with Properties=species:S:1:pos:R:3 first",
        ));
    }

    let mut atoms = Vec::new();
    let mut dummies = 0;
    let mut last = 1;
    for (number, line) in lines.take(count) {
        last = number;
        let mut fields = line.split_whitespace();
        let Some(symbol) = fields.next() else {
            return Err(missing(number, count, number - 2));
        };
        let mut coordinates = [0.0; 3];
        for coordinate in &mut coordinates {
            *coordinate = fields.next().and_then(number_of).ok_or_else(|| {
                WrongLine::new(
                    number,
                    "an atom needs an element and three coordinates",
                    "a coordinate is missing, no number, or too large",
                    "write lines like: C 0.0 1.2 -3.4",
                )
            })?;
        }
        match element(symbol) {
            Some(element) => atoms.push(Atom {
                position: Vec3::from_array(coordinates),
                element,
            }),
            None if matches!(symbol, "X" | "x" | "Xx" | "XX" | "0") => dummies += 1,
            None => atoms.push(Atom {
                position: Vec3::from_array(coordinates),
                element: &elements::UNKNOWN,
            }),
        }
    }
    if atoms.len() + dummies < count {
        return Err(missing(last, count, atoms.len() + dummies));
    }
    if dummies > 0 {
        tracing::warn!("{dummies} dummy atoms are left out");
    }
    if atoms.is_empty() {
        return Err(WrongLine::new(
            0,
            "the file has dummy atoms only",
            "nothing to draw",
            "give at least one atom",
        ));
    }
    Ok(atoms)
}

fn missing(line: usize, expected: usize, found: usize) -> WrongLine {
    WrongLine::new(
        line,
        format!("the file promises {expected} atoms and holds {found}"),
        "the atoms end here",
        "the file is truncated, or the number on its first line is wrong",
    )
}

/// A number that is not too large for a scene; Fortran's `1.0D+00` counts as one.
fn number_of(text: &str) -> Option<f32> {
    let plain = text.replace(['D', 'd'], "e");
    plain
        .parse()
        .ok()
        .filter(|value: &f32| value.abs() <= MAX_LENGTH)
}

/// From `C`, `cl`, `17`, and labels such as `C12` and `Fe2+`.
fn element(text: &str) -> Option<&'static Element> {
    if let Ok(number) = text.parse::<usize>() {
        return elements::by_number(number);
    }
    let letters = text.trim_end_matches(|c: char| !c.is_ascii_alphabetic());
    let end = letters
        .find(|c: char| !c.is_ascii_alphabetic())
        .unwrap_or(letters.len());
    elements::by_symbol(&letters[..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_buckyball_is_sixty_carbons_on_a_sphere() {
        let atoms = parse(include_str!("../../../scenes/c60.xyz")).expect("C60");
        assert_eq!(atoms.len(), 60);
        for atom in &atoms {
            assert_eq!(atom.element.symbol, "C");
            assert!((atom.position.length() - 3.55).abs() < 0.05, "{atom:?}");
        }
    }

    #[test]
    fn symbols_numbers_labels_and_frames() {
        let text = "5\ncomment\nC 0 0 0 0.1 extra\ncl 1 0 0\n26 2.0D+00 0 0\nO12 3 0 0\nX 0 0 0\n1\nnext frame\nH 0 0 0\n";
        let atoms = parse(text).expect("four atoms");
        let symbols: Vec<&str> = atoms.iter().map(|atom| atom.element.symbol).collect();
        assert_eq!(symbols, ["C", "Cl", "Fe", "O"]);
        assert_eq!(atoms[2].position.x, 2.0);
    }

    #[test]
    fn mistakes_are_refused_with_their_line() {
        for (text, line) in [
            ("", 0),
            ("many\n\nC 0 0 0\n", 0),
            ("0\n\n", 0),
            ("18446744073709551615\n\nC 0 0 0\n", 2),
            ("2\n\nC 0 0 0\n", 2),
            ("2\n\nC 0 0 0\n\n", 3),
            ("1\n\nC 0 0\n", 2),
            ("1\n\nC 0 0 nan\n", 2),
            ("1\n\nC 0 0 inf\n", 2),
            ("1\nProperties=pos:R:3:species:S:1\n0 0 0 C\n", 1),
        ] {
            let wrong = parse(text).expect_err(text);
            assert_eq!(wrong.line, line, "{text:?}");
        }
    }
}
