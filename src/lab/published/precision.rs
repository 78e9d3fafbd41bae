//! The same inversions beyond double precision, and in doubles under several tolerances.

use super::case::{Case, HALF_WIDTH, Row, curve, published, rows};
use super::exact;
use super::inversion::recovered;
use super::item::Item;
use super::outcome::Trial;
use super::plan::ReproducePlan;
use super::sheet::finding;
use crate::lab::LabError;
use crate::lab::check::Check;
use crate::lab::finding::{Axis, Finding, Plot, Table};
use crate::model::{Kernel, Stagger};
use crate::num::linalg::Tolerance;
use crate::transport::Control;

/// A group of cases: published item, elements a side, boards, spots a side, half-widths.
struct Group {
    item: &'static str,
    elements: usize,
    boards: &'static [usize],
    per_side: &'static [usize],
    half_widths: &'static [f64],
}

const GROUPS: [Group; 5] = [
    Group {
        item: "Table 1",
        elements: 8,
        boards: &[2],
        per_side: &[20, 100, 1000],
        half_widths: &[HALF_WIDTH],
    },
    Group {
        item: "Figs 12–14",
        elements: 8,
        boards: &[2, 4, 8],
        per_side: &[2, 4, 6, 10, 15, 20, 25, 30, 40, 60, 100],
        half_widths: &[HALF_WIDTH],
    },
    Group {
        item: "Figs 12–14",
        elements: 16,
        boards: &[2, 4, 8, 16],
        // 76, 116 and 396 different spots: the last leave no element out, with a smallest over
        // largest diagonal entry of R of 3e-48, of which 108 digits are lost.
        per_side: &[20, 30, 100],
        half_widths: &[HALF_WIDTH],
    },
    Group {
        item: "Fig 17",
        elements: 8,
        boards: &[8],
        per_side: &[25],
        half_widths: &[
            1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 7.5, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0,
        ],
    },
    Group {
        item: "Figs 12 and 13",
        elements: 4,
        boards: &[2, 4],
        // Not 5: of 16 different spots 9 combinations are alike to the left and the right of x = 5
        // and 7 are not, of the elements 8 and 8, so that the rank is 15 by any number of digits.
        per_side: &[2, 3, 4, 6, 10, 20, 30, 100],
        half_widths: &[HALF_WIDTH],
    },
];

/// Ways to recover: doubles under four cuts, N standing for max(r, l), and the arithmetic beyond
/// doubles.
pub(super) const WAYS: [&str; 5] = [
    "N·eps(σ1) (MATLAB)",
    "N·2⁻⁵²·σ1 (NumPy, Octave)",
    "10·N·2⁻⁵²·σ1",
    "0.1·N·2⁻⁵²·σ1",
    "multiple precision",
];
const MATLAB: usize = 0;
const DIGITS: usize = 4;

/// The cuts of the first four ways.
fn rules(elements: usize, spots: usize) -> [Tolerance; 4] {
    let eps = elements.max(spots) as f64 * f64::EPSILON;
    [
        Tolerance::Spacing,
        Tolerance::Auto,
        Tolerance::Relative(10.0 * eps),
        Tolerance::Relative(0.1 * eps),
    ]
}

/// The cases that the plan admits.
pub(super) fn cases(plan: &ReproducePlan) -> Vec<Case> {
    let mut cases = Vec::new();
    for g in GROUPS.iter().filter(|g| g.elements <= plan.most_elements) {
        for &half_width in g.half_widths {
            cases.extend(g.per_side.iter().map(|&per_side| {
                let (kernel, stagger) = (Kernel::Published, Stagger::None);
                let case = published(kernel, g.elements, per_side, half_width, stagger);
                Case::modelled(g.item, case, g.boards.to_vec())
            }));
        }
    }
    cases
}

/// Every way.
pub(super) fn trials(
    Case {
        published, boards, ..
    }: &Case,
    control: Control<'_>,
) -> Result<Vec<Trial>, LabError> {
    let rules = rules(
        published.elements * published.elements,
        4 * published.per_side,
    );
    let mut trials = recovered(published, &rules, boards)?;
    for trial in &mut trials {
        trial.digits = 16;
    }
    trials.push(exact::recover(published, boards, control)?);
    Ok(trials)
}

