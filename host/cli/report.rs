//! Errors as a person reads them: what, where, and how to mend it.

use std::fmt;

use miette::{
    Diagnostic, GraphicalReportHandler, GraphicalTheme, LabeledSpan, NamedSource, SourceCode,
};

use crate::error::Error;

/// Prints `error` to stderr.
pub(super) fn print(error: &Error) {
    let report = Report::new(error);
    let theme = if supports_color() {
        GraphicalTheme::unicode()
    } else {
        GraphicalTheme::unicode_nocolor()
    };
    let mut text = String::new();
    let rendered = GraphicalReportHandler::new_themed(theme)
        .with_links(false)
        .render_report(&mut text, &report);
    if rendered.is_err() {
        text = format!("{error}\n{}\n", error.help());
    }
    super::note(text.trim_end_matches('\n'));
}

fn supports_color() -> bool {
    use std::io::IsTerminal;
    std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none()
}

/// The text without control characters, which a terminal would obey; byte for byte as long, so
/// that spans still fit.
fn printable(text: &str) -> String {
    text.chars()
        .flat_map(|c| {
            let bad = c.is_control() && !matches!(c, '\n' | '\r' | '\t');
            let (c, count) = if bad { ('?', c.len_utf8()) } else { (c, 1) };
            std::iter::repeat_n(c, count)
        })
        .collect()
}

/// An [`Error`] with what miette needs to point at its place.
#[derive(Debug)]
struct Report {
    message: String,
    help: String,
    place: Option<(NamedSource<String>, LabeledSpan)>,
}

impl Report {
    fn new(error: &Error) -> Self {
        let place = match error {
            Error::Scene(scene) => scene.place.as_ref().map(|place| {
                (
                    NamedSource::new(
                        printable(&scene.path.display().to_string()),
                        printable(&place.text),
                    ),
                    LabeledSpan::new(
                        Some(printable(&place.label)),
                        place.span.start,
                        place.span.len(),
                    ),
                )
            }),
            _ => None,
        };
        // An excerpt of lines that no terminal shows in a piece helps nobody.
        let place =
            place.filter(|(source, _)| source.inner().lines().all(|line| line.len() < 1000));
        Self {
            message: printable(&error.to_string()),
            help: printable(&error.help()),
            place,
        }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Report {}

impl Diagnostic for Report {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(&self.help))
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.place.as_ref().map(|(source, _)| source as _)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        self.place
            .as_ref()
            .map(|(_, label)| Box::new(std::iter::once(label.clone())) as _)
    }
}
