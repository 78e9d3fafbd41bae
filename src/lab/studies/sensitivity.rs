//! What photographs say of each element, before any prior: their sensitivities, and triangles that
//! say the same.

use nalgebra::DVector;
use rayon::prelude::*;

use crate::lab::error::LabError;
use crate::matrix::Matrix;
use crate::model::MatrixModel;
use crate::num::linalg::{columns_times, triangle};

/// Triangles that are joined at once.
const TOGETHER: usize = 16;

/// A_l\[p,j\] = ∂Φcam\[p,l\]/∂ρ_j of spot `l`, pixels × elements, W.
pub(super) fn sensitivity(model: &MatrixModel, l: usize) -> Matrix {
    match &model.factors {
        None => {
            let lit: Vec<f64> = model.laser_side.column(l).iter().copied().collect();
            columns_times(model.camera_side.clone(), &lit)
        }
        Some(factors) => factors.terms.frame(l, model.albedo.len()),
    }
}

/// R of J = Q R, min(rows, n) × n: JᵀJ = RᵀR.
///
/// # Errors
/// [`LabError::Linalg`].
pub(super) fn reduced(j: &Matrix) -> Result<Matrix, LabError> {
    Ok(triangle(j, &DVector::zeros(j.nrows()))?.r)
}

/// R of `count` matrices J_l of n columns one below the other. They are joined along a fixed tree,
/// whatever the threads; condition is never squared.
///
/// # Errors
/// [`LabError::Linalg`].
pub(super) fn stacked(
    count: usize,
    of: impl Fn(usize) -> Matrix + Sync,
) -> Result<Matrix, LabError> {
    let each: Result<Vec<Matrix>, LabError> = (0..count)
        .into_par_iter()
        .map(|l| reduced(&of(l)))
        .collect();
    joined(each?)
}

/// The same of triangles.
///
/// # Errors
/// [`LabError::Linalg`].
pub(super) fn joined(mut triangles: Vec<Matrix>) -> Result<Matrix, LabError> {
    while triangles.len() > 1 {
        let join = |some: &[Matrix]| {
            let n = some[0].ncols();
            let mut all = Matrix::zeros(some.iter().map(Matrix::nrows).sum(), n);
            let mut from = 0;
            for one in some {
                all.rows_mut(from, one.nrows()).copy_from(one);
                from += one.nrows();
            }
            reduced(&all)
        };
        let next: Result<Vec<Matrix>, LabError> =
            triangles.par_chunks(TOGETHER).map(join).collect();
        triangles = next?;
    }
    Ok(triangles.pop().unwrap_or_else(|| Matrix::zeros(0, 0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Kernel;
    use crate::scene::Scene;

    /// Φcam is linear in ρ: A_l ρ is its column, past the edge of an occluder too; and 40 matrices
    /// one below the other have the Gram matrix of their triangle.
    #[test]
    fn sensitivities_give_photographs_and_triangles_their_squares() {
        for name in ["thesis", "periscope"] {
            let mut scene = Scene::load(name).unwrap();
            (scene.camera.columns, scene.camera.rows) = (3, 2);
            scene.laser.spots.truncate(2);
            let model = MatrixModel::new(&scene, Kernel::Physical, Some([2; 2])).unwrap();
            assert_eq!(model.factors.is_some(), name == "periscope");
            let phi = model.phi();
            let last = phi.ncols() - 1;
            let rho = DVector::from_column_slice(&model.albedo);
            let off = (sensitivity(&model, last) * rho - phi.column(last)).amax();
            assert!(off < 1e-12 * phi.amax(), "{name}: {off:e}");
        }
        let one = |l: usize| Matrix::from_fn(3, 4, |i, j| ((7 * i + 3 * j + l) % 11) as f64);
        let gram = (0..40).fold(Matrix::zeros(4, 4), |sum, l| {
            sum + one(l).transpose() * one(l)
        });
        let found = stacked(40, one).unwrap();
        let off = (found.transpose() * &found - &gram).amax();
        assert!(
            found.shape() == (4, 4) && off < 1e-12 * gram.amax(),
            "{off:e}"
        );
    }
}
