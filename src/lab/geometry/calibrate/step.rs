//! The step of Levenberg and Marquardt (1963), some moves of it fixed.

use nalgebra::DVector;

use crate::matrix::Matrix;
use crate::num::linalg::Cholesky;

/// By how much a step lowers the cost, to second order.
pub(super) fn gain(information: &Matrix, slope: &DVector<f64>, step: &DVector<f64>) -> f64 {
    -slope.dot(step) - 0.5 * step.dot(&(information * step))
}

/// The step down from `slope`, its moves that are fixed given; none where nothing changes with an
/// unknown.
pub(super) fn damped(
    information: &Matrix,
    slope: &DVector<f64>,
    damping: f64,
    fixed: &[Option<f64>],
) -> Option<DVector<f64>> {
    let (mut all, mut side) = (information.clone(), -slope);
    for k in 0..all.nrows() {
        all[(k, k)] *= 1.0 + damping;
    }
    let fixed = fixed.iter().enumerate();
    let fixed = fixed.filter_map(|(k, own)| Some((k, (*own)?)));
    for (k, own) in fixed.clone() {
        side.axpy(-own, &information.column(k), 1.0);
    }
    for (k, own) in fixed {
        all.row_mut(k).fill(0.0);
        all.column_mut(k).fill(0.0);
        (all[(k, k)], side[k]) = (1.0, own);
    }
    Some(Cholesky::new(&all)?.solve(&side))
}
