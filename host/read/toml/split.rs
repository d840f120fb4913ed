//! Splits a scene's text at its headers, so that millions of `[[sphere]]` tables can be parsed in
//! batches.

use std::ops::Range;

use toml_parser::Source;
use toml_parser::lexer::TokenKind;

/// Bytes of `[[sphere]]` tables that a thread parses at once.
const BATCH: usize = 1 << 15;

/// A part of a file, and where it starts in the text that was joined from such parts.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) range: Range<usize>,
    pub(super) start: usize,
}

impl Piece {
    pub(super) fn whole(range: Range<usize>) -> Self {
        Self { range, start: 0 }
    }
}

/// A file, split at its headers. Scenes may have millions of `[[sphere]]` tables, which can be
/// parsed independently.
pub(super) struct SplitText {
    /// Batches of `[[sphere]]` tables.
    pub(super) spheres: Vec<Batch>,
    /// Everything else.
    pub(super) others: Vec<Piece>,
}

/// Consecutive `[[sphere]]` tables of [`BATCH`] bytes or slightly more.
pub(super) struct Batch {
    pub(super) range: Range<usize>,
    /// The start of the last table.
    pub(super) last: usize,
}

impl SplitText {
    pub(super) fn of(text: &str) -> Self {
        let mut split = Self {
            spheres: Vec::new(),
            others: vec![Piece::whole(0..0)],
        };
        let mut is_sphere = false;
        // The number of open brackets, whether a line starts outside of them, and whether this line
        // is a header.
        let (mut depth, mut is_start, mut is_header) = (0_usize, true, false);
        for token in Source::new(text).lex() {
            let start = token.span().start();
            match token.kind() {
                TokenKind::Newline if depth == 0 => (is_start, is_header) = (true, false),
                TokenKind::Whitespace | TokenKind::Comment | TokenKind::Newline => {}
                TokenKind::LeftSquareBracket if is_start => {
                    let is_next = is_sphere_header(&text[start..]);
                    split.begin(is_sphere, is_next, start);
                    (is_sphere, is_start, is_header) = (is_next, false, true);
                }
                _ if is_header => {}
                TokenKind::LeftSquareBracket | TokenKind::LeftCurlyBracket => {
                    (depth, is_start) = (depth + 1, false);
                }
                TokenKind::RightSquareBracket | TokenKind::RightCurlyBracket => {
                    (depth, is_start) = (depth.saturating_sub(1), false);
                }
                _ => is_start = false,
            }
        }
        split.end(is_sphere, text.len());
        split
    }

    /// Starts a part at the header at `start`, which ends the part before.
    fn begin(&mut self, was_sphere: bool, is_sphere: bool, start: usize) {
        if was_sphere
            && is_sphere
            && let Some(batch) = self.spheres.last_mut()
            && start - batch.range.start < BATCH
        {
            batch.last = start;
            return;
        }
        if was_sphere || is_sphere {
            self.end(was_sphere, start);
        }
        if is_sphere {
            self.spheres.push(Batch {
                range: start..start,
                last: start,
            });
        } else if was_sphere {
            let before = self.others_length();
            self.others.push(Piece {
                range: start..start,
                start: before,
            });
        }
    }

    fn end(&mut self, is_sphere: bool, end: usize) {
        let last = if is_sphere {
            self.spheres.last_mut().map(|batch| &mut batch.range)
        } else {
            self.others.last_mut().map(|piece| &mut piece.range)
        };
        if let Some(last) = last {
            last.end = end;
        }
    }

    pub(super) fn others_length(&self) -> usize {
        self.others
            .last()
            .map_or(0, |piece| piece.start + piece.range.len())
    }
}

/// Whether a text starts with the header `[[sphere]]`, in any spelling.
fn is_sphere_header(text: &str) -> bool {
    let blank = [' ', '\t'];
    let name = text
        .strip_prefix("[[")
        .map(|text| text.trim_start_matches(blank))
        .and_then(|text| {
            ["sphere", "\"sphere\"", "'sphere'"]
                .iter()
                .find_map(|name| text.strip_prefix(name))
        });
    name.is_some_and(|text| text.trim_start_matches(blank).starts_with("]]"))
}
