//! Matrices as pictures with a title, axes and a legend.

use super::axis::{significant, tick, ticks};
use super::canvas::{Canvas, PictureError, Type};
use super::colour::{Map, NOT_A_NUMBER, Scale};

/// An enlarged matrix is at least this long on its longer side, px.
const SIDE: usize = 256;
const MARGIN: usize = 20;
const GAP: usize = 28;
/// Room left of a panel for the axis upwards.
const AXIS: usize = 26;
/// Widest row of panels, px.
const ROW: usize = 1240;
const BAR: [usize; 2] = [256, 16];

/// A matrix to be shown: the first index runs to the right, the second upwards.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// What it is.
    pub title: String,
    /// Columns and rows (nu, nv).
    pub size: [usize; 2],
    /// Value of column iu, row iv at iu + iv·nu; a value that is missing is shown as not a number.
    pub values: Vec<f64>,
    /// What runs to the right and what upwards.
    pub axes: [String; 2],
}

impl Panel {
    /// A panel of elements: iu to the right, iv upwards.
    pub fn elements(title: impl Into<String>, size: [usize; 2], values: Vec<f64>) -> Self {
        Self {
            title: title.into(),
            size,
            values,
            axes: ["iu", "iv"].map(str::to_owned),
        }
    }

    /// The value of column `iu`, row `iv`.
    pub(super) fn at(&self, iu: usize, iv: usize) -> f64 {
        self.values
            .get(iu + iv * self.size[0])
            .copied()
            .unwrap_or(f64::NAN)
    }

    /// The entries alone, enlarged by a whole factor, the last row on top, as PNG bytes.
    pub(super) fn plain_png(&self, scale: &Scale) -> Result<Vec<u8>, PictureError> {
        let [w, h] = self.pixels();
        let mut canvas = Canvas::new(w, h)?;
        self.paint(&mut canvas, [0, 0], self.factor(), scale);
        canvas.png()
    }

    fn paint(&self, canvas: &mut Canvas, [x, y]: [usize; 2], factor: usize, scale: &Scale) {
        let [nu, nv] = self.size.map(|n| n.max(1));
        for iv in 0..nv {
            for iu in 0..nu {
                let corner = [x + iu * factor, y + (nv - 1 - iv) * factor];
                canvas.fill(corner, [factor; 2], scale.colour(self.at(iu, iv)));
            }
        }
    }

    /// Whole pixels per entry, so that the longer side has at least [`SIDE`].
    fn factor(&self) -> usize {
        SIDE.div_ceil(self.size[0].max(self.size[1]).max(1))
    }

    fn pixels(&self) -> [usize; 2] {
        self.size.map(|n| n.max(1) * self.factor())
    }
}

/// Reflectances (or any values that belong in 0…1) side by side on the one fixed grey scale: black 0, white 1, whatever
/// the data, values below 0 blue and above 1 orange. Entries are enlarged by a whole factor, never smoothed; iu runs to
/// the right and iv upwards, as the arrows say. Returns PNG bytes.
///
/// # Errors
/// [`PictureError`] if the picture would be absurdly large.
pub fn grey_png(title: &str, panels: &[Panel]) -> Result<Vec<u8>, PictureError> {
    colour_png(title, panels, &Scale::reflectance(), "")
}

