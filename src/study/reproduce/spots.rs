//! Figs 12 to 16: the number of spots.

use rayon::prelude::*;

use super::figure::{computed, decades, linear};
use super::inversion::{Inversion, Outcome, published};
use super::{Check, FigureCurve, Item, Plot, ReproduceError, ReproducePlan, Reproduction, Watch};
use crate::metrics::rank_correlation;
use crate::model::{Kernel, Stagger};
use crate::num::linalg::Tolerance;
use crate::study::eigenvalue::smallest_eigenvalue;

/// Spots a side: 8 to 400 in all.
pub(super) const PER_SIDE: [usize; 16] =
    [2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 40, 60, 80, 100];
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
const KERNELS: [Kernel; 2] = [Kernel::Published, Kernel::Physical];

/// The layout and cut that all these figures share, in words.
fn layout() -> &'static str {
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

/// Fig 12 (2 × 2 board), 13 (4 × 4) or 14 (8 × 8 and 16 × 16).
pub(super) fn modulation(
    item: Item,
    plan: &ReproducePlan,
    watch: Watch<'_>,
) -> Result<Reproduction, ReproduceError> {
    let boards: &[usize] = match item {
        Item::Fig12 => &[2],
        Item::Fig13 => &[4],
        _ => &[8, 16],
    };
    let sides = ELEMENTS.into_iter().filter(|e| *e <= plan.most_elements);
    let cases: Vec<(Kernel, usize, usize)> = sides
        .filter(|e| boards.iter().any(|b| e % b == 0))
        .flat_map(|e| PER_SIDE.map(|n| (e, n)))
        .flat_map(|(e, n)| KERNELS.map(|k| (k, e, n)))
        .collect();
    let points: Vec<Vec<Point>> = cases
        .into_par_iter()
        .map(|(kernel, elements, per_side)| {
            watch.go_on()?;
            let case = published(kernel, elements, per_side, HALF_WIDTH, Stagger::None);
            let inversion = Inversion::new(&case)?;
            let rank = inversion.rank(Tolerance::Spacing)?;
            let point = |board: usize| Point {
                board,
                elements,
                kernel,
                spots: 4 * per_side,
                rank,
                outcome: inversion.noiseless(&case.board(board), rank),
            };
            let own = boards.iter().filter(|b| elements % **b == 0);
            Ok(own.map(|b| point(*b)).collect())
        })
        .collect::<Result<_, ReproduceError>>()?;
    let mut points: Vec<Point> = points.into_iter().flatten().collect();
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
        ]
    };
    let title = |b: usize| format!("{b} × {b} board");
    let mut plots = Vec::new();
    for &board in boards {
        for kernel in KERNELS {
            for (name, f) in [
                ("normalized MTF", (|o| o.normalized) as fn(&Outcome) -> Option<f64>),
                ("raw MTF", |o| o.raw),
            ] {
                plots.push(Plot {
                    title: format!("{}, {} kernel", title(board), kernel.name()),
                    axes: [linear("number of spots", [0.0, 400.0]), linear(name, [-0.2, 1.0])],
                    curves: curves(&points, board, kernel, f),
                });
            }
        }
    }
    Ok(Reproduction {
        item,
        title: format!(
            "MTF against the number of spots, {}",
            boards.iter().map(|b| title(*b)).collect::<Vec<_>>().join(" and ")
        ),
        caption: format!(
            "Published and physical kernel (G12 and G23 alike); {}; normalized MTF of the values stretched to [0, 1], raw MTF beside it; noiseless, by the projector; \
             elements a side as the legend says, those that the board divides.",
            layout()
        ),
        columns: vec!["kernel", "board", "elements", "spots", "rank", "mtf_raw", "mtf_normalized"],
        rows: points.iter().map(row).collect(),
        plots,
        galleries: Vec::new(),
        checks: boards.iter().flat_map(|b| checks(&points, *b)).collect(),
        notes: Vec::new(),
    })
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
    let highest = own.iter().flat_map(|c| &c.points).map(|p| p[1]).fold(f64::NEG_INFINITY, f64::max);
    if board == 16 {
        let computed = format!("highest normalized MTF {highest:.4}");
        let criterion = format!("every normalized MTF, published kernel, is below {RESOLVED}");
        let what = "16 × 16 board";
        return vec![Check::trend(what, "never resolved", computed, criterion, highest < RESOLVED)];
    }
    let at = |c: &FigureCurve, spots: usize| c.points.iter().find(|p| p[0] == spots as f64).map(|p| p[1]);
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
            format!("normalized MTF rises for {rises} of {} numbers of elements", own.len()),
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
        let own = cases.iter().zip(&found).filter(|(c, _)| (c.0, c.1) == (kernel, side));
        own.filter_map(|(c, (_, x))| Some([(4 * c.2) as f64, f(x)?])).collect::<Vec<_>>()
    };
    let mut plots = Vec::new();
    for kernel in KERNELS {
        for (title, f) in [
            ("‖G12‖·‖G12⁺‖", (|x| Some(x.condition)) as fn(&Figures) -> Option<f64>),
            ("|smallest eigenvalue of G12·G12ᵀ| / largest", |x| Some(x.smallest.abs())),
        ] {
            let curve = |side| computed(format!("{side} × {side} elements"), line(kernel, side, &f));
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
    let own = |side| cases.iter().zip(&found).filter(move |(c, _)| (c.0, c.1) == (Kernel::Published, side));
    let mut checks = Vec::new();
    for side in [8, 16] {
        let all: Vec<&Figures> = own(side).map(|(_, (_, x))| x).collect();
        let raw: Vec<f64> = all.iter().filter_map(|x| x.raw).collect();
        for (name, values) in [
            ("condition number", all.iter().map(|x| x.condition).collect::<Vec<f64>>()),
            ("smallest eigenvalue", all.iter().map(|x| x.smallest).collect()),
        ] {
            let r = rank_correlation(&values, &raw);
            checks.push(Check::trend(
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
        columns: vec!["kernel", "elements", "spots", "rank", "condition", "smallest_eigenvalue", "mtf_raw"],
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