/// The figure.
pub(super) fn figure(cases: &[Case], found: &[Vec<Trial>]) -> Finding {
    let rows = rows(cases, found);
    let across = || Axis::linear("number of spots", [0.0, 400.0]);
    let half_widths = Axis::linear("half-width / in.", [0.0, 15.0]);
    let spots = |r: &Row<'_>| r.spots() as f64;
    let plots = vec![
        plot(
            "8 × 8 board and elements, half-width 6 in.",
            &rows,
            ("Figs 12–14", 8),
            across(),
            spots,
        ),
        plot(
            "16 × 16 board and elements, half-width 6 in.",
            &rows,
            ("Figs 12–14", 16),
            across(),
            spots,
        ),
        plot(
            "8 × 8 board, 8 × 8 elements, 100 spots",
            &rows,
            ("Fig 17", 8),
            half_widths,
            |r| r.half_width(),
        ),
    ];
    let enough = |way: usize| {
        let own =
            move |r: &&Row<'_>| r.way == way && r.case.published.elements == 8 && r.spots() >= 80;
        rows.iter().filter(own)
    };
    let shortfall = |r: &Row<'_>| r.outcome.shortfall.abs();
    let worst = enough(DIGITS).map(shortfall).fold(0.0, f64::max);
    let doubles = enough(MATLAB).filter_map(|r| r.outcome.raw);
    let least = doubles.fold(f64::INFINITY, f64::min);
    let checks = vec![Check::claim(
        format!(
            "raw MTF of the {} cases with 8 × 8 elements and 80 spots or more (doubles: down to {least:.4})",
            enough(DIGITS).count()
        ),
        "below 1: what the figures show is a property of the method",
        format!("at least 1 − {worst:.1e} in multiple precision"),
        "refuted where all are above 1 − 1e-9: the loss then comes from the rounding of doubles \
         and from the cut",
        worst > 1e-9,
    )];
    let notes = GROUPS.iter().filter_map(|g| {
        let n = g.elements;
        let own = |r: &&Row<'_>| {
            let group = (r.case.label, r.case.published.elements) == (g.item, n);
            group && r.way == DIGITS && r.trial.rank == n * n
        };
        let own: Vec<&Row<'_>> = rows.iter().filter(own).collect();
        let digits = own.iter().map(|r| r.trial.digits).max()?;
        let spots = own.iter().map(|r| r.spots()).min()?;
        let worst = own.iter().map(|r| shortfall(r)).fold(0.0, f64::max);
        Some(format!(
            "{}, {n} × {n} elements: full rank of {} in the cases with {spots} spots and more, with at most {digits} digits; raw MTF 1 to {worst:.1e} for every board.",
            g.item,
            n * n
        ))
    });
    let notes = notes.collect();
    let caption = "Published kernel (G12 and G23 alike); spots on the four sides of a square around C, no stagger; 16 × 16 pixels laid to the edges of the view; raw MTF, \
                   normalized in the CSV; noiseless. Doubles: by the projector, singular values cut as the legend says, N = max(r, l). Multiple precision: geometry, kernel, G12⁺ \
                   and (B ∘ G23)·(G12·G12⁺) with 60 digits or more, no cut, as many as make G12·G12⁺ symmetric and its trace the rank to 1e-15; spots that the layout has twice taken once, which does not change the \
                   Moore–Penrose recovery.";
    let table = Table::of(
        rows,
        [
            ("item", |r| r.case.label.into()),
            ("board", |r| r.board.into()),
            ("elements", |r| r.case.published.elements.into()),
            ("spots", |r| r.spots().into()),
            ("half_width_in", |r| r.half_width().into()),
            ("arithmetic", |r| WAYS[r.way].into()),
            ("digits", |r| u64::from(r.trial.digits).into()),
            ("rank", |r| r.trial.rank.into()),
            ("mtf_raw", |r| r.outcome.raw.into()),
            ("mtf_normalized", |r| r.outcome.normalized.into()),
            ("one_minus_mtf_raw", |r| r.outcome.shortfall.into()),
        ],
    );
    let title = "Double against multiple precision";
    Finding {
        checks,
        notes,
        ..finding(Item::Precision, title, caption, table, plots)
    }
}

/// Raw MTF of the boards of one check an element, a curve for each way.
fn plot(
    title: &str,
    rows: &[Row<'_>],
    (label, elements): (&str, usize),
    across: Axis,
    x: fn(&Row<'_>) -> f64,
) -> Plot {
    let own = rows.iter().filter(|r| {
        let group = (r.case.label, r.case.published.elements) == (label, elements);
        group && r.board == elements
    });
    let curves = WAYS.iter().enumerate().map(|(way, name)| {
        let own = own.clone().filter(move |r| r.way == way);
        curve(*name, own, x, |o| o.raw)
    });
    let upwards = Axis::linear("raw MTF", [0.0, 1.0]);
    Plot::new(title, [across, upwards], curves.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No case that is listed has a rank below both elements and different spots, which no digits
    /// would mend. The mirror x → 10 − x parts both into even and odd.
    #[test]
    #[ignore = "slow"]
    fn every_case_has_full_rank() {
        for (g, per_side) in GROUPS
            .iter()
            .filter(|g| g.elements <= 8)
            .flat_map(|g| g.per_side.iter().map(move |n| (g, *n)))
            .filter(|(_, n)| *n <= 30)
        {
            let mut case = published(
                Kernel::Published,
                g.elements,
                per_side,
                HALF_WIDTH,
                Stagger::None,
            );
            case.pixels = 2;
            let found = exact::recover(&case, &[2], Control::none()).unwrap();
            assert_eq!(found.rank, (4 * per_side - 4).min(g.elements.pow(2)));
        }
        let mut even = published(Kernel::Published, 4, 5, HALF_WIDTH, Stagger::None);
        even.pixels = 2;
        assert!(matches!(
            exact::recover(&even, &[2], Control::none()),
            Err(LabError::Digits(_))
        ));
    }
}
