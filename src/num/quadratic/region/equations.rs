//! The equations of a step.

use nalgebra::{DMatrix, DVector};

use super::Region;
use super::state::{State, over};
use crate::num::linalg::{Cholesky, columns_over, gram_product};

/// The equations of a step at a point,
///
/// > (Θ + Rᵀ V R) Δx = b,   Θ = z/y + w/s,   V = m (1 + e eᵀ/g),
///
/// solved by k × k equations for u = V R Δx: k³/3 + k² n multiplications.
pub(super) struct Equations {
    theta: DVector<f64>,
    /// V⁻¹ + R Θ⁻¹ Rᵀ.
    inner: Cholesky,
}

impl Equations {
    pub(super) fn new(region: &Region<'_>, state: &State) -> Option<Self> {
        let State { y, s, z, w, e, .. } = state;
        let theta = DVector::from_fn(y.len(), |j, _| z[j] / y[j] + over(w[j], s[j]));
        let k = region.r.nrows();
        let mut inner = DMatrix::from_diagonal_element(k, k, 1.0 / state.m);
        inner.ger(-1.0 / (state.m * (state.g + e.norm_squared())), e, e, 1.0);
        let scaled = columns_over(region.r.clone(), &theta.map(f64::sqrt));
        gram_product(&mut inner, &scaled.transpose());
        let inner = Cholesky::new(&inner)?;
        Some(Self { theta, inner })
    }

    /// Δx.
    pub(super) fn solve(&self, r: &DMatrix<f64>, b: &DVector<f64>) -> DVector<f64> {
        let u = self.inner.solve(&(r * b.component_div(&self.theta)));
        (b - r.tr_mul(&u)).component_div(&self.theta)
    }
}
