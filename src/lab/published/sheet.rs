//! The finding of an item, and pictures as items show them.

use super::item::Item;
use crate::lab::finding::{Figure, Finding, Picture, Place, Plot, Table};

/// What the captions of several items say of kernel, pixels, tolerance and normalisation.
pub(super) const BOTH_KERNELS: &str = "Published and physical kernel (G12 and G23 alike)";
pub(super) const VIEW: &str = "16 × 16 pixels laid to the edges of the view";
pub(super) const CUT: &str = "Moore–Penrose inverse cut at max(r, l)·eps(σ1), eps the spacing of \
                              doubles at σ1 (MATLAB)";
pub(super) const STRETCHED: &str = "normalized MTF of the values stretched to [0, 1]";

/// What is plotted of a result: the title of its axis, and its value.
pub(super) type Measure<R, T> = (&'static str, fn(&R) -> T);

/// Side of the published object, in.
const OBJECT: f64 = 4.0;
/// A table of more rows than this is left to its CSV file.
const MOST_ROWS: usize = 40;

/// The finding of `item`. `caption` says kernel, layout, pixels, tolerance rule and normalisation.
pub(super) fn finding(
    item: Item,
    title: impl Into<String>,
    caption: impl Into<String>,
    table: Table,
    plots: Vec<Plot>,
) -> Finding {
    let title = title.into();
    let figure = Figure::new(format!("{item}.svg"), format!("{item}: {title}"), plots);
    let place = if table.rows.len() > MOST_ROWS {
        Place::File
    } else {
        Place::Page
    };
    Finding {
        title,
        tables: vec![Table {
            caption: caption.into(),
            file: Some(format!("{item}.csv")),
            place,
            ..table
        }],
        figures: Some(figure)
            .filter(|f| !f.plots.is_empty())
            .into_iter()
            .collect(),
        ..Finding::default()
    }
}

/// Whether every row has a cell for each column, and every picture as many values as its size says.
pub(super) fn is_whole(finding: &Finding) -> bool {
    let row = |t: &Table| t.rows.iter().all(|r| r.len() == t.columns.len());
    let picture = |p: &Picture| p.size[0].checked_mul(p.size[1]) == Some(p.values.len());
    let mut pictures = finding.galleries.iter().flat_map(|g| &g.pictures);
    finding.tables.iter().all(row) && pictures.all(picture)
}

/// A square picture, `width` inches wide.
pub(super) fn square(
    title: impl Into<String>,
    side: usize,
    values: Vec<f64>,
    axes: [&str; 2],
    width: f64,
) -> Picture {
    Picture {
        title: title.into(),
        size: [side; 2],
        values,
        axes: axes.map(str::to_owned),
        width,
    }
}

/// The elements as a picture, iu to the right and distance from the hinge upwards.
pub(super) fn elements(title: impl Into<String>, side: usize, values: Vec<f64>) -> Picture {
    square(title, side, values, ["x", "d"], OBJECT)
}

/// A board of `checks` a side on `side` × `side` points, the first check dark: 0 or 1.
pub(super) fn board(side: usize, checks: usize) -> Vec<f64> {
    let check = |at: usize| at % side * checks / side + at / side * checks / side;
    (0..side * side).map(|at| (check(at) % 2) as f64).collect()
}
