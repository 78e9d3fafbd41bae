//! Linear least squares, by orthogonal reduction where the matrix fits and by normal equations where it does not.

use faer::linalg::solvers::{Llt, Qr};
use faer::{MatRef, Side};
use nalgebra::{DMatrix, DVector};

use super::{LinalgError, Tolerance, cut, scaled, svd};

/// Singular values below this fraction of σ₁ are not trusted after an unpivoted QR, whose error on numerically
/// rank-deficient input is about 4e-14 σ₁ (measured): three digits are kept above that.
const QR_TRUST: f64 = 1e-10;

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
    /// Singular values of A, descending, min(m, n) of them.
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
    /// (AᵀA)⁺ = V_k Σ_k⁻² V_kᵀ, n × n: the covariance of the solution where the entries of b carry independent noise of unit variance.
    pub fn covariance(&self) -> DMatrix<f64> {
        let mut scaled = self.vt.clone();
        for (mut row, &s) in scaled.row_iter_mut().zip(self.sigma.iter()) {
            row /= s;
        }
        scaled.transpose() * scaled
    }
}

fn same_length(what: &'static str, expected: usize, found: usize) -> Result<(), LinalgError> {
    if expected == found {
        Ok(())
    } else {
        Err(LinalgError::Shape {
            what,
            expected,
            found,
        })
    }
}

/// The column b scaled, as a vector, and its exponent.
fn scaled_vector(b: &DVector<f64>) -> Result<(DVector<f64>, i32), LinalgError> {
    let (matrix, exponent) = scaled(&DMatrix::from_column_slice(b.len(), 1, b.as_slice()))?;
    Ok((matrix.column(0).into_owned(), exponent))
}

