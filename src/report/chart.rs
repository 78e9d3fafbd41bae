//! Line charts.

use super::axis::{tick, ticks};
use super::look::{colour, mark, printed_mark, sample, style};
use super::picture::scientific;
use super::plotted::{Kind, metadata};
use super::raster::FAMILIES;
use super::svg::{Close, Svg, escape, ink, number, raised};

/// How an axis runs.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Run {
    Linear,
    Logarithmic,
}

/// An axis: its run, its ends and what it shows.
pub(super) struct Axis {
    pub run: Run,
    pub ends: [f64; 2],
    pub title: String,
}

impl Axis {
    /// A logarithmic axis around the positive values, from decade to decade.
    pub(super) fn decades(values: impl Iterator<Item = f64>, title: impl Into<String>) -> Self {
        let positive = values.filter(|x| *x > 0.0 && x.is_finite());
        let (low, high) = positive.fold((f64::INFINITY, 0.0f64), |(l, h), x| (l.min(x), h.max(x)));
        let (low, high) = if high > 0.0 { (low, high) } else { (0.1, 1.0) };
        let (a, b) = (libm::log10(low).floor(), libm::log10(high).ceil());
        let ends = [libm::pow(10.0, a), libm::pow(10.0, b.max(a + 1.0))];
        Self {
            run: Run::Logarithmic,
            ends,
            title: title.into(),
        }
    }

    /// A linear axis from the least to the greatest of the values.
    pub(super) fn around(values: impl Iterator<Item = f64>, title: impl Into<String>) -> Self {
        let finite = values.filter(|x| x.is_finite());
        let ends = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], x| {
            [l.min(x), h.max(x)]
        });
        let ends = match ends {
            [low, high] if low < high => ends,
            [low, _] if low.is_finite() => [low - 1.0, low + 1.0],
            _ => [0.0, 1.0],
        };
        Self {
            run: Run::Linear,
            ends,
            title: title.into(),
        }
    }

    /// Position of x between the ends, 0 to 1; `None` where the axis does not reach.
    fn fraction(&self, x: f64) -> Option<f64> {
        let [a, b] = self.ends;
        let t = match self.run {
            Run::Linear => (x - a) / (b - a),
            Run::Logarithmic if x > 0.0 => libm::log(x / a) / libm::log(b / a),
            Run::Logarithmic => return None,
        };
        (-1e-9..=1.0 + 1e-9).contains(&t).then_some(t)
    }

    fn ticks(&self) -> Vec<(f64, String)> {
        let [a, b] = self.ends;
        match self.run {
            Run::Linear => ticks(a, b, 7)
                .into_iter()
                .map(|x| (x, scientific(&tick(x))))
                .collect(),
            Run::Logarithmic => {
                let (low, high) = (libm::log10(a).round() as i32, libm::log10(b).round() as i32);
                // Every decade has its line, and as many of them a name as have room.
                let each = (high - low + MOST_DECADES) / MOST_DECADES;
                let name = |d: i32| match d.rem_euclid(each.max(1)) {
                    0 => format!("10{}", superscript(d)),
                    _ => String::new(),
                };
                (low..=high)
                    .map(|d| (libm::pow(10.0, f64::from(d)), name(d)))
                    .collect()
            }
        }
    }
}

/// Named decades of a logarithmic axis: as many as have room side by side on the narrowest panel, 250 px.
const MOST_DECADES: i32 = 7;

/// A line with its name.
pub(super) struct Series {
    pub name: String,
    pub points: Vec<[f64; 2]>,
}

/// More points of a line than this are not all marked.
const MOST_MARKS: usize = 40;

/// Width of a character over the size of its type, bold and regular, rounded up.
const BOLD: f64 = 0.68;
const REGULAR: f64 = 0.6;

