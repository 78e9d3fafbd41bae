//! One plot: its axes, its grid and its curves.

use super::DARK;
use super::looks::Looks;
use crate::lab::finding::{Curve, Mark, Plot};
use crate::report::axis::Ruler;
use crate::report::look::Look;
use crate::report::plotted::{Direction, Kind, Plotted, Series};
use crate::report::svg::{Close, END, MIDDLE, Svg, fill, ink, stroke};

/// More points of a line than this are not all marked.
const MOST_MARKS: usize = 40;

/// Where a plot is drawn: the plotting area by its upper left corner, its width and height, and the
/// axes.
pub(super) struct Area<'a> {
    pub(super) corner: [f64; 2],
    pub(super) size: [f64; 2],
    pub(super) rulers: &'a [Ruler<'a>; 2],
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
    pub(super) fn draw(&self, svg: &mut Svg, plot: &Plot, looks: &Looks<'_>) {
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
    pub(super) fn plotted<'a>(
        &'a self,
        title: &'a str,
        plot: &'a Plot,
        looks: &Looks<'_>,
    ) -> Plotted<'a> {
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
