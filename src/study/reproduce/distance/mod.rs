//! Figs 17, 18, 20, 21: the distance of the spot lines from C.

mod checks;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::contour;
use super::figure::{computed, elements, linear, published as printed};
use super::inversion::{Inversion, Outcome, published};
use super::substitution::{self, Case, Trial};
use super::traced::{self, MODELLED, NAMES};
use super::{Gallery, Item, Plot, ReproduceError, Reproduction, Shades, Watch};
use crate::model::{Kernel, Stagger};
use crate::num::linalg::Tolerance;
use checks::{finer, with, without};

/// Checks and elements a side.
const SIDE: usize = 8;
/// Spots a side: 100 in all.
const PER_SIDE: usize = 25;
/// Where curves start and end, in half inches.
const HALVES: std::ops::RangeInclusive<usize> = 2..=28;
/// Distances of the pictures, in.
const SHOWN: [f64; 5] = [1.0, 5.0, 6.0, 7.5, 11.0];
/// Distances at which light is traced, in.
const TRACED: [f64; 8] = [1.0, 3.0, 5.0, 6.0, 7.5, 9.0, 11.0, 14.0];

/// A point of a curve.
#[derive(Debug, Serialize, Deserialize)]
pub struct At {
    pub(super) half_width: f64,
    pub(super) rank: usize,
    /// The first singular value that is cut, over the cut.
    pub(super) nearest: f64,
    /// The last that is kept, over the cut.
    pub(super) last: f64,
    pub(super) outcome: Outcome,
}

pub(super) fn curve(
    kernel: Kernel,
    stagger: Stagger,
    tolerance: Tolerance,
    watch: Watch<'_>,
) -> Result<Vec<At>, ReproduceError> {
    let at = |half: usize| {
        watch.go_on()?;
        let half_width = 0.5 * half as f64;
        let case = published(kernel, SIDE, PER_SIDE, half_width, stagger);
        let inversion = Inversion::new(&case)?;
        let (rank, cut) = inversion.cut(tolerance)?;
        let outcome = inversion.noiseless(&case.board(SIDE), rank);
        Ok(At {
            half_width,
            rank,
            nearest: inversion.sigma.get(rank).map_or(0.0, |s| s / cut),
            last: inversion.sigma[rank - 1] / cut,
            outcome,
        })
    };
    HALVES.into_par_iter().map(at).collect()
}

/// Layouts with their names; Fig 17 has the first of two, Fig 20 both.
fn layouts(item: Item) -> &'static [(Stagger, &'static str)] {
    match item {
        Item::Fig17 => &[(Stagger::None, "no stagger")],
        _ => &[(Stagger::None, "no stagger"), (Stagger::OneInch, "stagger")],
    }
}

/// Kernels and layouts of the curves.
pub(super) fn curves(item: Item) -> Vec<(Kernel, Stagger)> {
    let layouts = layouts(item).iter();
    [Kernel::Published, Kernel::Physical]
        .into_iter()
        .flat_map(|k| layouts.clone().map(move |l| (k, l.0)))
        .collect()
}

/// Whether `curve` may be one of them.
pub(super) fn fits(curve: &[At]) -> bool {
    let whole = |a: &At| a.outcome.values.len() == SIDE * SIDE;
    curve.len() == HALVES.count() && curve.iter().all(whole)
}