/// A white sheet of that size with its title and, below, a note in grey. Close it with `</svg>`.
pub(super) fn sheet([width, height]: [u32; 2], title: &str, note: &str) -> Svg {
    let mut svg = Svg::default();
    svg.raw(&format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"{FAMILIES}\" \
         font-size=\"13\" role=\"img\" aria-label=\"{}\"><rect width=\"100%\" height=\"100%\" fill=\"white\"/>",
        escape(title)
    ));
    // Words that are too many for the width are set smaller.
    let fitting = |size: f64, each: f64, text: &str| {
        let room = f64::from(width) - 32.0;
        number(size.min(room / (each * text.chars().count().max(1) as f64)))
    };
    let bold = fitting(16.0, BOLD, title);
    let style = format!("font-weight=\"bold\" font-size=\"{bold}\" fill=\"#222222\"");
    svg.text([16.0, 28.0], &style, title);
    if !note.is_empty() {
        let size = fitting(13.0, REGULAR, note);
        let style = format!(
            "class=\"remark\" font-size=\"{size}\" fill=\"{}\"",
            ink::GREY
        );
        svg.text([16.0, 48.0], &style, note);
    }
    svg
}

/// Where a plotting area lies: its upper left corner, its width and height.
#[derive(Clone, Copy)]
struct Area {
    corner: [f64; 2],
    size: [f64; 2],
}

impl Area {
    /// Where a point lies; `None` where the axes do not reach.
    fn place(&self, [x, y]: [&Axis; 2], point: &[f64; 2]) -> Option<[f64; 2]> {
        let (tx, ty) = (x.fraction(point[0])?, y.fraction(point[1])?);
        Some([
            self.corner[0] + self.size[0] * tx,
            self.corner[1] + self.size[1] * (1.0 - ty),
        ])
    }
}

/// A panel of a figure: its plotting area (upper left corner, width and height), axes, lines, and the published points over them. The title is for those who read
/// the figure's data; whoever draws the panel sets it where it has room.
pub(super) struct Panel<'a> {
    pub corner: [f64; 2],
    pub size: [f64; 2],
    pub axes: [&'a Axis; 2],
    pub title: &'a str,
    pub series: &'a [Series],
    pub published: &'a [Series],
}

impl Panel<'_> {
    /// Draws axes, grid, lines and points, and leaves the data. Points beyond the axes are left out, and the line is broken there.
    pub(super) fn draw(&self, svg: &mut Svg) {
        let Self {
            corner,
            size,
            axes,
            series,
            ..
        } = *self;
        let area = Area { corner, size };
        svg.raw("<g class=\"panel\">");
        let kinds = [(Kind::Line, series), (Kind::Published, self.published)];
        svg.raw(&metadata(self.title, [corner, size], axes, &kinds));
        frame(svg, area, axes);
        // Lines first, so that no line hides a mark.
        let runs = |s: &Series| -> Vec<Vec<[f64; 2]>> {
            let placed: Vec<Option<[f64; 2]>> =
                s.points.iter().map(|p| area.place(axes, p)).collect();
            let runs = placed.split(Option::is_none);
            runs.map(|run| run.iter().flatten().copied().collect())
                .collect()
        };
        for (i, s) in series.iter().enumerate() {
            for run in runs(s).iter().filter(|run| run.len() > 1) {
                svg.path(run, Close::No, &style(i));
            }
        }
        for (i, s) in series.iter().enumerate() {
            let each = s.points.len().div_ceil(MOST_MARKS).max(1);
            for run in runs(s) {
                for p in run.into_iter().step_by(each) {
                    mark(svg, p, i);
                }
            }
        }
        for (i, s) in self.published.iter().enumerate() {
            for p in s.points.iter().filter_map(|p| area.place(axes, p)) {
                printed_mark(svg, p, i);
            }
        }
        svg.raw("</g>");
    }
}

/// Draws a panel of lines that needs no title; see [`Panel`].
pub(super) fn panel(
    svg: &mut Svg,
    corner: [f64; 2],
    size: [f64; 2],
    axes: [&Axis; 2],
    series: &[Series],
) {
    Panel {
        corner,
        size,
        axes,
        title: "",
        series,
        published: &[],
    }
    .draw(svg);
}

/// Draws a panel with its axes, grid and points without lines; points beyond the axes are left out. Returns how many.
pub(super) fn scatter(
    svg: &mut Svg,
    corner: [f64; 2],
    size: [f64; 2],
    axes: [&Axis; 2],
    series: &[Series],
) -> usize {
    let area = Area { corner, size };
    svg.raw("<g class=\"panel\">");
    svg.raw(&metadata(
        "",
        [corner, size],
        axes,
        &[(Kind::Points, series)],
    ));
    frame(svg, area, axes);
    let mut beyond = 0;
    for (i, s) in series.iter().enumerate() {
        let dot = format!("fill=\"{}\" fill-opacity=\"0.5\"", colour(i));
        for point in &s.points {
            match area.place(axes, point) {
                Some(p) => svg.circle(p, 1.8, &dot),
                None => beyond += 1,
            }
        }
    }
    svg.raw("</g>");
    beyond
}

