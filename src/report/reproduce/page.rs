//! What was found on all items: `reproduction.md`, `reproduction.html` and the table of the terminal.

use serde::{Deserialize, Serialize};

use super::super::axis::significant;
use super::super::picture::scientific;
use super::super::svg::escape;
use crate::study::reproduce::{Cell, Check, Reproduction, Verdict, Weight};

/// An item in short, as `ITEM.json` keeps it: what the page is made of, and what tells whether the item has to be computed again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ItemSummary {
    /// Name of the item.
    pub item: String,
    /// What results have to share to be one another's.
    pub settings: String,
    /// What was published.
    pub title: String,
    /// Kernel, layout, pixels, tolerance rule and normalisation.
    pub caption: String,
    /// By the checks.
    pub verdict: Verdict,
    /// Published beside computed.
    pub checks: Vec<Check>,
    /// What else the numbers say.
    pub notes: Vec<String>,
    /// Its table, the head first, where it is short enough to be read; the CSV has every row and digit.
    pub table: Vec<Vec<String>>,
    /// Names of the item's other files.
    pub files: Vec<String>,
}

/// A table of more rows than this is left to the CSV.
const MOST_ROWS: usize = 40;

/// The rows as they are read: four significant digits, words for names of columns.
fn table(r: &Reproduction) -> Vec<Vec<String>> {
    if r.rows.len() > MOST_ROWS {
        return Vec::new();
    }
    let cell = |c: &Cell| match c {
        Cell::Text(text) => text.clone(),
        Cell::Count(n) => n.to_string(),
        Cell::Number(x) => x.map_or("–".to_owned(), |x| scientific(&significant(x, 4))),
    };
    let head = r
        .columns
        .iter()
        .map(|name| name.replace('_', " "))
        .collect();
    let rows = r.rows.iter().map(|row| row.iter().map(cell).collect());
    std::iter::once(head).chain(rows).collect()
}

impl ItemSummary {
    /// Of a computed item with its files.
    pub fn new(r: &Reproduction, settings: String, files: Vec<String>) -> Self {
        Self {
            item: r.item.name().to_owned(),
            settings,
            title: r.title.clone(),
            caption: r.caption.clone(),
            verdict: Verdict::of(&r.checks),
            checks: r.checks.clone(),
            notes: r.notes.clone(),
            table: table(r),
            files,
        }
    }

    /// The verdict with its reason where it is not the best.
    fn reason(&self) -> String {
        let mut failed: Vec<&Check> = self.checks.iter().filter(|c| !c.holds).collect();
        // What decided the verdict first.
        failed.sort_by_key(|c| match c.weight {
            Weight::Claim => 0,
            Weight::Trend => 1,
            Weight::Value => 2,
        });
        let held = self.checks.len() - failed.len();
        let all = self.checks.len();
        match (self.verdict, failed.first()) {
            (_, None) => format!("{} ({held} of {all} checks hold)", self.verdict.words()),
            (_, Some(first)) => format!(
                "{} ({held} of {all} checks hold; published of {}: {}; computed: {})",
                self.verdict.words(),
                first.what,
                first.published,
                first.computed
            ),
        }
    }

    fn pictures(&self) -> impl Iterator<Item = &String> {
        self.files.iter().filter(|f| f.ends_with(".svg"))
    }
}

const HOW: &str = "Each verdict follows from the checks below it: refuted, where a published statement is computed to be wrong; not reproducible, where a published trend \
                   does not show, or numbers are missed and no trend is published; reproduced in trend, where numbers are missed but every trend shows; reproduced else.";

