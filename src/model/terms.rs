//! Matrices as products of few terms.

use super::error::ModelError;
use crate::matrix::Matrix;
use crate::num::linalg::svd;

/// Terms less than this share of an element's largest are left out.
const NEGLIGIBLE: f64 = 1e-6;
/// The terms of the elements one behind the other, and the element of each.
pub(super) fn stacked(
    all: &[(&Matrix, &Matrix)],
    (pixels, spots): (usize, usize),
) -> (Matrix, Matrix, Vec<usize>) {
    let element: Vec<usize> = (0..all.len())
        .flat_map(|j| std::iter::repeat_n(j, all[j].1.nrows()))
        .collect();
    let mut camera = Matrix::zeros(pixels, element.len());
    let mut laser = Matrix::zeros(element.len(), spots);
    let mut at = 0;
    for (c, d) in all {
        let count = d.nrows();
        camera.columns_mut(at, count).copy_from(c);
        laser.rows_mut(at, count).copy_from(d);
        at += count;
    }
    (camera, laser, element)
}

/// C D with as few terms as carry it: D = U Σ Vᵀ, C U Σ = U′ Σ′ V′ᵀ, C D = (U′ Σ′)(V′ᵀ Vᵀ).
pub(super) fn compressed(c: &Matrix, d: &Matrix) -> Result<(Matrix, Matrix), ModelError> {
    let nothing = (Matrix::zeros(c.nrows(), 0), Matrix::zeros(0, d.ncols()));
    if c.amax() == 0.0 || d.amax() == 0.0 {
        return Ok(nothing);
    }
    let kept = |sigma: &[f64]| {
        sigma
            .iter()
            .take_while(|s| **s > NEGLIGIBLE * sigma[0])
            .count()
    };
    let right = svd(d)?;
    let n = kept(right.sigma.as_slice());
    let scaled = Matrix::from_fn(d.nrows(), n, |q, k| right.u[(q, k)] * right.sigma[k]);
    let left = svd(&(c * scaled))?;
    if left.sigma[0] == 0.0 {
        return Ok(nothing);
    }
    let r = kept(left.sigma.as_slice());
    let camera = Matrix::from_fn(c.nrows(), r, |p, k| left.u[(p, k)] * left.sigma[k]);
    Ok((camera, left.vt.rows(0, r) * right.vt.rows(0, n)))
}
