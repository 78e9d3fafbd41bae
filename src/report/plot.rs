//! A figure of a finding as SVG: a sheet of plots with one legend.
//!
//! 830 units are 180 mm, the width of two columns of a journal: type of 13 units is then 8 pt, a
//! line of 1.6 units 1 pt. A single plot takes one column, 90 mm.

use super::axis::Ruler;
use super::legend::samples;
use super::look::Look;
use super::picture::{lettered, wrapped};
use super::plotted::{Direction, Kind, Plotted, Series};
use super::svg::{Close, END, FAMILIES, MIDDLE, Svg, escape, fill, ink, stroke};
use crate::lab::finding::{Curve, Figure, Mark, Plot};

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
/// More points of a line than this are not all marked.
const MOST_MARKS: usize = 40;
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

/// How the curves of a figure look: those of one name alike in every plot, computed and published
/// ones numbered apart.
struct Looks<'a> {
    computed: Vec<&'a Curve>,
    published: Vec<&'a Curve>,
}

impl<'a> Looks<'a> {
    fn of(figure: &'a Figure) -> Self {
        let mut looks = Self {
            computed: Vec::new(),
            published: Vec::new(),
        };
        for curve in figure.plots.iter().flat_map(|p| &p.curves) {
            let own = match curve.mark {
                Mark::Published => &mut looks.published,
                _ => &mut looks.computed,
            };
            if own.iter().all(|c| c.name != curve.name) {
                own.push(curve);
            }
        }
        looks
    }

    /// The look of a curve.
    fn of_curve(&self, curve: &Curve) -> Look {
        let own = match curve.mark {
            Mark::Published => &self.published,
            _ => &self.computed,
        };
        let place = own.iter().position(|c| c.name == curve.name);
        Look {
            mark: curve.mark,
            number: place.unwrap_or(0),
        }
    }

    /// Samples and texts of the legend.
    fn legend(&self) -> Vec<(String, String)> {
        let entry = |c: &&Curve| {
            let name = match c.mark {
                Mark::Published => format!("{} (published)", c.name),
                _ => c.name.clone(),
            };
            (self.of_curve(c).sample(), name)
        };
        let all = self.computed.iter().chain(&self.published);
        all.filter(|c| !c.name.is_empty()).map(entry).collect()
    }
}

/// Where a plot is drawn: the plotting area by its upper left corner, its width and height, and the
/// axes.
struct Area<'a> {
    corner: [f64; 2],
    size: [f64; 2],
    rulers: &'a [Ruler<'a>; 2],
}

