//! One matrix by itself, for a look at it: as PNG, or in a terminal.

use super::colour::{Rgb, Scale};
use super::encode::PictureError;
use super::figure::{Reduction, reduced};
use super::legend::{bar_ticks, outside};
use super::panel::Panel;
use super::picture::{BAR, MARGIN, Sheet};
use super::raster;
use super::terminal::half_blocks;

/// Longer side of the matrix on its sheet, px, where it has no more entries than that.
const LARGEST: usize = 900;
/// Room right of the colour bar for the unit, px.
const UNIT: usize = 380;
/// Cells of the colour bar in a terminal.
const CELLS: usize = 32;

/// A matrix with its scale. What the scale does not hold is counted, never shown as if it did:
/// there is no tone curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    panel: Panel,
    scale: Scale,
    unit: String,
    infinite: usize,
}

impl Shown {
    /// A matrix and how it is shown; `unit` is that of its values, empty for none.
    pub fn new(panel: Panel, scale: Scale, unit: impl Into<String>) -> Self {
        let infinite = panel.values.iter().filter(|v| v.is_infinite()).count();
        let finite = |v: &f64| if v.is_finite() { *v } else { f64::NAN };
        let values = panel.values.iter().map(finite).collect();
        Self {
            panel: Panel { values, ..panel },
            scale,
            unit: unit.into(),
            infinite,
        }
    }

    /// What the colours outside the scale mean and how many values have them.
    pub fn outside(&self) -> Vec<(Rgb, String)> {
        let panels = std::slice::from_ref(&self.panel);
        outside(&self.scale, panels, &self.unit, self.infinite)
    }

    /// With title, axes, colour bar and what lies outside it, as PNG bytes; the last row is on top.
    ///
    /// # Errors
    /// [`PictureError`].
    pub fn sheet_png(&self) -> Result<Vec<u8>, PictureError> {
        let sheet = Sheet {
            title: &self.panel.title,
            width: MARGIN + 100 + BAR[0] + UNIT,
            most: LARGEST,
            outside: self.outside(),
        };
        let panel = Panel {
            title: String::new(),
            ..self.panel.clone()
        };
        raster::png(&sheet.svg(&[panel], &self.scale, &self.unit)?)
    }

    /// The entries alone, each a square of whole pixels, the last row on top, as PNG bytes.
    ///
    /// # Errors
    /// [`PictureError`].
    pub fn bare_png(&self) -> Result<Vec<u8>, PictureError> {
        self.panel.plain_png(&self.scale)
    }

    /// Title, picture and legend for a terminal of 24-bit colours that is `columns` wide: each
    /// character ▀ is two entries, one above the other. A matrix with more columns than that is
    /// shown by the means of blocks, and the legend says so.
    pub fn blocks(&self, columns: usize) -> String {
        let panel = &self.panel;
        let most = columns.max(8);
        let (small, note) = reduced(
            String::new(),
            ["", ""],
            panel.size,
            most,
            Reduction::Mean,
            |iu, iv| panel.at(iu, iv),
        );
        let [nu, nv] = small.size;
        // A small matrix is enlarged to about half of the width.
        let factor = (most / (2 * nu.max(1))).clamp(1, 8);
        let colour = |x: usize, y: usize| {
            let row = (nv * factor).checked_sub(y + 1)? / factor;
            Some(self.scale.colour(small.at(x / factor, row)))
        };
        let mut text = format!("{}\n", panel.title);
        for y in (0..nv * factor).step_by(2) {
            let cells = (0..nu * factor).map(|x| (colour(x, y), colour(x, y + 1)));
            text += &half_blocks(cells);
            text.push('\n');
        }
        text += &self.legend();
        if let Some(note) = note {
            text += &note;
            text.push('\n');
        }
        text
    }

