//! QR with column pivoting, and the two solutions of a rank-deficient system that rest on it.
//!
//! Businger and Golub's Householder reduction (1965): at every step the column with the largest
//! part left is taken next. The columns' remaining norms are summed anew at every step, not
//! downdated, so the choice and the diagonal of R hold to rounding however deficient the matrix is;
//! faer's own pivoted QR updates them by differences and its diagonal then need not fall.

use nalgebra::DMatrix;

use super::householder::{Pivoting, reduce};
use super::svd::certain;
use super::{LinalgError, Tolerance, cut, product, range, same_length, same_to_rounding, scaled};

/// A P = Q R with |R₁₁| ≥ |R₂₂| ≥ …, thin: k = min(m, n).
#[derive(Debug, Clone, PartialEq)]
pub struct PivotedQr {
    /// Q, m × k, orthonormal columns.
    pub q: DMatrix<f64>,
    /// Column i of A P is column `order[i]` of A.
    pub order: Vec<usize>,
    /// R times 2^−exponent, k × n, upper trapezoidal.
    r: DMatrix<f64>,
    exponent: i32,
}

/// The pivoted QR of an m × n matrix.
///
/// Before it is returned it must reproduce the matrix to rounding, ‖A P − Q R‖ ≤ 10 N eps ‖A‖ with
/// N = max(m, n), and Q must be orthonormal, ‖QᵀQ − 1‖ ≤ 10 N eps √k (Frobenius norms).
///
/// # Errors
/// [`LinalgError::Empty`], [`LinalgError::NotFinite`], [`LinalgError::Inaccurate`] if a check
/// fails.
pub fn pivoted_qr(a: &DMatrix<f64>) -> Result<PivotedQr, LinalgError> {
    let (scaled, exponent) = scaled(a)?;
    let (reflections, r, order) = reduce(scaled.clone(), Pivoting::Largest);
    let result = PivotedQr {
        q: reflections.thin(),
        order,
        r,
        exponent,
    };
    check(&scaled, &result)?;
    Ok(result)
}

/// The pivoted QR as far as a cut at `tolerance` needs it: of a large matrix of few directions that
/// of its [`Range`](super::Range), A P = Q_range (B P), whose columns have the norms of A's columns
/// but for what the range misses, at the cost of B; of any other, or where what is missed leaves
/// the rank in doubt, of all of A.
///
/// # Errors
/// Those of [`pivoted_qr`](pivoted_qr()), and [`LinalgError::Tolerance`].
pub fn pivoted_qr_to(a: &DMatrix<f64>, tolerance: Tolerance) -> Result<PivotedQr, LinalgError> {
    if let Some(found) = range(a)? {
        let small = pivoted_qr(&found.b)?;
        if certain(&small.diagonal(), found.rest, a.shape(), tolerance)? {
            let q = product(&found.q, &small.q);
            return Ok(PivotedQr { q, ..small });
        }
    }
    pivoted_qr(a)
}

/// The two a-posteriori checks of [`pivoted_qr`] on the scaled matrix.
fn check(a: &DMatrix<f64>, qr: &PivotedQr) -> Result<(), LinalgError> {
    let k = qr.q.ncols();
    let off = (qr.q.transpose() * &qr.q - DMatrix::identity(k, k)).norm();
    same_to_rounding(a, "the orthogonality of Q", off / (k as f64).sqrt())?;
    let norm = a.norm();
    if norm == 0.0 {
        return Ok(());
    }
    let off = (a.select_columns(&qr.order) - &qr.q * &qr.r).norm();
    same_to_rounding(a, "the product of the factors", off / norm)
}

impl PivotedQr {
    /// |R₁₁|, |R₂₂|, … in the unit of A.
    pub fn diagonal(&self) -> Vec<f64> {
        let unscaled = |x| libm::scalbn(x, self.exponent);
        self.scaled_diagonal().into_iter().map(unscaled).collect()
    }

