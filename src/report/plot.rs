//! A figure of a finding as SVG: a sheet of plots with one legend.
//!
//! 830 units are 180 mm, the width of two columns of a journal: type of 13 units is then 8 pt, a
//! line of 1.6 units 1 pt. A single plot takes one column, 90 mm.

mod area;
mod looks;

use super::axis::Ruler;
use super::legend::samples;
use super::picture::{lettered, wrapped};
use super::svg::{FAMILIES, Svg, escape, ink};
use crate::lab::finding::{Curve, Figure, Mark, Plot};
use area::Area;
use looks::Looks;

/// Plots a row, and the width that each has.
const COLUMNS: usize = 2;
const COLUMN: f64 = 415.0;
const MILLIMETRES: f64 = 180.0 / 830.0;
/// Width of a plotting area, and its height where there are up to three rows or more of them: four
/// rows are a page of 230 mm.
const WIDTH: f64 = 328.0;
const HEIGHTS: [f64; 2] = [226.0, 176.0];
/// Height of a bar with the room around it.
const BAR: f64 = 13.0;
/// From the left end to a plotting area, and from its right end to that of its column.
const LEFT: f64 = 74.0;
const RIGHT: f64 = COLUMN - LEFT - WIDTH;
/// Above the first row of plots, between two, and from the last to the legend.
const ABOVE: f64 = 30.0;
const BETWEEN: f64 = 80.0;
const BELOW: f64 = 64.0;
/// Left of title and legend.
const MARGIN: f64 = 20.0;
/// Sizes of the title and of what is said below it, with the width of a letter of each, rounded up,
/// and lines of them.
const TITLE: (f64, f64, f64) = (15.0, 10.2, 20.0);
const NOTE: (f64, f64, f64) = (12.0, 7.2, 16.0);
const DARK: &str = "fill=\"#222222\"";

/// A figure as SVG with its title, its plots and one legend. Each plot leaves its data beside its
/// drawing (see `plotted`).
pub fn figure_svg(figure: &Figure) -> String {
    let rulers: Vec<[Ruler<'_>; 2]> = figure.plots.iter().map(|p| rulers(figure, p)).collect();
    let looks = Looks::of(figure);
    let categories = rulers.iter().filter_map(|[_, up]| up.categories());
    let widest = categories.flatten().map(|name| name.chars().count()).max();
    // Bars with their names have the whole width.
    let columns = match widest {
        Some(_) => 1,
        None => figure.plots.len().clamp(1, COLUMNS),
    };
    let width = match widest {
        Some(_) => COLUMN * COLUMNS as f64,
        None => COLUMN * columns as f64,
    };
    let left = widest.map_or(LEFT, |n| (NOTE.1 * n as f64 + 2.0 * MARGIN).max(LEFT));
    let rows = figure.plots.len().div_ceil(columns);
    let height = |plot: &Plot, [_, up]: &[Ruler<'_>; 2]| {
        let bars = plot.curves.iter().filter(|c| c.mark == Mark::Bars).count();
        match up.categories() {
            Some(names) => names.len() as f64 * BAR * (bars as f64 + 1.0),
            None => HEIGHTS[usize::from(rows > 3)],
        }
    };
    let mut svg = Svg::default();
    let mut top = heading(&mut svg, figure, &remark(figure, &rulers), width) + ABOVE;
    for (i, (plot, rulers)) in figure.plots.iter().zip(&rulers).enumerate() {
        let area = Area {
            corner: [left + COLUMN * (i % columns) as f64, top],
            size: [width / columns as f64 - left - RIGHT, height(plot, rulers)],
            rulers,
        };
        let title = lettered(i, figure.plots.len(), &plot.title);
        svg.text([area.corner[0], top - 9.0], DARK, &title);
        // The script of a page draws what it has the data of, and knows no bars.
        if widest.is_none() {
            svg.raw(&area.plotted(&title, plot, &looks).metadata());
        }
        area.draw(&mut svg, plot, &looks);
        if (i + 1) % columns == 0 || i + 1 == figure.plots.len() {
            top += area.size[1] + BETWEEN;
        }
    }
    top += BELOW - BETWEEN;
    let key = looks.legend();
    let below = if key.is_empty() {
        0.0
    } else {
        samples(&mut svg, [MARGIN, top], width - 2.0 * MARGIN, &key)
    };
    let height = (top + below).ceil();
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.3}mm\" height=\"{:.3}mm\" viewBox=\"0 0 {width} {height}\" font-family=\"{FAMILIES}\" \
         font-size=\"13\" role=\"img\" aria-label=\"{}\"><rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{}</svg>\n",
        MILLIMETRES * width,
        MILLIMETRES * height,
        escape(&figure.title),
        svg.text
    )
}

/// The axes of a plot with their ends. Axes of one direction and title share them.
fn rulers<'a>(figure: &'a Figure, plot: &'a Plot) -> [Ruler<'a>; 2] {
    std::array::from_fn(|d| {
        let axis = &plot.axes[d];
        let same = figure.plots.iter().filter(|p| p.axes[d] == *axis);
        let curves = same.flat_map(|p| &p.curves);
        let mut values: Vec<f64> = curves.flat_map(|c| &c.points).map(|p| p[d]).collect();
        if plot.curves.iter().any(|c| c.mark == Mark::Bars) {
            // There a bar begins.
            values.push(0.0);
        }
        let mut ruler = Ruler::around(axis, values.into_iter());
        if d == 1 && ruler.categories().is_some() {
            ruler.ends.reverse();
        }
        ruler
    })
}

/// What is said below the title: the figure's own note, what whiskers are, and how many points the
/// axes do not show.
fn remark(figure: &Figure, rulers: &[[Ruler<'_>; 2]]) -> String {
    let curves = || figure.plots.iter().flat_map(|p| &p.curves);
    let hidden = |(plot, [x, y]): (&Plot, &[Ruler<'_>; 2])| {
        let pointed = |c: &&Curve| !matches!(c.mark, Mark::Bars | Mark::Level);
        let points = plot.curves.iter().filter(pointed).flat_map(|c| &c.points);
        let beyond = |p: &&[f64; 2]| x.fraction(p[0]).is_none() || y.fraction(p[1]).is_none();
        points.filter(beyond).count()
    };
    let hidden: usize = figure.plots.iter().zip(rulers).map(hidden).sum();
    let mut words = vec![figure.note.clone()];
    if curves().any(|c| !c.stderr.is_empty()) {
        words.push("whiskers: ± 1 standard error".to_owned());
    }
    if hidden > 0 {
        words.push(format!(
            "{hidden} points lie beyond the axes; the files have all of them"
        ));
    }
    words.retain(|w| !w.is_empty());
    words.join("; ")
}

/// The title and the remark; returns where they end.
fn heading(svg: &mut Svg, figure: &Figure, remark: &str, width: f64) -> f64 {
    let bold = format!("font-weight=\"bold\" {DARK}");
    let grey = format!("class=\"remark\" fill=\"{}\"", ink::GREY);
    let mut y = 8.0;
    for ((size, letter, line), style, text) in [(TITLE, bold, &*figure.title), (NOTE, grey, remark)]
    {
        for words in wrapped(text, ((width - 2.0 * MARGIN) / letter) as usize) {
            y += line;
            let style = format!("{style} font-size=\"{size}\"");
            svg.text([MARGIN, y], &style, &words);
        }
    }
    y
}

#[cfg(test)]
mod tests;
