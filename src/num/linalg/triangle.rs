//! Orthogonal reduction of a least-squares problem to a square one, and the same from normal
//! equations.

use std::ops::Range;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::qr::no_pivoting::factor;
use faer::linalg::solvers::Llt;
use faer::{Mat, MatMut, MatRef, Par, Side};
use nalgebra::{DMatrix, DVector};

use super::solution::{LeastSquares, Route, solve_by_svd};
use super::{
    LinalgError, Tolerance, exponent, refuse_empty, same_length, scaled, svd, times_two_to,
};

/// The reduction of min ‖A x − b‖ for an m × n matrix to k = min(m, n) rows:
/// ‖A x − b‖² = ‖R x − d‖² + rest² for every x.
#[derive(Debug, Clone, PartialEq)]
pub struct Triangle {
    /// R, k × n; upper triangular unless it comes from deficient normal equations.
    pub r: DMatrix<f64>,
    /// d, k entries.
    pub d: DVector<f64>,
    /// The part of ‖b‖ that no x can reach, ≥ 0.
    pub rest: f64,
}

/// The column b scaled, as a vector, and its exponent.
pub(super) fn scaled_vector(b: &DVector<f64>) -> Result<(DVector<f64>, i32), LinalgError> {
    let (matrix, exponent) = scaled(&DMatrix::from_column_slice(b.len(), 1, b.as_slice()))?;
    Ok((matrix.column(0).into_owned(), exponent))
}

/// Householder QR of [A | b]: R, d = Qᵀb and what of b lies outside the range of A.
///
/// # Errors
/// Empty or non-finite input, a b that has not as many entries as A has rows, overflow.
pub fn triangle(a: &DMatrix<f64>, b: &DVector<f64>) -> Result<Triangle, LinalgError> {
    same_length("entries of b against rows of A", a.nrows(), b.len())?;
    let n = a.ncols();
    let mut joined = a.clone().insert_column(n, 0.0);
    joined.set_column(n, b);
    triangle_of(joined)
}

/// The same of the matrix [A | b], in its own memory.
///
/// # Errors
/// Empty or non-finite input, overflow.
pub fn triangle_of(mut joined: DMatrix<f64>) -> Result<Triangle, LinalgError> {
    let (m, columns) = joined.shape();
    let n = columns.saturating_sub(1);
    refuse_empty(m, n)?;
    let mut scale = |entries: Range<usize>| {
        let entries = &mut joined.as_mut_slice()[entries];
        let exponent = exponent(entries, m)?;
        let down = times_two_to(-exponent);
        entries.iter_mut().for_each(|x| *x = down(*x));
        Ok(exponent)
    };
    let (a_exponent, b_exponent) = (scale(0..m * n)?, scale(m * n..m * columns)?);
    reduce(&mut joined);
    let k = m.min(n);
    let entry = |i: usize, j: usize| if i <= j { joined[(i, j)] } else { 0.0 };
    let [a_up, b_up] = [a_exponent, b_exponent].map(times_two_to);
    let result = Triangle {
        r: DMatrix::from_fn(k, n, |i, j| a_up(entry(i, j))),
        d: DVector::from_fn(k, |i, _| b_up(entry(i, n))),
        rest: if m > n { b_up(entry(n, n).abs()) } else { 0.0 },
    };
    let finite = result
        .r
        .iter()
        .chain(result.d.iter())
        .all(|x| x.is_finite())
        && result.rest.is_finite();
    if finite {
        Ok(result)
    } else {
        Err(LinalgError::Overflow("the triangular factor"))
    }
}

/// R of the Householder QR above the diagonal of the matrix, in its place.
fn reduce(a: &mut DMatrix<f64>) {
    let (m, n) = a.shape();
    let block = factor::recommended_block_size::<f64>(m, n);
    let mut coefficients = Mat::<f64>::zeros(block, m.min(n));
    let (how, par) = (Default::default(), Par::Seq);
    let mut memory = MemBuffer::new(factor::qr_in_place_scratch::<f64>(m, n, block, par, how));
    factor::qr_in_place(
        MatMut::from_column_major_slice_mut(a.as_mut_slice(), m, n),
        coefficients.as_mut(),
        par,
        MemStack::new(&mut memory),
        how,
    );
}

/// Unknowns of normal equations; refuses those whose sides do not fit.
fn unknowns(gram: &DMatrix<f64>, moment: &DVector<f64>) -> Result<usize, LinalgError> {
    let n = gram.nrows();
    same_length(
        "columns of the Gram matrix against its rows",
        n,
        gram.ncols(),
    )?;
    same_length(
        "entries of Aᵀb against rows of the Gram matrix",
        n,
        moment.len(),
    )?;
    Ok(n)
}