/// Householder QR of [A | b]: R, d = Qᵀb and what of b lies outside the range of A.
///
/// # Errors
/// Empty or non-finite input, a b that has not as many entries as A has rows, overflow.
pub fn triangle(a: &DMatrix<f64>, b: &DVector<f64>) -> Result<Triangle, LinalgError> {
    same_length("entries of b against rows of A", a.nrows(), b.len())?;
    let (m, n) = a.shape();
    let (mut joined, a_exponent) = scaled(a)?;
    let (b, b_exponent) = scaled_vector(b)?;
    joined = joined.insert_column(n, 0.0);
    joined.set_column(n, &b);
    let qr = Qr::new(MatRef::from_column_major_slice(joined.as_slice(), m, n + 1));
    let upper = qr.thin_R();
    let k = m.min(n);
    let entry = |i: usize, j: usize| if i <= j { upper[(i, j)] } else { 0.0 };
    let result = Triangle {
        r: DMatrix::from_fn(k, n, |i, j| libm::scalbn(entry(i, j), a_exponent)),
        d: DVector::from_fn(k, |i, _| libm::scalbn(entry(i, n), b_exponent)),
        rest: if m > n {
            libm::scalbn(entry(n, n).abs(), b_exponent)
        } else {
            0.0
        },
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

/// The same reduction from the normal equations: `gram` = AᵀA (n × n, symmetric), `moment` = Aᵀb (n), `square` = ‖b‖².
/// By Cholesky, G = LLᵀ, R = Lᵀ, d = L⁻¹Aᵀb; where G is not positive definite to rounding by its singular values.
/// Solve the result with a [`Tolerance`] no tighter than √(n eps), below which a Gram matrix holds only rounding.
///
/// # Errors
/// Empty, non-finite or non-square input, a `moment` of another length.
pub fn normal_triangle(
    gram: &DMatrix<f64>,
    moment: &DVector<f64>,
    square: f64,
) -> Result<Triangle, LinalgError> {
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
            let (rank, _) = cut(decomposed.sigma.as_slice(), n, n, Tolerance::Auto)?;
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
    let d = d.map(|x| libm::scalbn(x, moment_exponent - half));
    let rest = (square - d.norm_squared()).max(0.0).sqrt();
    Ok(Triangle {
        r: r.map(|x| libm::scalbn(x, half)),
        d,
        rest,
    })
}

impl Triangle {
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

fn solve_by_svd(
    a: &DMatrix<f64>,
    b: &DVector<f64>,
    rest: f64,
    rows: usize,
    tolerance: Tolerance,
    route: Route,
) -> Result<LeastSquares, LinalgError> {
    let decomposed = svd(a)?;
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

/// The x of least norm among those that minimise ‖A x − b‖, for an m × n matrix.
///
/// QR first; where that shows σ_n < 1e-10 σ₁, or the tolerance is not [`Tolerance::Auto`], the singular value
/// decomposition of A itself, cut at `tolerance`.
///
/// # Errors
/// Empty or non-finite input, shapes that do not fit, a tolerance without meaning, overflow.
pub fn least_squares(
    a: &DMatrix<f64>,
    b: &DVector<f64>,
    tolerance: Tolerance,
) -> Result<LeastSquares, LinalgError> {
    same_length("entries of b against rows of A", a.nrows(), b.len())?;
    if tolerance == Tolerance::Auto && a.nrows() >= a.ncols() {
        let reduced = triangle(a, b)?;
        let solved = reduced.solve(a.nrows(), Tolerance::Auto, Route::Qr)?;
        if solved.sigma[solved.sigma.len() - 1] > QR_TRUST * solved.sigma[0] {
            return Ok(solved);
        }
    }
    scaled_vector(b)?;
    solve_by_svd(a, b, 0.0, a.nrows(), tolerance, Route::Svd)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::linalg::kernel::{bench_g12, hilbert};

    #[test]
    fn planted_solution_of_a_tall_system() {
        // A = columns 1, t, t² at t = 0..9, b = 3 − 2t + 0.5t² plus a vector orthogonal to all three columns.
        let a = DMatrix::from_fn(10, 3, |i, j| (i as f64).powi(j as i32));
        let x = DVector::from_row_slice(&[3.0, -2.0, 0.5]);
        // Fourth difference-type vector: (1, −3, 3, −1) annihilates polynomials of degree ≤ 2.
        let mut outside = DVector::zeros(10);
        for (i, value) in [1.0, -3.0, 3.0, -1.0].into_iter().enumerate() {
            outside[i + 2] = value;
        }
        let b = &a * &x + &outside;
        let solved = least_squares(&a, &b, Tolerance::Auto).unwrap();
        assert_eq!((solved.route, solved.rank), (Route::Qr, 3));
        assert!((&solved.solution - &x).norm() < 1e-12);
        assert!((solved.residual - 20f64.sqrt()).abs() < 1e-12);
        // (AᵀA)(AᵀA)⁻¹ = 1
        assert!(
            (a.transpose() * &a * solved.covariance() - DMatrix::identity(3, 3)).amax() < 1e-10
        );
        // The normal equations agree as far as their squared condition (1e2² here) lets them.
        let normal = normal_triangle(
            &(a.transpose() * &a),
            &(a.transpose() * &b),
            b.norm_squared(),
        )
        .unwrap();
        let solved = normal.solve(3, Tolerance::Auto, Route::Normal).unwrap();
        assert!((&solved.solution - &x).norm() < 1e-10);
        assert!((solved.residual - 20f64.sqrt()).abs() < 1e-9);
    }

    #[test]
    fn the_triangle_keeps_every_distance() {
        for a in [hilbert(30, 8), bench_g12(3.0).transpose(), hilbert(5, 9)] {
            let b = DVector::from_fn(a.nrows(), |i, _| ((i * 5) % 7) as f64 - 3.0);
            let t = triangle(&a, &b).unwrap();
            for seed in 0..3 {
                let x = DVector::from_fn(a.ncols(), |j, _| ((j * 3 + seed) % 5) as f64 - 2.0);
                let direct = (&a * &x - &b).norm();
                let reduced = libm::hypot((&t.r * &x - &t.d).norm(), t.rest);
                assert!((direct / reduced - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_deficient_system_has_its_minimum_norm_solution() {
        // x₁ + x₂ = 2 thrice: minimum norm (1, 1), rank 1.
        let a = DMatrix::from_element(3, 2, 1.0);
        let solved = least_squares(&a, &DVector::from_element(3, 2.0), Tolerance::Auto).unwrap();
        assert_eq!((solved.route, solved.rank), (Route::Svd, 1));
        assert!((solved.solution - DVector::from_element(2, 1.0)).norm() < 1e-14);
        let normal = normal_triangle(
            &DMatrix::from_element(2, 2, 3.0),
            &DVector::from_element(2, 6.0),
            12.0,
        )
        .unwrap();
        let solved = normal
            .solve(3, Tolerance::Relative(1e-7), Route::Normal)
            .unwrap();
        assert_eq!(solved.rank, 1);
        assert!((solved.solution - DVector::from_element(2, 1.0)).norm() < 1e-7);
    }

    #[test]
    fn scale_does_not_matter() {
        let a = hilbert(8, 4);
        let b = &a * DVector::from_element(4, 1.0);
        for (left, right) in [(1e300, 1e300), (1e-160, 1e-160), (1e200, 1e200)] {
            let solved = least_squares(&(&a * left), &(&b * right), Tolerance::Auto).unwrap();
            assert!((solved.solution - DVector::from_element(4, 1.0)).norm() < 1e-10);
        }
        let gram = a.transpose() * &a;
        let normal = normal_triangle(
            &(&gram * 1e-210),
            &(a.transpose() * &b * 1e-210),
            1e-210 * b.norm_squared(),
        )
        .unwrap();
        // Condition of the Gram matrix about 1e8: eight digits left.
        assert!(
            (normal
                .solve(4, Tolerance::Auto, Route::Normal)
                .unwrap()
                .solution
                - DVector::from_element(4, 1.0))
            .norm()
                < 1e-6
        );
    }

    #[test]
    fn bad_input_is_refused() {
        let a = DMatrix::from_element(3, 2, 1.0);
        assert!(matches!(
            least_squares(&a, &DVector::zeros(2), Tolerance::Auto),
            Err(LinalgError::Shape { .. })
        ));
        let nan = DVector::from_element(3, f64::NAN);
        assert!(matches!(
            least_squares(&a, &nan, Tolerance::Auto),
            Err(LinalgError::NotFinite { .. })
        ));
        assert!(matches!(
            least_squares(&a, &nan, Tolerance::Rank(1)),
            Err(LinalgError::NotFinite { .. })
        ));
        assert!(least_squares(&DMatrix::zeros(0, 0), &DVector::zeros(0), Tolerance::Auto).is_err());
        assert!(normal_triangle(&DMatrix::zeros(2, 3), &DVector::zeros(2), 0.0).is_err());
    }
}
