//! Figs 15 and 16: condition number and smallest eigenvalue.

use rayon::prelude::*;

use super::figure::{computed, decades, linear};
use super::inversion::{Inversion, published};
use super::spots::{HALF_WIDTH, KERNELS, PER_SIDE, layout};
use super::{Check, Item, Plot, ReproduceError, Reproduction, Watch};
use crate::metrics::rank_correlation;
use crate::model::{Kernel, Stagger};
use crate::num::linalg::Tolerance;
use crate::num::statistics::{correlation_two_sided, sidak_p};
use crate::study::inversion::smallest_eigenvalue;

/// Elements a side of Figs 15 and 16.
const SIDES: [usize; 4] = [2, 4, 8, 16];
/// Those of them whose patterns are tested: at 2 × 2 and 4 × 4 elements the MTF is 1 but for rounding as soon as there are as many spots as elements.
const TESTED: [usize; 2] = [8, 16];
/// Chance that one of all the tests sees a pattern where there is none.
const LEVEL: f64 = 0.01;

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
                "condition number ‖G12‖·‖G12⁺‖",
                (|x| Some(x.condition)) as fn(&Figures) -> Option<f64>,
            ),
            ("|λmin| / λmax of G12·G12ᵀ", |x| Some(x.smallest.abs())),
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
    let own = |side: usize| {
        let all = cases.iter().zip(&found);
        let own = all.filter(|(c, _)| (c.0, c.1) == (Kernel::Published, side));
        let sample =
            own.filter_map(|(c, (_, x))| Some([4.0 * c.2 as f64, x.raw?, x.condition, x.smallest]));
        sample.collect::<Vec<[f64; 4]>>()
    };
    let checks = TESTED.iter().flat_map(|side| checks(*side, &own(*side)));
    let negative = found.iter().filter(|(_, x)| x.smallest < 0.0).count();
    Ok(Reproduction {
        item: Item::Fig15,
        title: "Condition number and smallest eigenvalue against the number of spots".to_owned(),
        caption: format!(
            "Published and physical kernel; {}; condition number σ1 over the last kept singular value; smallest eigenvalue of G12·G12ᵀ formed in doubles, relative to \
             the largest and drawn by its size, its sign in the CSV; MTF of the board of one check an element, raw.",
            layout()
        ),
        columns: [
            "kernel",
            "elements",
            "spots",
            "rank",
            "condition",
            "smallest_eigenvalue",
            "mtf_raw",
        ].map(str::to_owned).to_vec(),
        rows: rows.collect(),
        plots,
        galleries: Vec::new(),
        checks: checks.collect(),
        notes: vec![
            format!(
                "{negative} of the {} smallest eigenvalues are negative, which those of G12·G12ᵀ cannot be: they are rounding, and no pattern is to be looked for in \
                 them.",
                found.len()
            ),
            "The condition number of a truncated inverse is bounded by the cut, 1/(max(r, l)·eps), whatever G12 is. At 8 × 8 and 16 × 16 elements it rises with the spots \
             as long as they add directions that are kept, and is level near the cut from then on; the MTF rises with the same directions. That is the pattern \
             that is found."
                .to_owned(),
            format!(
                "\"No pattern\" is published without a criterion; the test is ours: Spearman's rank correlation over the {} numbers of spots, its probability for orders drawn at \
                 random, two-sided, taken for the {TESTS} tests together (Šidák), against {LEVEL}. It sees what rises or falls throughout, and with so few numbers of \
                 spots no correlation nearer to 0 than ±{:.2}; that none is seen does not prove that there is none. Boards share their spots, so a correlation with the \
                 MTF need not mean that the one makes the other.",
                PER_SIDE.len(),
                least_seen(PER_SIDE.len())
            ),
        ],
    })
}

/// Two figures against two things at each of the tested numbers of elements.
const TESTS: usize = 4 * TESTED.len();

/// Whether condition number and smallest eigenvalue follow the number of spots or the raw MTF; the columns of `sample` are spots, MTF, condition, eigenvalue.
fn checks(side: usize, sample: &[[f64; 4]]) -> Vec<Check> {
    let column = |k: usize| sample.iter().map(|x| x[k]).collect::<Vec<f64>>();
    let mut checks = Vec::new();
    for (figure, name) in [(2, "condition number"), (3, "smallest eigenvalue")] {
        for (against, other) in [(0, "number of spots"), (1, "raw MTF")] {
            let r = rank_correlation(&column(figure), &column(against));
            let p = r.map(|r| probability(r, sample.len()));
            checks.push(Check::claim(
                format!("{name} against {other}, {side} × {side} elements"),
                "no pattern",
                match (r, p) {
                    (Some(r), Some(p)) => format!(
                        "rank correlation {r:.2} over {} numbers of spots, p = {p:.1e}",
                        sample.len()
                    ),
                    _ => "none: one of them does not vary".to_owned(),
                },
                format!(
                    "ours: Spearman's test, p ≥ {LEVEL} for the {TESTS} tests together; published kernel"
                ),
                p.is_none_or(|p| p >= LEVEL),
            ));
        }
    }
    checks
}

/// Probability that one of all the tests sees at least |r| by chance.
fn probability(r: f64, pairs: usize) -> f64 {
    sidak_p(correlation_two_sided(r, pairs), TESTS as u64)
}

/// The smallest correlation that is told from chance, by hundredths.
fn least_seen(pairs: usize) -> f64 {
    let hundredths = (1..=100).map(|k| 0.01 * f64::from(k));
    let mut seen = hundredths.filter(|r| probability(*r, pairs) < LEVEL);
    seen.next().unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn holds(figure: impl Fn(f64) -> f64) -> Vec<bool> {
        let sample: Vec<[f64; 4]> = (0..16)
            .map(|k| [f64::from(k), 1.0, figure(f64::from(k)), 1.0])
            .collect();
        checks(8, &sample).iter().map(|c| c.holds).collect()
    }

    /// A figure that rises with the spots has a pattern, one that zigzags has none, and what does not vary has none.
    #[test]
    fn patterns_are_told_from_their_absence() {
        assert_eq!(holds(libm::exp), [false, true, true, true]);
        assert_eq!(holds(|k| (7.0 * k) % 16.0 % 5.0), [true; 4]);
        assert_eq!(TESTS, 2 * holds(|k| k).len());
    }

    #[test]
    fn what_is_just_seen_is_seen() {
        let least = least_seen(16);
        assert!(probability(least, 16) < LEVEL && probability(least - 0.01, 16) >= LEVEL);
    }
}
