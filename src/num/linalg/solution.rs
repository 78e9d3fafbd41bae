//! A least-squares solution, and how it follows from singular directions.

use nalgebra::{DMatrix, DVector};

use super::{LinalgError, Svd, Tolerance, cut, rows_over, svd};

/// Which decomposition a solution rests on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Route {
    /// Householder QR of A, then the singular values of R: the condition of A, not its square.
    Qr,
    /// The singular value decomposition of A itself, because A is close to rank deficient.
    Svd,
    /// Cholesky of AᵀA: the square of A's condition, singular values below √eps σ₁ lost.
    Normal,
}

/// The minimum-norm solution of min ‖A x − b‖.
#[derive(Debug, Clone, PartialEq)]
pub struct LeastSquares {
    /// x, n entries.
    pub solution: DVector<f64>,
    /// Singular values of A, descending: min(m, n) of them, or those above rounding
    /// ([`svd_to`](super::svd_to)).
    pub sigma: DVector<f64>,
    /// How many singular values were kept.
    pub rank: usize,
    /// Singular values at or below this were taken as zero.
    pub cutoff: f64,
    /// ‖A x − b‖.
    pub residual: f64,
    /// Which decomposition was used.
    pub route: Route,
    /// Kept right singular vectors as rows, rank × n.
    pub vt: DMatrix<f64>,
}

impl LeastSquares {
    /// (AᵀA)⁺ = V_k Σ_k⁻² V_kᵀ, n × n: the covariance of the solution where the entries of b carry
    /// independent noise of unit variance.
    pub fn covariance(&self) -> DMatrix<f64> {
        let scaled = rows_over(self.vt.clone(), &self.sigma);
        scaled.transpose() * scaled
    }
}

/// From the singular value decomposition of A.
pub(super) fn solve_by_svd(
    a: &DMatrix<f64>,
    b: &DVector<f64>,
    rest: f64,
    rows: usize,
    tolerance: Tolerance,
    route: Route,
) -> Result<LeastSquares, LinalgError> {
    by_directions(a, svd(a)?, (b, rest), rows, tolerance, route)
}

/// From the directions of A.
pub(super) fn by_directions(
    a: &DMatrix<f64>,
    decomposed: Svd,
    (b, rest): (&DVector<f64>, f64),
    rows: usize,
    tolerance: Tolerance,
    route: Route,
) -> Result<LeastSquares, LinalgError> {
    let (rank, cutoff) = cut(decomposed.sigma.as_slice(), rows, a.ncols(), tolerance)?;
    let vt = decomposed.vt.rows(0, rank).into_owned();
    let mut along = decomposed.u.columns(0, rank).transpose() * b;
    for (x, &s) in along.iter_mut().zip(decomposed.sigma.iter()) {
        *x /= s;
    }
    let solution = vt.transpose() * along;
    if solution.iter().any(|x| !x.is_finite()) {
        return Err(LinalgError::Overflow("the least-squares solution"));
    }
    let residual = libm::hypot((a * &solution - b).norm(), rest);
    Ok(LeastSquares {
        solution,
        sigma: decomposed.sigma,
        rank,
        cutoff,
        residual,
        route,
        vt,
    })
}
