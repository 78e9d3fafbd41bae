//! The Cholesky factor of a symmetric positive definite matrix.

use faer::linalg::solvers::Llt;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{MatMut, MatRef, Par, Side};
use nalgebra::{DMatrix, DVector};

use super::product::tr_product;

/// L of A = L Lᵀ. Its errors are those of A scaled to a unit diagonal, so that a graded matrix
/// loses nothing by its grades (Demmel 1989).
#[derive(Debug, Clone)]
pub struct Cholesky {
    l: DMatrix<f64>,
}

impl Cholesky {
    /// The factor of `a` (n × n, its lower triangle); none where it is not positive definite to
    /// rounding, or not finite.
    pub fn new(a: &DMatrix<f64>) -> Option<Self> {
        if !a.is_square() || a.is_empty() || a.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let n = a.nrows();
        let found = Llt::new(
            MatRef::from_column_major_slice(a.as_slice(), n, n),
            Side::Lower,
        );
        let l = found.ok()?;
        let l = l.L();
        let l = DMatrix::from_fn(n, n, |i, j| if i >= j { l[(i, j)] } else { 0.0 });
        l.diagonal().iter().all(|x| *x > 0.0).then_some(Self { l })
    }

    /// L, n × n.
    pub fn lower(&self) -> &DMatrix<f64> {
        &self.l
    }

    /// ln det A = 2 Σ ln L_ii.
    pub fn log_det(&self) -> f64 {
        2.0 * self.l.diagonal().iter().map(|x| libm::log(*x)).sum::<f64>()
    }

    /// L⁻¹ B, n × m.
    ///
    /// # Panics
    /// Where B has not n rows.
    pub fn forward(&self, mut b: DMatrix<f64>) -> DMatrix<f64> {
        let n = self.l.nrows();
        assert!(b.nrows() == n);
        let columns = b.ncols();
        solve_lower_triangular_in_place(
            MatRef::from_column_major_slice(self.l.as_slice(), n, n),
            MatMut::from_column_major_slice_mut(b.as_mut_slice(), n, columns),
            Par::Seq,
        );
        b
    }

    /// A⁻¹ = L⁻ᵀ L⁻¹.
    pub fn inverse(&self) -> DMatrix<f64> {
        let n = self.l.nrows();
        let half = self.forward(DMatrix::identity(n, n));
        tr_product(&half, &half)
    }

    /// A⁻¹ b.
    ///
    /// # Panics
    /// Where b has not n entries.
    pub fn solve(&self, b: &DVector<f64>) -> DVector<f64> {
        let n = self.l.nrows();
        let mut x = self.forward(DMatrix::from_column_slice(n, 1, b.as_slice()));
        solve_upper_triangular_in_place(
            MatRef::from_column_major_slice(self.l.as_slice(), n, n).transpose(),
            MatMut::from_column_major_slice_mut(x.as_mut_slice(), n, 1),
            Par::Seq,
        );
        x.column(0).into_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// min(i, j) = Σ_k [k ≤ i][k ≤ j]: the factor is the triangle of ones, its determinant 1.
    /// Grades of 1e±100 on both sides scale the factor and nothing else.
    #[test]
    fn the_factor_of_least_indices_is_a_triangle_of_ones() {
        let least = DMatrix::from_fn(7, 7, |i, j| (i.min(j) + 1) as f64);
        let found = Cholesky::new(&least).unwrap();
        assert!((found.log_det()).abs() < 1e-14);
        // L⁻¹ of ones in all rows is one in the first alone.
        let solved = found.forward(DMatrix::from_element(7, 2, 1.0));
        let first = DMatrix::from_fn(7, 2, |i, _| if i == 0 { 1.0 } else { 0.0 });
        assert!((solved - first).amax() < 1e-14);
        let grade = |i: usize| libm::exp(30.0 * (i as f64 - 3.0));
        let graded = DMatrix::from_fn(7, 7, |i, j| grade(i) * least[(i, j)] * grade(j));
        let graded = Cholesky::new(&graded).unwrap();
        for i in 0..7 {
            assert!((graded.l[(i, 0)] / grade(i) - 1.0).abs() < 1e-12);
            assert!((graded.l[(6, i)] / grade(6) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn what_has_no_factor() {
        for a in [
            DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 1.0]),
            DMatrix::from_element(2, 2, f64::NAN),
            DMatrix::zeros(2, 2),
            DMatrix::zeros(0, 0),
            DMatrix::zeros(2, 3),
        ] {
            assert!(Cholesky::new(&a).is_none(), "{a}");
        }
    }
}
