//! Atoms from the XYZ format: a count, a comment, then one atom a line.
//!
//! An atom is an element (symbol or atomic number) and three coordinates in ångström. In extended
//! XYZ the comment says in which columns they are; the default is `Properties=species:S:1:pos:R:3`.
//! Other columns are ignored. Only the first frame is read.

use std::mem::MaybeUninit;

use glam::DVec3;
use rayon::prelude::*;

use super::atom::{Atom, WrongLine, is_coordinate};
use super::elements::{self, Element};
use crate::plural::count_of;
use crate::shown::shown;

/// Reads the atoms of the first frame of an XYZ file.
///
/// # Errors
///
/// The first line that is wrong.
pub fn parse(text: &str) -> Result<Vec<Atom>, WrongLine> {
    let text = text.trim_start_matches('\u{feff}');
    let (first, rest) = text.split_once('\n').unwrap_or((text, ""));
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
    let (comment, rest) = rest.split_once('\n').unwrap_or((rest, ""));
    let columns = Columns::of(comment)?;

    let (blocks, lines, rest) = blocks(rest, count);
    let mut atoms = Vec::new();
    atoms.try_reserve_exact(lines).map_err(|_| {
        WrongLine::new(
            0,
            format!("there is no memory for {}", count_of(lines, "atom")),
            "too many",
            "use a machine with more memory, or fewer atoms",
        )
    })?;
    let mut dummies = 0;
    for read in read_blocks(&blocks, columns, &mut atoms) {
        dummies += read.dummies;
        match read.wrong {
            None => {}
            Some((line, Wrong::Blank)) => return Err(missing(line, count, line - FIRST_ATOM)),
            Some((line, Wrong::Coordinate)) => {
                return Err(WrongLine::new(
                    line,
                    "an atom needs an element and three coordinates",
                    "a coordinate is missing, not a number, or out of range (1e18)",
                    if columns == Columns::PLAIN {
                        "write lines like: C 0.0 1.2 -3.4"
                    } else {
                        "write the columns that the second line names"
                    },
                ));
            }
        }
    }
    if lines < count {
        return Err(missing(FIRST_ATOM + lines - 1, count, lines));
    }
    check_what_follows(rest, count)?;
    if dummies > 0 {
        tracing::warn!("left out: {}", count_of(dummies, "dummy atom"));
    }
    if atoms.is_empty() {
        return Err(WrongLine::new(
            0,
            "the file has only dummy atoms",
            "nothing to draw",
            "give at least one atom",
        ));
    }
    Ok(atoms)
}

/// The line of the first atom, counted from zero.
const FIRST_ATOM: usize = 2;
/// Bytes that a thread reads at once.
const BLOCK: usize = 1 << 18;

/// Blocks that are cut before the lines are counted: another frame may follow.
const AT_ONCE: usize = 256;

/// Whole lines of a file.
struct Block<'a> {
    /// The number of the frame's atoms before this block.
    before: usize,
    lines: usize,
    text: &'a str,
}

/// The first `count` lines, or all if there are fewer, in blocks; their number; and the text after
/// them.
fn blocks(text: &str, count: usize) -> (Vec<Block<'_>>, usize, &str) {
    let mut blocks = Vec::new();
    let mut end = 0;
    let (mut rest, mut before) = (text, 0);
    while before < count && !rest.is_empty() {
        let mut cut = Vec::new();
        while cut.len() < AT_ONCE && !rest.is_empty() {
            let end = rest.as_bytes()[BLOCK.min(rest.len())..]
                .iter()
                .position(|byte| *byte == b'\n')
                .map_or(rest.len(), |at| BLOCK + at + 1);
            cut.push(&rest[..end]);
            rest = &rest[end..];
        }
        let all_lines: Vec<usize> = cut.par_iter().map(|text| lines_of(text)).collect();
        for (mut text, mut lines) in cut.into_iter().zip(all_lines) {
            if lines > count - before {
                lines = count - before;
                text = &text[..text.split_inclusive('\n').take(lines).map(str::len).sum()];
            }
            end += text.len();
            if lines > 0 {
                blocks.push(Block {
                    before,
                    lines,
                    text,
                });
            }
            before += lines;
        }
    }
    (blocks, before, &text[end..])
}

