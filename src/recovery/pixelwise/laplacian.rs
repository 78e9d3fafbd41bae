//! The Laplacian LᵀL of element grids with free edges, L the differences between neighbours along u
//! and along v.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};

/// Eigenvectors of the Laplacians LᵀL of all grids: the constants as columns, and all others
/// divided by the root of their eigenvalue 4 sin²(πa/2nu) + 4 sin²(πb/2nv). On a line of n elements
/// mode a is cos(πa(i + ½)/n), normalised.
pub(super) fn modes(grids: &[[usize; 2]]) -> (DMatrix<f64>, DMatrix<f64>) {
    let elements: usize = grids.iter().map(|[nu, nv]| nu * nv).sum();
    let wave = |mode: usize, n: usize, i: usize| {
        let (scale, n) = (if mode == 0 { 1.0f64 } else { 2.0 }, n as f64);
        (scale / n).sqrt() * libm::cos(PI * mode as f64 * (i as f64 + 0.5) / n)
    };
    let root = |mode: usize, n: usize| 2.0 * libm::sin(0.5 * PI * mode as f64 / n as f64);
    let mut constants = Vec::with_capacity(grids.len());
    let mut smooth = Vec::with_capacity(elements - grids.len());
    let mut first = 0;
    for &[nu, nv] in grids {
        for mode in 0..nu * nv {
            let (a, b) = (mode % nu, mode / nu);
            let mut column = DVector::zeros(elements);
            for i in 0..nu * nv {
                column[first + i] = wave(a, nu, i % nu) * wave(b, nv, i / nu);
            }
            if mode == 0 {
                constants.push(column);
            } else {
                smooth.push(column / libm::hypot(root(a, nu), root(b, nv)));
            }
        }
        first += nu * nv;
    }
    (
        DMatrix::from_columns(&constants),
        DMatrix::from_columns(&smooth),
    )
}

/// The difference operator L of one grid as it is written down: a row of −1, +1 for every pair of
/// neighbours.
#[cfg(test)]
pub(super) fn differences([nu, nv]: [usize; 2]) -> DMatrix<f64> {
    let mut rows = Vec::new();
    for i in 0..nu * nv {
        for (step, inside) in [(1, i % nu + 1 < nu), (nu, i / nu + 1 < nv)] {
            if inside {
                let mut row = nalgebra::RowDVector::zeros(nu * nv);
                (row[i], row[i + step]) = (-1.0, 1.0);
                rows.push(row);
            }
        }
    }
    DMatrix::from_rows(&rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_modes_are_those_of_the_differences() {
        for grid in [[4, 3], [5, 1], [1, 6]] {
            let laplacian = differences(grid).tr_mul(&differences(grid));
            let (constants, smooth) = modes(&[grid]);
            assert!((&laplacian * constants).amax() < 1e-14);
            let n = grid[0] * grid[1];
            let identity = smooth.transpose() * laplacian * smooth;
            assert!((identity - DMatrix::identity(n - 1, n - 1)).amax() < 1e-13);
        }
        // Two grids know nothing of each other.
        let (constants, smooth) = modes(&[[2, 2], [3, 1]]);
        assert_eq!((constants.ncols(), smooth.ncols()), (2, 5));
        assert!(constants.column(0).rows(4, 3).amax() == 0.0);
    }
}
