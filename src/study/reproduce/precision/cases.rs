//! The cases, each in doubles under several tolerances and with many digits.

use serde::{Deserialize, Serialize};

use crate::model::{Kernel, Published, Stagger};
use crate::num::linalg::Tolerance;
use crate::study::reproduce::inversion::{Inversion, Outcome, published};
use crate::study::reproduce::spots::HALF_WIDTH;
use crate::study::reproduce::{ReproduceError, ReproducePlan, Watch, exact};

/// A group of cases: published item, elements a side, boards, spots a side, half-widths.
pub(super) struct Group {
    pub(super) item: &'static str,
    pub(super) elements: usize,
    boards: &'static [usize],
    per_side: &'static [usize],
    half_widths: &'static [f64],
}

pub(super) const GROUPS: [Group; 5] = [
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
        // 76, 116 and 396 different spots: the last leave no element out, with a smallest over largest diagonal entry of R of 3e-48, of which 108 digits are lost.
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
        // Not 5: of 16 different spots 9 combinations are alike to the left and the right of x = 5 and 7 are not, of the elements 8 and 8, so that the rank is 15 by
        // any number of digits.
        per_side: &[2, 3, 4, 6, 10, 20, 30, 100],
        half_widths: &[HALF_WIDTH],
    },
];

/// Cuts in doubles; N stands for max(r, l).
pub(super) fn rules(elements: usize, spots: usize) -> [(&'static str, Tolerance); 4] {
    let eps = elements.max(spots) as f64 * f64::EPSILON;
    [
        ("N·eps(σ1) (MATLAB)", Tolerance::Spacing),
        ("N·2⁻⁵²·σ1 (NumPy, Octave)", Tolerance::Auto),
        ("10·N·2⁻⁵²·σ1", Tolerance::Relative(10.0 * eps)),
        ("0.1·N·2⁻⁵²·σ1", Tolerance::Relative(0.1 * eps)),
    ]
}

/// Name of the arithmetic beyond doubles.
pub(super) const DIGITS: &str = "multiple precision";

/// What one arithmetic comes to on one board, as it travels.
#[derive(Debug, Serialize, Deserialize)]
pub struct Line {
    pub(super) rank: usize,
    pub(super) outcome: Outcome,
    pub(super) shortfall: f64,
    pub(super) digits: u32,
}

/// The cases that the plan admits, with their groups.
pub(in super::super) fn cases(plan: &ReproducePlan) -> Vec<(usize, Published)> {
    let mut cases = Vec::new();
    let groups = GROUPS.iter().enumerate();
    for (group, g) in groups.filter(|(_, g)| g.elements <= plan.most_elements) {
        for &half_width in g.half_widths {
            for &per_side in g.per_side {
                let (kernel, stagger) = (Kernel::Published, Stagger::None);
                let case = published(kernel, g.elements, per_side, half_width, stagger);
                cases.push((group, case));
            }
        }
    }
    cases
}

/// Arithmetics and boards of a case, in the order of its lines.
pub(super) fn arithmetics(group: usize, case: &Published) -> Vec<(&'static str, usize)> {
    let rules = rules(case.elements * case.elements, 4 * case.per_side).map(|r| r.0);
    let names = rules.into_iter().chain([DIGITS]);
    let boards = GROUPS[group].boards.iter();
    names
        .flat_map(|name| boards.clone().map(move |board| (name, *board)))
        .collect()
}

/// Whether `lines` may be those of a case.
pub(in super::super) fn fits((group, case): &(usize, Published), lines: &[Line]) -> bool {
    let elements = case.elements * case.elements;
    let whole = |line: &Line| line.outcome.values.len() == elements;
    lines.len() == arithmetics(*group, case).len() && lines.iter().all(whole)
}

/// The lines of a case.
pub(in super::super) fn one(
    (group, case): &(usize, Published),
    watch: Watch<'_>,
) -> Result<Vec<Line>, ReproduceError> {
    let boards = GROUPS[*group].boards;
    let inversion = Inversion::new(case)?;
    let mut lines = Vec::new();
    for (_, tolerance) in rules(case.elements * case.elements, 4 * case.per_side) {
        let rank = inversion.rank(tolerance)?;
        for &board in boards {
            let outcome = inversion.noiseless(&case.board(board), rank);
            lines.push(Line {
                rank,
                shortfall: outcome.raw.map_or(f64::NAN, |raw| 1.0 - raw),
                outcome,
                digits: 16,
            });
        }
    }
    for e in exact::recover(case, boards, watch)? {
        lines.push(Line {
            rank: e.rank,
            outcome: e.outcome,
            shortfall: e.shortfall,
            digits: e.digits,
        });
    }
    Ok(lines)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicBool;

    /// No case that is listed has a rank below both elements and different spots, which no digits would mend. The mirror x → 10 − x parts both into even and odd.
    #[test]
    fn every_case_has_full_rank() {
        let stop = AtomicBool::new(false);
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
            let found = exact::recover(&case, &[2], Watch::new(&stop)).unwrap();
            assert_eq!(found[0].rank, (4 * per_side - 4).min(g.elements.pow(2)));
        }
        let mut even = published(Kernel::Published, 4, 5, HALF_WIDTH, Stagger::None);
        even.pixels = 2;
        assert!(matches!(
            exact::recover(&even, &[2], Watch::new(&stop)),
            Err(ReproduceError::Digits(_))
        ));
    }
}
