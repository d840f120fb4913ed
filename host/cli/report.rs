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
    eprint!("{text}");
}

fn supports_color() -> bool {
    use std::io::IsTerminal;
    std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none()
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
        let mut message = error.to_string();
        let place = match error {
            Error::Scene(scene) => scene.place.as_ref().map(|place| {
                let (line, column) = place.line_column();
                let name = scene.path.display().to_string();
                message = format!("{name}:{line}:{column}: {message}");
                (
                    NamedSource::new(name, place.text.clone()),
                    LabeledSpan::new(
                        Some(place.label.clone()),
                        place.span.start,
                        place.span.len(),
                    ),
                )
            }),
            _ => None,
        };
        Self {
            message,
            help: error.help(),
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