/// The number of lines of a text. The last may lack its end of line.
fn lines_of(text: &str) -> usize {
    let ends = text.bytes().filter(|byte| *byte == b'\n').count();
    ends + usize::from(!text.ends_with('\n'))
}

/// The result of reading a block, besides the atoms.
struct Read {
    atoms: usize,
    dummies: usize,
    /// The first line that is wrong. Nothing after it was read.
    wrong: Option<(usize, Wrong)>,
}

enum Wrong {
    Blank,
    Coordinate,
}

/// Appends the atoms of all blocks in order. Returns the results block by block.
fn read_blocks(blocks: &[Block<'_>], columns: Columns, atoms: &mut Vec<Atom>) -> Vec<Read> {
    let mut rooms = Vec::with_capacity(blocks.len());
    let mut rest = atoms.spare_capacity_mut();
    for block in blocks {
        let (room, others) = rest.split_at_mut(block.lines);
        rooms.push(room);
        rest = others;
    }
    let read: Vec<Read> = blocks
        .par_iter()
        .zip(rooms)
        .map(|(block, room)| read_block(block, columns, room))
        .collect();
    // If there are dummies, the following atoms move up.
    let (mut from, mut to) = (0, 0);
    let room = atoms.spare_capacity_mut();
    for (block, read) in blocks.iter().zip(&read) {
        if from != to {
            room.copy_within(from..from + read.atoms, to);
        }
        from += block.lines;
        to += read.atoms;
    }
    // SAFETY: each block's atoms were written from the position of its first line, and moved up to
    // the end of the block before.
    unsafe { atoms.set_len(to) };
    read
}

/// Reads the atoms of a block into `room`, which has an element for each line.
fn read_block(block: &Block<'_>, columns: Columns, room: &mut [MaybeUninit<Atom>]) -> Read {
    let first = FIRST_ATOM + block.before;
    let mut read = Read {
        atoms: 0,
        dummies: 0,
        wrong: None,
    };
    // Neighbours often have the same element.
    let mut last = ("", None);
    for (number, line) in block.text.lines().enumerate() {
        let (symbol, position) = match columns.fields(line) {
            Ok(fields) => fields,
            Err(wrong) => {
                read.wrong = Some((first + number, wrong));
                break;
            }
        };
        if symbol != last.0 {
            last = (symbol, element(symbol));
        }
        let element = match last.1 {
            Some(element) => element,
            None if matches!(symbol, "X" | "x" | "Xx" | "XX" | "0") => {
                read.dummies += 1;
                continue;
            }
            None => &elements::UNKNOWN,
        };
        room[read.atoms].write(Atom { position, element });
        read.atoms += 1;
    }
    read
}

/// The columns of the element and of the first coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Columns {
    element: usize,
    position: usize,
}

impl Columns {
    /// The default columns.
    const PLAIN: Self = Self {
        element: 0,
        position: 1,
    };

    /// The columns that the comment of extended XYZ names: names, types and widths in order.
    fn of(comment: &str) -> Result<Self, WrongLine> {
        // The key must be a word of its own. A value without a colon is an ordinary comment.
        let is_there = |at: &usize| {
            comment[..*at]
                .chars()
                .next_back()
                .is_none_or(char::is_whitespace)
        };
        let key = "Properties=";
        let Some(at) = comment.match_indices(key).map(|(at, _)| at).find(is_there) else {
            return Ok(Self::PLAIN);
        };
        let properties = &comment[at + key.len()..];
        let wrong = |message: String, label| {
            WrongLine::new(
                1,
                message,
                label,
                "name the columns, for example Properties=species:S:1:pos:R:3",
            )
        };
        let end = |c: char| c.is_whitespace() || c == '"';
        let properties = properties.trim_start_matches('"');
        let properties = properties.split(end).next().unwrap_or_default();
        if !properties.contains(':') {
            return Ok(Self::PLAIN);
        }
        let words: Vec<&str> = properties.split(':').collect();
        let (mut element, mut position, mut at) = (None, None, 0_usize);
        for property in words.chunks(3) {
            let width = match property {
                [_, "S" | "R" | "I" | "L", width] => width.parse::<u16>().ok(),
                _ => None,
            };
            let Some(width) = width.filter(|width| *width > 0).map(usize::from) else {
                return Err(wrong(
                    format!("{} is not a property", shown(&property.join(":"))),
                    "not a name, a type of S, R, I or L, and a width",
                ));
            };
            match (property[0], property[1], width) {
                ("species" | "element", "S", 1) | ("Z" | "numbers", "I", 1) => {
                    element = element.or(Some(at));
                }
                ("pos", "R", 3) => position = Some(at),
                _ => {}
            }
            at += width;
        }
        match (element, position) {
            (Some(element), Some(position)) => Ok(Self { element, position }),
            (None, _) => Err(wrong(
                "no column holds the elements of the atoms".into(),
                "neither species:S:1 nor Z:I:1",
            )),
            (_, None) => Err(wrong(
                "no columns hold the positions of the atoms".into(),
                "no pos:R:3",
            )),
        }
    }

