//! Branch and bound over patterns of two given values.

use nalgebra::{DMatrix, DVector};

use crate::num::linalg::{Tolerance, least_squares};
use crate::num::quadratic::{Bounds, QuadraticError, box_least_squares_from};

/// Searches for a pattern within these multiples of the relaxation's objective, one after the
/// other, and the relaxations that each may solve: without a good pattern known, a search that goes
/// down first would spend itself where nothing fits any more.
const SEARCHES: [(f64, usize); 3] = [(4.0, 800), (64.0, 200), (f64::INFINITY, 100)];
/// Nearer to a level than this fraction of their distance is at it.
const AT: f64 = 1e-7;
/// A pattern must be better by more than this fraction of the objective.
const WORTH: f64 = 1e-10;

/// What the search found.
pub(super) struct Searched {
    /// Which elements are light, where a pattern is better than the one given.
    pub(super) light: Option<Vec<bool>>,
    /// No pattern of these levels has a smaller ½‖R x − d‖².
    pub(super) bound: f64,
}

struct Node {
    bounds: Bounds,
    start: DVector<f64>,
    /// The parent's lower bound.
    bound: f64,
}

/// The best pattern x_j ∈ {dark, light}, depth first: the relaxation to dark ≤ x ≤ light bounds a
/// node from below, of the variables at no level the clearest case is put to its nearer level
/// first, to the other later. Nodes whose bound reaches `incumbent` (½‖R x − d‖² of a known
/// pattern) hold nothing better. Ends when no node is left, and the bound is then the minimum
/// itself, or after a fixed number of relaxations.
pub(super) fn search(
    r: &DMatrix<f64>,
    d: &DVector<f64>,
    levels: [f64; 2],
    relaxed: &DVector<f64>,
    incumbent: f64,
) -> Result<Searched, QuadraticError> {
    let n = r.ncols();
    let root = box_least_squares_from(r, d, &Bounds::all(n, levels[0], levels[1]), relaxed)?;
    let mut bound = 0.0f64;
    for (factor, nodes) in SEARCHES {
        let cutoff = factor * root.objective;
        let searched = within(r, d, levels, &root.solution, (cutoff.min(incumbent), nodes))?;
        bound = bound.max(searched.bound);
        if searched.light.is_some() || cutoff >= incumbent {
            return Ok(Searched { bound, ..searched });
        }
    }
    Ok(Searched { light: None, bound })
}

/// The same for patterns below `incumbent` alone, by at most so many relaxations.
fn within(
    r: &DMatrix<f64>,
    d: &DVector<f64>,
    [dark, light]: [f64; 2],
    relaxed: &DVector<f64>,
    (incumbent, nodes): (f64, usize),
) -> Result<Searched, QuadraticError> {
    let n = r.ncols();
    let width = light - dark;
    let mut best = incumbent;
    let mut found = None;
    let mut open = vec![Node {
        bounds: Bounds::all(n, dark, light),
        start: relaxed.clone(),
        bound: 0.0,
    }];
    let mut solved = 0;
    while let Some(node) = open.pop() {
        if node.bound >= best * (1.0 - WORTH) {
            continue;
        }
        if solved == nodes {
            open.push(node);
            break;
        }
        solved += 1;
        let relaxed = box_least_squares_from(r, d, &node.bounds, &node.start)?;
        let bound = (relaxed.objective - relaxed.gap).max(node.bound);
        if bound >= best * (1.0 - WORTH) {
            continue;
        }
        let x = relaxed.solution;
        let pattern: Vec<bool> = x.iter().map(|x| x - dark > 0.5 * width).collect();
        let rounded = DVector::from_fn(n, |j, _| if pattern[j] { light } else { dark });
        let objective = 0.5 * (r * &rounded - d).norm_squared();
        if objective < best * (1.0 - WORTH) {
            (best, found) = (objective, Some(pattern.clone()));
        }
        let Some(j) = clearest(r, [dark, light], &x)? else {
            continue;
        };
        for side in [!pattern[j], pattern[j]] {
            let level = if side { light } else { dark };
            let mut bounds = node.bounds.clone();
            (bounds.lower[j], bounds.upper[j]) = (level, level);
            open.push(Node {
                bounds,
                start: x.clone(),
                bound,
            });
        }
    }
    let bound = open.iter().map(|node| node.bound).fold(best, f64::min);
    Ok(Searched {
        light: found,
        bound,
    })
}

/// Of the variables at neither level the one whose other level would cost most, as far as the
/// curvature around x says: moving x_j by δ while the others at no level follow raises the
/// objective by ½ δ²/(RᵀR)⁻¹_jj.
fn clearest(
    r: &DMatrix<f64>,
    [dark, light]: [f64; 2],
    x: &DVector<f64>,
) -> Result<Option<usize>, QuadraticError> {
    let off = |j: usize| [x[j] - dark, light - x[j]];
    let free: Vec<usize> = (0..x.len())
        .filter(|&j| off(j).iter().all(|o| *o > AT * (light - dark)))
        .collect();
    if free.is_empty() {
        return Ok(None);
    }
    let columns = r.select_columns(&free);
    let fit = least_squares(&columns, &DVector::zeros(r.nrows()), Tolerance::Auto)?;
    let variance = fit.covariance().diagonal();
    let cost = |i: usize| {
        let [a, b] = off(free[i]);
        (a * a - b * b).abs() / variance[i].max(f64::MIN_POSITIVE)
    };
    Ok((0..free.len())
        .max_by(|&a, &b| cost(a).total_cmp(&cost(b)))
        .map(|i| free[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against all 2¹⁰ patterns.
    #[test]
    fn it_finds_the_best_of_all_patterns() {
        for seed in 0..8 {
            let r = DMatrix::from_fn(12, 10, |i, j| {
                (((i * 31 + j * 17 + seed * 5) % 23) as f64 - 9.0) / 6.0
            });
            let d = DVector::from_fn(12, |i, _| (((i + seed) * 7) % 11) as f64 - 4.0);
            let objective = |set: usize| {
                let x = DVector::from_fn(10, |j, _| if set >> j & 1 == 1 { 0.9 } else { 0.2 });
                0.5 * (&r * x - &d).norm_squared()
            };
            let best = (0..1024).map(objective).fold(f64::INFINITY, f64::min);
            let start = DVector::from_element(10, 0.5);
            let found = search(&r, &d, [0.2, 0.9], &start, f64::INFINITY).unwrap();
            let light = found.light.unwrap();
            let set = (0..10).map(|j| usize::from(light[j]) << j).sum();
            assert!((objective(set) / best - 1.0).abs() < 1e-12, "{seed}");
            assert!(
                (found.bound / best - 1.0).abs() < 1e-9,
                "{seed}: {}",
                found.bound
            );
        }
    }
}
