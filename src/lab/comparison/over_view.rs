//! Patterns of light over the view that no geometry makes.

use crate::matrix::Matrix;

/// Patterns of [`over_view`].
pub(in crate::lab) const PATTERNS: usize = 6;

/// Patterns over the pixels of a frame whose light is `m`, W, pixels × patterns: 1, x and y, from
/// −1 to 1 over the `columns` and the rows of the view; and x, y and x² + y² times `m`.
pub(in crate::lab) fn over_view(m: &Matrix, columns: usize) -> Matrix {
    let rows = m.nrows() / columns;
    let over = |k: usize, n: usize| (2 * k + 1) as f64 / n as f64 - 1.0;
    Matrix::from_fn(m.nrows(), PATTERNS, |p, k| {
        let [x, y] = [over(p % columns, columns), over(p / columns, rows)];
        [1.0, x, y, m[p] * x, m[p] * y, m[p] * (x * x + y * y)][k]
    })
}
