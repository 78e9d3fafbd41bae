//! Bounded-variable least squares by active sets (Stark and Parker 1995).

use nalgebra::{DMatrix, DVector};

use super::{Place, QuadraticError};
use crate::num::linalg::{Tolerance, least_squares, triangle};

/// Floating-point operations that the active-set refinement may spend.
const REFINEMENT_BUDGET: f64 = 1e11;

/// A pivot below this fraction of the largest makes columns dependent.
const PIVOT: f64 = 1e-11;

/// Bounded-variable least squares, 0 ≤ x ≤ u, from a given start. Stops at a point where all
/// optimality conditions hold to rounding, or when its budget is spent; the objective never rises
/// from the start's.
pub(super) fn refine(
    r: &DMatrix<f64>,
    d: &DVector<f64>,
    upper: &DVector<f64>,
    start: DVector<f64>,
    mut places: Vec<Place>,
) -> Result<(DVector<f64>, usize), QuadraticError> {
    let (k, n) = r.shape();
    let lengths: Vec<f64> = r.column_iter().map(|c| c.norm()).collect();
    let rounding = 4.0 * (k + n) as f64 * f64::EPSILON;
    let objective = |x: &DVector<f64>| (r * x - d).norm();
    let mut x = DVector::from_fn(n, |j, _| match places[j] {
        Place::Free => start[j],
        Place::Lower => 0.0,
        Place::Upper => upper[j],
    });
    let mut released = None;
    let mut banned = vec![false; n];
    let (mut steps, mut spent) = (0, 0.0);
    while steps < 10 * (n + 1) && spent < REFINEMENT_BUDGET {
        steps += 1;
        let free: Vec<usize> = (0..n)
            .filter(|&j| places[j] == Place::Free && lengths[j] > 0.0)
            .collect();
        let mut stride = 1.0;
        let mut blocked = None;
        if !free.is_empty() {
            // The singular value decomposition of k × f, with its vectors, that it may take.
            spent += 25.0 * (k * free.len() * k.min(free.len())) as f64;
            let towards = solve(&r.select_columns(&free), &(d - r * &x))?;
            for (&j, &step) in free.iter().zip(towards.iter()) {
                let room = if step < 0.0 {
                    x[j] / -step
                } else {
                    (upper[j] - x[j]) / step
                };
                if step != 0.0 && room < stride {
                    stride = room;
                    blocked = Some((
                        j,
                        if step < 0.0 {
                            Place::Lower
                        } else {
                            Place::Upper
                        },
                    ));
                }
            }
            for (&j, &step) in free.iter().zip(towards.iter()) {
                x[j] = (x[j] + stride * step).clamp(0.0, upper[j]);
            }
        }
        if let Some((j, place)) = blocked {
            x[j] = if place == Place::Lower { 0.0 } else { upper[j] };
            places[j] = place;
            if stride > 0.0 {
                banned.fill(false);
            }
            banned[j] |= released == Some(j) && stride == 0.0;
            released = None;
            continue;
        }
        if released.is_some() {
            banned.fill(false);
        }
        // Multipliers from the part that the free variables cannot change: of the whole residual,
        // rounding of a large d would leave eps·‖d‖ along them, which may outweigh a small
        // multiplier.
        let left = orthogonal_to(r, &(r * &x - d), &free)?;
        let unit = left.norm();
        if unit <= f64::EPSILON * d.norm() {
            break;
        }
        let gradient = r.transpose() * left;
        released = (0..n)
            .filter(|&j| !banned[j] && lengths[j] > 0.0)
            .map(|j| match places[j] {
                Place::Lower => (j, -gradient[j] / lengths[j]),
                Place::Upper => (j, gradient[j] / lengths[j]),
                Place::Free => (j, 0.0),
            })
            .filter(|&(_, pull)| pull > rounding * unit)
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(j, _)| j);
        match released {
            Some(j) => places[j] = Place::Free,
            None => break,
        }
    }
    if objective(&x) <= objective(&start) * (1.0 + f64::EPSILON) + rounding * d.norm() {
        Ok((x, steps))
    } else {
        Ok((start, steps))
    }
}

/// The part of the residual that the variables strictly between their bounds cannot change.
pub(super) fn orthogonal_to_free(
    r: &DMatrix<f64>,
    residual: &DVector<f64>,
    upper: &DVector<f64>,
    x: &DVector<f64>,
) -> Result<DVector<f64>, QuadraticError> {
    let free: Vec<usize> = (0..x.len())
        .filter(|&j| x[j] > 0.0 && x[j] < upper[j])
        .collect();
    orthogonal_to(r, residual, &free)
}

/// Least squares by QR; by singular values where the columns are dependent to rounding.
fn solve(columns: &DMatrix<f64>, b: &DVector<f64>) -> Result<DVector<f64>, QuadraticError> {
    match triangle(columns, b)?.substitute(PIVOT) {
        Some(x) => Ok(x),
        None => Ok(least_squares(columns, b, Tolerance::Auto)?.solution),
    }
}

fn orthogonal_to(
    r: &DMatrix<f64>,
    residual: &DVector<f64>,
    free: &[usize],
) -> Result<DVector<f64>, QuadraticError> {
    if free.is_empty() {
        return Ok(residual.clone());
    }
    let columns = r.select_columns(free);
    let within = solve(&columns, residual)?;
    Ok(residual - columns * within)
}

#[cfg(test)]
mod tests {
    use super::super::{Bounds, box_least_squares};
    use super::*;

    #[test]
    fn refinement_reaches_the_optimum_from_a_bad_start() {
        let r = DMatrix::from_fn(12, 8, |i, j| (((i * 31 + j * 17) % 13) as f64 - 6.0) / 6.0);
        let d = DVector::from_fn(12, |i, _| ((i * 7) % 5) as f64 - 1.0);
        let bounds = Bounds::all(8, 0.0, 1.0);
        let reference = box_least_squares(&r, &d, &bounds).unwrap();
        for place in [Place::Free, Place::Lower, Place::Upper] {
            let start = DVector::from_element(8, 0.5);
            let (x, _) = refine(&r, &d, &bounds.upper, start, vec![place; 8]).unwrap();
            assert!((&x - &reference.solution).amax() < 1e-12);
        }
    }
}
