//! Figs 12 to 14: the number of spots.

use serde::{Deserialize, Serialize};

use super::figure::{computed, linear};
use super::inversion::{Inversion, Outcome, published};
use super::substitution::{self, Case, Trial};
use super::traced::{self, MODELLED, NAMES};
use super::{Cell, Check, FigureCurve, Item, Plot, ReproduceError, ReproducePlan, Reproduction};
use crate::model::{Kernel, Stagger};
use crate::num::linalg::Tolerance;

/// Spots a side: 8 to 400 in all.
pub(super) const PER_SIDE: [usize; 16] =
    [2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 40, 60, 80, 100];
/// Those of which some are traced.
const TRACED: [usize; 5] = [2, 5, 10, 20, 30];
/// Half-width of the square, in.
pub(super) const HALF_WIDTH: f64 = 6.0;
/// Elements a side of Figs 12 to 14.
const ELEMENTS: [usize; 6] = [4, 8, 16, 24, 32, 64];
/// Spots from which on the published curves are level.
const LEVEL: usize = 120;
/// What a level curve may still rise or fall by.
const FLAT: f64 = 0.1;
/// Below this normalized MTF a board is not resolved.
const RESOLVED: f64 = 0.5;
pub(super) const KERNELS: [Kernel; 2] = [Kernel::Published, Kernel::Physical];

/// The layout and cut that all these figures share, in words.
pub(super) fn layout() -> &'static str {
    "spots on the four sides of a square of half-width 6 in. around C, no stagger; 16 × 16 pixels laid to the edges of the view; Moore–Penrose inverse cut at \
     max(r, l)·eps(σ1), eps the spacing of doubles at σ1 (MATLAB)"
}

struct Point {
    board: usize,
    elements: usize,
    kernel: Kernel,
    spots: usize,
    rank: usize,
    outcome: Outcome,
}

/// What a case comes to, as it travels.
#[derive(Debug, Serialize, Deserialize)]
pub struct Modulations {
    rank: usize,
    /// One for each board that divides the elements.
    outcomes: Vec<Outcome>,
}

/// Kernel, elements a side, spots a side.
type Bench = (Kernel, usize, usize);

/// Checks a side of the boards of Fig 12, 13 or 14.
fn boards(item: Item) -> &'static [usize] {
    match item {
        Item::Fig12 => &[2],
        Item::Fig13 => &[4],
        _ => &[8, 16],
    }
}

/// Those of them that divide the elements.
fn dividing(item: Item, elements: usize) -> impl Iterator<Item = usize> {
    let boards = boards(item).iter().copied();
    boards.filter(move |b| elements.is_multiple_of(*b))
}

/// What is modelled.
pub(super) fn cases(item: Item, plan: &ReproducePlan) -> Vec<Bench> {
    let sides = ELEMENTS.into_iter().filter(|e| *e <= plan.most_elements);
    sides
        .filter(|e| dividing(item, *e).next().is_some())
        .flat_map(|e| PER_SIDE.map(|n| (e, n)))
        .flat_map(|(e, n)| KERNELS.map(|k| (k, e, n)))
        .collect()
}

/// One case.
pub(super) fn one(
    item: Item,
    &(kernel, elements, per_side): &Bench,
) -> Result<Modulations, ReproduceError> {
    let case = published(kernel, elements, per_side, HALF_WIDTH, Stagger::None);
    let inversion = Inversion::new(&case)?;
    let rank = inversion.rank(Tolerance::Spacing)?;
    let outcome = |board: usize| inversion.noiseless(&case.board(board), rank);
    Ok(Modulations {
        rank,
        outcomes: dividing(item, elements).map(outcome).collect(),
    })
}

/// Whether `found` may be what a case comes to.
pub(super) fn fits(item: Item, bench: &Bench, found: &Modulations) -> bool {
    found.outcomes.len() == dividing(item, bench.1).count()
}

