//! Matrices as pictures with a title, axes and a legend.

use super::colour::{Rgb, Scale};
use super::encode::PictureError;
use super::legend::{colour_bar, outside};
use super::panel::{Panel, ScaleBar};
#[cfg(feature = "cli")]
use super::raster;
use super::svg::{Close, DPI, END, FAMILIES, MIDDLE, Svg, escape};
use crate::num::digits::scientific;

/// Width of a sheet where no matrix needs more: 180 mm, two columns of a journal, px at 300 an inch
/// as all lengths here.
const WIDTH: usize = 2126;
/// Longer side of a panel at most, where it has no more entries than that.
const LARGEST: usize = 600;
/// Panels a row.
const MOST_COLUMNS: usize = 5;
pub(super) const MARGIN: usize = 24;
const GAP: usize = 44;
/// Room left of a panel for the axis upwards, and below for the axis across.
const AXIS: usize = 52;
const BELOW: usize = 54;
/// Size of type (7 pt), of a line of it, and of a character, rounded up.
const TYPE: usize = 29;
const LINE: usize = 36;
const CHARACTER: usize = 17;
pub(super) const BAR: [usize; 2] = [640, 30];
/// From the left of a colour's sample to what it means.
const BESIDE: usize = 52;
/// Ink of frames and arrows, 0.5 pt wide.
const THIN: &str = "fill=\"none\" stroke=\"#222222\" stroke-width=\"2\"";

/// Reflectances (or any values that belong in 0…1) side by side on the one fixed grey scale: black
/// 0, white 1, whatever the data, values below 0 blue and above 1 orange. Entries are whole pixels,
/// never smoothed; iu runs to the right and iv upwards, as the arrows say. Returns PNG bytes, 300
/// pixels an inch, 180 mm wide unless a matrix needs more.
///
/// # Errors
/// [`PictureError`] if the picture would be absurdly large.
#[cfg(feature = "cli")]
pub fn grey_png(title: &str, panels: &[Panel]) -> Result<Vec<u8>, PictureError> {
    colour_png(title, panels, &Scale::reflectance(), "reflectance")
}

/// Matrices side by side on one shared `scale`, with a legend that is named `unit`. As [`grey_png`]
/// else.
///
/// # Errors
/// [`PictureError`] if the picture would be absurdly large.
#[cfg(feature = "cli")]
pub fn colour_png(
    title: &str,
    panels: &[Panel],
    scale: &Scale,
    unit: &str,
) -> Result<Vec<u8>, PictureError> {
    raster::png(&pictures_svg(title, panels, scale, unit)?)
}

/// The same as SVG.
///
/// # Errors
/// [`PictureError`] if a picture in it cannot be encoded.
pub(super) fn pictures_svg(
    title: &str,
    panels: &[Panel],
    scale: &Scale,
    unit: &str,
) -> Result<String, PictureError> {
    let letter = |(i, p): (usize, &Panel)| Panel {
        title: lettered(i, panels.len(), &p.title),
        ..p.clone()
    };
    let sheet = Sheet {
        title,
        width: WIDTH,
        most: longest_side(panels.len()),
        outside: outside(scale, panels, "", 0),
    };
    let panels: Vec<Panel> = panels.iter().enumerate().map(letter).collect();
    sheet.svg(&panels, scale, unit)
}

/// A sheet of pictures on one scale.
pub(super) struct Sheet<'a> {
    pub(super) title: &'a str,
    /// Width where no matrix needs more, px.
    pub(super) width: usize,
    /// Longer side of a panel at most, where it has no more entries than that, px.
    pub(super) most: usize,
    /// Colours outside the scale and what they mean.
    pub(super) outside: Vec<(Rgb, String)>,
}

impl Sheet<'_> {
    /// The sheet: its title, `panels`, the colour bar, and what lies outside of it.
    pub(super) fn svg(
        &self,
        panels: &[Panel],
        scale: &Scale,
        unit: &str,
    ) -> Result<String, PictureError> {
        let sizes: Vec<[usize; 2]> = panels.iter().map(|p| p.pixels(self.most)).collect();
        let titles = panels.iter().zip(&sizes);
        let titles: Vec<Vec<String>> = titles
            .map(|(p, [w, _])| wrapped(&p.title, w.max(&self.most) / CHARACTER))
            .collect();
        let above = LINE * titles.iter().map(Vec::len).max().unwrap_or(0) + 8;
        let (places, [width, height]) = arrange(&sizes, self.most, above, self.width);
        let heading = wrapped(self.title, (width - 2 * MARGIN) / CHARACTER);
        let top = MARGIN + LINE * heading.len() + 12;
        let legend = top + height + 16;
        let room = (width - 2 * MARGIN - BESIDE) / CHARACTER;
        let outside = self.outside.iter();
        let outside: Vec<(Rgb, Vec<String>)> =
            outside.map(|(c, text)| (*c, wrapped(text, room))).collect();
        let lines: usize = outside.iter().map(|(_, lines)| lines.len()).sum();
        let full = legend + BAR[1] + 56 + LINE * lines + MARGIN;
        let mut svg = Svg::default();
        svg.raw(&opening(self.title, [width, full]));
        write(&mut svg, [MARGIN, MARGIN], &heading);
        for (i, panel) in panels.iter().enumerate() {
            let [x, y] = [places[i][0] + AXIS, top + places[i][1] + above];
            // The last line of the title stands on the picture.
            write(&mut svg, [x, y - 8 - LINE * titles[i].len()], &titles[i]);
            draw(&mut svg, panel, [x, y], sizes[i], scale)?;
        }
        let corner = at([MARGIN + 100, legend]);
        colour_bar(&mut svg, corner, at(BAR), TYPE as f64, scale, unit)?;
        key(&mut svg, [MARGIN, legend + BAR[1] + 56], &outside);
        svg.raw("</svg>");
        Ok(svg.text)
    }
}

