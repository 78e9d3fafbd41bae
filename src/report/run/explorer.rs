//! The explorer of Φcam: what of the matrices lies in the page, and what the script must know of
//! them.

use rayon::prelude::*;
use serde_json::{Value, json};

use super::super::page::{Library, Packed, Page, Precision};
use crate::lab::RunResults;
use crate::matrix::Matrix;
use crate::scene::Scene;
use crate::transport::tails::WORDS;

/// What a page may have, bytes: below 10 MB, with room for the words around the last blocks.
const PAGE: usize = 9_900_000;
/// What the packed matrices may take in any case; where the rest of a page leaves less, it is too
/// large without them.
const LEAST: usize = 500_000;
/// More positions of spots than this are not in the page.
const MOST_PLACES: usize = 20_000;
/// Bytes that an entry takes at the very least, as the start of a search.
const LEAST_EACH: f64 = 5.0;

/// How exactly traced and modelled flux, standard error, z and the codes of the error bars are
/// kept; the first set that fits. Codes are below 2⁵: with four bits after the first they are
/// exact.
const PRECISIONS: [[Precision; MATRICES]; 5] = {
    use Precision::{Exact, Single};
    const CODES: Precision = Single(4);
    [
        [Exact, Exact, Exact, Exact, CODES],
        [Single(23), Single(23), Single(12), Single(10), CODES],
        [Single(23), Single(23), Single(8), Single(7), CODES],
        [Single(21), Single(21), Single(7), Single(6), CODES],
        [Single(18), Single(18), Single(7), Single(6), CODES],
    ]
};

/// Matrices of a page.
const MATRICES: usize = 5;

/// The part of Φcam that lies in the page: every pixel and spot, or the middle one of each block of
/// pixels, and one spot of every `step`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Excerpt {
    /// Every so many columns and rows of the camera.
    pub every: usize,
    /// One spot of so many.
    pub step: usize,
    /// The spots.
    pub spots: Vec<usize>,
    /// The pixels, columns first.
    pub pixels: Vec<usize>,
}

/// Indices of the middle ones of blocks of `every` out of n.
fn middles(n: usize, every: usize) -> impl Iterator<Item = usize> {
    (0..n)
        .step_by(every)
        .map(move |start| (start + (start + every).min(n) - 1) / 2)
}

impl Excerpt {
    /// At most `entries` of them: spots are left out first, down to a few, then pixels.
    pub(super) fn new([columns, rows]: [usize; 2], spots: usize, entries: f64) -> Self {
        let all = (columns * rows) as f64 * spots as f64;
        let few = spots.div_ceil(12).max(1);
        let step = ((all / entries).ceil() as usize).clamp(1, few);
        let spots: Vec<usize> = middles(spots, step).collect();
        let mut every = 1;
        while (columns.div_ceil(every) * rows.div_ceil(every)) as f64 * spots.len() as f64 > entries
            && every < columns.max(rows)
        {
            every += 1;
        }
        let across: Vec<usize> = middles(columns, every).collect();
        let pixels = middles(rows, every)
            .flat_map(|row| across.iter().map(move |column| column + row * columns))
            .collect();
        Self {
            every,
            step,
            spots,
            pixels,
        }
    }

    /// One frame in sixteen of it.
    fn few(&self) -> Self {
        Self {
            spots: self.spots.iter().copied().step_by(16).collect(),
            ..self.clone()
        }
    }

    /// Its entries of a matrix, frame after frame.
    pub(super) fn of(&self, matrix: &Matrix) -> Vec<f64> {
        let frame = |&spot: &usize| self.pixels.iter().map(move |&pixel| matrix[(pixel, spot)]);
        self.spots.iter().flat_map(frame).collect()
    }
}

/// The element that the script turns into the explorer.
pub(super) fn explorer(page: &mut Page, results: &RunResults, fallback: &str) -> String {
    if results.phi.is_empty() {
        return String::new();
    }
    page.needs(Library::Plot);
    format!("<div class=\"explorer\">\n{fallback}</div>\n")
}

/// Puts Φcam, as much of it as the rest of the page leaves room for, and its circumstances into the
/// page: the last of its parts.
pub(super) fn embed(page: &mut Page, results: &RunResults) {
    let phi = &results.phi;
    if phi.is_empty() {
        return;
    }
    let camera = &results.scene.camera;
    let size = [camera.columns, camera.rows];
    let named = [
        ("traced", Some(phi)),
        ("modelled", results.model.as_ref()),
        ("stderr", Some(&results.stderr)),
        ("z", results.z.as_ref()),
        ("tails", Some(&results.tails)),
    ];
    page.json("explorer-places", &places(&results.scene));
    let room = PAGE.saturating_sub(page.len()).max(LEAST);
    let mut entries = room as f64 / LEAST_EACH;
    let (excerpt, precision, blocks) = loop {
        let excerpt = Excerpt::new(size, phi.ncols(), entries);
        let fitting = PRECISIONS.into_iter().find_map(|precisions| {
            let blocks = packed(&excerpt, &named, precisions, room)?;
            Some((precisions, blocks))
        });
        if let Some((precision, blocks)) = fitting {
            break (excerpt, precision, blocks);
        }
        entries *= 0.7;
    };
    for (name, block) in &blocks {
        page.numbers(&format!("phi-{name}"), block);
    }
    let about = circumstances(
        (&results.scene, results.plan.seed),
        &excerpt,
        Ends::of(results),
        precision,
        results.model.is_some(),
    );
    page.json("explorer-data", &about);
}

