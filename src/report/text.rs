//! A finding for the terminal.

use super::cells::Cells;
use super::picture::wrapped;
use crate::lab::finding::{Check, Column, Finding, Place, Table};

/// Columns of the terminal that words keep to, and tables where their numbers let them.
const WIDTH: usize = 80;
/// The last column of a table is not set narrower than this.
const NARROW: usize = 24;
/// A head is broken between words where it is wider than this and than what stands below.
const HEAD: usize = 9;
/// Between two columns.
const GAP: &str = "  ";

/// Title, sentence, notes, tables and checks. Control characters, which could steer a terminal,
/// become spaces.
pub fn finding_text(finding: &Finding) -> String {
    let mut out = String::new();
    paragraph(&mut out, &finding.title);
    paragraph(&mut out, &finding.sentence);
    for note in &finding.notes {
        paragraph(&mut out, note);
    }
    let tables = finding.tables.iter();
    for table in tables.filter(|t| t.place == Place::Everywhere) {
        put(&mut out, table);
    }
    if !finding.checks.is_empty() {
        put(&mut out, &checks(&finding.checks));
    }
    out.split('\n').map(clean).collect::<Vec<_>>().join("\n")
}

/// Without control characters.
fn clean(text: &str) -> String {
    let harmless = |c: char| if c.is_control() { ' ' } else { c };
    text.chars().map(harmless).collect()
}

/// The checks of a finding as a table.
pub(super) fn checks(all: &[Check]) -> Table {
    let row = |c: &Check| {
        let words = [&c.what, &c.published, &c.computed, &c.criterion].map(|t| t.clone().into());
        std::iter::once(c.holds.into()).chain(words).collect()
    };
    let heads = ["holds", "what", "published", "computed", "criterion"];
    Table {
        caption: "Published beside computed".to_owned(),
        columns: heads.map(|head| Column::text(head, "")).to_vec(),
        rows: all.iter().map(row).collect(),
        ..Table::default()
    }
}

/// A paragraph, below an empty line unless it is the first.
fn paragraph(out: &mut String, text: &str) {
    if text.is_empty() {
        return;
    }
    if !out.is_empty() {
        out.push('\n');
    }
    for line in lines(text, WIDTH) {
        *out += &format!("{line}\n");
    }
}

/// Text in lines; a power of ten stays on the line of its number.
fn lines(text: &str, width: usize) -> Vec<String> {
    wrapped(&text.replace(" × 10", "\u{a0}×\u{a0}10"), width)
}

/// A table with its caption and its note.
fn put(out: &mut String, table: &Table) {
    paragraph(out, &table.caption);
    if table.caption.is_empty() && !out.is_empty() {
        out.push('\n');
    }
    let cells = Cells::of(table);
    let widths = widths(&cells);
    if let Some(heads) = &cells.heads {
        let lines = |(text, width): (&String, &usize)| wrapped(text, *width);
        let heads: Vec<Vec<String>> = heads.iter().zip(&widths).map(lines).collect();
        row(out, &heads, &widths, &cells.words);
    }
    for cells_of_row in &cells.rows {
        let lines = |(i, text): (usize, &String)| {
            if i + 1 == widths.len() {
                lines(text, widths[i])
            } else {
                vec![clean(text)]
            }
        };
        let lines: Vec<Vec<String>> = cells_of_row.iter().enumerate().map(lines).collect();
        row(out, &lines, &widths, &cells.words);
    }
    for line in lines(&table.note, WIDTH) {
        *out += &format!("{line}\n");
    }
}

/// Widths of the columns: of their texts and the words of their heads. A last column of words has
/// what is left.
fn widths(cells: &Cells) -> Vec<usize> {
    let count = |text: &str| text.chars().count();
    let head = |i: usize| {
        let head = cells.heads.as_ref().map_or("", |h| &h[i]);
        let longest = head.split(' ').map(count).max().unwrap_or(0);
        longest.max(count(head).min(HEAD))
    };
    let body = |i: usize| cells.rows.iter().map(|r| count(&r[i])).max().unwrap_or(0);
    let mut widths: Vec<usize> = (0..cells.words.len())
        .map(|i| head(i).max(body(i)))
        .collect();
    let before: usize = widths.iter().rev().skip(1).map(|w| w + GAP.len()).sum();
    if let (Some(last), Some(true)) = (widths.last_mut(), cells.words.last()) {
        *last = (*last).min(WIDTH.saturating_sub(before).max(NARROW));
    }
    widths
}

/// A row of texts of one or more lines each.
fn row(out: &mut String, cells: &[Vec<String>], widths: &[usize], words: &[bool]) {
    let height = cells.iter().map(Vec::len).max().unwrap_or(0);
    for k in 0..height {
        let cell = |i: usize| {
            let text = cells[i].get(k).map_or("", String::as_str);
            let width = widths[i];
            if words[i] {
                format!("{text:<width$}")
            } else {
                format!("{text:>width$}")
            }
        };
        let line: Vec<String> = (0..cells.len()).map(cell).collect();
        *out += line.join(GAP).trim_end();
        out.push('\n');
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::finding::Cell;

    fn finding() -> Finding {
        let table = |caption: &str, place| Table {
            caption: caption.to_owned(),
            place,
            columns: vec![
                Column::text("method", "method"),
                Column::number("after the best single scale", "scale", "", 2),
                Column::text("what it chose", "chosen"),
            ],
            rows: vec![vec![
                "pinv".into(),
                1.25e-7.into(),
                "a long sentence about the parameter ".repeat(4).into(),
            ]],
            note: "Said below.".to_owned(),
            ..Table::default()
        };
        Finding {
            title: "A study: bench".to_owned(),
            sentence: "It closes at 3 %. ".repeat(8),
            notes: vec!["An assumption.".to_owned()],
            tables: vec![
                table("Shown", Place::Everywhere),
                table("On the page", Place::Page),
                table("In the file", Place::File),
            ],
            ..Finding::default()
        }
    }

    #[test]
    fn words_and_tables_keep_to_80_columns() {
        let text = finding_text(&finding());
        assert!(text.lines().all(|l| l.chars().count() <= WIDTH), "{text}");
        assert!(text.starts_with("A study: bench\n\nIt closes at 3 %."));
        assert!(text.contains("\nAn assumption.\n\nShown\n") && text.contains("\nSaid below.\n"));
        assert!(!text.contains("On the page") && !text.contains("In the file"));
        // A head is broken between words, numbers stand on the right of it.
        let lines: Vec<&str> = text.lines().collect();
        let at = lines.iter().position(|l| l.contains("after the")).unwrap();
        assert!(lines[at].ends_with("what it chose"), "{text}");
        assert_eq!(lines[at + 1].trim(), "best");
        assert!(
            text.contains("pinv    1.2 × 10⁻⁷  a long sentence"),
            "{text}"
        );
    }

    #[test]
    fn nothing_steers_the_terminal() {
        let mut finding = finding();
        finding.title = "\u{1b}[31mred".to_owned();
        finding.tables[0].rows[0][0] = Cell::from("\u{1b}[2J\nforged");
        let text = finding_text(&finding);
        assert!(!text.contains('\u{1b}') && !text.contains("\nforged"));
    }
}
