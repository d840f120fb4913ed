//! Atoms from the Protein Data Bank's fixed-column format (versions 1 to 3.3).
//!
//! | columns | content |
//! | --- | --- |
//! | 1–6 | record name: `ATOM`, `HETATM`, `ENDMDL`, `END`, … |
//! | 13–16 | atom name, its element right-justified in 13–14 |
//! | 17 | alternate location |
//! | 18–20 | residue name |
//! | 22–27 | chain, residue number, insertion code |
//! | 31–54 | x, y and z in ångström, eight columns each |
//! | 77–78 | element, in files from 1996 on |
//!
//! Only what an image needs is read: the first model, and of alternate locations the one that comes
//! first in its residue. Serial numbers, occupancies and unknown records are ignored, because real
//! files put all sorts of things there. A file that starts as an entry of the Data Bank must end as
//! one, with `END`.

use std::collections::HashMap;

use glam::DVec3;

use super::atom::{Atom, TOO_FAR, WrongLine, is_coordinate};
use super::elements::{self, Element};

/// Reads the atoms of a PDB file.
///
/// # Errors
///
/// The first line that is wrong.
pub fn parse(text: &str) -> Result<Vec<Atom>, WrongLine> {
    let mut atoms = Vec::new();
    let mut entry_id = "";
    let mut first_location: HashMap<&[u8], u8> = HashMap::new();
    let mut last_line = 0;
    let mut is_ended = false;
    let text = text.trim_start_matches('\u{feff}');
    for (number, line) in text.lines().enumerate() {
        last_line = number;
        let line = Record(line.as_bytes());
        match line.text(1, 6).trim_end() {
            "HEADER" => entry_id = line.text(63, 66),
            "ATOM" | "HETATM" => {
                let position = position(&line, number)?;
                let location = line.byte(17);
                let is_first = location == b' '
                    || *first_location.entry(line.bytes(22, 27)).or_insert(location) == location;
                if is_first {
                    let element = element(&line, entry_id).unwrap_or(&elements::UNKNOWN);
                    atoms.push(Atom { position, element });
                }
            }
            "ENDMDL" | "END" => {
                is_ended = true;
                break;
            }
            "MODEL" if !atoms.is_empty() => break,
            _ if is_misplaced_atom(line.0) => {
                return Err(WrongLine::new(
                    number,
                    "the record name of this atom is not in its columns",
                    "neither `ATOM  ` nor `HETATM`",
                    "write ATOM or HETATM in capitals from column 1, with two blanks after ATOM",
                ));
            }
            _ => {}
        }
    }
    // Programs write files without END. The Data Bank, whose files have a HEADER, does not.
    if !entry_id.is_empty() && !is_ended {
        return Err(WrongLine::new(
            last_line,
            "the entry stops before its END record",
            "end of the file",
            "the file is truncated: get it again, or add a line END if it is complete",
        ));
    }
    if atoms.is_empty() {
        return Err(WrongLine::new(
            last_line,
            "the file has no atoms",
            "end of the file",
            "a PDB file holds ATOM or HETATM records; mmCIF files (.cif) must be converted first",
        ));
    }
    Ok(atoms)
}

/// Whether a line without a record name in its columns was meant to be an atom.
fn is_misplaced_atom(line: &[u8]) -> bool {
    let line = line.trim_ascii_start();
    ["ATOM", "HETATM"].iter().any(|name| {
        line.split_at_checked(name.len())
            .is_some_and(|(start, rest)| {
                start.eq_ignore_ascii_case(name.as_bytes())
                    && rest
                        .first()
                        .is_some_and(|next| next.is_ascii_digit() || next.is_ascii_whitespace())
            })
    })
}

fn position(line: &Record<'_>, number: usize) -> Result<DVec3, WrongLine> {
    if line.0.len() < 54 {
        return Err(WrongLine::new(
            number,
            "the line of an atom ends before its coordinates",
            "ends before column 54",
            "the file is truncated: get it again; coordinates are in columns 31 to 54",
        ));
    }
    let coordinate = |from: usize| {
        line.text(from, from + 7)
            .trim()
            .parse::<f64>()
            .ok()
            .ok_or_else(|| {
                WrongLine::new(
                    number,
                    format!("columns {from} to {} do not hold a coordinate", from + 7),
                    "not a number",
                    "coordinates are decimal numbers in columns 31–38, 39–46 and 47–54; shift the line into its columns",
                )
            })
            .and_then(|value| {
                if is_coordinate(value) {
                    return Ok(value);
                }
                Err(WrongLine::new(
                    number,
                    format!("columns {from} to {} hold a coordinate out of range: {value:e}", from + 7),
                    "too far away, or not finite",
                    TOO_FAR,
                ))
            })
    };
    Ok(DVec3::new(
        coordinate(31)?,
        coordinate(39)?,
        coordinate(47)?,
    ))
}

