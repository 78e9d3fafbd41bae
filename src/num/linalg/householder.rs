//! Householder reduction, with or without a choice of columns, and the orthogonal complement that
//! it gives.

use nalgebra::{DMatrix, DVector};

use super::{LinalgError, scaled};

/// H_1 H_2 … H_k, H_i = 1 − 2 v_i v_iᵀ, v_i zero before row i.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Reflections {
    rows: usize,
    vectors: Vec<DVector<f64>>,
}

/// Whether a reduction may choose the order of the columns.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Pivoting {
    /// The column with the largest part left is taken next (Businger and Golub 1965). What is left
    /// is summed anew at every step, not downdated.
    Largest,
    /// None.
    Never,
}

/// A P = H R: the reflections, R (min(m, n) × n, upper trapezoidal) and the order of the columns.
pub(super) fn reduce(
    mut a: DMatrix<f64>,
    pivoting: Pivoting,
) -> (Reflections, DMatrix<f64>, Vec<usize>) {
    let (m, n) = a.shape();
    let k = m.min(n);
    let mut order: Vec<usize> = (0..n).collect();
    let mut left: Vec<f64> = a.column_iter().map(|c| c.norm_squared()).collect();
    let mut vectors: Vec<DVector<f64>> = Vec::with_capacity(k);
    for i in 0..k {
        if pivoting == Pivoting::Largest {
            let next = (i..n).fold(i, |best, j| if left[j] > left[best] { j } else { best });
            a.swap_columns(i, next);
            left.swap(i, next);
            order.swap(i, next);
        }
        // H takes what is left of column i to −sign(a_ii) ‖·‖ on the diagonal.
        let mut v: DVector<f64> = a.column(i).rows_range(i..).into_owned();
        let diagonal = -libm::copysign(v.norm(), v[0]);
        v[0] -= diagonal;
        if diagonal != 0.0 {
            v.normalize_mut();
            for (j, left) in left.iter_mut().enumerate().skip(i + 1) {
                reflect(&mut a, j, i, &v);
                *left = a.column(j).rows_range(i + 1..).norm_squared();
            }
            a.column_mut(i).rows_range_mut(i + 1..).fill(0.0);
            a[(i, i)] = diagonal;
        }
        vectors.push(v);
    }
    let reflections = Reflections { rows: m, vectors };
    (reflections, a.rows(0, k).into_owned(), order)
}

/// H of v on the rows from `first` of column j.
fn reflect(a: &mut DMatrix<f64>, j: usize, first: usize, v: &DVector<f64>) {
    let mut column = a.column_mut(j);
    let mut below = column.rows_range_mut(first..);
    let along = -2.0 * v.dot(&below);
    below.axpy(along, v, 1.0);
}

impl Reflections {
    /// H_1 … H_k times B.
    fn times(&self, mut b: DMatrix<f64>) -> DMatrix<f64> {
        for (i, v) in self.vectors.iter().enumerate().rev() {
            for j in 0..b.ncols() {
                reflect(&mut b, j, i, v);
            }
        }
        b
    }

    /// Its transpose, H_k … H_1, times B.
    fn transposed_times(&self, mut b: DMatrix<f64>) -> DMatrix<f64> {
        for (i, v) in self.vectors.iter().enumerate() {
            for j in 0..b.ncols() {
                reflect(&mut b, j, i, v);
            }
        }
        b
    }

    /// Its first k columns.
    pub(super) fn thin(&self) -> DMatrix<f64> {
        self.times(DMatrix::identity(self.rows, self.vectors.len()))
    }
}

/// The orthogonal complement of the columns of a matrix.
#[derive(Debug, Clone, PartialEq)]
pub struct Complement(Reflections);

/// The complement of the k independent columns of an m × k matrix, k ≤ m (none for k = 0): m − k
/// orthonormal vectors, as reflections.
///
/// # Errors
/// [`LinalgError::NotFinite`], [`LinalgError::Shape`] for more columns than rows.
pub fn complement(a: &DMatrix<f64>) -> Result<Complement, LinalgError> {
    let (rows, columns) = a.shape();
    if columns > rows {
        return Err(LinalgError::Shape {
            what: "columns to be independent against rows",
            expected: rows,
            found: columns,
        });
    }
    if columns == 0 {
        let vectors = Vec::new();
        return Ok(Complement(Reflections { rows, vectors }));
    }
    Ok(Complement(reduce(scaled(a)?.0, Pivoting::Never).0))
}

impl Complement {
    /// Coordinates, (m − k) × c, of what of each column of B (m × c) lies in the complement.
    pub fn coordinates(&self, b: &DMatrix<f64>) -> DMatrix<f64> {
        let turned = self.0.transposed_times(b.clone());
        let k = self.0.vectors.len();
        turned.rows(k, b.nrows() - k).into_owned()
    }

    /// The vectors, m × c, of these coordinates.
    pub fn vectors(&self, coordinates: &DMatrix<f64>) -> DMatrix<f64> {
        let k = self.0.vectors.len();
        let mut all = DMatrix::zeros(self.0.rows, coordinates.ncols());
        all.rows_mut(k, coordinates.nrows()).copy_from(coordinates);
        self.0.times(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_complement_is_what_the_columns_leave() {
        let a = DMatrix::from_fn(7, 2, |i, j| ((i * 5 + j * 3) % 7) as f64 - 2.0);
        let outside = complement(&a).unwrap();
        let basis = outside.vectors(&DMatrix::identity(5, 5));
        assert!((a.tr_mul(&basis)).amax() < 1e-14 * a.norm());
        assert!((basis.tr_mul(&basis) - DMatrix::identity(5, 5)).amax() < 1e-14);
        let b = DMatrix::from_fn(7, 3, |i, j| ((i * 2 + j) % 5) as f64);
        assert!((outside.coordinates(&b) - basis.tr_mul(&b)).amax() < 1e-13);
        // Of no columns it is everything, of seven nothing.
        let all = complement(&DMatrix::zeros(7, 0)).unwrap();
        assert_eq!(all.coordinates(&b), b);
        let none = complement(&DMatrix::identity(7, 7)).unwrap();
        assert_eq!(none.coordinates(&b).nrows(), 0);
        assert!(complement(&DMatrix::zeros(2, 3)).is_err());
        assert!(complement(&DMatrix::from_element(3, 2, f64::NAN)).is_err());
    }
}
