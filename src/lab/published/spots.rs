//! Figs 12 to 14: the number of spots.

use super::case::{Case, HALF_WIDTH, KERNELS, Row, curve, published, rows};
use super::item::Item;
use super::outcome::{Outcome, Trial};
use super::plan::ReproducePlan;
use super::sheet::{BOTH_KERNELS, CUT, Measure, STRETCHED, VIEW, finding};
use super::substitution;
use super::traced;
use crate::lab::check::Check;
use crate::lab::finding::{Axis, Curve, Finding, Plot, Table};
use crate::model::{Kernel, Stagger};

/// Spots a side: 8 to 400 in all.
pub(super) const PER_SIDE: [usize; 16] =
    [2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 40, 60, 80, 100];
/// Those of which some are traced.
const TRACED: [usize; 5] = [2, 5, 10, 20, 30];
/// Elements a side of Figs 12 to 14, with the names of their curves.
const ELEMENTS: [(usize, &str); 6] = [
    (4, "4 × 4 elements"),
    (8, "8 × 8 elements"),
    (16, "16 × 16 elements"),
    (24, "24 × 24 elements"),
    (32, "32 × 32 elements"),
    (64, "64 × 64 elements"),
];
/// Spots from which on the published curves are level.
const LEVEL: usize = 120;
/// What a level curve may still rise or fall by.
const FLAT: f64 = 0.1;
/// Below this normalized MTF a board is not resolved.
const RESOLVED: f64 = 0.5;

/// The layout and cut that all these figures share, in words.
pub(super) fn layout() -> String {
    format!(
        "spots on the four sides of a square of half-width 6 in. around C, no stagger; {VIEW}; {CUT}"
    )
}

/// The axis of the number of spots.
pub(super) fn across() -> Axis {
    Axis::linear("number of spots", [0.0, 400.0])
}

/// Checks a side of the boards of Fig 12, 13 or 14.
fn boards(item: Item) -> &'static [usize] {
    match item {
        Item::Fig12 => &[2],
        Item::Fig13 => &[4],
        _ => &[8, 16],
    }
}

/// Every number of elements under every number of spots, with the boards that divide the elements;
/// of Fig 12 the smallest numbers of elements are traced too.
pub(super) fn cases(item: Item, plan: &ReproducePlan) -> Vec<Case> {
    let bench = |kernel, elements, per_side| {
        published(kernel, elements, per_side, HALF_WIDTH, Stagger::None)
    };
    let (mut modelled, mut traced) = (Vec::new(), Vec::new());
    for (elements, label) in ELEMENTS.into_iter().filter(|e| e.0 <= plan.most_elements) {
        let boards: Vec<usize> = boards(item)
            .iter()
            .copied()
            .filter(|b| elements.is_multiple_of(*b))
            .collect();
        if boards.is_empty() {
            continue;
        }
        for (n, kernel) in PER_SIDE.into_iter().flat_map(|n| KERNELS.map(|k| (n, k))) {
            modelled.push(Case::modelled(
                label,
                bench(kernel, elements, n),
                boards.clone(),
            ));
        }
        if item == Item::Fig12 && elements <= 8 {
            traced.extend(
                TRACED.map(|n| Case::traced(label, bench(Kernel::Physical, elements, n), 2)),
            );
        }
    }
    modelled.extend(traced);
    modelled
}

