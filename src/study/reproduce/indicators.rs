//! Figs 15 and 16: condition number and smallest eigenvalue.

use rayon::prelude::*;

use super::figure::{computed, decades, linear};
use super::inversion::{Inversion, published};
use super::spots::{HALF_WIDTH, KERNELS, PER_SIDE, layout};
use super::{Check, Item, Plot, ReproduceError, Reproduction, Watch};
use crate::metrics::rank_correlation;
use crate::model::{Kernel, Stagger};
use crate::num::linalg::Tolerance;
use crate::study::inversion::smallest_eigenvalue;

/// Elements a side of Figs 15 and 16.
const SIDES: [usize; 4] = [2, 4, 8, 16];
/// A rank correlation below this is no pattern.
const NO_PATTERN: f64 = 0.5;

struct Figures {
    condition: f64,
    smallest: f64,
    raw: Option<f64>,
}

/// Figs 15 and 16.
pub(super) fn indicators(watch: Watch<'_>) -> Result<Reproduction, ReproduceError> {
    let cases: Vec<(Kernel, usize, usize)> = KERNELS
        .into_iter()
        .flat_map(|k| SIDES.map(|e| (k, e)))
        .flat_map(|(k, e)| PER_SIDE.map(|n| (k, e, n)))
        .collect();
    let found: Vec<(usize, Figures)> = cases
        .par_iter()
        .map(|&(kernel, elements, per_side)| {
            watch.go_on()?;
            let case = published(kernel, elements, per_side, HALF_WIDTH, Stagger::None);
            let inversion = Inversion::new(&case)?;
            let rank = inversion.rank(Tolerance::Spacing)?;
            let figures = Figures {
                condition: inversion.sigma[0] / inversion.sigma[rank - 1],
                smallest: smallest_eigenvalue(&case.g12())?,
                raw: inversion.noiseless(&case.board(elements), rank).raw,
            };
            Ok((rank, figures))
        })
        .collect::<Result<_, ReproduceError>>()?;
    let line = |kernel: Kernel, side: usize, f: &dyn Fn(&Figures) -> Option<f64>| {
        let own = cases
            .iter()
            .zip(&found)
            .filter(|(c, _)| (c.0, c.1) == (kernel, side));
        own.filter_map(|(c, (_, x))| Some([(4 * c.2) as f64, f(x)?]))
            .collect::<Vec<_>>()
    };
    let mut plots = Vec::new();
    for kernel in KERNELS {
        for (title, f) in [
            (
                "‖G12‖·‖G12⁺‖",
                (|x| Some(x.condition)) as fn(&Figures) -> Option<f64>,
            ),
            ("|smallest eigenvalue of G12·G12ᵀ| / largest", |x| {
                Some(x.smallest.abs())
            }),
        ] {
            let curve =
                |side| computed(format!("{side} × {side} elements"), line(kernel, side, &f));
            plots.push(Plot {
                title: format!("{} kernel", kernel.name()),
                axes: [linear("number of spots", [0.0, 400.0]), decades(title)],
                curves: SIDES.map(curve).to_vec(),
            });
        }
    }
    let rows = cases.iter().zip(&found).map(|(c, (rank, x))| {
        vec![
            c.0.name().into(),
            c.1.into(),
            (4 * c.2).into(),
            (*rank).into(),
            x.condition.into(),
            x.smallest.into(),
            x.raw.into(),
        ]
    });
    let own = |side| {
        cases
            .iter()
            .zip(&found)
            .filter(move |(c, _)| (c.0, c.1) == (Kernel::Published, side))
    };
    let mut checks = Vec::new();
    for side in [8, 16] {
        let all: Vec<&Figures> = own(side).map(|(_, (_, x))| x).collect();
        let raw: Vec<f64> = all.iter().filter_map(|x| x.raw).collect();
        for (name, values) in [
            (
                "condition number",
                all.iter().map(|x| x.condition).collect::<Vec<f64>>(),
            ),
            (
                "smallest eigenvalue",
                all.iter().map(|x| x.smallest).collect(),
            ),
        ] {
            let r = rank_correlation(&values, &raw);
            checks.push(Check::claim(
                format!("{name} and raw MTF over the numbers of spots, {side} × {side} elements"),
                "no pattern",
                r.map_or("none".to_owned(), |r| format!("rank correlation {r:.3}")),
                format!("rank correlation within ±{NO_PATTERN}, published kernel"),
                r.is_some_and(|r| r.abs() < NO_PATTERN),
            ));
        }
    }
    let negative = found.iter().filter(|(_, x)| x.smallest < 0.0).count();
    Ok(Reproduction {
        item: Item::Fig15,
        title: "Condition number and smallest eigenvalue against the number of spots".to_owned(),
        caption: format!(
            "Published and physical kernel; {}; condition number σ1 over the last kept singular value; smallest eigenvalue of G12·G12ᵀ formed in doubles, relative to \
             the largest and drawn by its size, its sign in the CSV; MTF of the board of one check an element, raw.",
            layout()
        ),
        columns: vec![
            "kernel",
            "elements",
            "spots",
            "rank",
            "condition",
            "smallest_eigenvalue",
            "mtf_raw",
        ],
        rows: rows.collect(),
        plots,
        galleries: Vec::new(),
        checks,
        notes: vec![format!(
            "{negative} of the {} smallest eigenvalues are negative, which those of G12·G12ᵀ cannot be: they are rounding. The condition number of a truncated inverse \
             is bounded by the cut, 1/(max(r, l)·eps), whatever G12 is.",
            found.len()
        )],
    })
}