    /// Colour bar with its ends and its unit, and what lies outside, as text of 24-bit colours.
    fn legend(&self) -> String {
        let steps = (0..CELLS).map(|i| {
            let value = self.scale.value(i as f64 / (CELLS - 1) as f64);
            let colour = Some(self.scale.colour(value));
            (colour, colour)
        });
        let ticks = bar_ticks(&self.scale);
        let text = |share: f64| ticks.iter().find(|t| t.0 == share).map_or("", |t| &t.1);
        let (low, high) = (text(0.0), text(1.0));
        let mut text = format!("{low} {} {high} {}\n", half_blocks(steps), self.unit);
        for (colour, words) in self.outside() {
            let sample = half_blocks([(Some(colour), Some(colour))].into_iter());
            text += &format!("{sample} {words}\n");
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::super::colour::{Law, Map};
    use super::super::encode::decoded;
    use super::*;

    fn shown(size: [usize; 2], values: Vec<f64>, range: [f64; 2]) -> Shown {
        let scale = Scale::between(Map::Viridis, Law::Linear, range).unwrap();
        Shown::new(Panel::elements("frame", size, values), scale, "W")
    }

    #[test]
    fn what_is_outside_is_counted() {
        let mut values = vec![0.5; 256];
        values[..3].fill(2.0);
        values[3] = -1.0;
        values[4] = f64::NAN;
        values[5] = f64::INFINITY;
        values[6] = f64::NEG_INFINITY;
        let words = |s: &Shown| s.outside().into_iter().map(|o| o.1).collect::<Vec<_>>();
        assert_eq!(
            words(&shown([16, 16], values, [0.0, 1.0])),
            [
                "black: 1 of 256 values below 0 W, clipped in the picture only",
                "orange: 3 of 256 values above 1.00 W, clipped in the picture only",
                "purple: 3 of 256 values not finite (2 infinite, 1 not a number)"
            ]
        );
        // The ends belong to the scale.
        assert!(words(&shown([2, 1], vec![0.0, 1.0], [0.0, 1.0])).is_empty());
    }

    #[test]
    fn the_bar_says_its_ends_and_decades() {
        let scale = Scale::between(Map::Grey, Law::Logarithmic, [1e-12, 1e-8]).unwrap();
        let texts: Vec<String> = bar_ticks(&scale).into_iter().map(|t| t.1).collect();
        assert_eq!(texts, ["10⁻¹⁰", "1.00 × 10⁻¹²", "1.00 × 10⁻⁸"]);
        let scale = Scale::between(Map::Grey, Law::Linear, [0.0, 4e-9]).unwrap();
        let ends: Vec<(f64, String)> = bar_ticks(&scale);
        assert_eq!(ends[0], (0.5, "2 × 10⁻⁹".to_owned()));
        assert_eq!(ends[2], (1.0, "4.00 × 10⁻⁹".to_owned()));
    }

    #[test]
    fn the_first_row_is_at_the_bottom_of_the_sheet() {
        let s = shown([1, 2], vec![0.0, 1.0], [0.0, 1.0]);
        let (w, h, pixels) = decoded(&s.bare_png().unwrap());
        let at = |x: usize, y: usize| &pixels[3 * (x + y * w)..][..3];
        assert_eq!(at(0, h - 1), Map::Viridis.at(0.0));
        assert_eq!(at(0, 0), Map::Viridis.at(1.0));
        let (w, h, pixels) = decoded(&s.sheet_png().unwrap());
        let find = |c: Rgb| {
            let at = |i: usize| (i % w, i / w);
            let all = pixels.chunks(3).enumerate().filter(|(_, p)| **p == c);
            all.map(|(i, _)| at(i).1).min()
        };
        assert!(
            find(Map::Viridis.at(1.0)) < find(Map::Viridis.at(0.0)),
            "{w} × {h}"
        );
    }

    /// The upper half of a character is the upper row.
    #[test]
    fn blocks_have_the_last_row_on_top_and_the_legend_below() {
        let s = shown([1, 2], vec![0.0, 1.0], [0.0, 1.0]);
        let text = s.blocks(8);
        let lines: Vec<&str> = text.lines().collect();
        let [r, g, b] = Map::Viridis.at(1.0);
        assert!(
            lines[1].starts_with(&format!("\x1b[38;2;{r};{g};{b}m")),
            "{lines:?}"
        );
        assert_eq!(lines[0], "frame");
        // 1 × 2 entries four times as large: four characters a line, four lines.
        assert_eq!(lines[1].matches('▀').count(), 4);
        assert!(
            lines[5].starts_with("0 ") && lines[5].ends_with("1.00 W"),
            "{lines:?}"
        );
    }

    #[test]
    fn a_wide_matrix_fits_the_terminal_and_says_how() {
        let s = shown([200, 100], vec![0.5; 20_000], [0.0, 1.0]);
        let text = s.blocks(80);
        assert!(text.lines().all(|l| l.matches('▀').count() <= 80));
        assert!(text.contains("mean of 3 × 2 entries"), "{text}");
    }
}
