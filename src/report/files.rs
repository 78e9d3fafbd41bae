//! What a finding leaves beside its page.

use super::csv::finding_csv;
use super::plot::figure_svg;
use crate::lab::finding::{Figure, Finding, Table};

/// The files of a finding, name and text: every table that has one, every figure, and those of its
/// own.
pub fn finding_files(finding: &Finding) -> Vec<(String, String)> {
    let table = |t: &Table| Some((t.file.clone()?, finding_csv(t)));
    let figure = |f: &Figure| (f.file.clone(), figure_svg(f));
    let tables = finding.tables.iter().filter_map(table);
    let figures = finding.figures.iter().map(figure);
    let others = finding.files.iter().cloned();
    tables.chain(figures).chain(others).collect()
}