/// The figure from its curves, and what was traced.
pub(super) fn figure(item: Item, found: Vec<Vec<At>>, traced: &[(Case, Trial)]) -> Reproduction {
    let layouts = layouts(item);
    let mut found = found.into_iter();
    let mut rows = Vec::new();
    let mut curves = [const { Vec::new() }; 2];
    let mut pictures = Vec::new();
    let mut of_published = Vec::new();
    for kernel in [Kernel::Published, Kernel::Physical] {
        for &(_, layout) in layouts {
            let curve = found.next().unwrap_or_default();
            for a in &curve {
                let o = &a.outcome;
                rows.push(vec![
                    kernel.name().into(),
                    layout.into(),
                    a.half_width.into(),
                    a.rank.into(),
                    a.last.into(),
                    a.nearest.into(),
                    o.raw.into(),
                    o.normalized.into(),
                    MODELLED.into(),
                    0.0.into(),
                ]);
            }
            let points = |f: fn(&Outcome) -> Option<f64>| {
                curve
                    .iter()
                    .filter_map(|a| Some([a.half_width, f(&a.outcome)?]))
                    .collect()
            };
            let name = format!("{} kernel, {layout}", kernel.name());
            curves[0].push(computed(&name, points(|o| o.normalized)));
            curves[1].push(computed(&name, points(|o| o.raw)));
            if kernel == Kernel::Published {
                for a in curve.iter().filter(|a| SHOWN.contains(&a.half_width)) {
                    let title = format!("{} in., {layout}", a.half_width);
                    pictures.push(elements(title, SIDE, a.outcome.stretched()));
                }
                of_published.push(curve);
            }
        }
    }
    let checks = match item {
        Item::Fig17 => without(&of_published[0]),
        _ => with(&of_published[0], &of_published[1]),
    };
    let known = match item {
        Item::Fig17 => vec![[5.0, 0.4731]],
        _ => vec![[5.0, 0.4731], [5.0, 1.0]],
    };
    curves[0].push(printed("printed in the text", known));
    let axes = |title| {
        [
            linear("half-width of the square of spots / in.", [0.0, 15.0]),
            linear(title, [0.0, 1.0]),
        ]
    };
    let [normalized, raw] = curves;
    for (case, t) in traced {
        for (name, r) in NAMES.iter().zip(&t.found) {
            rows.push(vec![
                Kernel::Physical.name().into(),
                case.curve.into(),
                case.x.into(),
                t.rank.into(),
                t.around[0].into(),
                t.around[1].into(),
                r.outcome.raw.into(),
                r.outcome.normalized.into(),
                (*name).into(),
                r.noise.into(),
            ]);
        }
    }
    let mut galleries = vec![Gallery {
        title: "Recovered 8 × 8 board, published kernel, stretched to [0, 1]".to_owned(),
        shades: Shades::Reflectance,
        unit: String::new(),
        pictures,
    }];
    galleries.push(substitution::gallery(traced, &SHOWN));
    if item == Item::Fig20 {
        galleries.push(contour::contours());
    }
    Reproduction {
        item,
        title: match item {
            Item::Fig17 => "MTF against the distance of the spot lines from C, no stagger",
            _ => "MTF against the distance of the spot lines from C, with and without stagger",
        }
        .to_owned(),
        caption: format!(
            "Published and physical kernel (G12 and G23 alike); 8 × 8 board at 8 × 8 elements; 100 spots on the four sides of a square around C, {}; \
             16 × 16 pixels laid to the edges of the view; Moore–Penrose inverse cut at max(r, l)·eps(σ1), eps the spacing of doubles at σ1 (MATLAB); \
             normalized MTF of the values stretched to [0, 1], raw MTF beside it; noiseless, by the projector. {}",
            match item {
                Item::Fig17 => "no stagger",
                _ => "without stagger and by turns on, 1 in. inside and 1 in. outside its lines",
            },
            traced::caption()
        ),
        columns: [
            "kernel",
            "layout",
            "half_width_in",
            "rank",
            "last_kept_over_cut",
            "first_cut_over_cut",
            "mtf_raw",
            "mtf_normalized",
            "phi",
            "noise",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows,
        plots: vec![
            Plot {
                title: "normalized MTF (published convention)".to_owned(),
                axes: axes("normalized MTF"),
                curves: normalized,
            },
            Plot {
                title: "raw MTF".to_owned(),
                axes: axes("raw MTF"),
                curves: raw,
            },
            substitution::plot(
                traced,
                linear("half-width of the square of spots / in.", [0.0, 15.0]),
            ),
        ],
        galleries,
        checks,
        notes: vec![finer(&of_published[0]), substitution::words(traced)],
    }
}

/// What is traced.
pub(super) fn cases(item: Item) -> Vec<Case> {
    let of = |&(stagger, curve): &(Stagger, &'static str)| {
        TRACED.map(|x| Case {
            curve,
            x,
            published: published(Kernel::Physical, SIDE, PER_SIDE, x, stagger),
            checks: SIDE,
        })
    };
    layouts(item).iter().flat_map(of).collect()
}
