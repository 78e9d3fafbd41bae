//! Products of large matrices: faer's, on one thread, so that their bits do not depend on the
//! number of cores.

use std::ops::Range;

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, MatMut, MatRef, Par};
use nalgebra::DMatrix;

fn view(a: &DMatrix<f64>) -> MatRef<'_, f64> {
    MatRef::from_column_major_slice(a.as_slice(), a.nrows(), a.ncols())
}

fn write(target: &mut DMatrix<f64>, how: Accum, a: MatRef<'_, f64>, b: MatRef<'_, f64>, sign: f64) {
    assert!(a.ncols() == b.nrows() && target.shape() == (a.nrows(), b.ncols()));
    let (rows, columns) = target.shape();
    let target = MatMut::from_column_major_slice_mut(target.as_mut_slice(), rows, columns);
    matmul(target, how, a, b, sign, Par::Seq);
}

/// A B, m × n.
///
/// # Panics
/// Where A has not as many columns as B rows.
pub fn product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut target = DMatrix::zeros(a.nrows(), b.ncols());
    write(&mut target, Accum::Replace, view(a), view(b), 1.0);
    target
}

/// Aᵀ B, m × n for A with m columns.
///
/// # Panics
/// Where A has not as many rows as B.
pub fn tr_product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    tr_product_of(a, 0..a.ncols(), b)
}

/// The same with some neighbouring columns of A.
///
/// # Panics
/// Where A has not these columns, or not as many rows as B.
pub fn tr_product_of(a: &DMatrix<f64>, columns: Range<usize>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut target = DMatrix::zeros(columns.len(), b.ncols());
    let columns = view(a).subcols(columns.start, columns.len());
    write(
        &mut target,
        Accum::Replace,
        columns.transpose(),
        view(b),
        1.0,
    );
    target
}

/// C + AᵀA in place of the symmetric C.
///
/// # Panics
/// Where the shapes do not fit.
pub fn gram_product(c: &mut DMatrix<f64>, a: &DMatrix<f64>) {
    let n = a.ncols();
    assert!(c.shape() == (n, n));
    let lower = BlockStructure::TriangularLower;
    triangular::matmul(
        MatMut::from_column_major_slice_mut(c.as_mut_slice(), n, n),
        lower,
        Accum::Add,
        view(a).transpose(),
        BlockStructure::Rectangular,
        view(a),
        BlockStructure::Rectangular,
        1.0,
        Par::Seq,
    );
    c.fill_upper_triangle_with_lower_triangle();
}

/// C − A B in place of C.
///
/// # Panics
/// Where the shapes do not fit.
pub fn subtract_product(c: &mut DMatrix<f64>, a: &DMatrix<f64>, b: &DMatrix<f64>) {
    write(c, Accum::Add, view(a), view(b), -1.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_their_definition() {
        let a = DMatrix::from_fn(5, 7, |i, j| ((i * 3 + j * 5) % 11) as f64 - 4.0);
        let b = DMatrix::from_fn(7, 3, |i, j| ((i * 2 + j * 7) % 9) as f64 - 3.0);
        let by_hand = DMatrix::from_fn(5, 3, |i, j| (0..7).map(|k| a[(i, k)] * b[(k, j)]).sum());
        // Small integers: exact in any order.
        assert_eq!(product(&a, &b), by_hand);
        assert_eq!(tr_product(&a.transpose(), &b), by_hand);
        let some = tr_product_of(&a.transpose(), 1..4, &b);
        assert_eq!(some, by_hand.rows(1, 3));
        let mut c = tr_product(&a, &a);
        gram_product(&mut c, &a);
        assert_eq!(c, tr_product(&a, &a) * 2.0);
        let mut c = by_hand.clone();
        subtract_product(&mut c, &a, &b);
        assert_eq!(c, DMatrix::zeros(5, 3));
    }
}
