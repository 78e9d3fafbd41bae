//! What was found on all items: `reproduction.md`, `reproduction.html` and the table of the terminal.

use serde::{Deserialize, Serialize};

use super::super::axis::significant;
use super::super::page::{Library, Page, Room, Tone, explained};
use super::super::picture::scientific;
use super::super::svg::escape;
use crate::study::reproduce::{Cell, Check, ReproducePlan, Reproduction, Verdict, Weight};

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

/// What the verdicts come to: how many items of each.
fn verdict(items: &[ItemSummary]) -> String {
    let all = [
        Verdict::Reproduced,
        Verdict::InTrend,
        Verdict::NotReproducible,
        Verdict::Refuted,
    ];
    let counts: Vec<String> = all
        .iter()
        .map(|v| {
            let n = items.iter().filter(|i| i.verdict == *v).count();
            format!("{n} {}", v.words())
        })
        .collect();
    let checks = || items.iter().flat_map(|i| &i.checks);
    format!(
        "Of {} published items that were computed again, {}; {} of {} checks hold.",
        items.len(),
        counts.join(", "),
        checks().filter(|c| c.holds).count(),
        checks().count()
    )
}

/// How the items were asked for.
#[derive(Clone, Copy, Debug)]
pub struct ReproductionSettings<'a> {
    /// What was free.
    pub plan: &'a ReproducePlan,
    /// Version of the program.
    pub version: &'a str,
}

/// The page as HTML, whole in itself; `read` gives the bytes of an item's file. Of a file that is not there the page has the name.
pub fn reproduction_html(
    items: &[ItemSummary],
    settings: ReproductionSettings<'_>,
    read: impl Fn(&str) -> Option<Vec<u8>>,
) -> String {
    let mut page = Page::new("The published study, computed again");
    page.verdict(Tone::Plain, &verdict(items));
    page.needs(Library::Plot);
    let mut summary = format!(
        "<p>{}</p>\n<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"Verdicts\"><table>\n<tr><th scope=\"col\">item</th><th scope=\"col\">what</th><th scope=\"col\">verdict</th></tr>\n",
        escape(HOW)
    );
    for i in items {
        let [name, title, reason] = [&i.item, &i.title, &i.reason()].map(|t| escape(t));
        summary += &format!(
            "<tr><td><a href=\"#{name}\">{name}</a></td><td>{title}</td><td>{reason}</td></tr>\n"
        );
    }
    page.section("summary", "Verdicts", &(summary + "</table></div>\n"));
    let mut room = Room::new();
    for i in items {
        let html = section(i, &mut room, &read);
        page.section(&i.item, &format!("{}: {}", i.item, i.title), &html);
    }
    page.section("run", "What was run", &run(items, settings));
    page.html()
}

/// An item: figures, caption, table, checks, files.
fn section(i: &ItemSummary, room: &mut Room, read: &impl Fn(&str) -> Option<Vec<u8>>) -> String {
    let mut out = format!("<p><b>{}</b></p>\n", escape(&i.reason()));
    for file in i.pictures() {
        let svg = read(file).and_then(|bytes| String::from_utf8(bytes).ok());
        if let Some(svg) = svg {
            out += &room.figure(file, &svg);
        }
    }
    out += &format!("<p>{}</p>\n", explained(&i.caption));
    for note in &i.notes {
        out += &format!("<p>{}</p>\n", explained(note));
    }
    if !i.table.is_empty() {
        out += &format!(
            "<details><summary>The numbers of {0}</summary>\n<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"The numbers of {0}\"><table>\n",
            escape(&i.item)
        );
        for (k, row) in i.table.iter().enumerate() {
            let tag = if k == 0 { "th" } else { "td" };
            let cells = row.iter().map(|c| format!("<{tag}>{}</{tag}>", escape(c)));
            out += &format!("<tr>{}</tr>\n", cells.collect::<String>());
        }
        out += "</table></div>\n</details>\n";
    }
    out += &format!(
        "<details open=\"\"><summary>The checks of {0}</summary>\n<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"The checks of {0}\"><table>\n\
         <tr><th>holds</th><th>what</th><th>published</th><th>computed</th><th>criterion</th></tr>\n",
        escape(&i.item)
    );
    for c in &i.checks {
        let fields = [&c.what, &c.published, &c.computed, &c.criterion]
            .map(|t| format!("<td>{}</td>", escape(t)));
        let holds = if c.holds { "yes" } else { "<b>no</b>" };
        out += &format!("<tr><td>{holds}</td>{}</tr>\n", fields.concat());
    }
    out += "</table></div>\n</details>\n";
    let (kept, beside): (Vec<&String>, Vec<&String>) =
        i.files.iter().partition(|f| f.ends_with(".csv"));
    let kept: Vec<(&str, Vec<u8>)> = kept
        .into_iter()
        .filter_map(|f| Some((f.as_str(), read(f)?)))
        .collect();
    out += &room.files(kept.iter().map(|(name, bytes)| (*name, &bytes[..])));
    let beside: Vec<String> = beside.into_iter().map(|f| escape(f)).collect();
    match beside.is_empty() {
        true => out,
        false => format!(
            "{out}<p class=\"note\">Beside this page: {}</p>\n",
            beside.join(", ")
        ),
    }
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
    let rows = facts.map(|(key, value)| {
        let [key, value] = [key, &value].map(escape);
        format!("<tr><th scope=\"row\">{key}</th><td>{value}</td></tr>\n")
    });
    let command = format!(
        "phicam reproduce {} --most-elements {} --seeds {} --seed {}",
        names.join(" "),
        plan.most_elements,
        plan.seeds,
        plan.first_seed
    );
    format!(
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"Settings\"><table>\n{}</table></div>\n<h3>To repeat it</h3>\n<pre>{}</pre>\n",
        rows.concat(),
        escape(&command)
    )
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
