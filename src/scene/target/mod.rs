//! Target pictures, drawn here: no file is needed, and every grey value follows from the definition
//! below.
//!
//! A pixel's value is the mean of the ideal picture over the pixel's square, linear reflectance
//! with 0 black and 1 white. Outlines are polygons and their coverage is exact, see [`Figure`];
//! arcs are polygons of as many corners as they need, with the area of the true disc.
//!
//! | name | picture |
//! | --- | --- |
//! | `card` | the eight of spades, 63 × 95 upright or 95 × 63 lying, with its two corner indices: black on a white card with round corners, black around it |
//! | `letters` | eight rows of five Sloan letters on their grid of 5 × 5 strokes; each row 10^−0.1 of the one above, the first a tenth of the width high |
//! | `siemens` | a star of 36 black and 36 white sectors in a disc of 0.48 of the shorter side; grey (½) around it |
//! | `edge` | an edge through the centre, black on its left, 5° from upright: its upper end is further right |
//! | `usaf` | three bars upright and three lying, 5 times as long as wide, like those of the chart of 1951: the bars of element k, k = 0, 1, … are 2^(−k/6) of the first's, which are 1/26 of the width; six elements a group, the first group in the left column, the others in the right |
//! | `ramp` | grey from 0 on the left to 1 on the right, linear |

mod bars;
mod card;
mod figure;
mod letters;

use crate::num::named::named;
pub use figure::Figure;

/// More pixels along a side than this are taken for a mistake.
pub const MOST_SIDE: usize = 4096;

/// Sectors of one colour in the star.
const SPOKES: usize = 36;

/// Slant of the edge, radians: 5°.
const SLANT: f64 = 5.0 * std::f64::consts::PI / 180.0;

/// A picture of linear reflectance.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Columns and rows.
    pub size: [usize; 2],
    /// Reflectance in \[0, 1\], row by row from the top, each from the left.
    pub values: Vec<f64>,
}

named! {
    /// A picture that is built in.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Target {
        /// A playing card.
        Card = "card",
        /// A chart of letters.
        Letters = "letters",
        /// A Siemens star.
        Siemens = "siemens",
        /// A slanted edge.
        Edge = "edge",
        /// Groups of three bars.
        Usaf = "usaf",
        /// A grey ramp.
        Ramp = "ramp",
    }
}

impl Target {
    /// What it shows, in one line.
    pub fn summary(self) -> &'static str {
        match self {
            Self::Card => "playing card, eight of spades; upright, or lying if wider than high",
            Self::Letters => "letter chart: eight rows of five, each 0.79 of the one above",
            Self::Siemens => "Siemens star of 36 spokes",
            Self::Edge => "edge, 5° from upright",
            Self::Usaf => "three-bar groups, each element 0.89 of the one before",
            Self::Ramp => "grey ramp, 0 to 1 from left to right, linear",
        }
    }

    /// Columns and rows unless others are asked for.
    pub fn usual_size(self) -> [usize; 2] {
        match self {
            Self::Card => [63, 95],
            Self::Letters => [220, 176],
            Self::Siemens => [256, 256],
            Self::Edge => [128, 128],
            Self::Usaf => [208, 288],
            Self::Ramp => [256, 32],
        }
    }

    /// The picture in `size` columns and rows; `None` if one of them is not 1 to [`MOST_SIDE`].
    pub fn picture(self, size: [usize; 2]) -> Option<Picture> {
        if !size.iter().all(|n| (1..=MOST_SIDE).contains(n)) {
            return None;
        }
        Some(match self {
            Self::Card => card::draw(size),
            Self::Letters => letters::draw(size),
            Self::Siemens => siemens(size, SPOKES),
            Self::Edge => edge(size),
            Self::Usaf => bars::draw(size),
            Self::Ramp => ramp(size),
        })
    }
}

impl Picture {
    /// All pixels of one value.
    fn flat(size: [usize; 2], value: f64) -> Self {
        Self {
            size,
            values: vec![value; size[0] * size[1]],
        }
    }

    /// Lays a figure of reflectance `ink` over the picture.
    fn paint(&mut self, figure: &Figure, ink: f64) {
        for (value, cover) in self.values.iter_mut().zip(figure.coverage()) {
            *value += (ink - *value) * cover;
        }
    }
}

/// ½ + ½·c − s with the coverages c of the disc and s of its black sectors: grey without, white or
/// black within.
fn siemens(size: [usize; 2], spokes: usize) -> Picture {
    let [w, h] = size.map(|n| n as f64);
    let (centre, radius) = ([0.5 * w, 0.5 * h], 0.48 * w.min(h));
    // Corners of the disc's polygon, the same number in each sector.
    let each = 1024_usize.div_ceil(2 * spokes);
    let rim = figure::disc(centre, radius, 2 * spokes * each);
    let mut disc = Figure::new(size);
    disc.add(&rim);
    let mut sectors = Figure::new(size);
    for k in 0..spokes {
        let arc = (2 * k * each..=(2 * k + 1) * each).map(|i| rim[i % rim.len()]);
        sectors.add(&std::iter::once(centre).chain(arc).collect::<Vec<_>>());
    }
    let both = disc.coverage().into_iter().zip(sectors.coverage());
    Picture {
        size,
        values: both
            .map(|(c, s)| (0.5 + 0.5 * c - s).clamp(0.0, 1.0))
            .collect(),
    }
}

/// x = w/2 + tan(5°)·(h/2 − y), y downwards, is the edge.
fn edge(size: [usize; 2]) -> Picture {
    let [w, h] = size.map(|n| n as f64);
    let lean = 0.5 * h * libm::tan(SLANT);
    let far = -w - h;
    let mut dark = Figure::new(size);
    dark.add(&[
        [far, 0.0],
        [0.5 * w + lean, 0.0],
        [0.5 * w - lean, h],
        [far, h],
    ]);
    let mut picture = Picture::flat(size, 1.0);
    picture.paint(&dark, 0.0);
    picture
}

fn ramp([w, h]: [usize; 2]) -> Picture {
    let row = (0..w).map(|i| (i as f64 + 0.5) / w as f64);
    Picture {
        size: [w, h],
        values: (0..h).flat_map(|_| row.clone()).collect(),
    }
}

#[cfg(test)]
mod tests;
