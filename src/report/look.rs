//! How series look: inks, dashes and marks that go together. Each of them alone tells the first six
//! series apart, with and without colour; the next six have hollow marks and other dashes.

use serde_json::{Value, json};

use super::svg::{Close, Svg, fill, ink};
use crate::lab::finding::Mark;

const INKS: [&str; 6] = [
    ink::BLUE,
    ink::VERMILLION,
    ink::GREEN,
    ink::PURPLE,
    ink::ORANGE,
    ink::BLACK,
];
const DASHES: [&str; 6] = ["", "8 3", "2 2.5", "9 3 2 3", "4 4", "10 3 2 3 2 3"];
/// Ink of what was published.
const PRINTED: &str = "fill=\"none\" stroke=\"#222222\" stroke-width=\"1.3\"";

/// The outline of a mark around its point.
enum Outline {
    /// A circle of this radius.
    Disc(f64),
    /// An upright square of this half side.
    Square(f64),
    /// A polygon.
    Corners(&'static [[f64; 2]]),
}

/// Disc, square, triangle, diamond, triangle upside down, cross.
const MARKS: [Outline; 6] = [
    Outline::Disc(3.2),
    Outline::Square(2.9),
    Outline::Corners(&[[0.0, -4.2], [3.8, 2.7], [-3.8, 2.7]]),
    Outline::Corners(&[[0.0, -4.4], [4.0, 0.0], [0.0, 4.4], [-4.0, 0.0]]),
    Outline::Corners(&[[0.0, 4.2], [3.8, -2.7], [-3.8, -2.7]]),
    Outline::Corners(&[
        [-1.1, -3.8],
        [1.1, -3.8],
        [1.1, -1.1],
        [3.8, -1.1],
        [3.8, 1.1],
        [1.1, 1.1],
        [1.1, 3.8],
        [-1.1, 3.8],
        [-1.1, 1.1],
        [-3.8, 1.1],
        [-3.8, -1.1],
        [-1.1, -1.1],
    ]),
];

/// Published points: an open circle for the first set, an open square for the second, a diamond for
/// the third, around the computed mark where they agree.
const PRINTED_MARKS: [Outline; 3] = [
    Outline::Disc(6.2),
    Outline::Square(5.8),
    Outline::Corners(&[[0.0, -7.6], [7.6, 0.0], [0.0, 7.6], [-7.6, 0.0]]),
];

impl Outline {
    fn draw(&self, svg: &mut Svg, [x, y]: [f64; 2], style: &str) {
        match self {
            Self::Disc(r) => svg.circle([x, y], *r, style),
            Self::Square(h) => svg.rect([x - h, y - h], [2.0 * h; 2], style),
            Self::Corners(corners) => {
                let placed: Vec<[f64; 2]> =
                    corners.iter().map(|[dx, dy]| [x + dx, y + dy]).collect();
                svg.path(&placed, Close::Yes, style);
            }
        }
    }

    /// For the page's script: the radius, or the corners.
    fn told(&self) -> Value {
        match self {
            Self::Disc(r) => json!(r),
            Self::Square(h) => json!([[-h, -h], [h, -h], [h, *h], [-h, *h]]),
            Self::Corners(corners) => json!(corners),
        }
    }
}

/// How a curve looks.
#[derive(Clone, Copy)]
pub(super) struct Look {
    /// How it is drawn.
    pub mark: Mark,
    /// Its number among those of the figure: published ones have numbers of their own.
    pub number: usize,
}

impl Look {
    /// Its ink.
    pub(super) fn ink(self) -> &'static str {
        INKS[self.number % INKS.len()]
    }

    /// The style of its line. From the seventh curve on inks come again with other dashes.
    pub(super) fn line(self) -> String {
        let dash = DASHES[(self.number + self.number / INKS.len()) % DASHES.len()];
        let dashes = match dash {
            "" => String::new(),
            lengths => format!(" stroke-dasharray=\"{lengths}\""),
        };
        format!(
            "fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\" stroke-linejoin=\"round\"{dashes}",
            self.ink()
        )
    }

    /// Marks a point.
    pub(super) fn point(self, svg: &mut Svg, at: [f64; 2]) {
        let (i, ink) = (self.number, self.ink());
        match self.mark {
            Mark::Line if (i / INKS.len()).is_multiple_of(2) => {
                MARKS[i % MARKS.len()].draw(svg, at, &fill(ink));
            }
            Mark::Line => {
                let hollow = format!("fill=\"white\" stroke=\"{ink}\" stroke-width=\"1.2\"");
                MARKS[i % MARKS.len()].draw(svg, at, &hollow);
            }
            Mark::Points => {
                let dot = format!("fill=\"{ink}\" fill-opacity=\"0.5\"");
                svg.circle(at, 1.8, &dot);
            }
            Mark::Published => PRINTED_MARKS[i % PRINTED_MARKS.len()].draw(svg, at, PRINTED),
            Mark::Bars | Mark::Level => {}
        }
    }

    /// A sample for a legend, 30 px long.
    pub(super) fn sample(self) -> String {
        let mut svg = Svg::default();
        let fill = fill(self.ink());
        match self.mark {
            Mark::Line | Mark::Level => svg.line([0.0, 0.0], [30.0, 0.0], &self.line()),
            Mark::Points => svg.circle([15.0, 0.0], 3.2, &fill),
            Mark::Bars => svg.rect([0.0, -5.0], [30.0, 10.0], &fill),
            Mark::Published => {}
        }
        if self.mark != Mark::Points {
            self.point(&mut svg, [15.0, 0.0]);
        }
        svg.text
    }
}

/// Inks, dashes and marks for the script of a page, which draws the same.
pub(super) fn looks() -> Value {
    let told = |marks: &[Outline]| -> Vec<Value> { marks.iter().map(Outline::told).collect() };
    json!({ "inks": INKS, "dashes": DASHES, "marks": told(&MARKS), "printed": told(&PRINTED_MARKS) })
}

#[cfg(test)]
mod tests {
    use super::super::svg::well_formed;
    use super::*;

    /// Twelve series look different without their colours, and the first six by their marks alone.
    #[test]
    fn series_are_told_apart_without_colour() {
        let line = |number| Look {
            mark: Mark::Line,
            number,
        };
        let grey = |text: String| INKS.iter().fold(text, |t, ink| t.replace(ink, "grey"));
        let samples: Vec<String> = (0..12).map(|i| grey(line(i).sample())).collect();
        for (i, a) in samples.iter().enumerate() {
            well_formed(a).unwrap();
            assert!(samples[..i].iter().all(|b| a != b), "{i}");
        }
        let marks = (0..6).map(|i| {
            let mut svg = Svg::default();
            line(i).point(&mut svg, [0.0, 0.0]);
            grey(svg.text)
        });
        let marks: Vec<String> = marks.collect();
        assert!((0..6).all(|i| marks[..i].iter().all(|m| *m != marks[i])));
    }
}