    /// The element and the position in an atom's line.
    fn fields<'a>(&self, line: &'a str) -> std::result::Result<(&'a str, DVec3), Wrong> {
        let mut fields = line.split_whitespace();
        if *self == Self::PLAIN {
            let symbol = fields.next().ok_or(Wrong::Blank)?;
            return Ok((symbol, position_of(&mut fields)?));
        }
        let mut after = fields.clone();
        let symbol = fields.nth(self.element);
        if self.position > 0 {
            after.nth(self.position - 1);
        }
        let is_blank = line.trim_start().is_empty();
        let symbol = symbol.ok_or(if is_blank {
            Wrong::Blank
        } else {
            Wrong::Coordinate
        })?;
        Ok((symbol, position_of(&mut after)?))
    }
}

/// Parses the next three fields.
fn position_of<'a>(
    fields: &mut impl Iterator<Item = &'a str>,
) -> std::result::Result<DVec3, Wrong> {
    let mut coordinate = || fields.next().and_then(number_of).ok_or(Wrong::Coordinate);
    Ok(DVec3::new(coordinate()?, coordinate()?, coordinate()?))
}

/// After a frame of `count` atoms a file ends, or another frame begins with its number.
fn check_what_follows(rest: &str, count: usize) -> Result<(), WrongLine> {
    let next = rest
        .lines()
        .enumerate()
        .find(|(_, line)| !line.trim().is_empty())
        .filter(|(_, line)| line.trim().parse::<usize>().is_err());
    let Some((line, _)) = next else {
        return Ok(());
    };
    Err(WrongLine::new(
        FIRST_ATOM + count + line,
        format!(
            "the file promises {}, but neither its end nor another frame follows them",
            count_of(count, "atom")
        ),
        "one more line",
        "write the number of all atoms on the first line, or remove what follows them",
    ))
}

fn missing(line: usize, expected: usize, found: usize) -> WrongLine {
    WrongLine::new(
        line,
        format!(
            "the file promises {}, but holds {found}",
            count_of(expected, "atom")
        ),
        "the atoms end here",
        "the file is truncated, or the number on its first line is wrong",
    )
}

/// A number that is not too large for a scene. Fortran's `1.0D+00` is accepted.
fn number_of(text: &str) -> Option<f64> {
    let plain = |text: &str| text.parse().ok();
    plain(text)
        .or_else(|| plain(&text.replace(['D', 'd'], "e")))
        .filter(|value| is_coordinate(*value))
}

