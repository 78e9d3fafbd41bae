//! The eight of spades.

use super::Picture;
use super::figure::{Figure, Point, curve, disc};

/// Of the upright card, in its own unit.
const CARD: [f64; 2] = [63.0, 95.0];
/// Radius of its corners.
const CORNER: f64 = 4.0;
/// Height of a pip, and of the pip below an index.
const PIP: f64 = 16.0;
const SMALL_PIP: f64 = 8.0;
/// Centres of the pips of the upper half, and of the middle row, which are upright; those of the
/// lower half are the upper's, turned.
const UPPER: [Point; 5] = [
    [20.5, 16.0],
    [42.5, 16.0],
    [31.5, 31.75],
    [20.5, 47.5],
    [42.5, 47.5],
];
const TURNED: usize = 3;

pub(super) fn draw(size: [usize; 2]) -> Picture {
    let [w, h] = size.map(|n| n as f64);
    let lies = w > h;
    let [across, along] = if lies { [h, w] } else { [w, h] };
    let scale = (across / CARD[0]).min(along / CARD[1]);
    // Card to pixels: centred, and turned by a quarter if it lies, the upper end to the left.
    let place = |[x, y]: Point| {
        let [x, y] = [(x - 0.5 * CARD[0]) * scale, (y - 0.5 * CARD[1]) * scale];
        let [x, y] = if lies { [y, -x] } else { [x, y] };
        [x + 0.5 * w, y + 0.5 * h]
    };
    let placed = |outline: Vec<Point>| outline.into_iter().map(place).collect::<Vec<_>>();
    let turned = |outline: &[Point]| {
        outline
            .iter()
            .map(|p| [CARD[0] - p[0], CARD[1] - p[1]])
            .collect::<Vec<_>>()
    };

    let mut card = Figure::new(size);
    card.add(&placed(round_corners()));
    let mut ink = Figure::new(size);
    for (k, centre) in UPPER.into_iter().enumerate() {
        let pip = spade(centre, PIP);
        if k < TURNED {
            ink.add(&placed(turned(&pip)));
        }
        ink.add(&placed(pip));
    }
    let pip = spade([7.5, 22.5], SMALL_PIP);
    ink.add(&placed(turned(&pip)));
    ink.add(&placed(pip));
    // The figure 8: a smaller ring on a larger one.
    for (centre, outer, inner) in [([7.5, 8.2], 2.9, 1.3), ([7.5, 13.1], 3.3, 1.6)] {
        for (radius, is_hole) in [(outer, false), (inner, true)] {
            let ring = disc(centre, radius, 128);
            for outline in [turned(&ring), ring] {
                let outline = placed(outline);
                if is_hole {
                    ink.cut(&outline);
                } else {
                    ink.add(&outline);
                }
            }
        }
    }
    let mut picture = Picture::flat(size, 0.0);
    picture.paint(&card, 1.0);
    picture.paint(&ink, 0.0);
    picture
}

/// A spade of so much height, upright, as wide as 0.88 of it.
fn spade([x, y]: Point, height: f64) -> Vec<Point> {
    // Shoulder, lobe and stem of the right half, from the tip down.
    let right = [
        [[0.0, -0.5], [0.08, -0.31], [0.44, -0.13], [0.44, 0.14]],
        [[0.44, 0.14], [0.44, 0.36], [0.15, 0.40], [0.05, 0.20]],
        [[0.05, 0.20], [0.06, 0.36], [0.12, 0.46], [0.20, 0.50]],
    ];
    let half: Vec<Point> = right.into_iter().flat_map(curve).collect();
    let left = half.iter().rev().map(|p| [-p[0], p[1]]);
    let tip = std::iter::once([0.0, -0.5]);
    let outline = tip.chain(half.iter().copied()).chain(left);
    outline
        .map(|p| [x + height * p[0], y + height * p[1]])
        .collect()
}

fn round_corners() -> Vec<Point> {
    use std::f64::consts::FRAC_PI_2;
    let [w, h] = CARD;
    let centres = [
        [w - CORNER, h - CORNER],
        [CORNER, h - CORNER],
        [CORNER, CORNER],
        [w - CORNER, CORNER],
    ];
    let corner = |(k, centre): (usize, Point)| {
        let from = k as f64 * FRAC_PI_2;
        super::figure::arc(centre, CORNER, [from, from + FRAC_PI_2])
    };
    centres.into_iter().enumerate().flat_map(corner).collect()
}