/// The same reduction from the normal equations: `gram` = AᵀA (n × n, symmetric), `moment` = Aᵀb
/// (n), `square` = ‖b‖². By Cholesky, G = LLᵀ, R = Lᵀ, d = L⁻¹Aᵀb; where G is not positive definite
/// to rounding by its singular values. Solve the result with a [`Tolerance`] no tighter than √(n
/// eps), below which a Gram matrix holds only rounding.
///
/// # Errors
/// Empty, non-finite or non-square input, a `moment` of another length.
pub fn normal_triangle(
    gram: &DMatrix<f64>,
    moment: &DVector<f64>,
    square: f64,
) -> Result<Triangle, LinalgError> {
    let n = unknowns(gram, moment)?;
    let (mut g, mut exponent) = scaled(gram)?;
    if exponent % 2 != 0 {
        // An even exponent has a square root that is a power of two as well.
        g *= 2.0;
        exponent -= 1;
    }
    let half = exponent / 2;
    let (moment, moment_exponent) = scaled_vector(moment)?;
    let (r, d) = match Llt::new(
        MatRef::from_column_major_slice(g.as_slice(), n, n),
        Side::Lower,
    ) {
        Ok(llt) => {
            let l = llt.L();
            let r = DMatrix::from_fn(n, n, |i, j| if i <= j { l[(j, i)] } else { 0.0 });
            let mut d = moment;
            for i in 0..n {
                let known: f64 = (0..i).map(|k| r[(k, i)] * d[k]).sum();
                d[i] = (d[i] - known) / r[(i, i)];
            }
            (r, d)
        }
        Err(_) => {
            let decomposed = svd(&g)?;
            let (rank, _) = decomposed.cut(Tolerance::Auto)?;
            let mut r = decomposed.vt.rows(0, rank).into_owned();
            let mut d = &r * moment;
            for k in 0..rank {
                let root = decomposed.sigma[k].sqrt();
                r.row_mut(k).scale_mut(root);
                d[k] /= root;
            }
            (r, d)
        }
    };
    let d = d.map(times_two_to(moment_exponent - half));
    let rest = (square - d.norm_squared()).max(0.0).sqrt();
    Ok(Triangle {
        r: r.map(times_two_to(half)),
        d,
        rest,
    })
}

/// A symmetric positive semidefinite matrix by its diagonal and what computes a column.
pub struct Gram<F> {
    /// The diagonal.
    pub diagonal: DVector<f64>,
    /// Column j; none where it is not to be gone on.
    pub column: F,
    /// The columns that may be asked for.
    pub most: usize,
}

/// The same reduction of as few rows as leave at most `lost` of the trace of the Gram matrix, by
/// Cholesky with pivots (Harbrecht, Peters and Schneider 2012): G − RᵀR is positive semidefinite
/// and of trace ≤ `lost`, so that for every x
///
/// > 0 ≤ ‖A x‖² − ‖R x‖² ≤ lost·‖x‖².
///
/// One column of G is asked for each row of R. `None` where `lost` is less than the rounding of G
/// lets be told, or takes more columns than there may be.
///
/// # Errors
/// [`LinalgError`] where the sides do not fit.
pub fn pivoted_triangle(
    gram: Gram<impl Fn(usize) -> Option<DVector<f64>>>,
    moment: &DVector<f64>,
    square: f64,
    lost: f64,
) -> Result<Option<Triangle>, LinalgError> {
    let Gram {
        diagonal: mut left,
        column,
        most,
    } = gram;
    let n = left.len();
    same_length(
        "entries of Aᵀb against rows of the Gram matrix",
        n,
        moment.len(),
    )?;
    let trace = left.sum();
    if !trace.is_finite() || 10.0 * f64::EPSILON * trace > lost {
        return Ok(None);
    }
    // Columns of L, G ≈ L Lᵀ, and what they leave of the data.
    let mut l: Vec<DVector<f64>> = Vec::new();
    let mut d: Vec<f64> = Vec::new();
    while left.sum() > lost && l.len() < n {
        if l.len() == most {
            return Ok(None);
        }
        let (pivot, largest) = left.argmax();
        let root = largest.sqrt();
        let Some(mut column) = column(pivot) else {
            return Ok(None);
        };
        let mut own = moment[pivot];
        for (before, d) in l.iter().zip(&d) {
            column.axpy(-before[pivot], before, 1.0);
            own -= before[pivot] * d;
        }
        column /= root;
        for (left, x) in left.iter_mut().zip(column.iter()) {
            *left = (*left - x * x).max(0.0);
        }
        left[pivot] = 0.0;
        d.push(own / root);
        l.push(column);
    }
    let d = DVector::from_vec(d);
    let rest = (square - d.norm_squared()).max(0.0).sqrt();
    let r = DMatrix::from_fn(l.len(), n, |i, j| l[i][j]);
    Ok((!l.is_empty()).then_some(Triangle { r, d, rest }))
}

impl Triangle {
    /// [R | d] above the row (0 | rest): an (k + 1) × (n + 1) matrix whose distances are those of
    /// [A | b].
    pub fn joined(&self) -> DMatrix<f64> {
        let (k, n) = self.r.shape();
        DMatrix::from_fn(k + 1, n + 1, |i, j| match (i < k, j < n) {
            (true, true) => self.r[(i, j)],
            (true, false) => self.d[i],
            (false, true) => 0.0,
            (false, false) => self.rest,
        })
    }

    /// x by back substitution, of a triangle from [`triangle`]; none where a pivot is below `trust`
    /// times the largest, so that the solution is not unique to rounding.
    pub fn substitute(&self, trust: f64) -> Option<DVector<f64>> {
        let (k, n) = self.r.shape();
        let largest = (0..k).map(|i| self.r[(i, i)].abs()).fold(0.0, f64::max);
        if k < n || (0..n).any(|i| self.r[(i, i)].abs() <= trust * largest) {
            return None;
        }
        let mut x = self.d.clone();
        for i in (0..n).rev() {
            x[i] /= self.r[(i, i)];
            let known = x[i];
            for above in 0..i {
                x[above] -= self.r[(above, i)] * known;
            }
        }
        x.iter().all(|x| x.is_finite()).then_some(x)
    }

    /// The minimum-norm solution of the reduced problem, `route` recorded as its origin.
    ///
    /// # Errors
    /// Those of [`svd`](svd()) and of the tolerance.
    pub fn solve(
        &self,
        rows: usize,
        tolerance: Tolerance,
        route: Route,
    ) -> Result<LeastSquares, LinalgError> {
        solve_by_svd(&self.r, &self.d, self.rest, rows, tolerance, route)
    }
}

#[cfg(test)]
mod tests;
