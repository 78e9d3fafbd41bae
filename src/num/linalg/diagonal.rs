//! Products with diagonal matrices. Rows or columns beyond the last factor stay as they are.

use nalgebra::DMatrix;

/// diag(f) M: row i times f_i.
pub fn rows_times<'f>(
    mut m: DMatrix<f64>,
    factors: impl IntoIterator<Item = &'f f64>,
) -> DMatrix<f64> {
    let factors: Vec<f64> = factors.into_iter().copied().collect();
    for mut column in m.column_iter_mut() {
        let entries = column.iter_mut().zip(&factors);
        entries.for_each(|(x, f)| *x *= f);
    }
    m
}

/// diag(f)⁻¹ M: row i over f_i.
pub fn rows_over<'f>(
    mut m: DMatrix<f64>,
    factors: impl IntoIterator<Item = &'f f64>,
) -> DMatrix<f64> {
    let factors: Vec<f64> = factors.into_iter().copied().collect();
    for mut column in m.column_iter_mut() {
        let entries = column.iter_mut().zip(&factors);
        entries.for_each(|(x, f)| *x /= f);
    }
    m
}

/// M diag(f): column j times f_j.
pub fn columns_times<'f>(
    mut m: DMatrix<f64>,
    factors: impl IntoIterator<Item = &'f f64>,
) -> DMatrix<f64> {
    for (mut column, f) in m.column_iter_mut().zip(factors) {
        column *= *f;
    }
    m
}

/// M diag(f)⁻¹: column j over f_j.
pub fn columns_over<'f>(
    mut m: DMatrix<f64>,
    factors: impl IntoIterator<Item = &'f f64>,
) -> DMatrix<f64> {
    for (mut column, f) in m.column_iter_mut().zip(factors) {
        column /= *f;
    }
    m
}
