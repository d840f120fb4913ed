//! Prints errors for people: what is wrong, where, and how to fix it.

use std::fmt;

use miette::{
    Diagnostic, GraphicalReportHandler, GraphicalTheme, LabeledSpan, MietteError,
    MietteSpanContents, SourceCode, SourceSpan, SpanContents,
};

use crate::error::{Error, Place};
use crate::shown::{shown, shown_lines, shown_path, shown_up_to};

/// Prints `error` to stderr.
pub(super) fn print(error: &Error) {
    let theme = if supports_color() {
        GraphicalTheme::unicode()
    } else {
        GraphicalTheme::unicode_nocolor()
    };
    super::note(&rendered(error, theme));
}

fn rendered(error: &Error, theme: GraphicalTheme) -> String {
    let report = ErrorReport::new(error);
    let mut text = String::new();
    let rendered = GraphicalReportHandler::new_themed(theme)
        .with_links(false)
        .render_report(&mut text, &report);
    if rendered.is_err() {
        text = format!("{}\n{}\n", report.message, report.help);
    }
    text.truncate(text.trim_end_matches('\n').len());
    text
}

fn supports_color() -> bool {
    use std::io::IsTerminal;
    std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none()
}

/// An [`Error`] with what miette needs to show its place.
#[derive(Debug)]
struct ErrorReport {
    message: String,
    help: String,
    excerpt: Option<(Excerpt, LabeledSpan)>,
}

impl ErrorReport {
    fn new(error: &Error) -> Self {
        let excerpt = match error {
            Error::Scene(scene) => scene.place.as_ref().map(|place| {
                let excerpt = Excerpt::around(place, shown_path(&scene.path));
                let label = shown(&place.label).into_owned();
                let label = LabeledSpan::new_with_span(Some(label), excerpt.span);
                (excerpt, label)
            }),
            _ => None,
        };
        Self {
            message: shown_lines(&error.to_string()),
            help: shown_lines(&error.help()),
            excerpt,
        }
    }
}

/// The line with the error and its neighbours, safe for a terminal: escaped, and cut if they are
/// long.
#[derive(Debug)]
struct Excerpt {
    name: String,
    text: String,
    /// The error's place, in bytes of `text`.
    span: SourceSpan,
    /// The first line of `text` and the place of the error, counted from zero.
    first_line: usize,
    line_column: (usize, usize),
}

impl Excerpt {
    /// The most characters of a neighbouring line, and of the error itself.
    const LONGEST: usize = 100;
    /// Characters of its line that are shown before and after the error.
    const AROUND: usize = 40;

    fn around(place: &Place, name: String) -> Self {
        let text = &place.text[..];
        let start = floor(text, place.span.start);
        let line_start = text[..start].rfind('\n').map_or(0, |newline| newline + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |at| start + at);
        let end = floor(text, place.span.end.max(start)).clamp(start, line_end);
        let (line, column) = place.line_column();

        let mut excerpt = String::new();
        let mut first_line = line - 1;
        if line_start > 0 {
            let before = &text[..line_start - 1];
            let before = &before[before.rfind('\n').map_or(0, |newline| newline + 1)..];
            excerpt += &shown_up_to(before.trim_end(), Self::LONGEST);
            excerpt.push('\n');
            first_line -= 1;
        }
        let before = &text[line_start..start];
        match before.char_indices().rev().nth(Self::AROUND - 1) {
            Some((at, _)) if at > 0 => {
                excerpt.push('…');
                excerpt += &shown(&before[at..]);
            }
            _ => excerpt += &shown(before),
        }
        let span_start = excerpt.len();
        excerpt += &shown_up_to(text[start..end].trim_end_matches('\r'), Self::LONGEST);
        let span_end = excerpt.len();
        let after = text[end..line_end].trim_end();
        match after.char_indices().nth(Self::AROUND) {
            Some((at, _)) => {
                excerpt += &shown(&after[..at]);
                excerpt.push('…');
            }
            None => excerpt += &shown(after),
        }
        if line_end < text.len() {
            let next = text[line_end + 1..].lines().next().unwrap_or_default();
            excerpt.push('\n');
            excerpt += &shown_up_to(next, Self::LONGEST);
        }
        Self {
            name,
            text: excerpt,
            span: (span_start..span_end).into(),
            first_line,
            line_column: (line - 1, column - 1),
        }
    }
}

/// The start of the character that contains this byte.
fn floor(text: &str, at: usize) -> usize {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        lines_before: usize,
        lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        // Without neighbours miette asks only for the position of the span, else for the whole
        // text.
        let (part, (line, column)) = if lines_before + lines_after == 0 {
            (*span, self.line_column)
        } else {
            ((0..self.text.len()).into(), (self.first_line, 0))
        };
        let range = part.offset()..part.offset() + part.len();
        let bytes = self.text.as_bytes().get(range);
        Ok(Box::new(MietteSpanContents::new_named(
            self.name.clone(),
            bytes.ok_or(MietteError::OutOfBounds)?,
            part,
            line,
            column,
            self.text.lines().count(),
        )))
    }
}

impl fmt::Display for ErrorReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for ErrorReport {}

impl Diagnostic for ErrorReport {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(&self.help))
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.excerpt.as_ref().map(|(excerpt, _)| excerpt as _)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        self.excerpt
            .as_ref()
            .map(|(_, label)| Box::new(std::iter::once(label.clone())) as _)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::SceneError;

    fn report(text: &str, wrong: &str) -> String {
        let start = text.find(wrong).expect("what is wrong");
        let error = Error::Scene(Box::new(SceneError {
            path: "a\x1b[2J.toml".into(),
            message: "is wrong".into(),
            help: "fix it".into(),
            place: Some(Place {
                text: text.into(),
                span: start..start + wrong.len(),
                label: "here".into(),
            }),
        }));
        rendered(&error, GraphicalTheme::unicode_nocolor())
    }

    #[test]
    fn an_excerpt_shows_the_line_and_its_neighbours_with_their_numbers() {
        let report = report("one\ntwo\nδ = 3 # why\nfour\nfive\n", "3");
        for part in [
            "a\\u{1b}[2J.toml:3:5]",
            "2 │ two",
            "3 │ δ = 3 # why",
            "4 │ four",
            "here",
        ] {
            assert!(report.contains(part), "{part}: {report}");
        }
        assert!(
            !report.contains("one") && !report.contains("five"),
            "{report}"
        );
    }

    #[test]
    fn excerpts_hold_no_escapes_and_no_lines_of_megabytes() {
        let long = "x".repeat(50_000_000);
        for (text, wrong) in [
            (
                format!("a\n{long} = \"\x1b[31m\u{202e}\" {long}\n{long}"),
                "\"\x1b[31m\u{202e}\"",
            ),
            (format!("{long}\n{long}\n"), "xxx"),
            (format!("k = \"{long}\x07\""), &long),
            ("\u{9b}2J\r\nwrong\r\n\x08".to_owned(), "wrong"),
            ("wrong".to_owned(), "wrong"),
        ] {
            let report = report(&text, wrong);
            assert!(report.len() < 3000, "{} bytes", report.len());
            let obeyed = |c: char| c.is_control() && c != '\n' || c == '\u{202e}';
            assert!(!report.contains(obeyed), "{report:?}");
            assert!(report.contains("here"), "{report}");
        }
    }
}
