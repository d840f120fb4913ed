//! Makes texts of unknown origin safe to print: names and messages from files, drivers and the
//! command line.

use std::borrow::Cow;

/// The most characters of a name that are shown.
const LONGEST: usize = 200;
/// How many of them are from the end, for a longer name.
const END: usize = 40;

/// A name on one line that is safe in a terminal: characters that would move the cursor, change
/// colours or turn the direction of writing are escaped, as in `\u{1b}`. A long name is cut to its
/// beginning and end, with its length between them.
#[must_use]
pub fn shown(name: &str) -> Cow<'_, str> {
    shown_up_to(name, LONGEST)
}

/// [`shown`], with at most `most` characters.
#[must_use]
pub fn shown_up_to(text: &str, most: usize) -> Cow<'_, str> {
    // A character has at most four bytes.
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

/// [`shown`] for a path, which may not be valid UTF-8.
#[must_use]
pub fn shown_path(path: &std::path::Path) -> String {
    shown(&path.to_string_lossy()).into_owned()
}

/// Whether a character must be escaped: controls, characters that turn the direction of writing
/// (Unicode Standard Annex 9), line and paragraph separators, and invisible tags.
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
