//! The figure by which the published study judged its matrices.

use crate::matrix::Matrix;
use crate::num::linalg::{LinalgError, svd};

/// Algebraically smallest eigenvalue of D·Dᵀ formed in doubles, over the largest: where D is numerically rank deficient, rounding noise of either sign.
pub(super) fn smallest_eigenvalue(d: &Matrix) -> Result<f64, LinalgError> {
    let gram = svd(&(d * d.transpose()))?;
    // A symmetric matrix: the singular vectors of an eigenvalue λ agree up to its sign.
    let eigenvalue =
        |k: usize| gram.sigma[k].copysign(gram.u.column(k).dot(&gram.vt.row(k).transpose()));
    let smallest = (0..d.nrows()).map(eigenvalue).fold(f64::INFINITY, f64::min);
    Ok(smallest / gram.sigma[0])
}
