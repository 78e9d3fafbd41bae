//! `/api/…`: what was run, and parts of its matrices, which stay on disk.

use std::io;
use std::path::Path;

use hyper::header::HeaderName;
use serde::Serialize;

use super::answer::{Answer, Refusal, bytes, pieces, set};
use super::body::PIECE;
use super::folder::Served;
use super::query::Query;
use super::run::record;
use crate::cli::run_folder::{PHI, STDERR, TAILS};
use crate::folder::Record;
use crate::matrix::npy::{Entries, NpyError};

/// Φcam of the model.
pub(super) const MODELLED: &str = "model/phi.npy";
/// Deviates of the traced entries from the model.
const Z: &str = "model/z.npy";
/// The matrices that can be asked for, all pixels × spots, and their files.
const MATRICES: [(&str, &str); 5] = [
    ("traced", PHI),
    ("stderr", STDERR),
    ("tails", TAILS),
    ("modelled", MODELLED),
    ("z", Z),
];
/// Most columns and rows of a tile.
const SIDE_MAX: usize = 512;
/// Most entries of a row.
const ROW_MAX: usize = 1_000_000;
/// Numbers in a piece of an answer.
const NUMBERS: usize = PIECE / size_of::<f64>();

/// What was run, and which of its matrices are there and of the right shape.
pub(super) fn about(folder: &Served, query: Option<&str>) -> Result<Answer, Refusal> {
    #[derive(Serialize)]
    struct About<'a> {
        version: &'a str,
        scene: &'a str,
        hash: &'a str,
        /// As text: JavaScript has no integers of 64 bits.
        seed: Option<String>,
        pixels: [usize; 2],
        spots: usize,
        matrices: Vec<&'a str>,
    }
    Query::of(query, &[])?;
    let record = record(folder)?;
    let there = |name: &&str| entries(folder, &record, name).is_ok();
    let about = About {
        version: &record.version,
        scene: &record.scene,
        hash: &record.scene_hash,
        seed: record.origin.plan().map(|plan| plan.seed.to_string()),
        pixels: record.pixels,
        spots: record.spots,
        matrices: MATRICES
            .map(|(name, _)| name)
            .into_iter()
            .filter(there)
            .collect(),
    };
    let text = serde_json::to_vec(&about).map_err(|e| Refusal::broken(e.to_string()))?;
    Ok(bytes("application/json", text))
}

/// A part of the frame of one spot.
pub(super) fn frame(folder: &Served, query: Option<&str>) -> Result<Answer, Refusal> {
    let query = Query::of(query, &["matrix", "spot", "x", "y", "w", "h", "step"])?;
    let record = record(folder)?;
    let spot = query.number("spot")?;
    if spot >= record.spots {
        let words = format!("spot has to be below {}", record.spots);
        return Err(Refusal::meaningless(words));
    }
    let step = query.number("step")?;
    let [columns, rows] = record.pixels;
    let across = Samples::of(query.number("x")?, query.number("w")?, step, columns);
    let up = Samples::of(query.number("y")?, query.number("h")?, step, rows);
    let (Some(across), Some(up)) = (across, up) else {
        return Err(Refusal::meaningless(format!(
            "x, y, w, h have to be a part, with something in it, of {columns} × {rows} pixels, and step above 0"
        )));
    };
    if across.count > SIDE_MAX || up.count > SIDE_MAX {
        return Err(Refusal::meaningless(format!(
            "{} × {} numbers are more than {SIDE_MAX} × {SIDE_MAX}: ask for smaller parts, or a larger step",
            across.count, up.count
        )));
    }
    let mut entries = entries(folder, &record, query.word("matrix"))?;
    let pixel = move |n: usize| {
        let (row, column) = (n / across.count, n % across.count);
        across.pixel(column) + columns * up.pixel(row)
    };
    let mut left = 0..across.count * up.count;
    let count = left.len();
    let source = move || {
        let pixels: Vec<usize> = left.by_ref().take(NUMBERS).map(pixel).collect();
        entries.column(spot, &pixels)
    };
    let mut answer = numbers(source, count);
    for (name, count) in [("x-columns", across.count), ("x-rows", up.count)] {
        set(
            &mut answer,
            HeaderName::from_static(name),
            &count.to_string(),
        );
    }
    Ok(answer)
}