/// The places of the spots, to a millionth of the length unit.
fn places(scene: &Scene) -> Vec<[f64; 3]> {
    let spots = scene.laser.spots.iter().take(MOST_PLACES);
    spots
        .map(|s| {
            s.target
                .position
                .to_array()
                .map(|x| (1e6 * x).round() / 1e6)
        })
        .collect()
}

/// The matrices at a precision, if they fit.
fn packed(
    excerpt: &Excerpt,
    named: &[(&'static str, Option<&Matrix>); MATRICES],
    precisions: [Precision; MATRICES],
    room: usize,
) -> Option<Vec<(&'static str, Packed)>> {
    let there = || {
        let both = named.iter().zip(precisions);
        both.filter_map(|((name, matrix), precision)| Some((*name, (*matrix)?, precision)))
    };
    // A few frames tell how many bytes all will take: what misses by far is not tried.
    let few = excerpt.few();
    let all = excerpt.spots.len() as f64 / few.spots.len().max(1) as f64;
    let sample: usize = there()
        .map(|(_, matrix, precision)| Packed::new(&few.of(matrix), precision).len())
        .sum();
    if sample as f64 * all > 1.05 * room as f64 {
        return None;
    }
    let blocks: Vec<(&'static str, Packed)> = there()
        .collect::<Vec<_>>()
        .into_par_iter()
        .map(|(name, matrix, precision)| (name, Packed::new(&excerpt.of(matrix), precision)))
        .collect();
    let size: usize = blocks.iter().map(|(_, block)| block.len()).sum();
    (size <= room).then_some(blocks)
}

/// The ends of scales, as far as they are known.
#[derive(Clone, Copy, Debug, Default)]
struct Ends {
    /// Least and greatest flux, traced or modelled, W.
    range: Option<[f64; 2]>,
    /// Largest |traced − modelled|, W.
    residual: Option<f64>,
    /// Largest standard error, W.
    stderr: Option<f64>,
    /// The limit for the largest |z|.
    limit: Option<f64>,
}

impl Ends {
    fn of(results: &RunResults) -> Self {
        let flux = results.model.iter().chain([&results.phi]);
        let range = flux
            .flat_map(|m| m.iter())
            .filter(|x| x.is_finite())
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], x| {
                [l.min(*x), h.max(*x)]
            });
        Self {
            range: (range[0] < range[1]).then_some(range),
            residual: results.model.as_ref().map(|m| (&results.phi - m).amax()),
            stderr: Some(results.stderr.amax()),
            limit: results.agreement.as_ref().map(|a| a.z_limit),
        }
    }
}

/// The element that the script turns into the explorer where a server hands out the matrices;
/// `model` says whether there are modelled ones.
pub(super) fn served_explorer(page: &mut Page, scene: &Scene, seed: u64, model: bool) -> String {
    let nothing = Excerpt {
        every: 1,
        step: 1,
        spots: Vec::new(),
        pixels: Vec::new(),
    };
    let exact = [Precision::Exact; MATRICES];
    let about = circumstances((scene, seed), &nothing, Ends::default(), exact, model);
    page.json("explorer-data", &about);
    page.json("explorer-places", &places(scene));
    page.needs(Library::Plot);
    "<div class=\"explorer\">\n<p>The entries are read when they are asked for, by the page's script.</p>\n</div>\n".to_owned()
}

/// What the script must know beside the numbers.
fn circumstances(
    (scene, seed): (&Scene, u64),
    excerpt: &Excerpt,
    ends: Ends,
    precision: [Precision; MATRICES],
    model: bool,
) -> Value {
    let camera = &scene.camera;
    let (right, up) = (camera.view.u().normalize(), camera.view.v().normalize());
    let bits = |p: Precision| match p {
        Precision::Exact => None,
        Precision::Single(bits) => Some(bits + 1),
    };
    let [flux, _, stderr, z, _] = precision.map(bits);
    json!({
        "unit": scene.unit.symbol(),
        "columns": camera.columns,
        "rows": camera.rows,
        "spots": scene.laser.spots.len(),
        "hash": scene.hash,
        "seed": seed.to_string(),
        "every": excerpt.every,
        "step": excerpt.step,
        "embedded": excerpt.spots,
        "bits": flux.map(|flux| [Some(flux), stderr, z]),
        "view": {
            "corner": camera.view.corner().to_array(),
            "u": camera.view.u().to_array(),
            "v": camera.view.v().to_array(),
        },
        "axes": { "right": right.to_array(), "up": up.to_array() },
        "range": ends.range,
        "residual": ends.residual,
        "stderr": ends.stderr,
        "limit": ends.limit,
        "model": model,
        "tails": WORDS,
    })
}

#[cfg(test)]
mod tests;