    fn scaled_diagonal(&self) -> Vec<f64> {
        (0..self.q.ncols()).map(|i| self.r[(i, i)].abs()).collect()
    }

    /// How many diagonal entries of R survive `tolerance`, and the value at or below which they
    /// were cut. [`Tolerance::Auto`] is max(m, n) · eps · |R₁₁|, the tolerance that MATLAB's `\`
    /// and `/` name in their warning of rank deficiency.
    ///
    /// # Errors
    /// [`LinalgError::Tolerance`], [`LinalgError::Rank`].
    pub fn rank(&self, tolerance: Tolerance) -> Result<(usize, f64), LinalgError> {
        let diagonal = self.scaled_diagonal();
        let (rank, cutoff) = cut(&diagonal, self.q.nrows(), self.r.ncols(), tolerance)?;
        Ok((rank, libm::scalbn(cutoff, self.exponent)))
    }

    /// The basic solution of min ‖A X − B‖ (B m × c, X n × c) with the first `rank` columns of A P:
    /// all other rows of X are zero.
    ///
    /// # Errors
    /// A B of other rows than A, not finite or empty; a rank that R does not have; overflow.
    pub fn basic(&self, rank: usize, b: &DMatrix<f64>) -> Result<DMatrix<f64>, LinalgError> {
        let (along, exponent) = self.along(rank, b)?;
        let head = self.r.view((0, 0), (rank, rank));
        let solved = head.solve_upper_triangular(&along);
        let mut x = DMatrix::zeros(self.order.len(), b.ncols());
        x.rows_mut(0, rank)
            .copy_from(&solved.ok_or(self.deficient(rank))?);
        self.unscaled(x, exponent)
    }

    /// The solution of least norm of the same system, R beyond row `rank` taken as zero: by a
    /// complete orthogonal decomposition \[R₁₁ R₁₂\] = Sᵀ Zᵀ, X = P Z S⁻ᵀ Qᵀ B, as LAPACK's
    /// `gelsy`.
    ///
    /// # Errors
    /// Those of [`PivotedQr::basic`].
    pub fn minimum_norm(&self, rank: usize, b: &DMatrix<f64>) -> Result<DMatrix<f64>, LinalgError> {
        let (along, exponent) = self.along(rank, b)?;
        let (z, s, _) = reduce(self.r.rows(0, rank).transpose(), Pivoting::Never);
        let solved = s.tr_solve_upper_triangular(&along);
        self.unscaled(z.thin() * solved.ok_or(self.deficient(rank))?, exponent)
    }

    /// The first `rank` rows of QᵀB, scaled, and the exponent taken out.
    fn along(&self, rank: usize, b: &DMatrix<f64>) -> Result<(DMatrix<f64>, i32), LinalgError> {
        same_length("rows of B against rows of A", self.q.nrows(), b.nrows())?;
        if rank == 0 || rank > self.q.ncols() {
            return Err(self.deficient(rank));
        }
        let (b, exponent) = scaled(b)?;
        Ok((self.q.columns(0, rank).transpose() * b, exponent))
    }

    fn deficient(&self, asked: usize) -> LinalgError {
        let available = self.scaled_diagonal().iter().filter(|&&x| x > 0.0).count();
        LinalgError::Rank { asked, available }
    }

    /// Rows back in the order of A's columns, scales put back.
    fn unscaled(&self, x: DMatrix<f64>, exponent: i32) -> Result<DMatrix<f64>, LinalgError> {
        let mut result = DMatrix::zeros(x.nrows(), x.ncols());
        for (row, &place) in self.order.iter().enumerate() {
            let scaled = x
                .row(row)
                .map(|x| libm::scalbn(x, exponent - self.exponent));
            result.row_mut(place).copy_from(&scaled);
        }
        if result.iter().all(|x| x.is_finite()) {
            Ok(result)
        } else {
            Err(LinalgError::Overflow("the solution of the linear system"))
        }
    }
}

#[cfg(test)]
mod tests;