/// The page as Markdown.
pub fn reproduction_markdown(items: &[ItemSummary]) -> String {
    let mut out = format!(
        "# The published study, computed again\n\n{HOW}\n\n| item | what | verdict |\n| --- | --- | --- |\n"
    );
    for i in items {
        out += &format!(
            "| [{}](#{}) | {} | {} |\n",
            i.item,
            i.item,
            cell(&i.title),
            cell(&i.reason())
        );
    }
    for i in items {
        out += &format!("\n## {}\n\n**{}**: {}\n\n", i.item, i.title, i.reason());
        for file in i.pictures() {
            out += &format!("![{}]({file})\n\n", i.title);
        }
        out += &format!("{}\n\n", i.caption);
        for note in &i.notes {
            out += &format!("{note}\n\n");
        }
        for (k, row) in i.table.iter().enumerate() {
            let cells: Vec<String> = row.iter().map(|c| cell(c)).collect();
            out += &format!("| {} |\n", cells.join(" | "));
            if k == 0 {
                out += &format!("|{}\n", " --- |".repeat(row.len()));
            }
        }
        if !i.table.is_empty() {
            out += "\n";
        }
        out += &format!(
            "Files: {}\n\n",
            i.files
                .iter()
                .map(|f| format!("[{f}]({f})"))
                .collect::<Vec<_>>()
                .join(", ")
        );
        out += "| holds | what | published | computed | criterion |\n| --- | --- | --- | --- | --- |\n";
        for c in &i.checks {
            let fields = [&c.what, &c.published, &c.computed, &c.criterion].map(|t| cell(t));
            out += &format!("| {} | {} |\n", yes(c.holds), fields.join(" | "));
        }
    }
    out
}

fn yes(holds: bool) -> &'static str {
    if holds { "yes" } else { "**no**" }
}

/// Text that cannot end a cell.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

const STYLE: &str = "body{font:15px/1.45 system-ui,sans-serif;max-width:75rem;margin:2rem auto;padding:0 1rem}table{border-collapse:collapse}\
td,th{border:1px solid #bbb;padding:.2rem .5rem;text-align:left}img{max-width:100%}.no{font-weight:bold}";

/// The page as HTML; figures are files beside it.
pub fn reproduction_html(items: &[ItemSummary]) -> String {
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>The published study, computed again</title>\n<style>{STYLE}</style>\n</head>\n<body>\n\
         <h1>The published study, computed again</h1>\n<p>{}</p>\n<table>\n<tr><th>item</th><th>what</th><th>verdict</th></tr>\n",
        escape(HOW)
    );
    for i in items {
        let [name, title, reason] = [&i.item, &i.title, &i.reason()].map(|t| escape(t));
        out += &format!(
            "<tr><td><a href=\"#{name}\">{name}</a></td><td>{title}</td><td>{reason}</td></tr>\n"
        );
    }
    out += "</table>\n";
    for i in items {
        let [name, title, reason, caption] =
            [&i.item, &i.title, &i.reason(), &i.caption].map(|t| escape(t));
        out += &format!("<h2 id=\"{name}\">{name}: {title}</h2>\n<p><b>{reason}</b></p>\n");
        for file in i.pictures().map(|f| escape(f)) {
            out += &format!("<p><img src=\"{file}\" alt=\"{title}\"></p>\n");
        }
        out += &format!("<p>{caption}</p>\n");
        for note in &i.notes {
            out += &format!("<p>{}</p>\n", escape(note));
        }
        if !i.table.is_empty() {
            out += "<table>\n";
            for (k, row) in i.table.iter().enumerate() {
                let tag = if k == 0 { "th" } else { "td" };
                let cells = row.iter().map(|c| format!("<{tag}>{}</{tag}>", escape(c)));
                out += &format!("<tr>{}</tr>\n", cells.collect::<String>());
            }
            out += "</table>\n";
        }
        let links = i
            .files
            .iter()
            .map(|f| format!("<a href=\"{0}\">{0}</a>", escape(f)));
        out += &format!("<p>Files: {}</p>\n", links.collect::<Vec<_>>().join(", "));
        out += "<details><summary>Checks</summary>\n<table>\n<tr><th>holds</th><th>what</th><th>published</th><th>computed</th><th>criterion</th></tr>\n";
        for c in &i.checks {
            let fields = [&c.what, &c.published, &c.computed, &c.criterion]
                .map(|t| format!("<td>{}</td>", escape(t)));
            let holds = if c.holds {
                "<td>yes</td>"
            } else {
                "<td class=\"no\">no</td>"
            };
            out += &format!("<tr>{holds}{}</tr>\n", fields.concat());
        }
        out += "</table>\n</details>\n";
    }
    out + "</body>\n</html>\n"
}

/// A line an item, for the terminal.
pub fn reproduction_table(items: &[ItemSummary]) -> String {
    let line = |i: &ItemSummary| {
        let held = i.checks.iter().filter(|c| c.holds).count();
        format!(
            "{:<11} {:<20} {held:>3} of {:>3} checks hold\n",
            i.item,
            i.verdict.words(),
            i.checks.len()
        )
    };
    items.iter().map(line).collect()
}
