//! Occluders to choose from, and where they stand.

use serde::{Deserialize, Serialize};

use crate::geometry::{Disc, Parallelogram, Shape};
use crate::num::named::named;
use crate::num::stream::{Key, Sampling, Stream};
use crate::scene::mesh::opaque_runs;
use crate::scene::{Scene, SceneError};

named! {
    /// What stands between object and wall, black on both sides.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub(super) enum Kind {
        /// Nothing.
        None = "none": "Nothing",
        /// A square plate, its side the size.
        Plate = "plate": "A square plate",
        /// A disc, its diameter the size.
        Disc = "disc": "A disc",
        /// A strip along the view's v, a quarter of the size wide and four sizes long.
        Rod = "rod": "A strip, a quarter of the size wide",
        /// A plate of eight sizes with a square hole of a quarter of the size.
        Pinhole = "pinhole": "A plate with a square hole of a quarter of the size",
        /// The same with a slit of that width along the view's v.
        Slit = "slit": "A plate with a slit of that width",
        /// A mask of 2.4 sizes a side, half of its cells open, chosen at random.
        Random = "random": "A mask of 2.4 sizes a side, half of its cells open",
        /// A mask of 2·7 − 1 a side of cells of 0.2 sizes, the 7 × 7 modified uniformly redundant
        /// array repeated (Gottesman and Fenimore 1989): wherever it is looked through, all of the
        /// 7 × 7 are met.
        Mura = "mura": "A mask of 13 × 13 cells of 0.2 sizes, the 7 × 7 MURA repeated",
    }
}

/// Where an occluder stands: in a plane parallel to the view, around the line from the middle of
/// the view to the middle of the hidden surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Place {
    /// Share of the way from the view (0) to the hidden surface (1).
    pub height: f64,
    /// Offset from the line along the view's u and v, length.
    pub offset: [f64; 2],
    /// Length.
    pub size: f64,
}

impl Kind {
    /// The scene with it at `place`; `mask` is the random one.
    ///
    /// # Errors
    /// [`SceneError`] where the shapes have no proper size.
    pub(super) fn in_scene(
        self,
        scene: &Scene,
        place: &Place,
        mask: &Cells,
    ) -> Result<Scene, SceneError> {
        let view = &scene.camera.view;
        let from = view.at([0.5; 2]).position;
        let hidden = scene.hidden().next();
        let to = hidden.map_or(from, |(_, s)| s.shape.at([0.5; 2]).position);
        let u = view.u().normalize_or_zero();
        let v = (view.v() - u * view.v().dot(u)).normalize_or_zero();
        let middle = from + (to - from) * place.height + u * place.offset[0] + v * place.offset[1];
        let s = place.size;
        let plate = |[a, b, wide, high]: &[f64; 4]| {
            let corner = middle + (u * *a + v * *b) * s;
            Parallelogram::new(corner, u * (wide * s), v * (high * s)).map(Shape::Parallelogram)
        };
        let shapes: Vec<Option<Shape>> = match self {
            Self::Disc => vec![Disc::new(middle, view.normal(), 0.5 * s).map(Shape::Disc)],
            _ => self.rectangles(mask).iter().map(plate).collect(),
        };
        scene.with_black(&shapes)
    }

    /// The rectangles of a flat occluder: left, low, wide and high, in sizes around its middle.
    fn rectangles(self, mask: &Cells) -> Vec<[f64; 4]> {
        match self {
            Self::None | Self::Disc => Vec::new(),
            Self::Plate => vec![[-0.5, -0.5, 1.0, 1.0]],
            Self::Rod => vec![[-0.125, -2.0, 0.25, 4.0]],
            Self::Slit => vec![[-4.0, -4.0, 3.875, 8.0], [0.125, -4.0, 3.875, 8.0]],
            Self::Pinhole => vec![
                [-4.0, -4.0, 3.875, 8.0],
                [0.125, -4.0, 3.875, 8.0],
                [-0.125, -4.0, 0.25, 3.875],
                [-0.125, 0.125, 0.25, 3.875],
            ],
            Self::Random => rectangles(mask, RANDOM_WIDTH),
            Self::Mura => rectangles(&mura(), 0.2 * MURA as f64),
        }
    }
}

