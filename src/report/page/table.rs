//! Tables of a page, each in a frame that scrolls where it is wider than the page.

use super::super::cells::Cells;
use super::super::svg::{escape, number};
use super::term::explained;
use crate::lab::finding::Table;

/// Rows of a table in a frame that is named for screen readers and is reached by the keyboard.
pub(in super::super) fn framed(name: &str, rows: &str) -> String {
    format!(
        "<div class=\"wide\" tabindex=\"0\" role=\"group\" aria-label=\"{}\"><table>\n{rows}</table></div>\n",
        escape(name)
    )
}

/// A table with its caption above and its note below.
pub(in super::super) fn table(table: &Table) -> String {
    let caption = match table.caption.as_str() {
        "" => String::new(),
        caption => format!("<h3>{}</h3>\n", explained(caption)),
    };
    caption + &bare(table)
}

/// A table with its note.
pub(in super::super) fn bare(table: &Table) -> String {
    let cells = Cells::of(table);
    let class = |i: usize| if cells.words[i] { "" } else { " class=\"n\"" };
    let headless = cells.heads.is_none();
    // A share has its bar in a cell beside it.
    let shared = |i: usize| cells.shares.iter().any(|row| row[i].is_some());
    let mut rows = String::new();
    if let Some(heads) = &cells.heads {
        let head = |(i, h): (usize, &String)| {
            let both = if shared(i) { " colspan=\"2\"" } else { "" };
            format!("<th scope=\"col\"{both}{}>{}</th>", class(i), explained(h))
        };
        let heads: String = heads.iter().enumerate().map(head).collect();
        rows += &format!("<tr>{heads}</tr>\n");
    }
    for (row, shares) in cells.rows.iter().zip(&cells.shares) {
        let bar = |share: Option<f64>| {
            let width = number((160.0 * share.unwrap_or(0.0)).max(0.0));
            format!("<td><span class=\"bar\" style=\"width:{width}px\"></span></td>")
        };
        let cell = |(i, text): (usize, &String)| match i {
            0 if headless => format!("<th scope=\"row\">{}</th>", escape(text)),
            _ => {
                let bar = if shared(i) {
                    bar(shares[i])
                } else {
                    String::new()
                };
                format!("<td{}>{}</td>{bar}", class(i), escape(text))
            }
        };
        let row: String = row.iter().enumerate().map(cell).collect();
        rows += &format!("<tr>{row}</tr>\n");
    }
    let name = match table.caption.as_str() {
        "" => "Table",
        caption => caption,
    };
    let note = match table.note.as_str() {
        "" => String::new(),
        note => format!("<p class=\"note\">{}</p>\n", explained(note)),
    };
    framed(name, &rows) + &note
}