/// The atom's element: from its own columns if the file has them, else from the atom's name.
fn element(line: &Record<'_>, entry_id: &str) -> Option<&'static Element> {
    // Before 1996 columns 73–80 held the entry's name and a line number.
    let is_old_layout = !entry_id.trim().is_empty() && line.text(73, 76) == entry_id;
    if !is_old_layout && let Some(element) = elements::by_symbol(line.text(77, 78).trim()) {
        return Some(element);
    }

    // Two letters at the start of an atom's name are an element only for these. Otherwise they are
    // an element and a position in the residue (CD: delta carbon, HG: gamma hydrogen), or a
    // position and an element (AC1 and NP of a nucleotide).
    const TWO_LETTERS: &[&str] = &[
        "AL", "AS", "AG", "AU", "BA", "BE", "BR", "CA", "CD", "CL", "CO", "CR", "CS", "CU", "FE",
        "GA", "HG", "IN", "KR", "LI", "MG", "MN", "MO", "NA", "NI", "PB", "PD", "PT", "RB", "RE",
        "RH", "RU", "SE", "SI", "SM", "SR", "TE", "TI", "TL", "XE", "YB", "ZN", "ZR",
    ];
    let name = line.bytes(13, 14);
    let pair = line.text(13, 14);
    let letter = |byte: &[u8]| std::str::from_utf8(byte).ok().and_then(elements::by_symbol);
    if matches!(name, [b' ' | b'0'..=b'9', _]) {
        return letter(&name[1..]);
    }
    let is_hetero = line.text(1, 6) == "HETATM";
    let residue = line.text(18, 20);
    if pair == "SE" && residue.trim() == "MSE" {
        return elements::by_symbol("SE");
    }
    let third_is_letter = line.byte(15).is_ascii_alphabetic();
    if is_hetero
        && TWO_LETTERS.contains(&pair.to_ascii_uppercase().as_str())
        && (residue.trim().eq_ignore_ascii_case(pair) || !third_is_letter)
    {
        return elements::by_symbol(pair);
    }
    match name {
        [b'H', _] => elements::by_symbol("H"),
        [_, second @ (b'C' | b'H' | b'N' | b'O' | b'P' | b'S')] if is_hetero => letter(&[*second]),
        [first, _] => letter(&[*first]),
        _ => None,
    }
}

/// A line addressed as in the format's description: columns count from one, both ends are
/// inclusive, and columns beyond the end are blank.
struct Record<'a>(&'a [u8]);

