//! What can be wrong with a scene, and where.

use std::fmt;
use std::ops::Range;

/// A scene that cannot be used: what is wrong, in which line, and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError {
    /// File or built-in name.
    pub source: String,
    /// Line and column (from 1) with the line's text, where a place in the file is to blame.
    pub place: Option<Place>,
    /// What is wrong.
    pub cause: String,
    /// What to do about it.
    pub cure: String,
}

/// A place in a scene file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// From 1.
    pub line: usize,
    /// From 1, in characters.
    pub column: usize,
    /// The text of the line: of a long one 200 characters around the column.
    pub text: String,
}

impl Place {
    /// The place where byte range `span` starts in `text`.
    pub(super) fn new(text: &str, span: &Range<usize>) -> Self {
        let start = (0..=span.start.min(text.len()))
            .rev()
            .find(|i| text.is_char_boundary(*i));
        let before = &text[..start.unwrap_or(0)];
        let line_start = before.rfind('\n').map_or(0, |i| i + 1);
        let column = before[line_start..].chars().count() + 1;
        Self {
            line: before.matches('\n').count() + 1,
            column,
            text: around(text[line_start..].lines().next().unwrap_or(""), column),
        }
    }
}

/// Most characters that are shown of a line.
const SHOWN: usize = 200;

/// At most [`SHOWN`] characters of `line`, those around `column`; an ellipsis for the others.
fn around(line: &str, column: usize) -> String {
    let count = line.chars().count();
    if count <= SHOWN {
        return line.to_owned();
    }
    let first = column.saturating_sub(SHOWN / 2).min(count - SHOWN);
    let part: String = line.chars().skip(first).take(SHOWN).collect();
    let ellipsis = |there| if there { "…" } else { "" };
    let [before, behind] = [first > 0, first + SHOWN < count].map(ellipsis);
    format!("{before}{part}{behind}")
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            None => write!(f, "{}: {}", self.source, self.cause)?,
            Some(place) => {
                let Place { line, column, text } = place;
                write!(
                    f,
                    "{}:{line}:{column}: {}\n  {line} | {text}",
                    self.source, self.cause
                )?;
            }
        }
        write!(f, "\n  cure: {}", self.cure)
    }
}

impl std::error::Error for SceneError {}

/// A fault of the content, before it is known where in the file it stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Fault {
    /// Path of keys and array positions to blame; empty for the whole scene.
    pub path: Vec<Step>,
    pub cause: String,
    pub cure: String,
}

/// One step into a TOML document.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Step {
    Key(&'static str),
    Index(usize),
}

impl From<&'static str> for Step {
    fn from(key: &'static str) -> Self {
        Self::Key(key)
    }
}

impl From<usize> for Step {
    fn from(index: usize) -> Self {
        Self::Index(index)
    }
}

impl Fault {
    pub(super) fn new(
        path: impl IntoIterator<Item = Step>,
        cause: impl Into<String>,
        cure: impl Into<String>,
    ) -> Self {
        Self {
            path: path.into_iter().collect(),
            cause: cause.into(),
            cure: cure.into(),
        }
    }

    /// Puts the steps of an enclosing table in front of the path.
    pub(super) fn within(mut self, outer: impl IntoIterator<Item = Step>) -> Self {
        self.path = outer.into_iter().chain(self.path).collect();
        self
    }
}

/// `keys!["laser", "spots", 3]`: a key path.
macro_rules! keys {
    ($($step:expr),* $(,)?) => { [$($crate::scene::error::Step::from($step)),*] };
}
pub(super) use keys;
