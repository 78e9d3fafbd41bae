//! The same inversions beyond double precision, and in doubles under several tolerances.

use serde::{Deserialize, Serialize};

use super::exact;
use super::figure::{computed, linear};
use super::inversion::{Inversion, Outcome, published};
use super::spots::HALF_WIDTH;
use super::{Check, Item, Plot, ReproduceError, ReproducePlan, Reproduction, Watch};
use crate::model::{Kernel, Published, Stagger};
use crate::num::linalg::Tolerance;

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
fn rules(elements: usize, spots: usize) -> [(&'static str, Tolerance); 4] {
    let eps = elements.max(spots) as f64 * f64::EPSILON;
    [
        ("N·eps(σ1) (MATLAB)", Tolerance::Spacing),
        ("N·2⁻⁵²·σ1 (NumPy, Octave)", Tolerance::Auto),
        ("10·N·2⁻⁵²·σ1", Tolerance::Relative(10.0 * eps)),
        ("0.1·N·2⁻⁵²·σ1", Tolerance::Relative(0.1 * eps)),
    ]
}

/// One line of the table.
struct Found {
    group: usize,
    board: usize,
    spots: usize,
    half_width: f64,
    rule: &'static str,
    rank: usize,
    outcome: Outcome,
    shortfall: f64,
    digits: u32,
}

/// Name of the arithmetic beyond doubles.
const DIGITS: &str = "multiple precision";

/// What one arithmetic comes to on one board, as it travels.
#[derive(Debug, Serialize, Deserialize)]
pub struct Line {
    rank: usize,
    outcome: Outcome,
    shortfall: f64,
    digits: u32,
}

/// The cases that the plan admits, with their groups.
pub(super) fn cases(plan: &ReproducePlan) -> Vec<(usize, Published)> {
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
fn arithmetics(group: usize, case: &Published) -> Vec<(&'static str, usize)> {
    let rules = rules(case.elements * case.elements, 4 * case.per_side).map(|r| r.0);
    let names = rules.into_iter().chain([DIGITS]);
    let boards = GROUPS[group].boards.iter();
    names
        .flat_map(|name| boards.clone().map(move |board| (name, *board)))
        .collect()
}

/// Whether `lines` may be those of a case.
pub(super) fn fits((group, case): &(usize, Published), lines: &[Line]) -> bool {
    let elements = case.elements * case.elements;
    let whole = |line: &Line| line.outcome.values.len() == elements;
    lines.len() == arithmetics(*group, case).len() && lines.iter().all(whole)
}

/// The figure from the lines of every case.
pub(super) fn figure(plan: &ReproducePlan, lines: Vec<Vec<Line>>) -> Reproduction {
    let mut found = Vec::new();
    for ((group, case), lines) in cases(plan).into_iter().zip(lines) {
        let of = |((rule, board), line): ((&'static str, usize), Line)| Found {
            group,
            board,
            spots: 4 * case.per_side,
            half_width: case.half_width,
            rule,
            rank: line.rank,
            outcome: line.outcome,
            shortfall: line.shortfall,
            digits: line.digits,
        };
        found.extend(arithmetics(group, &case).into_iter().zip(lines).map(of));
    }
    let plots = vec![
        plot(
            &found,
            1,
            8,
            "8 × 8 board and elements, half-width 6 in.",
            "number of spots",
            [0.0, 400.0],
            |f| f.spots as f64,
        ),
        plot(
            &found,
            2,
            16,
            "16 × 16 board and elements, half-width 6 in.",
            "number of spots",
            [0.0, 400.0],
            |f| f.spots as f64,
        ),
        plot(
            &found,
            3,
            8,
            "8 × 8 board, 8 × 8 elements, 100 spots",
            "half-width / in.",
            [0.0, 15.0],
            |f| f.half_width,
        ),
    ];
    let enough = |f: &&Found| f.rule == DIGITS && GROUPS[f.group].elements == 8 && f.spots >= 80;
    let worst = found
        .iter()
        .filter(enough)
        .map(|f| f.shortfall.abs())
        .fold(0.0, f64::max);
    let cases = found.iter().filter(enough).count();
    let doubles = found
        .iter()
        .filter(|f| f.rule == rules(64, 64)[0].0 && GROUPS[f.group].elements == 8 && f.spots >= 80);
    let least = doubles
        .filter_map(|f| f.outcome.raw)
        .fold(f64::INFINITY, f64::min);
    let most = found
        .iter()
        .filter(|f| f.rule == DIGITS && f.rank == GROUPS[f.group].elements.pow(2));
    let notes = GROUPS
        .iter()
        .enumerate()
        .filter_map(|(group, g)| {
            let own = most.clone().filter(|f| f.group == group);
            let digits = own.clone().map(|f| f.digits).max()?;
            let spots = own.clone().map(|f| f.spots).min()?;
            let worst = own.map(|f| f.shortfall.abs()).fold(0.0, f64::max);
            Some(format!(
                "{}, {n} × {n} elements: full rank of {} in the cases with {spots} spots and more, with at most {digits} digits; raw MTF 1 to {worst:.1e} for every board.",
                g.item,
                g.elements.pow(2),
                n = g.elements
            ))
        })
        .collect();
    let rows = found.iter().map(|f| {
        vec![
            GROUPS[f.group].item.into(),
            f.board.into(),
            GROUPS[f.group].elements.into(),
            f.spots.into(),
            f.half_width.into(),
            f.rule.into(),
            (f.digits as usize).into(),
            f.rank.into(),
            f.outcome.raw.into(),
            f.outcome.normalized.into(),
            f.shortfall.into(),
        ]
    });
    Reproduction {
        item: Item::Precision,
        title: "Double against multiple precision".to_owned(),
        caption: "Published kernel (G12 and G23 alike); spots on the four sides of a square around C, no stagger; 16 × 16 pixels laid to the edges of the view; raw MTF, \
                  normalized in the CSV; noiseless. Doubles: by the projector, singular values cut as the legend says, N = max(r, l). Multiple precision: geometry, kernel, G12⁺ \
                  and (B ∘ G23)·(G12·G12⁺) with 60 digits or more, no cut, as many as make G12·G12⁺ symmetric and its trace the rank to 1e-15; spots that the layout has twice taken once, which does not change the \
                  Moore–Penrose recovery."
            .to_owned(),
        columns: [
            "item", "board", "elements", "spots", "half_width_in", "arithmetic", "digits", "rank", "mtf_raw", "mtf_normalized", "one_minus_mtf_raw",
        ].map(str::to_owned).to_vec(),
        rows: rows.collect(),
        plots,
        galleries: Vec::new(),
        checks: vec![Check::claim(
            format!("raw MTF of the {cases} cases with 8 × 8 elements and 80 spots or more (doubles: down to {least:.4})"),
            "below 1: what the figures show is a property of the method",
            format!("at least 1 − {worst:.1e} in multiple precision"),
            "refuted where all are above 1 − 1e-9: what is lost is lost to the rounding of doubles and the cut",
            worst > 1e-9,
        )],
        notes,
    }
}

/// The lines of a case.
pub(super) fn one(
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

fn plot(
    found: &[Found],
    group: usize,
    board: usize,
    title: &str,
    across: &str,
    ends: [f64; 2],
    x: fn(&Found) -> f64,
) -> Plot {
    let names = rules(64, 64).map(|r| r.0).into_iter().chain([DIGITS]);
    let curve = |name: &'static str| {
        let own = found
            .iter()
            .filter(|f| f.group == group && f.board == board && f.rule == name);
        computed(
            name,
            own.filter_map(|f| Some([x(f), f.outcome.raw?])).collect(),
        )
    };
    Plot {
        title: title.to_owned(),
        axes: [linear(across, ends), linear("raw MTF", [0.0, 1.0])],
        curves: names.map(curve).collect(),
    }
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
