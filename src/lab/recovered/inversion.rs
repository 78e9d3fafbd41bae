//! The published inversion without noise, and the figure by which the published study judged its
//! matrices.

use crate::matrix::Matrix;
use crate::num::linalg::{LinalgError, svd};

/// Algebraically smallest eigenvalue of D·Dᵀ formed in doubles, over the largest: where D is
/// numerically rank deficient, rounding noise of either sign.
pub(in crate::lab) fn smallest_eigenvalue(d: &Matrix) -> Result<f64, LinalgError> {
    let gram = svd(&(d * d.transpose()))?;
    // A symmetric matrix: the singular vectors of an eigenvalue λ agree up to its sign.
    let eigenvalue =
        |k: usize| gram.sigma[k].copysign(gram.u.column(k).dot(&gram.vt.row(k).transpose()));
    let smallest = (0..d.nrows()).map(eigenvalue).fold(f64::INFINITY, f64::min);
    Ok(smallest / gram.sigma[0])
}

/// What Φ·D⁺ ⊘ C, mean over the pixels, makes of Φ = (C diag ρ)·D without its rounding: (C diag
/// ρ)·P ⊘ C with P = D·D⁺ = U_k U_kᵀ, `kept` = U_k (elements × k) the left singular vectors of D
/// that are kept. `c` is pixels × elements.
pub(in crate::lab) fn noiseless(c: &Matrix, rho: &[f64], kept: &Matrix) -> Vec<f64> {
    let mut lit = c.clone();
    for (mut column, rho) in lit.column_iter_mut().zip(rho) {
        column *= *rho;
    }
    let found = ((lit * kept) * kept.transpose()).component_div(c);
    found.row_mean().iter().copied().collect()
}