/// Fig 12 (2 × 2 board), 13 (4 × 4) or 14 (8 × 8 and 16 × 16).
pub(super) fn figure(item: Item, cases: &[Case], found: &[Vec<Trial>]) -> Finding {
    let mut rows = rows(cases, found);
    rows.sort_by_key(|r| {
        let elements = r.case.published.elements;
        (r.case.is_traced, r.board, r.kernel(), elements, r.spots())
    });
    let boards = boards(item);
    let modelled: Vec<Row<'_>> = rows.iter().filter(|r| !r.case.is_traced).copied().collect();
    let measures: [Measure<Outcome, Option<f64>>; 2] =
        [("normalized MTF", |o| o.normalized), ("raw MTF", |o| o.raw)];
    let mut plots = Vec::new();
    for &board in boards {
        for kernel in KERNELS {
            for (name, measure) in measures {
                plots.push(Plot::new(
                    format!("{board} × {board} board, {} kernel", kernel.name()),
                    [across(), Axis::linear(name, [0.0, 1.0])],
                    curves(&modelled, board, kernel, measure),
                ));
            }
        }
    }
    let (mut more, mut notes) = (String::new(), Vec::new());
    if item == Item::Fig12 {
        plots.push(substitution::plot(&rows, across(), |r| r.spots() as f64));
        more = format!(" {}", traced::caption());
        notes.push(substitution::words(&rows));
    }
    let checks = boards.iter().flat_map(|b| checks(&modelled, *b)).collect();
    let names: Vec<String> = boards.iter().map(|b| format!("{b} × {b} board")).collect();
    let table = Table::of(
        rows,
        [
            ("kernel", |r| r.kernel().into()),
            ("board", |r| r.board.into()),
            ("elements", |r| r.case.published.elements.into()),
            ("spots", |r| r.spots().into()),
            ("rank", |r| r.trial.rank.into()),
            ("mtf_raw", |r| r.outcome.raw.into()),
            ("mtf_normalized", |r| r.outcome.normalized.into()),
            ("phi", |r| r.phi.into()),
            ("noise", |r| r.outcome.noise.into()),
        ],
    );
    let title = format!("MTF against the number of spots, {}", names.join(" and "));
    let layout = layout();
    let caption = format!(
        "{BOTH_KERNELS}; {layout}; {STRETCHED}, raw MTF beside it; noiseless, by the projector; \
         elements a side as the legend says, those that the board divides.{more}"
    );
    Finding {
        checks,
        notes,
        ..finding(item, title, caption, table, plots)
    }
}

/// A curve for each number of elements.
fn curves(
    rows: &[Row<'_>],
    board: usize,
    kernel: Kernel,
    measure: fn(&Outcome) -> Option<f64>,
) -> Vec<Curve> {
    let own = |r: &&Row<'_>| r.board == board && r.is(kernel);
    let mut labels: Vec<&str> = rows.iter().filter(own).map(|r| r.case.label).collect();
    labels.dedup();
    let line = |label: &str| {
        let here = rows.iter().filter(own).filter(|r| r.case.label == label);
        curve(label, here, |r| r.spots() as f64, measure)
    };
    labels.into_iter().map(line).collect()
}

/// Rises, then level (boards up to 8 × 8); never resolved (16 × 16).
fn checks(rows: &[Row<'_>], board: usize) -> Vec<Check> {
    let own = curves(rows, board, Kernel::Published, |o| o.normalized);
    let every = own.iter().flat_map(|c| &c.points).map(|p| p[1]);
    let highest = every.fold(f64::NEG_INFINITY, f64::max);
    if board == 16 {
        return vec![Check::trend(
            "16 × 16 board",
            "never resolved",
            format!("highest normalized MTF {highest:.4}"),
            format!("every normalized MTF, published kernel, is below {RESOLVED}"),
            highest < RESOLVED,
        )];
    }
    let at = |c: &Curve, spots: usize| {
        let own = c.points.iter().find(|p| p[0] == spots as f64);
        own.map(|p| p[1])
    };
    let (mut rises, mut worst) = (0, (0.0f64, String::new()));
    for c in &own {
        let (Some(first), Some(level)) = (at(c, 8), at(c, LEVEL)) else {
            continue;
        };
        rises += usize::from(level > first);
        for p in c.points.iter().filter(|p| p[0] > LEVEL as f64) {
            if (p[1] - level).abs() > worst.0 {
                worst = ((p[1] - level).abs(), format!("{}, {} spots", c.name, p[0]));
            }
        }
    }
    let all = own.len();
    vec![
        Check::trend(
            format!("{board} × {board} board, from 8 to 120 spots"),
            "rises",
            format!("normalized MTF rises for {rises} of {all} numbers of elements"),
            "for every number of elements, published kernel",
            rises == all,
        ),
        Check::trend(
            format!("{board} × {board} board, from 120 spots on"),
            "level",
            format!("largest change {:.4} ({})", worst.0, worst.1),
            format!("normalized MTF within {FLAT} of that at 120 spots, published kernel"),
            worst.0 <= FLAT,
        ),
    ]
}