/// Matrices side by side on one shared `scale`, with a legend in `unit` (empty: a pure number). As [`grey_png`] else.
///
/// # Errors
/// [`PictureError`] if the picture would be absurdly large.
pub fn colour_png(
    title: &str,
    panels: &[Panel],
    scale: &Scale,
    unit: &str,
) -> Result<Vec<u8>, PictureError> {
    let lettering = legend_lines(scale, panels);
    let longest = lettering
        .iter()
        .map(|(_, t)| 26 + 7 * t.chars().count())
        .max();
    let least = MARGIN + (BAR[0] + 60).max(longest.unwrap_or(0)) + MARGIN;
    let lines = panels
        .iter()
        .map(|p| title_lines(p).len())
        .max()
        .unwrap_or(0);
    let (places, [width, height]) = arrange(panels, lines);
    let width = width
        .max(least)
        .max(2 * MARGIN + (10 * title.chars().count()).min(ROW));
    let titles = wrapped(title, (width - 2 * MARGIN) / 10);
    let top = MARGIN + 24 * titles.len() + 6;
    let legend = top + height + 8;
    let mut canvas = Canvas::new(width, legend + BAR[1] + 28 + 18 * lettering.len() + MARGIN)?;
    for (i, line) in titles.iter().enumerate() {
        canvas.text([MARGIN, MARGIN + 24 * i], Type::Large, line);
    }
    for (panel, [x, y]) in panels.iter().zip(places) {
        let offset = lines - title_lines(panel).len();
        draw(&mut canvas, panel, [x, top + y + 18 * offset], scale);
    }
    bar(&mut canvas, [MARGIN, legend], scale, unit);
    for (i, (colour, text)) in lettering.iter().enumerate() {
        let y = legend + BAR[1] + 26 + 18 * i;
        canvas.fill([MARGIN, y + 1], [16, 12], *colour);
        canvas.outline([MARGIN, y + 1], [16, 12]);
        canvas.text([MARGIN + 24, y], Type::Small, text);
    }
    canvas.png()
}

/// The title of a panel in lines that are no wider than its picture.
fn title_lines(panel: &Panel) -> Vec<String> {
    wrapped(&panel.title, panel.pixels()[0].max(150) / 7)
}

/// Width and height that a panel takes when every title has `lines` lines.
fn cell(panel: &Panel, lines: usize) -> [usize; 2] {
    let [w, h] = panel.pixels();
    let w = w.max(150);
    [AXIS + w, h + 18 * lines + 28]
}

/// Upper left corner of each panel in rows of at most [`ROW`], and the size of it all.
fn arrange(panels: &[Panel], lines: usize) -> (Vec<[usize; 2]>, [usize; 2]) {
    let (mut x, mut y, mut row, mut right) = (MARGIN, 0, 0, 0);
    let mut places = Vec::with_capacity(panels.len());
    for panel in panels {
        let [w, h] = cell(panel, lines);
        if x > MARGIN && x + w > ROW {
            (x, y, row) = (MARGIN, y + row + 14, 0);
        }
        places.push([x, y]);
        x += w + GAP;
        right = right.max(x - GAP);
        row = row.max(h);
    }
    (places, [right + MARGIN, y + row])
}

fn draw(canvas: &mut Canvas, panel: &Panel, [x, y]: [usize; 2], scale: &Scale) {
    let [w, h] = panel.pixels();
    let lines = title_lines(panel);
    for (i, line) in lines.iter().enumerate() {
        canvas.text([x + AXIS, y + 18 * i], Type::Small, line);
    }
    let [left, top] = [x + AXIS, y + 18 * lines.len() + 4];
    panel.paint(canvas, [left, top], panel.factor(), scale);
    canvas.outline([left, top], [w, h]);
    let [across, up] = [&panel.axes[0], &panel.axes[1]];
    canvas.arrow([left, top + h + 11], [left + 36, top + h + 11]);
    canvas.text([left + 42, top + h + 5], Type::Small, across);
    canvas.arrow(
        [left - 8, top + h - 1],
        [left - 8, (top + h).saturating_sub(37)],
    );
    // Upwards there is room for a few letters only; longer names go to the line below.
    if up.chars().count() <= 2 {
        canvas.text([left - 24, (top + h).saturating_sub(54)], Type::Small, up);
    } else {
        let start = left + 42 + 7 * (across.chars().count() + 3);
        canvas.text([start, top + h + 5], Type::Small, &format!("up: {up}"));
    }
}

