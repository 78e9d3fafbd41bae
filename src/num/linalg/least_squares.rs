//! Linear least squares, by orthogonal reduction where the matrix fits and by normal equations
//! where it does not.

use nalgebra::{DMatrix, DVector};

use super::solution::{LeastSquares, Route, by_directions, solve_by_svd};
use super::triangle::scaled_vector;
use super::{LinalgError, Tolerance, same_length, svd_of_range, triangle};

/// Singular values below this fraction of σ₁ are not trusted after an unpivoted QR, whose error on
/// numerically rank-deficient input is about 4e-14 σ₁ (measured): three digits are kept above that.
const QR_TRUST: f64 = 1e-10;

/// The x of least norm among those that minimise ‖A x − b‖, for an m × n matrix.
///
/// A large matrix of few directions is decomposed by its [`range`](super::range()). Of any other QR
/// first; where that shows σ_n < 1e-10 σ₁, or the tolerance is not [`Tolerance::Auto`], the
/// singular value decomposition of A itself, cut at `tolerance`.
///
/// # Errors
/// Empty or non-finite input, shapes that do not fit, a tolerance without meaning, overflow.
pub fn least_squares(
    a: &DMatrix<f64>,
    b: &DVector<f64>,
    tolerance: Tolerance,
) -> Result<LeastSquares, LinalgError> {
    same_length("entries of b against rows of A", a.nrows(), b.len())?;
    if let Some(decomposed) = svd_of_range(a, tolerance)? {
        scaled_vector(b)?;
        return by_directions(a, decomposed, (b, 0.0), a.nrows(), tolerance, Route::Svd);
    }
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
    use crate::num::linalg::kernel::hilbert;
    use crate::num::linalg::normal_triangle;

    #[test]
    fn planted_solution_of_a_tall_system() {
        // A = columns 1, t, t² at t = 0..9, b = 3 − 2t + 0.5t² plus a vector orthogonal to all
        // three columns.
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
    fn a_deficient_system_has_its_minimum_norm_solution() {
        // x₁ + x₂ = 2 thrice: minimum norm (1, 1), rank 1.
        let a = DMatrix::from_element(3, 2, 1.0);
        let solved = least_squares(&a, &DVector::from_element(3, 2.0), Tolerance::Auto).unwrap();
        assert_eq!((solved.route, solved.rank), (Route::Svd, 1));
        // Hilbert's 30 × 12: condition 1e15, nowhere exactly zero.
        let near = least_squares(
            &hilbert(30, 12),
            &DVector::from_element(30, 1.0),
            Tolerance::Auto,
        );
        assert_eq!(near.unwrap().route, Route::Svd);
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
