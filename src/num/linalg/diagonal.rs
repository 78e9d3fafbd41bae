//! Products with diagonal matrices. Rows or columns beyond the last factor stay as they are.

use nalgebra::DMatrix;

/// diag(f) M: row i times f_i.
pub fn rows_times<'f>(m: DMatrix<f64>, factors: impl IntoIterator<Item = &'f f64>) -> DMatrix<f64> {
    by_rows(m, factors, |x, f| *x *= f)
}

/// diag(f)⁻¹ M: row i over f_i.
pub fn rows_over<'f>(m: DMatrix<f64>, factors: impl IntoIterator<Item = &'f f64>) -> DMatrix<f64> {
    by_rows(m, factors, |x, f| *x /= f)
}

/// Each entry changed by the factor of its row, column after column as they lie in memory.
fn by_rows<'f>(
    mut m: DMatrix<f64>,
    factors: impl IntoIterator<Item = &'f f64>,
    change: impl Fn(&mut f64, &f64),
) -> DMatrix<f64> {
    let factors: Vec<f64> = factors.into_iter().copied().collect();
    for mut column in m.column_iter_mut() {
        let entries = column.iter_mut().zip(&factors);
        entries.for_each(|(x, f)| change(x, f));
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