/// The tag that opens a sheet of so many pixels, and its white ground.
fn opening(title: &str, [width, height]: [usize; 2]) -> String {
    let millimetres = |px: usize| 25.4 / DPI * px as f64;
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.4}mm\" height=\"{:.4}mm\" viewBox=\"0 0 {width} {height}\" font-family=\"{FAMILIES}\" \
         font-size=\"{TYPE}\" fill=\"#222222\" color=\"#222222\" role=\"img\" aria-label=\"{}\"><rect width=\"100%\" height=\"100%\" fill=\"white\"/>",
        millimetres(width),
        millimetres(height),
        escape(title)
    )
}

/// Colours with what they mean, below each other.
fn key(svg: &mut Svg, [x, mut y]: [usize; 2], outside: &[(Rgb, Vec<String>)]) {
    for ([r, g, b], lines) in outside {
        let style =
            format!("fill=\"#{r:02x}{g:02x}{b:02x}\" stroke=\"#222222\" stroke-width=\"2\"");
        svg.rect(at([x, y + 5]), [36.0, 24.0], &style);
        write(svg, [x + BESIDE, y], lines);
        y += LINE * lines.len();
    }
}

/// "(a) title" and so on where there are several panels, numbers in it as they are set and kept on
/// the line of the word after them.
pub(super) fn lettered(i: usize, panels: usize, title: &str) -> String {
    let set = |word: &str| match word.parse::<f64>() {
        Ok(_) => scientific(word) + "\u{a0}",
        Err(_) => format!("{word} "),
    };
    let title: String = title.split(' ').map(set).collect();
    let title = title.trim_end().to_owned();
    match u8::try_from(i).ok().filter(|i| *i < 26 && panels > 1) {
        Some(i) => format!("({})\u{a0}{title}", char::from(b'a' + i)),
        None => title,
    }
}

/// How long a panel may be so that as many stand in a row as leave no row half empty, if that can
/// be.
fn longest_side(panels: usize) -> usize {
    let columns = match panels {
        0..=MOST_COLUMNS => panels.max(1),
        n => (3..=MOST_COLUMNS)
            .rev()
            .find(|c| n % c == 0)
            .unwrap_or(MOST_COLUMNS),
    };
    let each = (WIDTH - 2 * MARGIN - GAP * (columns - 1)) / columns - AXIS;
    each.min(LARGEST)
}

/// Upper left corner of each panel, its axis and its title, in rows of `width`, and the size of it
/// all.
fn arrange(
    sizes: &[[usize; 2]],
    most: usize,
    above: usize,
    width: usize,
) -> (Vec<[usize; 2]>, [usize; 2]) {
    let (mut x, mut y, mut row, mut right) = (MARGIN, 0, 0, width - MARGIN);
    let mut places = Vec::with_capacity(sizes.len());
    for &[w, h] in sizes {
        let w = AXIS + w.max(most);
        if x > MARGIN && x + w + MARGIN > width {
            (x, y, row) = (MARGIN, y + row, 0);
        }
        places.push([x, y]);
        right = right.max(x + w);
        x += w + GAP;
        row = row.max(above + h + BELOW + 10);
    }
    (places, [right + MARGIN, y + row])
}

fn at(p: [usize; 2]) -> [f64; 2] {
    p.map(|c| c as f64)
}

/// Lines of text below each other, the corner of the first.
fn write(svg: &mut Svg, [x, y]: [usize; 2], lines: &[String]) {
    for (i, line) in lines.iter().enumerate() {
        svg.text(at([x, y + LINE * i + TYPE - 3]), "", line);
    }
}

fn draw(
    svg: &mut Svg,
    panel: &Panel,
    [left, top]: [usize; 2],
    [w, h]: [usize; 2],
    scale: &Scale,
) -> Result<(), PictureError> {
    svg.image(at([left, top]), at([w, h]), &panel.data_uri(scale)?);
    let frame = [left as f64 - 1.0, top as f64 - 1.0];
    svg.rect(frame, [w as f64 + 2.0, h as f64 + 2.0], THIN);
    let [across, up] = &panel.axes;
    let bottom = top + h;
    arrow(svg, at([left, bottom + 30]), [1.0, 0.0]);
    svg.text(at([left + 70, bottom + 40]), "", across);
    arrow(svg, at([left - 20, bottom]), [0.0, -1.0]);
    // A letter stands upright, a word is turned along its arrow.
    let [x, y] = at([left, bottom]);
    if up.chars().count() <= 2 {
        svg.text([x - 20.0, y - 68.0], MIDDLE, up);
    } else {
        svg.upright([x - 12.0, y - 68.0], "", up);
    }
    if let Some(ScaleBar { share, text }) = &panel.scale_bar {
        let [right, y] = at([left + w, bottom + 30]);
        let long = share * w as f64;
        svg.line(
            [right - long, y],
            [right, y],
            "stroke=\"#222222\" stroke-width=\"7\"",
        );
        svg.text([right - long - 10.0, y + 10.0], END, text);
    }
    Ok(())
}

/// An arrow of 60 px.
fn arrow(svg: &mut Svg, [x, y]: [f64; 2], [dx, dy]: [f64; 2]) {
    let point = |along: f64, aside: f64| [x + along * dx - aside * dy, y + along * dy + aside * dx];
    svg.line(point(0.0, 0.0), point(45.0, 0.0), THIN);
    svg.path(
        &[point(60.0, 0.0), point(42.0, 8.0), point(42.0, -8.0)],
        Close::Yes,
        "fill=\"#222222\"",
    );
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