/// Rows of cells, whether they are opaque, the lowest row first.
pub(super) type Cells = Vec<Vec<bool>>;

/// Width of the random mask, sizes.
const RANDOM_WIDTH: f64 = 2.4;
/// Cells a side of the repeated array.
const MURA: usize = 13;

/// `n` × `n` cells, half of them opaque (the lesser half of an odd number), by the first numbers of
/// a stream of random ones.
pub(super) fn random(n: usize, seed: u64) -> Cells {
    let key = Key {
        seed,
        spot: Key::ALL_SPOTS,
        pixel: Key::ALL_PIXELS,
        block: 0,
    };
    let mut stream = Stream::new(Sampling::Pcg, key);
    let mut order: Vec<(f64, usize)> = (0..n * n).map(|k| (stream.uniform(), k)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut found = vec![vec![false; n]; n];
    for (_, k) in &order[..n * n / 2] {
        found[k / n][k % n] = true;
    }
    found
}

/// The 7 × 7 array repeated.
fn mura() -> Cells {
    let row = |j: usize| (0..MURA).map(|i| !is_open(i % 7, j % 7)).collect();
    (0..MURA).map(row).collect()
}

/// Whether cell (i, j) of the 7 × 7 MURA is open: A(0, j) = 0, A(i, 0) = 1 for i > 0, else whether
/// i and j are both squares modulo 7, or neither is.
fn is_open(i: usize, j: usize) -> bool {
    let square = |x: usize| matches!(x, 1 | 2 | 4);
    i != 0 && (j == 0 || square(i) == square(j))
}

/// The opaque cells of a square mask around the middle, neighbours in a row as one.
fn rectangles(mask: &Cells, width: f64) -> Vec<[f64; 4]> {
    let side = width / mask.len() as f64;
    let at = |k: usize| k as f64 * side - 0.5 * width;
    let rows = mask.iter().enumerate();
    rows.flat_map(|(j, row)| opaque_runs(row).map(move |run| (j, run)))
        .map(|(j, run)| [at(run.start), at(j), run.len() as f64 * side, side])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The MURA's defining property: with G = 1 where A is open and −1 elsewhere, but G(0, 0) = 1,
    /// the periodic correlation of A with G is 24 at no shift and 0 at all others (p = 7: (p² −
    /// 1)/2).
    #[test]
    fn the_mura_has_one_peak() {
        let a = |i: usize, j: usize| i64::from(is_open(i % 7, j % 7));
        let g = |i: usize, j: usize| {
            if [i % 7, j % 7] == [0, 0] {
                1
            } else {
                2 * a(i, j) - 1
            }
        };
        for shift in 0..49 {
            let (x, y) = (shift % 7, shift / 7);
            let sum: i64 = (0..49)
                .map(|k| a(k % 7, k / 7) * g(k % 7 + x, k / 7 + y))
                .sum();
            assert_eq!(sum, if shift == 0 { 24 } else { 0 }, "{x} {y}");
        }
    }

    /// The masks have the area that their cells have, and the random one is half open.
    #[test]
    fn masks_cover_what_is_opaque() {
        let area = |kind: Kind, n: usize| -> f64 {
            let rectangles = kind.rectangles(&random(n, 1));
            rectangles.iter().map(|r| r[2] * r[3]).sum()
        };
        assert!((area(Kind::Random, 6) - 18.0 * 0.16).abs() < 1e-12);
        assert!((area(Kind::Random, 9) - 40.0 * (2.4f64 / 9.0).powi(2)).abs() < 1e-12);
        assert_ne!(random(6, 1), random(6, 2));
        let opaque = (0..169)
            .filter(|k| !is_open(k % 13 % 7, k / 13 % 7))
            .count();
        assert!((area(Kind::Mura, 6) - opaque as f64 * 0.04).abs() < 1e-12);
        assert!((area(Kind::Pinhole, 6) - (64.0 - 0.0625)).abs() < 1e-12);
    }
}
