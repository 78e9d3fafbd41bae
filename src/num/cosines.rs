//! Photographs along the cosines of their columns and rows.
//!
//! > T = T_x ⊗ T_y,   (T_x)_xi = √((2 − δ_i0)/n) cos(π i (x + ½)/n)
//!
//! is orthonormal and diagonalises what is the same everywhere with reflecting borders (Strang
//! 1999). Pixels and cosines: column + row·columns.

use nalgebra::DMatrix;

use super::linalg::product;

/// Tᵀ m: each column of m, a photograph, along its orthonormal cosines.
pub(crate) fn along_cosines(m: &DMatrix<f64>, frame: [usize; 2]) -> DMatrix<f64> {
    turned(m, frame.map(|n| one_sided(n).transpose()))
}

/// T m.
pub(crate) fn from_cosines(m: &DMatrix<f64>, frame: [usize; 2]) -> DMatrix<f64> {
    turned(m, frame.map(one_sided))
}

/// A X Bᵀ of each column X (columns × rows) of m.
fn turned(m: &DMatrix<f64>, [a, b]: [DMatrix<f64>; 2]) -> DMatrix<f64> {
    let mut all = DMatrix::zeros(m.nrows(), m.ncols());
    let b = b.transpose();
    for (from, mut to) in m.column_iter().zip(all.column_iter_mut()) {
        let picture = DMatrix::from_iterator(a.ncols(), b.nrows(), from.iter().copied());
        to.copy_from_slice(product(&product(&a, &picture), &b).as_slice());
    }
    all
}

/// √((2 − δ_i0)/n) cos(π i (x + ½)/n), x down, i across: orthonormal.
fn one_sided(n: usize) -> DMatrix<f64> {
    DMatrix::from_fn(n, n, |x, i| {
        let size = if i == 0 { 1.0 } else { 2.0 } / n as f64;
        let turn = i as f64 * (x as f64 + 0.5) / n as f64;
        size.sqrt() * libm::cos(std::f64::consts::PI * turn)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: [usize; 2] = [7, 5];

    /// T is orthogonal: a photograph comes back, its length stays, and a constant is the first
    /// cosine alone.
    #[test]
    fn cosines_turn_photographs() {
        let m = DMatrix::from_fn(35, 3, |p, l| libm::sin((p * p + 7 * l) as f64));
        let turned = along_cosines(&m, FRAME);
        assert!((turned.norm() - m.norm()).abs() < 1e-12);
        assert!((from_cosines(&turned, FRAME) - &m).amax() < 1e-13);
        let constant = along_cosines(&DMatrix::from_element(35, 1, 1.0), FRAME);
        assert!((constant[0] - 35f64.sqrt()).abs() < 1e-12);
        assert!(constant.rows(1, 34).amax() < 1e-13);
        // Down the columns first: pixel column + row·columns.
        let slope = DMatrix::from_fn(35, 1, |p, _| (p % 7) as f64);
        let turned = along_cosines(&slope, FRAME);
        assert!(turned[1].abs() > 1.0 && turned[7].abs() < 1e-12);
    }
}
