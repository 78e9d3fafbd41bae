//! Figs 15 and 16: condition number and smallest eigenvalue.

use rayon::prelude::*;

use super::case::{HALF_WIDTH, KERNELS, published};
use super::inversion::recovered;
use super::item::Item;
use super::sheet::{Measure, finding};
use super::spots::{PER_SIDE, across, layout};
use crate::lab::LabError;
use crate::lab::check::Check;
use crate::lab::finding::{Axis, Curve, Finding, Mark, Plot, Table};
use crate::lab::recovered::inversion::smallest_eigenvalue;
use crate::metrics::rank_correlation;
use crate::model::{Kernel, Stagger};
use crate::num::linalg::Tolerance;
use crate::num::statistics::{correlation_two_sided, sidak_p};
use crate::transport::Control;

/// Elements a side of Figs 15 and 16.
const SIDES: [usize; 4] = [2, 4, 8, 16];
/// Those of them whose patterns are tested: at 2 × 2 and 4 × 4 elements the MTF is 1 but for
/// rounding as soon as there are as many spots as elements.
const TESTED: [usize; 2] = [8, 16];
/// Chance that one of all the tests sees a pattern where there is none.
const LEVEL: f64 = 0.01;

/// A configuration, and what is said of its G12.
struct Figures {
    kernel: Kernel,
    elements: usize,
    spots: usize,
    rank: usize,
    condition: f64,
    smallest: f64,
    raw: Option<f64>,
}

impl Figures {
    fn compute(kernel: Kernel, elements: usize, per_side: usize) -> Result<Self, LabError> {
        let case = published(kernel, elements, per_side, HALF_WIDTH, Stagger::None);
        let trial = &recovered(&case, &[Tolerance::Spacing], &[elements])?[0];
        Ok(Self {
            kernel,
            elements,
            spots: 4 * per_side,
            rank: trial.rank,
            condition: trial.condition,
            smallest: smallest_eigenvalue(&case.g12())?,
            raw: trial.found[0].raw,
        })
    }
}

/// Figs 15 and 16.
pub(super) fn figure(control: Control<'_>) -> Result<Finding, LabError> {
    let sides = KERNELS.into_iter().flat_map(|k| SIDES.map(|e| (k, e)));
    let cases: Vec<(Kernel, usize, usize)> = sides
        .flat_map(|(k, e)| PER_SIDE.map(|n| (k, e, n)))
        .collect();
    let one = |(kernel, elements, per_side)| {
        control.check()?;
        Figures::compute(kernel, elements, per_side)
    };
    let found: Result<Vec<Figures>, LabError> = cases.into_par_iter().map(one).collect();
    let found = found?;
    let own = |kernel: Kernel, side: usize| {
        let own = found.iter();
        own.filter(move |f| (f.kernel, f.elements) == (kernel, side))
    };
    let measures: [Measure<Figures, f64>; 2] = [
        ("condition number ‖G12‖·‖G12⁺‖", |f| f.condition),
        ("|λmin| / λmax of G12·G12ᵀ", |f| f.smallest.abs()),
    ];
    let mut plots = Vec::new();
    for kernel in KERNELS {
        for (title, measure) in measures {
            let curves = SIDES.map(|side| {
                let points = own(kernel, side).map(|f| [f.spots as f64, measure(f)]);
                Curve::new(
                    format!("{side} × {side} elements"),
                    Mark::Line,
                    points.collect(),
                )
            });
            plots.push(Plot::new(
                format!("{} kernel", kernel.name()),
                [across(), Axis::decades(title)],
                curves.to_vec(),
            ));
        }
    }
    let checks = TESTED.iter().flat_map(|side| {
        let sample = own(Kernel::Published, *side);
        let sample = sample.filter_map(|f| Some([f.spots as f64, f.raw?, f.condition, f.smallest]));
        checks(*side, &sample.collect::<Vec<_>>())
    });
    let checks = checks.collect();
    let negative = found.iter().filter(|f| f.smallest < 0.0).count();
    let notes = vec![
        format!(
            "{negative} of the {} smallest eigenvalues are negative, which those of G12·G12ᵀ \
             cannot be: they are rounding errors, and no pattern can be read from them.",
            found.len()
        ),
        "The condition number of a truncated inverse is bounded by the cut, 1/(max(r, l)·eps), \
         whatever G12 is. At 8 × 8 and 16 × 16 elements it rises with the number of spots while \
         these add directions above the cut, and then stays level near the cut; the MTF rises \
         with the same directions. This is the pattern that the test finds."
            .to_owned(),
        format!(
            "\"No pattern\" is published without a criterion, so the test is ours: Spearman's \
             rank correlation over the {} numbers of spots; its two-sided probability for random \
             orders, corrected for {TESTS} tests (Šidák), is compared with {LEVEL}. It detects \
             only what rises or falls throughout, and with so few numbers of spots no correlation \
             closer to 0 than ±{:.2}. If it detects nothing, there may still be a pattern. All \
             boards share their spots, so a correlation with the MTF does not prove a cause.",
            PER_SIDE.len(),
            least_seen(PER_SIDE.len())
        ),
    ];
    let layout = layout();
    let caption = format!(
        "Published and physical kernel; {layout}; condition number σ1 over the last kept singular value; smallest eigenvalue of G12·G12ᵀ formed in doubles, relative to \
         the largest and drawn by its size, its sign in the CSV; MTF of the board of one check an element, raw."
    );
    let table = Table::of(
        found,
        [
            ("kernel", |f| f.kernel.name().into()),
            ("elements", |f| f.elements.into()),
            ("spots", |f| f.spots.into()),
            ("rank", |f| f.rank.into()),
            ("condition", |f| f.condition.into()),
            ("smallest_eigenvalue_over_largest", |f| f.smallest.into()),
            ("mtf_raw", |f| f.raw.into()),
        ],
    );
    let title = "Condition number and smallest eigenvalue against the number of spots";
    Ok(Finding {
        checks,
        notes,
        ..finding(Item::Fig15, title, caption, table, plots)
    })
}

/// Two figures against two things at each of the tested numbers of elements.
const TESTS: usize = 4 * TESTED.len();

/// Whether condition number and smallest eigenvalue follow the number of spots or the raw MTF; the
/// columns of `sample` are spots, MTF, condition, eigenvalue.
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

    /// A figure that rises with the spots has a pattern, one that zigzags has none, and what does
    /// not vary has none.
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
