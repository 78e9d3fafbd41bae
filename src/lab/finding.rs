//! What a study found, as plain values: the one vocabulary of results.
//!
//! A study decides what is best, what passes and what is said about it, and puts that into a
//! [`Finding`]. The floor above lays a finding out as text, CSV, JSON, SVG and HTML, one renderer
//! each, and adds no decision and no word of its own.

mod figure;
mod gallery;
mod table;

use serde::{Deserialize, Serialize};

pub use crate::lab::check::Check;
pub use figure::{Axis, Curve, Figure, Mark, Plot, Spacing};
pub use gallery::{Gallery, Picture, Shades};
pub use table::{Cell, CellOf, Column, Place, Table};

/// How a finding sounds: what colour its sentence has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Tone {
    /// Nothing was judged.
    #[default]
    Plain,
    /// What was asked holds.
    Good,
    /// It does not.
    Bad,
}

/// A result that can be shown.
pub trait Describe {
    /// The finding: what is said, tabulated and drawn.
    fn describe(&self) -> Finding;
}

/// What was found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// What was studied, on which scene.
    pub title: String,
    /// Whether it is good news.
    pub tone: Tone,
    /// The answer in one or two sentences, with its numbers.
    pub sentence: String,
    /// What else is said: assumptions, settings, what could not be seen. A paragraph each.
    pub notes: Vec<String>,
    /// The numbers.
    pub tables: Vec<Table>,
    /// Line, point and bar charts; each is one SVG file.
    pub figures: Vec<Figure>,
    /// Pictures.
    pub galleries: Vec<Gallery>,
    /// Published beside computed values.
    pub checks: Vec<Check>,
    /// Other files that it leaves: name and text.
    pub files: Vec<(String, String)>,
}

/// Items as one reads them: a, b and c.
pub fn listed(items: &[String]) -> String {
    match items {
        [] => "none".to_owned(),
        [one] => one.clone(),
        [all @ .., last] => format!("{} and {last}", all.join(", ")),
    }
}
