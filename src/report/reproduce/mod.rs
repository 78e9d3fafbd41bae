//! The published study computed again, as files: tables, figures, pictures, and the pages that put
//! all items together.

use super::cells::Cells;
use super::csv::finding_csv;
use super::encode::PictureError;
use super::gallery_svg::gallery_svg;
use super::html::numbers;
use super::page::{Library, Page, Room, table};
use super::plot::figure_svg;
use super::raster;
use super::svg::escape;
use super::text::checks;
use crate::lab::finding::{Column, Describe, Finding, Table};
use crate::lab::published::{Item, ItemSummary, ReproducePlan, overview};

/// The files of an item: name and bytes. `ITEM.csv`; where it has plots `ITEM.svg`; for its
/// pictures `ITEM-images.svg`, further ones numbered. Beside each SVG the PNG that is drawn from
/// it, 300 pixels an inch at the width of one (90 mm) or two (180 mm) columns of a journal.
///
/// # Errors
/// [`PictureError`].
pub fn reproduction_files(
    item: Item,
    finding: &Finding,
) -> Result<Vec<(String, Vec<u8>)>, PictureError> {
    let figures = finding.figures.iter();
    let mut drawings: Vec<(String, String)> = figures
        .map(|f| (f.file.replace(".svg", ""), figure_svg(f)))
        .collect();
    for (gallery, number) in finding.galleries.iter().zip(1..) {
        let number = if number == 1 {
            String::new()
        } else {
            format!("-{number}")
        };
        drawings.push((format!("{item}-images{number}"), gallery_svg(gallery)?));
    }
    let file = |t: &Table| Some((t.file.clone()?, finding_csv(t).into_bytes()));
    let mut files: Vec<(String, Vec<u8>)> = finding.tables.iter().filter_map(file).collect();
    for (name, svg) in drawings {
        let png = raster::png(&svg)?;
        files.push((format!("{name}.svg"), svg.into_bytes()));
        files.push((format!("{name}.png"), png));
    }
    Ok(files)
}

/// All items as Markdown, with the pictures beside it.
pub fn reproduction_markdown(items: &[ItemSummary]) -> String {
    let all = overview(items);
    let mut out = format!(
        "# {}\n\n{}\n\n{}\n\n| item | verdict |\n| --- | --- |\n",
        all.title,
        all.sentence,
        all.notes.join("\n\n")
    );
    for i in items {
        let verdict = i.describe().sentence.replace('|', "\\|");
        out += &format!("| [{0}](#{0}) | {verdict} |\n", i.item);
    }
    for i in items {
        let found = i.describe();
        out += &format!("\n## {}\n\n**{}**: {}\n\n", i.item, i.title, found.sentence);
        for file in i.pictures() {
            out += &format!("![{}]({file})\n\n", i.title);
        }
        for note in &found.notes {
            out += &format!("{note}\n\n");
        }
        for table in found.tables.iter().chain([&checks(&found.checks)]) {
            out += &markdown(table);
        }
        let links: Vec<String> = i.files.iter().map(|f| format!("[{f}]({f})")).collect();
        out += &format!("Files: {}\n", links.join(", "));
    }
    out
}

/// A table as Markdown.
fn markdown(table: &Table) -> String {
    let cells = Cells::of(table);
    let line = |row: &Vec<String>| {
        let cells: Vec<_> = row.iter().map(|cell| cell.replace('|', "\\|")).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    let heads = cells.heads.unwrap_or_default();
    let rule = format!("|{}\n", " --- |".repeat(heads.len()));
    let rows: String = cells.rows.iter().map(line).collect();
    format!("{}{rule}{rows}\n", line(&heads))
}

/// How the items were asked for.
#[derive(Clone, Copy, Debug)]
pub struct ReproductionSettings<'a> {
    /// What was free.
    pub plan: &'a ReproducePlan,
    /// Version of the program.
    pub version: &'a str,
}

/// All items as one page of HTML that needs no other file; `read` gives the bytes of an item's
/// file. Of a file that is not there the page has the name.
pub fn reproduction_html(
    items: &[ItemSummary],
    settings: ReproductionSettings<'_>,
    read: impl Fn(&str) -> Option<Vec<u8>>,
) -> String {
    let all = overview(items);
    let mut page = Page::new(&all.title);
    page.verdict(all.tone, &all.sentence);
    page.needs(Library::Plot);
    page.section("summary", "Verdicts", &numbers(&all));
    let mut room = Room::new();
    for i in items {
        let html = section(i, &mut room, &read);
        page.section(&i.item, &i.describe().title, &html);
    }
    page.section("run", "What was run", &run(items, settings));
    page.html()
}

/// An item: figures, caption, table, checks, files.
fn section(i: &ItemSummary, room: &mut Room, read: &impl Fn(&str) -> Option<Vec<u8>>) -> String {
    let found = i.describe();
    let mut out = format!("<p><b>{}</b></p>\n", escape(&found.sentence));
    for file in i.pictures() {
        let svg = read(file).and_then(|bytes| String::from_utf8(bytes).ok());
        out += &svg.map_or(String::new(), |svg| room.figure(file, &svg));
    }
    out += &numbers(&found);
    let (kept, beside): (Vec<&String>, Vec<&String>) =
        i.files.iter().partition(|f| f.ends_with(".csv"));
    let kept = kept.into_iter().filter_map(|f| Some((f, read(f)?)));
    let kept: Vec<(&String, Vec<u8>)> = kept.collect();
    out += &room.files(kept.iter().map(|(name, bytes)| (name.as_str(), &bytes[..])));
    let beside: Vec<String> = beside.into_iter().map(|f| escape(f)).collect();
    if !beside.is_empty() {
        let beside = beside.join(", ");
        out += &format!("<p class=\"note\">Beside this page: {beside}</p>\n");
    }
    out
}

/// Settings and command.
fn run(
    items: &[ItemSummary],
    ReproductionSettings { plan, version }: ReproductionSettings<'_>,
) -> String {
    let names: Vec<&str> = items.iter().map(|i| i.item.as_str()).collect();
    let facts = [
        ("version", format!("phicam {version}")),
        ("most elements a side", plan.most_elements.to_string()),
        ("draws of noise", plan.seeds.to_string()),
        ("first seed", plan.first_seed.to_string()),
    ];
    let facts = Table {
        columns: vec![Column::text("", ""); 2],
        rows: facts
            .map(|(key, value)| vec![key.into(), value.into()])
            .to_vec(),
        ..Table::default()
    };
    let command = format!(
        "phicam reproduce {} --most-elements {} --seeds {} --seed {}",
        names.join(" "),
        plan.most_elements,
        plan.seeds,
        plan.first_seed
    );
    format!(
        "{}<h3>To repeat it</h3>\n<pre>{}</pre>\n",
        table(&facts),
        escape(&command)
    )
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
