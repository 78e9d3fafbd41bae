//! What each frame says of the geometry where only the others are fitted.
//!
//! With picture and geometry fitted to it as well a frame seems to say less than it does. Without
//! frame c of m the estimate is, to first order (Cook 1977; CR3 of MacKinnon and White 1985),
//!
//! > θ − θ_(c) = (F + Λ)⁻¹ B⊥_cᵀ (1 − H_c)⁻¹ r_c,   H_c = G Gᵀ,   G = (A P^½  B⊥ (F + Λ)^−½)_c
//!
//! with r_c what is left of the frame: H_c is what of it the fit takes. (1 − G Gᵀ)⁻¹ r = r + G (1 −
//! GᵀG)⁻¹ Gᵀ r.

use rayon::prelude::*;

use super::descent::{Problem, State};
use super::posterior::Columns;
use crate::lab::error::LabError;
use crate::matrix::Matrix;
use crate::num::linalg::{Cholesky, product, tr_product};

impl Problem<'_> {
    /// √((m − 1)/m) B⊥_cᵀ (1 − H_c)⁻¹ r_c of every frame, unknowns × frames; of a frame that alone
    /// tells something its score as it is.
    pub(super) fn by_frames(
        &self,
        best: &State,
        information: &Cholesky,
    ) -> Result<Matrix, LabError> {
        let seen = self.seen(best.factor);
        let light = self.light(&best.values, self.relative(best.factor), true)?;
        let (rho, covariance) = (&best.value.rho, &best.slope.covariance);
        let columns = seen.columns(&light, rho, covariance, self.unknowns())?;
        let half = best.value.factor.forward(best.prior.root.transpose());
        let of = |(l, own): (usize, &Columns)| -> Result<_, LabError> {
            let [y, a] = seen.frame(&light, l)?;
            let left = y.column(0) - &a * rho;
            let b = &own.b - product(&a, &best.slope.shift);
            let of_picture = product(&a, &half.transpose());
            let of_geometry = information.forward(b.transpose()).transpose();
            let fitted = beside(&of_picture, &of_geometry);
            let kept =
                Matrix::identity(fitted.ncols(), fitted.ncols()) - tr_product(&fitted, &fitted);
            let mut score = b.tr_mul(&left);
            if let Some(kept) = Cholesky::new(&kept) {
                let back = kept.solve(&fitted.tr_mul(&left));
                score += tr_product(&b, &fitted) * back;
            }
            Ok(score)
        };
        let scores: Vec<_> = columns
            .par_iter()
            .enumerate()
            .map(of)
            .collect::<Result<_, _>>()?;
        let m = scores.len() as f64;
        Ok(Matrix::from_columns(&scores) * ((m - 1.0) / m).sqrt())
    }
}

/// The columns of both.
fn beside(a: &Matrix, b: &Matrix) -> Matrix {
    let all: Vec<_> = a.column_iter().chain(b.column_iter()).collect();
    Matrix::from_columns(&all)
}