/// Parses `C`, `cl`, `17`, and labels such as `C12` and `Fe2+`.
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
    fn columns_are_those_that_the_comment_names() {
        let expected = parse("2\n\nC 1 2 3\nFe 4 5 6\n").expect("atoms");
        for (comment, lines) in [
            (
                "Properties=species:S:1:pos:R:3:forces:R:3",
                "C 1 2 3 9 9 9\nFe 4 5 6 9 9 9\n",
            ),
            (
                "Lattice=\"1 0 0 0 1 0 0 0 1\" Properties=pos:R:3:species:S:1 pbc=\"T T T\"",
                "1 2 3 C\n4 5 6 Fe\n",
            ),
            (
                "Properties=\"id:I:1:pos:R:3:Z:I:1\"",
                "7 1 2 3 6\n8 4 5 6 26\n",
            ),
            (
                "Properties=velo:R:3:element:S:1:flag:L:1:pos:R:3",
                "9 9 9 C T 1 2 3\n9 9 9 Fe F 4 5 6\n",
            ),
        ] {
            let text = format!("2\n{comment}\n{lines}");
            assert_eq!(parse(&text).expect(comment), expected, "{comment}");
        }
    }

    #[test]
    fn comments_are_free() {
        for comment in [
            "MyProperties=3:x note",
            "Properties=optimised",
            "Properties=",
            "a:b",
        ] {
            assert_eq!(
                parse(&format!("1\n{comment}\nC 0 0 0\n"))
                    .expect(comment)
                    .len(),
                1
            );
        }
    }

    #[test]
    fn nothing_after_a_frame_is_dropped_without_a_word() {
        for (after, line) in [
            ("C 6 0 0\n", Some(4)),
            ("C 6 0 0", Some(4)),
            ("\n \r\nC 6 0 0\n", Some(6)),
            ("2.5\n", Some(4)),
            ("", None),
            ("\n\n \t\r\n", None),
            ("1\nnext\nC 6 0 0\n", None),
            ("\n1\r\nnext\r\n", None),
        ] {
            let text = format!("2\n\nC 0 0 0\nC 3 0 0\n{after}");
            match (parse(&text), line) {
                (Ok(atoms), None) => assert_eq!(atoms.len(), 2),
                (Err(wrong), Some(line)) => assert_eq!(wrong.line, line, "{text:?}"),
                (read, _) => panic!("{text:?}: {read:?}"),
            }
        }
        // Also if the frame ends far from the end of a block.
        for count in [3, 30_000, 65_000] {
            let mut text = format!("{count}\n\n");
            for atom in 0..count {
                text += &format!("H {atom} 0 1.5\n");
            }
            assert_eq!(parse(&text).expect("atoms").len(), count);
            text += "H 1 2 3\n";
            assert_eq!(parse(&text).expect_err("an atom more").line, count + 2);
        }
    }

    #[test]
    fn blocks_are_read_as_one() {
        let count = 40_000;
        let mut text = format!("{count}\r\n\r\n");
        for atom in 0..count {
            text += &format!("H {atom} 0 1.5\r\n");
        }
        assert!(text.len() > 2 * BLOCK);
        text += "1\nthe next frame\nnone";
        let atoms = parse(&text).expect("atoms");
        assert_eq!(atoms.len(), count);
        for (index, atom) in atoms.iter().enumerate() {
            assert_eq!(atom.position.x, index as f64);
        }
        let with_dummies = text
            .replace("H 17 ", "X 17 ")
            .replace("H 30000 ", "Xx 30000 ");
        let atoms = parse(&with_dummies).expect("atoms");
        let expected: Vec<f64> = (0..count)
            .filter(|atom| ![17, 30_000].contains(atom))
            .map(|atom| atom as f64)
            .collect();
        assert!(atoms.iter().map(|atom| atom.position.x).eq(expected));
        let wrong = text.replace("H 39990 0", "H 39990 none");
        assert_eq!(parse(&wrong).expect_err("a word").line, 39_992);
        let promise = text.replacen("40000", "40004", 1);
        assert_eq!(parse(&promise).expect_err("a short line").line, 40_002);
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
            ("1\n\nC 0 1e30 0\n", 2),
            ("1\n\nC 0 -1e18 0\n", 2),
            ("1e9\n\nC 0 0 0\n", 0),
            ("4000000000\n\nC 0 0 0\n", 2),
            ("1\nProperties=pos:R:3\n0 0 0\n", 1),
            ("1\nProperties=species:S:1:pos:R:2\nC 0 0\n", 1),
            ("1\nProperties=species:S:1:pos:R\nC 0 0 0\n", 1),
            ("1\nProperties=species:S:0:pos:R:3\nC 0 0 0\n", 1),
            ("1\nProperties=species:S:1:pos:X:3\nC 0 0 0\n", 1),
            ("1\nProperties=id:I:1:species:S:1:pos:R:3\n7 C 0 0\n", 2),
            ("1\nProperties=pos:R:3:species:S:1\n0 0 0\n", 2),
            ("1\nProperties=pos:R:3:species:S:1\n \n", 2),
        ] {
            let wrong = parse(text).expect_err(text);
            assert_eq!(wrong.line, line, "{text:?}");
        }
    }
}