/// The colours of the scale with its ticks.
fn bar(canvas: &mut Canvas, [x, y]: [usize; 2], scale: &Scale, unit: &str) {
    for i in 0..BAR[0] {
        let colour = scale.map().at(i as f64 / (BAR[0] - 1) as f64);
        canvas.fill([x + i, y], [1, BAR[1]], colour);
    }
    canvas.outline([x, y], BAR);
    for (t, text) in bar_ticks(scale) {
        let at = x + (t * (BAR[0] - 1) as f64).round() as usize;
        canvas.fill([at, y + BAR[1]], [1, 4], [60; 3]);
        let half = 7 * text.chars().count() / 2;
        canvas.text(
            [at.saturating_sub(half).max(2), y + BAR[1] + 6],
            Type::Small,
            &text,
        );
    }
    canvas.text([x + BAR[0] + 16, y + 2], Type::Small, unit);
}

/// Where along the bar there is a tick, and its text: 0, 0.5, 1 on the grey scale, both ends and round values between
/// on the others.
pub(super) fn bar_ticks(scale: &Scale) -> Vec<(f64, String)> {
    let [low, high] = scale.range();
    let along = |x: f64| (0.5 * x - 0.5 * low) / (0.5 * high - 0.5 * low);
    if scale.map() == Map::Grey {
        return [0.0, 0.5, 1.0].map(|x| (along(x), tick(x))).to_vec();
    }
    let inner = ticks(low, high, 3)
        .into_iter()
        .filter(|x| (0.3..0.7).contains(&along(*x)));
    let inner: Vec<f64> = inner.take(1).collect();
    let ends = [(0.0, significant(low, 3)), (1.0, significant(high, 3))];
    let mut all = inner
        .into_iter()
        .map(|x| (along(x), tick(x)))
        .collect::<Vec<_>>();
    all.extend(ends);
    all
}

/// What the colours outside the scale mean; on the grey scale always, on the others where they occur.
pub(super) fn legend_lines(scale: &Scale, panels: &[Panel]) -> Vec<([u8; 3], String)> {
    let [low, high] = scale.range();
    let values = || panels.iter().flat_map(|p| p.values.iter());
    let fixed = scale.map() == Map::Grey;
    let count = |n: usize| match n {
        0 => "none here".to_owned(),
        1 => "1 value here".to_owned(),
        n => format!("{n} values here"),
    };
    let outside = |(colour, name), side: &str, limit: f64, n: usize| {
        let text = format!(
            "{name}: {side} {}, clipped in the picture only ({})",
            if fixed {
                tick(limit)
            } else {
                significant(limit, 3)
            },
            count(n)
        );
        (fixed || n > 0).then_some((colour, text))
    };
    let below = values().filter(|v| **v < low).count();
    let above = values().filter(|v| **v > high).count();
    let missing = panels.iter().map(|p| p.size[0] * p.size[1]).sum::<usize>();
    let numbers = values().filter(|v| !v.is_nan()).count();
    let missing = missing.saturating_sub(numbers);
    let nan = (missing > 0).then(|| {
        let (colour, name) = NOT_A_NUMBER;
        (colour, format!("{name}: not a number ({})", count(missing)))
    });
    [
        outside(scale.below(), "below", low, below),
        outside(scale.above(), "above", high, above),
        nan,
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// `text` in lines of at most `width` characters, broken at spaces (but not at no-break
/// spaces) where there are any.
pub(super) fn wrapped(text: &str, width: usize) -> Vec<String> {
    let width = width.max(8);
    let mut lines: Vec<String> = Vec::new();
    let space = |c: char| c.is_whitespace() && c != '\u{a0}';
    for word in text.split(space).filter(|w| !w.is_empty()) {
        let mut word: Vec<char> = word.chars().collect();
        let room = lines
            .last()
            .map_or(0, |l| width.saturating_sub(l.chars().count()));
        match lines.last_mut() {
            Some(line) if word.len() < room => {
                line.push(' ');
                line.extend(word);
            }
            _ => {
                while word.len() > width {
                    lines.push(word.drain(..width).collect());
                }
                lines.push(word.into_iter().collect());
            }
        }
    }
    lines
}

#[cfg(test)]
#[path = "picture_tests.rs"]
mod tests;
