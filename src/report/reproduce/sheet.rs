//! The plots of an item on one sheet, as SVG.

use super::super::chart::{Axis, Run, Series, legend, panel, sheet};
use super::super::svg::{Close, Svg};
use crate::study::reproduce::{Course, FigureAxis, FigureCurve, Plot, Reproduction, Source};

/// Plots a row.
const COLUMNS: usize = 2;
/// Width and height of a plotting area, and from one to the next, px.
pub(super) const AREA: [f64; 2] = [400.0, 260.0];
pub(super) const PITCH: [f64; 2] = [520.0, 370.0];
/// Upper left corner of the first.
pub(super) const FIRST: [f64; 2] = [90.0, 96.0];
/// Ink of what was published.
const PRINTED: &str = "fill=\"none\" stroke=\"#222222\" stroke-width=\"1.6\"";

/// Where the plotting area of plot `i` begins.
pub(super) fn corner(i: usize) -> [f64; 2] {
    let (column, row) = (i % COLUMNS, i / COLUMNS);
    [
        FIRST[0] + PITCH[0] * column as f64,
        FIRST[1] + PITCH[1] * row as f64,
    ]
}

/// The names of all curves, each once, computed ones before published ones: curves of one name look the same in every plot.
pub(super) fn names(r: &Reproduction) -> [Vec<&str>; 2] {
    [Source::Computed, Source::Published].map(|source| {
        let mut names: Vec<&str> = Vec::new();
        for c in r
            .plots
            .iter()
            .flat_map(|p| &p.curves)
            .filter(|c| c.source == source)
        {
            if !names.contains(&c.name.as_str()) {
                names.push(&c.name);
            }
        }
        names
    })
}

/// Width and height of the sheet.
pub(super) fn size(r: &Reproduction) -> [u32; 2] {
    let [computed, printed] = names(r);
    let columns = r.plots.len().min(COLUMNS);
    let width = (FIRST[0] + PITCH[0] * columns as f64).max(760.0);
    [
        width as u32,
        (legend_top(r) + 20.0 * (computed.len() + printed.len()) as f64 + 16.0) as u32,
    ]
}

/// Where the legend begins.
pub(super) fn legend_top(r: &Reproduction) -> f64 {
    FIRST[1] + PITCH[1] * r.plots.len().div_ceil(COLUMNS) as f64 - 30.0
}

/// The axes of a plot.
pub(super) fn axes(plot: &Plot) -> [Axis; 2] {
    std::array::from_fn(|d| {
        axis(
            &plot.axes[d],
            plot.curves
                .iter()
                .flat_map(|c| &c.points)
                .map(move |p| p[d]),
        )
    })
}

fn axis(axis: &FigureAxis, values: impl Iterator<Item = f64>) -> Axis {
    match axis.course {
        Course::Logarithmic => Axis::decades(values, axis.title.clone()),
        Course::Linear => Axis {
            run: Run::Linear,
            ends: axis.ends,
            title: axis.title.clone(),
        },
    }
}

/// The computed curves of a plot in the order of `names`, those that it lacks empty.
pub(super) fn series(plot: &Plot, names: &[&str]) -> Vec<Series> {
    let points = |name: &str| {
        let own = |c: &&FigureCurve| c.name == name && c.source == Source::Computed;
        plot.curves
            .iter()
            .find(own)
            .map_or(Vec::new(), |c| c.points.clone())
    };
    names
        .iter()
        .map(|name| Series {
            name: (*name).to_owned(),
            points: points(name),
        })
        .collect()
}

pub(super) fn svg(r: &Reproduction) -> String {
    let [computed, printed] = names(r);
    let mut svg = sheet(size(r), &format!("{}: {}", r.item, r.title), "");
    for (i, plot) in r.plots.iter().enumerate() {
        let corner = corner(i);
        let [x, y] = axes(plot);
        svg.text(
            [corner[0], corner[1] - 12.0],
            "fill=\"#222222\"",
            &plot.title,
        );
        panel(&mut svg, corner, AREA, [&x, &y], &series(plot, &computed));
        for c in plot.curves.iter().filter(|c| c.source == Source::Published) {
            let which = printed.iter().position(|n| *n == c.name).unwrap_or(0);
            for point in &c.points {
                if let Some(p) = super::super::chart::place(corner, AREA, [&x, &y], point) {
                    mark(&mut svg, p, which);
                }
            }
        }
    }
    let (top, left) = (legend_top(r), FIRST[0] - 20.0);
    let key = series(&r.plots[0], &computed);
    legend(&mut svg, [left, top], &key);
    for (i, name) in printed.iter().enumerate() {
        let y = top + 20.0 * (computed.len() + i) as f64;
        mark(&mut svg, [left + 15.0, y], i);
        svg.text(
            [left + 38.0, y + 4.0],
            "fill=\"#222222\"",
            &format!("{name} (published)"),
        );
    }
    svg.raw("</svg>");
    svg.text
}

/// A published point: diamonds for the first set, squares for the second.
fn mark(svg: &mut Svg, [x, y]: [f64; 2], which: usize) {
    let s = 6.0;
    match which % 2 {
        0 => svg.path(
            &[[x - s, y], [x, y - s], [x + s, y], [x, y + s]],
            Close::Yes,
            PRINTED,
        ),
        _ => svg.rect([x - 5.0, y - 5.0], [10.0, 10.0], PRINTED),
    }
}