impl<'a> Record<'a> {
    fn bytes(&self, from: usize, to: usize) -> &'a [u8] {
        let end = to.min(self.0.len());
        self.0.get(from - 1..end).unwrap_or_default()
    }

    fn text(&self, from: usize, to: usize) -> &'a str {
        std::str::from_utf8(self.bytes(from, to)).unwrap_or_default()
    }

    fn byte(&self, column: usize) -> u8 {
        self.0.get(column - 1).copied().unwrap_or(b' ')
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CRAMBIN: &str = include_str!("../../../scenes/1crn.pdb");
    const HAEMOGLOBIN: &str = include_str!("../../../scenes/2hhb.pdb");

    fn count(atoms: &[Atom], symbol: &str) -> usize {
        atoms
            .iter()
            .filter(|atom| atom.element.symbol == symbol)
            .count()
    }

    fn one(line: &str) -> Atom {
        parse(line).expect(line)[0]
    }

    #[test]
    fn crambin_has_the_atoms_of_its_formula() {
        let atoms = parse(CRAMBIN).expect("crambin");
        assert_eq!(atoms.len(), 327);
        let counts = ["C", "N", "O", "S"].map(|symbol| count(&atoms, symbol));
        assert_eq!(counts, [202, 55, 64, 6]);
        assert_eq!(atoms[0].position, DVec3::new(17.047, 14.099, 3.625));
    }

    /// In this entry the occupancy column holds electron counts, which independently state each
    /// atom's element.
    #[test]
    fn haemoglobin_agrees_with_its_own_electron_counts() {
        let atoms = parse(HAEMOGLOBIN).expect("haemoglobin");
        assert_eq!(atoms.len(), 4779);
        let counts = ["C", "N", "O", "S", "FE", "P"].map(|symbol| {
            atoms
                .iter()
                .filter(|a| a.element.symbol.eq_ignore_ascii_case(symbol))
                .count()
        });
        assert_eq!(counts, [2954, 780, 1027, 12, 4, 2]);
        let electrons = [
            ("C", "6.00"),
            ("N", "7.00"),
            ("O", "8.00"),
            ("S", "16.00"),
            ("Fe", "24.00"),
        ];
        let lines = HAEMOGLOBIN
            .lines()
            .filter(|line| line.starts_with("ATOM") || line.starts_with("HETATM"));
        let swapped = lines
            .zip(&atoms)
            .filter(|(line, atom)| {
                let stated = line[54..60].trim();
                electrons
                    .iter()
                    .any(|(symbol, expected)| *symbol == atom.element.symbol && *expected != stated)
            })
            .inspect(|(line, _)| assert!(["ASN", "HIS", "THR"].contains(&&line[17..20]), "{line}"))
            .count();
        // In that column the ends of ten side chains are swapped in the entry.
        assert_eq!(swapped, 20);
    }

    #[test]
    fn names_tell_the_element_where_its_columns_do_not() {
        let cases = [
            (
                "ATOM      1  CA  GLY A   1       0.000   0.000   0.000",
                "C",
            ),
            (
                "ATOM      1  CD1 LEU A   1       0.000   0.000   0.000",
                "C",
            ),
            (
                "ATOM      1 HG11 VAL A   1       0.000   0.000   0.000",
                "H",
            ),
            (
                "ATOM      1 1HB  ALA A   1       0.000   0.000   0.000",
                "H",
            ),
            (
                "HETATM    1 CA    CA A   1       0.000   0.000   0.000",
                "Ca",
            ),
            (
                "HETATM    1 FE   HEM A   1       0.000   0.000   0.000",
                "Fe",
            ),
            (
                "HETATM    1  NA  HEM A   1       0.000   0.000   0.000",
                "N",
            ),
            (
                "HETATM    1 AC1* NAD A   1       0.000   0.000   0.000",
                "C",
            ),
            (
                "HETATM    1 NP   NAD A   1       0.000   0.000   0.000",
                "P",
            ),
            (
                "ATOM      1 SE   MSE A   1       0.000   0.000   0.000",
                "Se",
            ),
            (
                "HETATM    1 ZN    ZN A   1       0.000   0.000   0.000  1.00  0.00          ZN",
                "Zn",
            ),
            (
                "ATOM      1  CA  GLY A   1       0.000   0.000   0.000  1.00  0.00           c",
                "C",
            ),
            (
                "ATOM      1  QQ  UNK A   1       0.000   0.000   0.000",
                "?",
            ),
        ];
        for (line, symbol) in cases {
            assert_eq!(one(line).element.symbol, symbol, "{line}");
        }
    }

    #[test]
    fn first_model_and_first_location_are_read() {
        let text = "MODEL        1\n\
            ATOM      1  N  BALA A   1       1.000   0.000   0.000\n\
            ATOM      2  N  AALA A   1       2.000   0.000   0.000\n\
            ATOM      3  CA  ALA A   1       3.000   0.000   0.000\n\
            ENDMDL\n\
            MODEL        2\n\
            ATOM      4  N   ALA A   1       4.000   0.000   0.000\n";
        let xs: Vec<f64> = parse(text)
            .expect("two atoms")
            .iter()
            .map(|atom| atom.position.x)
            .collect();
        assert_eq!(xs, [1.0, 3.0]);
    }

    #[test]
    fn mistakes_are_refused_with_their_line() {
        let good = "ATOM      1  N   ALA A   1       1.000   0.000   0.000";
        for (text, line) in [
            (format!("{good}\n{}", &good[..50]), 1),
            (format!("{good}\n{}", good.replace("1.000", "x.000")), 1),
            (format!("{good}\n{}", good.replace("1.000", "  nan")), 1),
            (format!("{good}\n{}", good.replace("1.000", " 1e30")), 1),
            (format!("{good}\n{}", good.replace("1.000", "-1e18")), 1),
            (format!("{good}\n{}", good.replace("1.000", "é.000")), 1),
            ("HEADER\nEND\n".into(), 1),
            // Such lines must not be skipped silently.
            (format!("{good}\n{}", good.replace("ATOM  ", "atom  ")), 1),
            (format!("{good}\n{}", good.replace("ATOM  ", " ATOM ")), 1),
            (format!("{good}\n{}", good.replace("ATOM   ", "ATOM 10")), 1),
            (format!("{good}\n{}", good.replace("ATOM   ", "ATOM100")), 1),
            (format!("{good}\n{}", good.replace("ATOM  ", " HETATM")), 1),
            (String::new(), 0),
        ] {
            let wrong = parse(&text).expect_err(&text);
            assert_eq!(wrong.line, line, "{text}");
        }
    }
}
