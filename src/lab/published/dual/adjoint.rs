//! Transposes in the place of inverses.
//!
//! Both are exact where the columns that are correlated with Φ are orthogonal, for then a matrix is
//! inverted by its transpose and a scale.

use crate::matrix::Matrix;

/// The published inversion with G12ᵀ in place of G12⁺: Φ Dᵀ ⊘ C, each element by Σ_l D\[j,l\]²,
/// mean over the pixels (`c` pixels × elements, `d` elements × spots).
pub(super) fn laser_side(phi: &Matrix, c: &Matrix, d: &Matrix) -> Vec<f64> {
    let back = (phi * d.transpose()).component_div(c).row_mean();
    let own = d.row_iter().map(|row| row.norm_squared());
    back.iter().zip(own).map(|(x, own)| x / own).collect()
}

/// Back projection over pixels and spots: Σ_pl C\[p,j\] Φ\[p,l\] D\[j,l\] by Σ_pl (C\[p,j\]
/// D\[j,l\])².
pub(super) fn both_sides(phi: &Matrix, c: &Matrix, d: &Matrix) -> Vec<f64> {
    let along = (c.transpose() * phi).component_mul(d).column_sum();
    let own = c
        .column_iter()
        .zip(d.row_iter())
        .map(|(c, d)| c.norm_squared() * d.norm_squared());
    along.iter().zip(own).map(|(x, own)| x / own).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn phi(c: &Matrix, rho: &[f64], d: &Matrix) -> Matrix {
        let rho = Matrix::from_diagonal(&nalgebra::DVector::from_row_slice(rho));
        c * rho * d
    }

    /// Orthogonal rows of D: (1, 1)·(1, −1) = 0. Transposing inverts.
    #[test]
    fn orthogonal_patterns_are_inverted_by_their_transpose() {
        let c = Matrix::from_row_slice(2, 2, &[1.0, 2.0, 3.0, 5.0]);
        let d = Matrix::from_row_slice(2, 2, &[2.0, 2.0, 3.0, -3.0]);
        let phi = phi(&c, &[0.25, 0.75], &d);
        for found in [laser_side(&phi, &c, &d), both_sides(&phi, &c, &d)] {
            assert!((found[0] - 0.25).abs() < 1e-15 && (found[1] - 0.75).abs() < 1e-15);
        }
    }

    /// C = (1 1), D rows (1, 1) and (1, 0), ρ = (1, 0): Φ = (1, 1). ΦDᵀ = (2, 1), by Σ D² = (2, 1):
    /// the dark element comes out as light as the other.
    #[test]
    fn other_patterns_are_not() {
        let c = Matrix::from_row_slice(1, 2, &[1.0, 1.0]);
        let d = Matrix::from_row_slice(2, 2, &[1.0, 1.0, 1.0, 0.0]);
        let phi = phi(&c, &[1.0, 0.0], &d);
        assert_eq!(laser_side(&phi, &c, &d), [1.0, 1.0]);
        assert_eq!(both_sides(&phi, &c, &d), [1.0, 1.0]);
    }
}
