//! What a study found, in a sentence and in tables.

use super::super::axis::significant;
use super::super::page::{Tone, explained};
use super::super::picture::scientific;
use super::super::svg::escape;

/// What a study found.
#[derive(Clone, Debug)]
pub struct Account {
    pub(super) title: String,
    pub(super) tone: Tone,
    /// With its numbers; text.
    pub(super) sentence: String,
    /// What else is said in words; text.
    pub(super) words: String,
    pub(super) tables: Vec<Table>,
}

/// A table of text.
#[derive(Clone, Debug)]
pub(super) struct Table {
    pub caption: String,
    pub head: Vec<String>,
    /// So many columns on the left are words, the others numbers.
    pub words: usize,
    pub rows: Vec<Vec<String>>,
    /// What is said below.
    pub note: String,
}

impl Table {
    pub(super) fn new(caption: impl Into<String>, words: usize, head: &[&str]) -> Self {
        Self {
            caption: caption.into(),
            head: head.iter().map(|h| (*h).to_owned()).collect(),
            words,
            rows: Vec::new(),
            note: String::new(),
        }
    }

    fn html(&self) -> String {
        let class = |i: usize| if i < self.words { "" } else { " class=\"n\"" };
        let row = |tag: &str, cells: &[String], show: fn(&str) -> String| {
            let cell = |(i, text): (usize, &String)| {
                format!("<{tag}{}>{}</{}>", class(i), show(text), &tag[..2])
            };
            let cells: String = cells.iter().enumerate().map(cell).collect();
            format!("<tr>{cells}</tr>\n")
        };
        let rows: String = self.rows.iter().map(|r| row("td", r, escape)).collect();
        let note = match self.note.is_empty() {
            true => String::new(),
            false => format!("<p class=\"note\">{}</p>\n", explained(&self.note)),
        };
        format!(
            "<h3>{}</h3>\n<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{}\"><table>\n{}{rows}</table></div>\n{note}",
            explained(&self.caption),
            escape(&self.caption),
            row("th scope=\"col\"", &self.head, explained)
        )
    }
}

impl Account {
    /// Words and tables.
    pub(super) fn html(&self) -> String {
        let words = match self.words.is_empty() {
            true => String::new(),
            false => format!("<p>{}</p>\n", explained(&self.words)),
        };
        words + &self.tables.iter().map(Table::html).collect::<String>()
    }
}

/// A number for people: so many significant digits, powers of ten raised.
pub(super) fn figure(x: f64, digits: usize) -> String {
    scientific(&significant(x, digits))
}

/// The same of a number that may be missing.
pub(super) fn perhaps(x: Option<f64>, digits: usize) -> String {
    x.map_or("–".to_owned(), |x| figure(x, digits))
}

/// Items as one reads them: a, b and c.
pub(super) fn listed(items: &[String]) -> String {
    match items {
        [] => "none".to_owned(),
        [one] => one.clone(),
        [all @ .., last] => format!("{} and {last}", all.join(", ")),
    }
}