/// Fig 12 (2 × 2 board), 13 (4 × 4) or 14 (8 × 8 and 16 × 16), from what its cases come to, and what was traced.
pub(super) fn modulation(
    item: Item,
    plan: &ReproducePlan,
    found: Vec<Modulations>,
    traced: &[(Case, Trial)],
) -> Reproduction {
    let boards = boards(item);
    let points = |((kernel, elements, per_side), found): (Bench, Modulations)| {
        let point = move |(board, outcome)| Point {
            board,
            elements,
            kernel,
            spots: 4 * per_side,
            rank: found.rank,
            outcome,
        };
        dividing(item, elements).zip(found.outcomes).map(point)
    };
    let cases = cases(item, plan).into_iter();
    let mut points: Vec<Point> = cases.zip(found).flat_map(points).collect();
    points.sort_by_key(|p| (p.board, p.kernel.name(), p.elements, p.spots));
    let row = |p: &Point| {
        vec![
            p.kernel.name().into(),
            p.board.into(),
            p.elements.into(),
            p.spots.into(),
            p.rank.into(),
            p.outcome.raw.into(),
            p.outcome.normalized.into(),
            MODELLED.into(),
            0.0.into(),
        ]
    };
    let mut rows: Vec<Vec<Cell>> = points.iter().map(row).collect();
    let title = |b: usize| format!("{b} × {b} board");
    let mut plots = Vec::new();
    for &board in boards {
        for kernel in KERNELS {
            for (name, f) in [
                (
                    "normalized MTF",
                    (|o| o.normalized) as fn(&Outcome) -> Option<f64>,
                ),
                ("raw MTF", |o| o.raw),
            ] {
                plots.push(Plot {
                    title: format!("{}, {} kernel", title(board), kernel.name()),
                    axes: [
                        linear("number of spots", [0.0, 400.0]),
                        linear(name, [0.0, 1.0]),
                    ],
                    curves: curves(&points, board, kernel, f),
                });
            }
        }
    }
    let (mut caption, mut notes) = (String::new(), Vec::new());
    if item == Item::Fig12 {
        for (case, t) in traced {
            for (name, r) in NAMES.iter().zip(&t.found) {
                rows.push(vec![
                    Kernel::Physical.name().into(),
                    case.checks.into(),
                    case.published.elements.into(),
                    (4 * case.published.per_side).into(),
                    t.rank.into(),
                    r.outcome.raw.into(),
                    r.outcome.normalized.into(),
                    (*name).into(),
                    r.noise.into(),
                ]);
            }
        }
        let across = linear("number of spots", [0.0, 400.0]);
        plots.push(substitution::plot(traced, across));
        caption = format!(" {}", traced::caption());
        notes.push(substitution::words(traced));
    }
    Reproduction {
        item,
        title: format!(
            "MTF against the number of spots, {}",
            boards
                .iter()
                .map(|b| title(*b))
                .collect::<Vec<_>>()
                .join(" and ")
        ),
        caption: format!(
            "Published and physical kernel (G12 and G23 alike); {}; normalized MTF of the values stretched to [0, 1], raw MTF beside it; noiseless, by the projector; \
             elements a side as the legend says, those that the board divides.{caption}",
            layout()
        ),
        columns: [
            "kernel",
            "board",
            "elements",
            "spots",
            "rank",
            "mtf_raw",
            "mtf_normalized",
            "phi",
            "noise",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows,
        plots,
        galleries: Vec::new(),
        checks: boards.iter().flat_map(|b| checks(&points, *b)).collect(),
        notes,
    }
}

/// What is traced, of Fig 12 alone: the smallest numbers of elements under a few numbers of spots.
pub(super) fn traced_cases(item: Item, plan: &ReproducePlan) -> Vec<Case> {
    if item != Item::Fig12 {
        return Vec::new();
    }
    let sides = [(4, "4 × 4 elements"), (8, "8 × 8 elements")];
    let of = |(elements, curve): (usize, &'static str)| {
        TRACED.map(|per_side| Case {
            curve,
            x: 4.0 * per_side as f64,
            published: published(
                Kernel::Physical,
                elements,
                per_side,
                HALF_WIDTH,
                Stagger::None,
            ),
            checks: 2,
        })
    };
    let wanted = sides.into_iter().filter(|s| s.0 <= plan.most_elements);
    wanted.flat_map(of).collect()
}

fn curves(
    points: &[Point],
    board: usize,
    kernel: Kernel,
    f: fn(&Outcome) -> Option<f64>,
) -> Vec<FigureCurve> {
    let own = |p: &&Point| p.board == board && p.kernel == kernel;
    let mut sides: Vec<usize> = points.iter().filter(own).map(|p| p.elements).collect();
    sides.dedup();
    let line = |side: usize| {
        let here = points.iter().filter(own).filter(|p| p.elements == side);
        let points = here.filter_map(|p| Some([p.spots as f64, f(&p.outcome)?]));
        computed(format!("{side} × {side} elements"), points.collect())
    };
    sides.into_iter().map(line).collect()
}

/// Rises, then level (boards up to 8 × 8); never resolved (16 × 16).
fn checks(points: &[Point], board: usize) -> Vec<Check> {
    let own = curves(points, board, Kernel::Published, |o| o.normalized);
    let highest = own
        .iter()
        .flat_map(|c| &c.points)
        .map(|p| p[1])
        .fold(f64::NEG_INFINITY, f64::max);
    if board == 16 {
        let computed = format!("highest normalized MTF {highest:.4}");
        let criterion = format!("every normalized MTF, published kernel, is below {RESOLVED}");
        let what = "16 × 16 board";
        return vec![Check::trend(
            what,
            "never resolved",
            computed,
            criterion,
            highest < RESOLVED,
        )];
    }
    let at = |c: &FigureCurve, spots: usize| {
        c.points.iter().find(|p| p[0] == spots as f64).map(|p| p[1])
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
    let what = |text: &str| format!("{board} × {board} board, {text}");
    vec![
        Check::trend(
            what("from 8 to 120 spots"),
            "rises",
            format!(
                "normalized MTF rises for {rises} of {} numbers of elements",
                own.len()
            ),
            "for every number of elements, published kernel",
            rises == own.len(),
        ),
        Check::trend(
            what("from 120 spots on"),
            "level",
            format!("largest change {:.4} ({})", worst.0, worst.1),
            format!("normalized MTF within {FLAT} of that at 120 spots, published kernel"),
            worst.0 <= FLAT,
        ),
    ]
}
