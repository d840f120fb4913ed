//! Texts of unknown origin as a person sees them: names and messages out of files, of drivers, of
//! the command line.

use std::borrow::Cow;

/// The most characters of a name that are shown.
const LONGEST: usize = 200;
/// Of a longer one, so many of its end.
const END: usize = 40;

/// A name on one line, which a terminal does nothing about but show it: what would move its cursor,
/// change its colours or turn the direction of writing is escaped, as in `\u{1b}`. Of a long one
/// beginning and end are shown, and its length.
#[must_use]
pub fn shown(name: &str) -> Cow<'_, str> {
    shown_up_to(name, LONGEST)
}

/// [`shown`], with at most so many characters.
#[must_use]
pub fn shown_up_to(text: &str, most: usize) -> Cow<'_, str> {
    // A character has four bytes at most.
    if text.len() > most && text.chars().nth(most).is_some() {
        let end = END.min(most / 2);
        let beginning = text.chars().take(most - end);
        let end: Vec<char> = text.chars().rev().take(end).collect();
        let mut cut = String::new();
        beginning.for_each(|c| push(&mut cut, c));
        cut += &format!("… ({} bytes) …", text.len());
        end.iter().rev().for_each(|c| push(&mut cut, *c));
        return cut.into();
    }
    if !text.chars().any(is_escaped) {
        return text.into();
    }
    let mut escaped = String::with_capacity(text.len());
    text.chars().for_each(|c| push(&mut escaped, c));
    escaped.into()
}

/// [`shown`] for a message that may have several lines.
#[cfg(feature = "cli")]
#[must_use]
pub fn shown_lines(text: &str) -> String {
    const MOST: usize = 4000;
    let lines: Vec<Cow<'_, str>> = text.lines().map(|line| shown_up_to(line, MOST)).collect();
    lines.join("\n")
}

/// [`shown`] for a path, whose bytes need not be text.
#[must_use]
pub fn shown_path(path: &std::path::Path) -> String {
    shown(&path.to_string_lossy()).into_owned()
}

/// Whether a character is more than shown: controls, what turns the direction of writing (Unicode
/// Standard Annex 9), line and paragraph separators, and the tags that nothing shows.
fn is_escaped(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{61c}' | '\u{200b}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2066}'..='\u{2069}' | '\u{feff}' | '\u{e0000}'..='\u{e007f}')
}

fn push(to: &mut String, c: char) {
    match c {
        '\n' | '\r' | '\t' => to.extend(c.escape_default()),
        c if is_escaped(c) => to.extend(c.escape_unicode()),
        c => to.push(c),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_left_for_a_terminal_to_obey() {
        assert_eq!(shown("Häm, 蛋白 γ"), "Häm, 蛋白 γ");
        assert_eq!(
            shown("a\x1b[31m\u{9b}2J\r\n\u{202e}b\u{7f}"),
            "a\\u{1b}[31m\\u{9b}2J\\r\\n\\u{202e}b\\u{7f}"
        );
        assert_eq!(shown_lines("one\ntwo\x07"), "one\ntwo\\u{7}");
        for c in (0..=0x10_ffff).filter_map(char::from_u32) {
            assert!(
                !shown(c.encode_utf8(&mut [0; 4])).chars().any(is_escaped),
                "{c:?}"
            );
        }
    }

    #[test]
    fn long_names_are_cut() {
        let long = format!("{}{}", "é".repeat(50_000_000), "end");
        let cut = shown(&long);
        assert!(
            cut.ends_with("éend") && cut.contains("… (100000003 bytes) …"),
            "{cut}"
        );
        assert_eq!(cut.chars().filter(|c| *c == 'é').count(), LONGEST - 3);
        let just = "x".repeat(LONGEST);
        assert_eq!(shown(&just), just);
    }
}