/// Grid, ticks, titles and border.
fn frame(svg: &mut Svg, Area { corner, size }: Area, [x, y]: [&Axis; 2]) {
    let [left, top] = corner;
    let [width, height] = size;
    let at_x = |t: f64| left + width * t;
    let at_y = |t: f64| top + height * (1.0 - t);
    let pale = format!("stroke=\"{}\" stroke-width=\"0.6\"", ink::PALE);
    for (value, text) in x.ticks() {
        if let Some(t) = x.fraction(value) {
            svg.line([at_x(t), top], [at_x(t), top + height], &pale);
            svg.text(
                [at_x(t), top + height + 18.0],
                "text-anchor=\"middle\" fill=\"#222222\"",
                &text,
            );
        }
    }
    for (value, text) in y.ticks() {
        if let Some(t) = y.fraction(value) {
            svg.line([left, at_y(t)], [left + width, at_y(t)], &pale);
            svg.text(
                [left - 8.0, at_y(t) + 4.0],
                "text-anchor=\"end\" fill=\"#222222\"",
                &text,
            );
        }
    }
    svg.rect(
        corner,
        size,
        "fill=\"none\" stroke=\"#222222\" stroke-width=\"0.9\"",
    );
    let middle = "text-anchor=\"middle\" fill=\"#222222\"";
    svg.text([left + 0.5 * width, top + height + 40.0], middle, &x.title);
    let (tx, ty) = (left - 52.0, top + 0.5 * height);
    svg.raw(&format!(
        "<text transform=\"translate({} {}) rotate(-90)\" {middle}>{}</text>",
        number(tx),
        number(ty),
        raised(&y.title)
    ));
}

/// The names of the series, one below the other.
pub(super) fn legend(svg: &mut Svg, [x, y]: [f64; 2], series: &[Series]) {
    for (i, s) in series.iter().enumerate() {
        let y = y + 20.0 * i as f64;
        svg.raw(&format!(
            "<g transform=\"translate({} {})\">{}</g>",
            number(x),
            number(y),
            sample(i)
        ));
        svg.text([x + 38.0, y + 4.0], "fill=\"#222222\"", &s.name);
    }
}

/// A whole number in superscript digits.
pub(super) fn superscript(n: i32) -> String {
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    n.to_string()
        .chars()
        .map(|c| c.to_digit(10).map_or('⁻', |d| digits[d as usize]))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A title of any length ends on the sheet: its type times its letters is no wider.
    #[test]
    fn long_titles_are_set_smaller() {
        let title = "w".repeat(200);
        let text = sheet([400, 300], &title, "").text;
        let size = text
            .split("font-weight=\"bold\" font-size=\"")
            .nth(1)
            .unwrap();
        let size: f64 = size.split('"').next().unwrap().parse().unwrap();
        assert!(size * BOLD * 200.0 <= 400.0 - 31.0, "{size}");
        assert!(
            sheet([400, 300], "short", "")
                .text
                .contains("font-size=\"16\"")
        );
    }

    #[test]
    fn decades_span_the_values_and_place_them() {
        let axis = Axis::decades([3e-4, 0.02, 0.0, f64::NAN].into_iter(), "");
        assert!(
            (axis.ends[0] / 1e-4 - 1.0).abs() < 1e-12 && (axis.ends[1] / 0.1 - 1.0).abs() < 1e-12
        );
        assert!((axis.fraction(1e-3).unwrap() - 1.0 / 3.0).abs() < 1e-12);
        assert_eq!((axis.fraction(0.0), axis.fraction(1.0)), (None, None));
        assert_eq!(axis.ticks().len(), 4);
        assert_eq!(superscript(-12), "⁻¹²");
        let ends = |values: &[f64]| Axis::around(values.iter().copied(), "").ends;
        assert_eq!(ends(&[24.0, 4.0, f64::NAN, 8.0]), [4.0, 24.0]);
        assert_eq!((ends(&[8.0]), ends(&[])), ([7.0, 9.0], [0.0, 1.0]));
    }
}
