//! Computed items in short, and what all of them come to.

use serde::{Deserialize, Serialize};

use super::item::Item;
use crate::lab::check::{Check, Verdict};
use crate::lab::finding::{Cell, Column, Describe, Finding, Place, Table, Tone};
use crate::num::digits::perhaps;

/// An item in short, as `ITEM.json` keeps it: what the page is made of, and what tells whether the
/// item has to be computed again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ItemSummary {
    /// Name of the item.
    pub item: String,
    /// What results have to share to belong together.
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
    /// Its table, the head first, where it is short enough to be read; the CSV has every row and
    /// digit.
    pub table: Vec<Vec<String>>,
    /// Names of the item's other files.
    pub files: Vec<String>,
}

/// The finding with the verdict that its checks come to.
pub(super) fn judged(finding: Finding) -> Finding {
    let verdict = Verdict::of(&finding.checks);
    Finding {
        tone: tone(verdict),
        sentence: verdict.reason(&finding.checks),
        ..finding
    }
}

fn tone(verdict: Verdict) -> Tone {
    match verdict {
        Verdict::Reproduced | Verdict::InTrend => Tone::Good,
        Verdict::NotReproducible | Verdict::Refuted => Tone::Bad,
    }
}

impl ItemSummary {
    /// Of a computed item with its files.
    pub fn new(item: Item, finding: &Finding, settings: String, files: Vec<String>) -> Self {
        let tables = &finding.tables;
        let shown = tables.iter().filter(|t| t.place != Place::File);
        Self {
            item: item.name().to_owned(),
            settings,
            title: finding.title.clone(),
            caption: tables.first().map_or(String::new(), |t| t.caption.clone()),
            verdict: Verdict::of(&finding.checks),
            checks: finding.checks.clone(),
            notes: finding.notes.clone(),
            table: shown.flat_map(readable).collect(),
            files,
        }
    }

    /// How many of its checks hold.
    pub fn held(&self) -> usize {
        self.checks.iter().filter(|c| c.holds).count()
    }

    /// Its figures and pictures.
    pub fn pictures(&self) -> impl Iterator<Item = &String> {
        self.files.iter().filter(|f| f.ends_with(".svg"))
    }
}

/// A table as it is read: four significant digits, the heads first.
fn readable(table: &Table) -> Vec<Vec<String>> {
    let cell = |c: &Cell| match c {
        Cell::Text(text) | Cell::Name(text) => text.clone(),
        Cell::Flag(yes) => if *yes { "yes" } else { "no" }.to_owned(),
        Cell::Count(n) => n.to_string(),
        Cell::Number(x) | Cell::Share(x) => perhaps(*x, 4),
        Cell::Estimate { value, .. } => perhaps(Some(*value), 4),
    };
    let heads = table.columns.iter().map(|c| c.name.clone()).collect();
    let rows = table.rows.iter().map(|row| row.iter().map(cell).collect());
    std::iter::once(heads).chain(rows).collect()
}

impl Describe for ItemSummary {
    /// The item without its figures, which stand in its files.
    fn describe(&self) -> Finding {
        let mut rows = self.table.iter();
        let heads = rows.next().map_or(&[][..], |heads| heads);
        let table = Table {
            caption: format!("The numbers of {}", self.item),
            columns: heads.iter().map(|name| Column::text(name, name)).collect(),
            rows: rows
                .map(|row| row.iter().map(|c| c.as_str().into()).collect())
                .collect(),
            ..Table::default()
        };
        let caption = std::iter::once(self.caption.clone());
        Finding {
            title: format!("{}: {}", self.item, self.title),
            tone: tone(self.verdict),
            sentence: self.verdict.reason(&self.checks),
            notes: caption.chain(self.notes.iter().cloned()).collect(),
            tables: vec![table]
                .into_iter()
                .filter(|t| !t.rows.is_empty())
                .collect(),
            checks: self.checks.clone(),
            ..Finding::default()
        }
    }
}

const HOW: &str = "Each verdict follows from the checks below it: refuted if the computation \
     contradicts a published statement; not reproducible if a published trend does not show, or \
     if numbers are missed and no trend is published; reproduced in trend if numbers are missed \
     but every trend shows; otherwise reproduced.";

/// What the verdicts on `items` come to.
pub fn overview(items: &[ItemSummary]) -> Finding {
    let counts = Verdict::ALL.map(|v| {
        let n = items.iter().filter(|i| i.verdict == v).count();
        format!("{n} {}", v.words())
    });
    let table = Table::of(
        items,
        [
            ("item", |i| i.item.as_str().into()),
            ("verdict", |i| i.verdict.reason(&i.checks).into()),
        ],
    );
    Finding {
        title: "The published study, computed again".to_owned(),
        sentence: format!(
            "Of {} published items that were computed again, {}; {} of {} checks hold.",
            items.len(),
            counts.join(", "),
            items.iter().map(ItemSummary::held).sum::<usize>(),
            items.iter().map(|i| i.checks.len()).sum::<usize>()
        ),
        notes: vec![HOW.to_owned()],
        tables: vec![table],
        ..Finding::default()
    }
}
