//! The letter chart: Sloan's ten letters, drawn on his grid of 5 × 5 strokes (L. L. Sloan, Am. J.
//! Ophthalmol. 48, 1959).

use std::f64::consts::{FRAC_PI_2, PI};

use super::Picture;
use super::figure::{Figure, Point, arc, disc, stroke};

/// Rows of the chart; each has every letter at most once.
const ROWS: [[char; 5]; 8] = [
    ['N', 'C', 'K', 'Z', 'O'],
    ['R', 'H', 'S', 'D', 'V'],
    ['D', 'O', 'V', 'H', 'R'],
    ['C', 'Z', 'R', 'N', 'S'],
    ['O', 'K', 'H', 'V', 'D'],
    ['S', 'N', 'Z', 'C', 'K'],
    ['H', 'V', 'O', 'R', 'N'],
    ['Z', 'D', 'C', 'S', 'K'],
];

/// Width and height of the chart in heights of its first row: nine for letters and gaps, and half
/// of one on each side. Below each row there is as much white as the next row is high.
const CHART: [f64; 2] = [10.0, 8.0];

/// 10^−0.1: a row in terms of the one above.
const RATIO: f64 = 0.794_328_234_724_281_5;

pub(super) fn draw(size: [usize; 2]) -> Picture {
    let [w, h] = size.map(|n| n as f64);
    let scale = (w / CHART[0]).min(h / CHART[1]);
    let mut ink = Figure::new(size);
    let mut letter = scale;
    let mut top = 0.5 * (h - CHART[1] * scale) + 0.5 * scale;
    for row in ROWS {
        let left = 0.5 * w - 4.5 * letter;
        for (k, name) in row.into_iter().enumerate() {
            let x = left + 2.0 * k as f64 * letter;
            let place = |p: &Point| [x + p[0] * letter / 5.0, top + p[1] * letter / 5.0];
            let (outline, hole) = glyph(name);
            ink.add(&outline.iter().map(place).collect::<Vec<_>>());
            ink.cut(&hole.iter().map(place).collect::<Vec<_>>());
        }
        top += letter * (1.0 + RATIO);
        letter *= RATIO;
    }
    let mut picture = Picture::flat(size, 1.0);
    picture.paint(&ink, 0.0);
    picture
}

/// Outline and hole of a letter in \[0, 5\]², strokes 1 wide, y downwards.
fn glyph(name: char) -> (Vec<Point>, Vec<Point>) {
    let middle = [2.5, 2.5];
    let plain = |outline: &[Point]| (outline.to_vec(), Vec::new());
    // A bowl on the right: its straight start, the arc, and back.
    let bowl = |left: f64, [cx, cy]: Point, radius: f64| {
        let arc = arc([cx, cy], radius, [-FRAC_PI_2, FRAC_PI_2]);
        let ends = [[left, cy + radius], [left, cy - radius]];
        arc.into_iter().chain(ends).collect::<Vec<_>>()
    };
    match name {
        'C' => {
            let gap = |radius: f64| libm::asin(0.5 / radius);
            let outer = arc(middle, 2.5, [gap(2.5), 2.0 * PI - gap(2.5)]);
            let inner = arc(middle, 1.5, [2.0 * PI - gap(1.5), gap(1.5)]);
            ([outer, inner].concat(), Vec::new())
        }
        'D' => (bowl(0.0, middle, 2.5), bowl(1.0, middle, 1.5)),
        'H' => plain(&[
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 2.0],
            [4.0, 2.0],
            [4.0, 0.0],
            [5.0, 0.0],
            [5.0, 5.0],
            [4.0, 5.0],
            [4.0, 3.0],
            [1.0, 3.0],
            [1.0, 5.0],
            [0.0, 5.0],
        ]),
        'K' => plain(&[
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 2.4],
            [3.6, 0.0],
            [5.0, 0.0],
            [2.65, 2.2],
            [5.0, 5.0],
            [3.7, 5.0],
            [1.9, 2.9],
            [1.0, 3.7],
            [1.0, 5.0],
            [0.0, 5.0],
        ]),
        'N' => plain(&[
            [0.0, 0.0],
            [1.1, 0.0],
            [4.0, 3.5],
            [4.0, 0.0],
            [5.0, 0.0],
            [5.0, 5.0],
            [3.9, 5.0],
            [1.0, 1.5],
            [1.0, 5.0],
            [0.0, 5.0],
        ]),
        'O' => (disc(middle, 2.5, 180), disc(middle, 1.5, 180)),
        'R' => {
            let mut outline = arc([3.5, 1.5], 1.5, [-FRAC_PI_2, FRAC_PI_2]);
            outline.extend([
                [3.4, 3.0],
                [5.0, 5.0],
                [3.75, 5.0],
                [2.15, 3.0],
                [1.0, 3.0],
                [1.0, 5.0],
                [0.0, 5.0],
                [0.0, 0.0],
            ]);
            (outline, bowl(1.0, [3.5, 1.5], 0.5))
        }
        'S' => {
            let line = [
                arc([3.5, 1.5], 1.0, [-0.2, -FRAC_PI_2]),
                arc([1.5, 1.5], 1.0, [-FRAC_PI_2, -3.0 * FRAC_PI_2]),
                arc([3.5, 3.5], 1.0, [-FRAC_PI_2, FRAC_PI_2]),
                arc([1.5, 3.5], 1.0, [FRAC_PI_2, PI - 0.2]),
            ];
            (stroke(&line.concat(), 1.0), Vec::new())
        }
        'V' => plain(&[
            [0.0, 0.0],
            [1.1, 0.0],
            [2.5, 3.6],
            [3.9, 0.0],
            [5.0, 0.0],
            [3.05, 5.0],
            [1.95, 5.0],
        ]),
        _ => plain(&[
            [0.0, 0.0],
            [5.0, 0.0],
            [5.0, 0.9],
            [1.5, 4.0],
            [5.0, 4.0],
            [5.0, 5.0],
            [0.0, 5.0],
            [0.0, 4.1],
            [3.5, 1.0],
            [0.0, 1.0],
        ]),
    }
}