/// What one pixel sees of all spots.
pub(super) fn row(folder: &Served, query: Option<&str>) -> Result<Answer, Refusal> {
    let query = Query::of(query, &["matrix", "pixel"])?;
    let record = record(folder)?;
    let mut entries = entries(folder, &record, query.word("matrix"))?;
    let pixel = query.number("pixel")?;
    let (pixels, spots) = entries.shape();
    if pixel >= pixels {
        let words = format!("pixel has to be below {pixels}");
        return Err(Refusal::meaningless(words));
    }
    if spots > ROW_MAX {
        let words = format!("a row of {spots} numbers is longer than {ROW_MAX}");
        return Err(Refusal::meaningless(words));
    }
    let mut next = 0;
    let source = move || {
        let count = NUMBERS.min(spots - next);
        let values = entries.row(pixel, next, count);
        next += count;
        values
    };
    Ok(numbers(source, spots))
}

/// `count` numbers, little-endian; `source` reads up to [`NUMBERS`] of them at a time.
fn numbers(
    mut source: impl FnMut() -> Result<Vec<f64>, NpyError> + Send + 'static,
    count: usize,
) -> Answer {
    let read = move || {
        let values = source().map_err(io::Error::other)?;
        Ok(values.into_iter().flat_map(f64::to_le_bytes).collect())
    };
    let length = (count * size_of::<f64>()) as u64;
    pieces("application/octet-stream", Box::new(read), length)
}

/// A matrix of the run, if it has the run's shape.
fn entries(folder: &Served, record: &Record, name: &str) -> Result<Entries, Refusal> {
    let Some((_, file)) = MATRICES.iter().find(|(n, _)| *n == name) else {
        let names = MATRICES.map(|(n, _)| n).join(", ");
        let words = format!("matrix has to be one of {names}");
        return Err(Refusal::meaningless(words));
    };
    let entries = Entries::of(folder.open(file)?.file, Path::new(file))?;
    let [columns, rows] = record.pixels;
    let expected = (columns * rows, record.spots);
    match entries.shape() {
        shape if shape == expected => Ok(entries),
        shape => Err(Refusal::broken(format!(
            "{file} has the shape {shape:?}, the run {expected:?}: run it again"
        ))),
    }
}

/// Pixels along one axis: of each block of `step` the middle one (the upper of two), and no further
/// than the last.
#[derive(Clone, Copy)]
struct Samples {
    first: usize,
    last: usize,
    step: usize,
    count: usize,
}

impl Samples {
    /// The blocks of `length` pixels from `first` on, if these are some of `all`.
    fn of(first: usize, length: usize, step: usize, all: usize) -> Option<Self> {
        let inside = first < all && (1..=all - first).contains(&length) && step > 0;
        inside.then(|| Self {
            first,
            last: first + length - 1,
            step,
            count: length.div_ceil(step),
        })
    }

    /// The pixel of block `block`.
    fn pixel(&self, block: usize) -> usize {
        let start = self.first + block * self.step;
        start.saturating_add(self.step / 2).min(self.last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_each_block_the_middle_pixel_is_taken() {
        let pixels = |first, length, step, all| {
            let samples = Samples::of(first, length, step, all)?;
            Some((0..samples.count).map(|b| samples.pixel(b)).collect())
        };
        for (window, expected) in [
            ((0, 5, 1, 5), vec![0, 1, 2, 3, 4]),
            ((2, 3, 1, 5), vec![2, 3, 4]),
            ((0, 9, 3, 9), vec![1, 4, 7]),
            ((0, 8, 2, 8), vec![1, 3, 5, 7]),
            // The last block has one pixel.
            ((1, 7, 3, 8), vec![2, 5, 7]),
            ((0, 7, 100, 7), vec![6]),
            ((0, 7, usize::MAX, 7), vec![6]),
            ((6, 1, usize::MAX, 7), vec![6]),
        ] {
            let (first, length, step, all) = window;
            assert_eq!(
                pixels(first, length, step, all),
                Some(expected),
                "{window:?}"
            );
        }
        for wrong in [
            (0, 6, 1, 5),
            (5, 1, 1, 5),
            (4, 2, 1, 5),
            (0, 0, 1, 5),
            (0, 5, 0, 5),
            (usize::MAX, 1, 1, 5),
            (1, usize::MAX, 1, 5),
            (0, 1, 1, 0),
        ] {
            let (first, length, step, all) = wrong;
            assert_eq!(
                pixels(first, length, step, all),
                None::<Vec<usize>>,
                "{wrong:?}"
            );
        }
    }
}
