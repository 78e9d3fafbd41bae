//! The plots of an item on one sheet, as SVG.
//!
//! 830 units are 180 mm, the width of two columns of a journal: type of 13 units is then 8 pt, a line of 1.6 units 1 pt. A single plot takes one column, 90 mm.

use super::super::chart::{Axis, Panel, Run, Series};
use super::super::label::legend;
use super::super::look::{printed_mark, sample};
use super::super::picture::lettered;
use super::super::raster::FAMILIES;
use super::super::svg::{Svg, escape, number};
use crate::study::reproduce::{Course, FigureAxis, FigureCurve, Plot, Reproduction, Source};

/// Plots a row.
const COLUMNS: usize = 2;
/// Width of a plotting area, and its height where there are up to three rows or more of them: four rows are a page of 230 mm.
const WIDTH: f64 = 328.0;
const HEIGHTS: [f64; 2] = [226.0, 176.0];
/// Between two rows of plots, for axis and title.
const BETWEEN: f64 = 80.0;
/// Upper left corner of the first.
const FIRST: [f64; 2] = [74.0, 30.0];
/// Width of a single column, and millimetres a unit.
const COLUMN: f64 = 415.0;
const MILLIMETRES: f64 = 180.0 / 830.0;
/// From the last row of plots to the legend, and left of the legend.
const BELOW: f64 = 64.0;
const LEFT: f64 = 20.0;
/// An even axis reaches beyond its ends by this share, so that no mark lies on the frame.
const BEYOND: f64 = 0.03;

/// Where the plotting area of plot `i` begins, areas being `height` high.
fn corner(i: usize, height: f64) -> [f64; 2] {
    let (column, row) = (i % COLUMNS, i / COLUMNS);
    [
        FIRST[0] + COLUMN * column as f64,
        FIRST[1] + (height + BETWEEN) * row as f64,
    ]
}

/// The names of all curves, each once, computed ones before published ones: curves of one name look the same in every plot.
fn names(r: &Reproduction) -> [Vec<&str>; 2] {
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

/// The axes of a plot.
fn axes(plot: &Plot) -> [Axis; 2] {
    std::array::from_fn(|d| {
        let points = plot.curves.iter().flat_map(|c| &c.points);
        axis(&plot.axes[d], points.map(move |p| p[d]))
    })
}

fn axis(axis: &FigureAxis, values: impl Iterator<Item = f64>) -> Axis {
    match axis.course {
        Course::Logarithmic => Axis::decades(values, axis.title.clone()),
        Course::Linear => {
            // Nothing that was computed is left out.
            let finite = values.filter(|x| x.is_finite());
            let [low, high] = finite.fold(axis.ends, |[a, b], x| [a.min(x), b.max(x)]);
            let beyond = BEYOND * (high - low);
            Axis {
                run: Run::Linear,
                ends: [low - beyond, high + beyond],
                title: axis.title.clone(),
            }
        }
    }
}

/// The curves of a plot from `source` in the order of `names`, those that it lacks empty.
fn series(plot: &Plot, source: Source, names: &[&str]) -> Vec<Series> {
    let points = |name: &str| -> Vec<[f64; 2]> {
        let own = |c: &&FigureCurve| c.name == name && c.source == source;
        let own = plot.curves.iter().filter(own);
        own.flat_map(|c| c.points.iter().copied()).collect()
    };
    names
        .iter()
        .map(|name| Series {
            name: (*name).to_owned(),
            points: points(name),
        })
        .collect()
}

/// The key of the figure in rows below the plots, and its height.
fn key(width: f64, computed: &[&str], printed: &[&str]) -> (Svg, f64) {
    let lines = computed
        .iter()
        .enumerate()
        .map(|(i, name)| (sample(i), (*name).to_owned()));
    let points = printed.iter().enumerate().map(|(i, name)| {
        let mut svg = Svg::default();
        printed_mark(&mut svg, [15.0, 0.0], i);
        (svg.text, format!("{name} (published)"))
    });
    let entries: Vec<(String, String)> = lines.chain(points).collect();
    let mut svg = Svg::default();
    let height = legend(&mut svg, [0.0, 0.0], width - 2.0 * LEFT, &entries);
    (svg, height)
}

pub(super) fn svg(r: &Reproduction) -> String {
    let [computed, printed] = names(r);
    let width = COLUMN * r.plots.len().min(COLUMNS) as f64;
    let (key, below) = key(width, &computed, &printed);
    let rows = r.plots.len().div_ceil(COLUMNS);
    let area = [WIDTH, HEIGHTS[usize::from(rows > 3)]];
    let top = FIRST[1] + (area[1] + BETWEEN) * rows as f64 - BETWEEN + BELOW;
    let height = (top + below).ceil();
    let mut svg = Svg::default();
    svg.raw(&format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.3}mm\" height=\"{:.3}mm\" viewBox=\"0 0 {width} {height}\" font-family=\"{FAMILIES}\" \
         font-size=\"13\" role=\"img\" aria-label=\"{}\"><rect width=\"100%\" height=\"100%\" fill=\"white\"/>",
        MILLIMETRES * width,
        MILLIMETRES * height,
        escape(&format!("{}: {}", r.item, r.title))
    ));
    for (i, plot) in r.plots.iter().enumerate() {
        let corner = corner(i, area[1]);
        let [x, y] = axes(plot);
        let title = lettered(i, r.plots.len(), &plot.title);
        let dark = "fill=\"#222222\"";
        svg.text([corner[0], corner[1] - 9.0], dark, &title);
        Panel {
            corner,
            size: area,
            axes: [&x, &y],
            title: &title,
            series: &series(plot, Source::Computed, &computed),
            published: &series(plot, Source::Published, &printed),
        }
        .draw(&mut svg);
    }
    svg.raw(&format!(
        "<g transform=\"translate({} {})\">{}</g></svg>",
        number(LEFT),
        number(top),
        key.text
    ));
    svg.text
}
