//! All photographs as one system of equations.
//!
//! Photograph l has a view of its own, and so a G23 of its own:
//!
//! > Φ\[p,l\] = Σ_j C_l\[p,j\] ρ_j D\[j,l\],   one row (p, l) of K for each pixel of each photograph,   K\[(p,l),j\] = C_l\[p,j\] D\[j,l\]
//!
//! With a fixed view C_l = C, K is the Khatri–Rao product of `joint`, and Φ = C diag(ρ) D can be
//! multiplied by D⁺ from the right. With a moving one no such product is left: a photograph by
//! itself sees D through one of its columns, whose pseudo-inverse has rank 1. What remains is least
//! squares over the rows of all photographs. To the recovery, which is blind, they are the pixels
//! of one photograph under one spot: C = K, D = 1.
//!
//! Rows are divided by the standard errors of their entries and compressed without loss: of K/σ = U
//! S Vᵀ only S Vᵀ and Uᵀ(Φ/σ) matter to least squares, and the noise of the latter is of unit
//! variance and independent like that of the rows.

use nalgebra::DVector;

use super::layout::{ELEMENTS, View};
use crate::lab::LabError;
use crate::matrix::Matrix;
use crate::model::{Kernel, MatrixModel};
use crate::num::linalg::{Svd, svd};
use crate::recovery::{Method, Options, Problem, Recovered, recover};
use crate::scene::Scene;

/// K, row p + l·pixels.
pub(super) struct System(Matrix);

impl System {
    /// Each element by `points` × `points` points, 1 for its centre.
    pub(super) fn new(
        scene: &Scene,
        view: View,
        kernel: Kernel,
        points: usize,
    ) -> Result<Self, LabError> {
        let fine = ELEMENTS * points;
        let block = |spot: usize| {
            let photograph = view.photograph(scene, spot)?;
            let model = MatrixModel::new(&photograph, kernel, Some([fine; 2]))?;
            let (c, d) = (&model.camera_side, &model.laser_side);
            let mut rows = Matrix::zeros(c.nrows(), ELEMENTS * ELEMENTS);
            for (point, (column, d)) in c.column_iter().zip(d.iter()).enumerate() {
                let element = point % fine / points + point / fine / points * ELEMENTS;
                rows.column_mut(element).axpy(*d, &column, 1.0);
            }
            Ok(rows)
        };
        let blocks: Vec<Matrix> = (0..scene.laser.spots.len())
            .map(block)
            .collect::<Result<_, LabError>>()?;
        let (pixels, elements) = blocks[0].shape();
        Ok(Self(Matrix::from_fn(
            pixels * blocks.len(),
            elements,
            |row, j| blocks[row / pixels][(row % pixels, j)],
        )))
    }

    /// Φ of the reflectances, entry p + l·pixels, W.
    pub(super) fn light(&self, rho: &[f64]) -> DVector<f64> {
        &self.0 * DVector::from_row_slice(rho)
    }

    /// Singular values of K, W.
    pub(super) fn sigma(&self) -> Result<Vec<f64>, LabError> {
        Ok(svd(&self.0)?.sigma.as_slice().to_vec())
    }

    /// Rows divided by `errors`, W.
    pub(super) fn weighted(&self, errors: &DVector<f64>) -> Result<Weighted, LabError> {
        let mut rows = self.0.clone();
        for (mut row, error) in rows.row_iter_mut().zip(errors.iter()) {
            row /= *error;
        }
        let Svd { u, sigma, vt, .. } = svd(&rows)?;
        let mut rows = vt;
        for (mut row, s) in rows.row_iter_mut().zip(sigma.iter()) {
            row *= *s;
        }
        Ok(Weighted {
            u,
            sigma: sigma.as_slice().to_vec(),
            all: Matrix::from_element(rows.ncols(), 1, 1.0),
            rows,
        })
    }
}

/// K/σ, compressed.
pub(super) struct Weighted {
    u: Matrix,
    /// Its singular values, one over the standard errors that ρ has along the singular directions.
    pub(super) sigma: Vec<f64>,
    /// S Vᵀ.
    rows: Matrix,
    /// D: every element is lit with 1.
    all: Matrix,
}

impl Weighted {
    /// Uᵀ of data divided by their errors.
    pub(super) fn along(&self, data: &DVector<f64>) -> DVector<f64> {
        self.u.tr_mul(data)
    }

    /// Directions of ρ that are known to better than 1 where every entry has `noise` times its
    /// error.
    pub(super) fn effective_rank(&self, noise: f64) -> usize {
        self.sigma.iter().filter(|s| **s > noise).count()
    }

    /// ρ from [`Weighted::along`] of data whose noise is `noise` times the errors.
    pub(super) fn recover(
        &self,
        method: Method,
        along: &DVector<f64>,
        noise: f64,
    ) -> Result<Recovered, LabError> {
        let phi = Matrix::from_column_slice(along.len(), 1, along.as_slice());
        let stderr = Matrix::from_element(along.len(), 1, noise);
        let problem = Problem::new(&phi, &self.rows, &self.all, Some(&stderr))?;
        Ok(recover(method, &problem, &Options::default())?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two photographs of one pixel each: C_1 = (1, 2), C_2 = (3, 1), D columns (2, 1) and (1, 4)
    /// make K rows (2, 2) and (3, 4). ρ = (1/2, 1/4) gives Φ = (3/2, 5/2).
    #[test]
    fn two_photographs_by_hand() {
        let system = System(Matrix::from_row_slice(2, 2, &[2.0, 2.0, 3.0, 4.0]));
        let phi = system.light(&[0.5, 0.25]);
        assert_eq!(phi.as_slice(), [1.5, 2.5]);
        // K Kᵀ has trace 33 and determinant 4.
        let sigma = system.sigma().unwrap();
        assert!((sigma[0] * sigma[1] - 2.0).abs() < 1e-14);
        assert!((sigma[0] * sigma[0] + sigma[1] * sigma[1] - 33.0).abs() < 1e-13);
        let errors = DVector::from_row_slice(&[0.5, 0.1]);
        let weighted = system.weighted(&errors).unwrap();
        let along = weighted.along(&phi.component_div(&errors));
        for method in [Method::JointUnbounded, Method::Joint] {
            let found = weighted.recover(method, &along, 1.0).unwrap().reflectance;
            assert!((found[0] - 0.5).abs() < 1e-13 && (found[1] - 0.25).abs() < 1e-13);
        }
        // K⁻¹ = (2 −1; −3/2 1): Var ρ_1 = 4·0.25 + 0.01, Var ρ_2 = 9/4·0.25 + 0.01.
        let found = weighted
            .recover(Method::JointUnbounded, &along, 1.0)
            .unwrap();
        let error = found.standard_error.unwrap();
        assert!((error[0] - 1.01f64.sqrt()).abs() < 1e-12);
        assert!((error[1] - 0.5725f64.sqrt()).abs() < 1e-12);
    }
}