impl Area<'_> {
    /// The coordinate on the sheet of a share of axis `d`.
    fn at(&self, d: usize, share: f64) -> f64 {
        let share = if d == 0 { share } else { 1.0 - share };
        self.corner[d] + self.size[d] * share
    }

    /// Where a point lies; `None` where the axes do not reach.
    fn place(&self, point: &[f64; 2]) -> Option<[f64; 2]> {
        let [x, y] = [0, 1].map(|d| Some(self.at(d, self.rulers[d].fraction(point[d])?)));
        Some([x?, y?])
    }

    /// The coordinate within the area that is nearest to a value of axis `d`.
    fn nearest(&self, d: usize, value: f64) -> f64 {
        self.at(d, self.rulers[d].nearest(value))
    }

    /// Draws axes, grid and curves. Points beyond the axes are left out, and a line is broken
    /// there.
    fn draw(&self, svg: &mut Svg, plot: &Plot, looks: &Looks<'_>) {
        svg.raw("<g class=\"panel\">");
        self.frame(svg);
        let bars = plot.curves.iter().filter(|c| c.mark == Mark::Bars);
        let count = bars.clone().count();
        for (k, curve) in bars.enumerate() {
            self.bars(svg, curve, looks.of_curve(curve), [k, count]);
        }
        let others = || plot.curves.iter().filter(|c| c.mark != Mark::Bars);
        // Lines first, so that no line hides a mark.
        for curve in others() {
            let points = match curve.mark {
                Mark::Line => &curve.points,
                Mark::Level => &self.level(curve),
                _ => continue,
            };
            for run in self.runs(points).iter().filter(|run| run.len() > 1) {
                svg.path(run, Close::No, &looks.of_curve(curve).line());
            }
        }
        for curve in others() {
            for (point, stderr) in curve.points.iter().zip(&curve.stderr) {
                if let Some([x, _]) = self.place(point) {
                    self.whisker(svg, 1, x, point[1], *stderr);
                }
            }
            let each = match curve.mark {
                Mark::Level => continue,
                Mark::Line => curve.points.len().div_ceil(MOST_MARKS).max(1),
                _ => 1,
            };
            for run in self.runs(&curve.points) {
                for place in run.into_iter().step_by(each) {
                    looks.of_curve(curve).point(svg, place);
                }
            }
        }
        svg.raw("</g>");
    }

    /// The places of points, parted where the axes do not reach.
    fn runs(&self, points: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
        let placed: Vec<Option<[f64; 2]>> = points.iter().map(|p| self.place(p)).collect();
        let runs = placed.split(Option::is_none);
        runs.map(|run| run.iter().flatten().copied().collect())
            .collect()
    }

    /// The ends of a straight line across the area.
    fn level(&self, curve: &Curve) -> Vec<[f64; 2]> {
        let [across, up] = self.rulers;
        let Some([x, y]) = curve.points.first().copied() else {
            return Vec::new();
        };
        let upright =
            curve.points.iter().all(|p| p[0] == x) && (curve.points.len() > 1 || y.is_nan());
        if upright {
            up.ends.map(|end| [x, end]).to_vec()
        } else {
            across.ends.map(|end| [end, y]).to_vec()
        }
    }

    /// Bars from the axis of categories, those of curve `k` of `count`.
    fn bars(&self, svg: &mut Svg, curve: &Curve, look: Look, [k, count]: [usize; 2]) {
        let across = usize::from(self.rulers[1].categories().is_some());
        let along = 1 - across;
        for (i, point) in curve.points.iter().enumerate() {
            let side = |k: usize| point[across] - 0.4 + 0.8 * k as f64 / count as f64;
            let sides = [k, k + 1].map(|k| self.nearest(across, side(k)));
            let ends = [0.0, point[along]].map(|x| self.nearest(along, x));
            let (mut corner, mut size) = ([0.0; 2], [0.0; 2]);
            for (d, [a, b]) in [(across, sides), (along, ends)] {
                corner[d] = a.min(b);
                size[d] = (a - b).abs().max(1.0);
            }
            svg.rect(corner, size, &fill(look.ink()));
            if let Some(stderr) = curve.stderr.get(i) {
                let middle = 0.5 * (sides[0] + sides[1]);
                self.whisker(svg, along, middle, point[along], *stderr);
            }
        }
    }

    /// A whisker of ± `stderr` around `value` on axis `along`, at coordinate `at` of the other.
    fn whisker(&self, svg: &mut Svg, along: usize, at: f64, value: f64, stderr: f64) {
        let ends = [value - stderr, value + stderr].map(|x| self.nearest(along, x));
        let point = |end: f64, aside: f64| {
            let mut point = [at + aside; 2];
            point[along] = end;
            point
        };
        let style = "stroke=\"#222222\" stroke-width=\"1\"";
        svg.line(point(ends[0], 0.0), point(ends[1], 0.0), style);
        for end in ends {
            svg.line(point(end, -3.0), point(end, 3.0), style);
        }
    }

    /// Grid, ticks, titles and border.
    fn frame(&self, svg: &mut Svg) {
        let ([left, top], [width, height]) = (self.corner, self.size);
        let pale = stroke(ink::PALE, 0.6);
        let middle = format!("{MIDDLE} {DARK}");
        let end = format!("{END} {DARK}");
        for (d, ruler) in self.rulers.iter().enumerate() {
            let shown = |(x, text)| Some((self.at(d, ruler.fraction(x)?), text));
            for (at, text) in ruler.ticks().into_iter().filter_map(shown) {
                let (line, place, style) = match d {
                    0 => (
                        [[at, top], [at, top + height]],
                        [at, top + height + 18.0],
                        &middle,
                    ),
                    _ => (
                        [[left, at], [left + width, at]],
                        [left - 8.0, at + 4.0],
                        &end,
                    ),
                };
                if ruler.categories().is_none() {
                    svg.line(line[0], line[1], &pale);
                }
                svg.text(place, style, &text);
            }
        }
        let border = "fill=\"none\" stroke=\"#222222\" stroke-width=\"0.9\"";
        svg.rect(self.corner, self.size, border);
        let [x, y] = self.rulers.each_ref().map(|r| &r.axis.title);
        svg.text([left + 0.5 * width, top + height + 40.0], &middle, x);
        svg.upright([left - 52.0, top + 0.5 * height], &middle, y);
    }

    /// The data of the plot.
    fn plotted<'a>(&'a self, title: &'a str, plot: &'a Plot, looks: &Looks<'_>) -> Plotted<'a> {
        let shown = |c: &'a Curve| Series {
            name: &c.name,
            kind: match c.mark {
                Mark::Points => Kind::Points,
                Mark::Published => Kind::Published,
                Mark::Line | Mark::Bars | Mark::Level => Kind::Line,
            },
            look: looks.of_curve(c).number,
            points: match c.mark {
                Mark::Level => self.level(c),
                _ => c.points.clone(),
            },
        };
        let direction = |r: &'a Ruler<'_>| Direction {
            title: &r.axis.title,
            run: if r.is_logarithmic() {
                "logarithmic"
            } else {
                "linear"
            },
            ends: r.ends,
        };
        let [left, top] = self.corner;
        let [width, height] = self.size;
        let curves = plot.curves.iter().filter(|c| !c.points.is_empty());
        Plotted {
            title,
            area: [left, top, width, height],
            x: direction(&self.rulers[0]),
            y: direction(&self.rulers[1]),
            series: curves.map(shown).collect(),
        }
    }
}

#[cfg(test)]
mod tests;
