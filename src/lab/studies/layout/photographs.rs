//! What the photograph of a spot says of the picture, wherever the spot is.

use rayon::prelude::*;

use crate::lab::error::LabError;
use crate::lab::studies::sensitivity::{reduced, sensitivity};
use crate::lab::uncertainty::noise_law::NoiseLaw;
use crate::matrix::Matrix;
use crate::model::{Kernel, MatrixModel, Occlusion};
use crate::num::linalg::product;
use crate::scene::Scene;
use crate::transport::Control;

use super::unsure::Unsure;

/// Mean of the prior.
pub(super) const GREY: f64 = 0.5;

/// What is the same for the photographs of all spots.
#[derive(Clone, Debug)]
pub(super) struct Photographs {
    pub scene: Scene,
    pub elements: Option<[usize; 2]>,
    pub noise: NoiseLaw,
    pub level: f64,
    /// The brightest entry of the scene's own photographs of a grey surface, W: what shot and read
    /// noise are shares of.
    pub top: f64,
    /// L of the prior K = L Lᵀ.
    pub factor: Matrix,
    /// What of the geometry is known only roughly.
    pub unsure: Vec<Unsure>,
}

impl Photographs {
    /// For the spot at each place the triangle R, min(pixels, n) × n, of its photograph in standard
    /// deviations of noise and prior,
    ///
    /// > RᵀR = \[Lᵀ Aᵀ; σ_θ ∂φᵀ/∂θ\] Σ⁻¹ \[A L, ∂φ/∂θ σ_θ\],   A = C diag(d),  φ = A ½,
    ///
    /// θ what is unsure. None where a photograph is dark.
    ///
    /// # Errors
    /// [`LabError`], also where a place is not on the wall.
    pub(super) fn triangles(
        &self,
        places: &[[f64; 2]],
        control: Control<'_>,
    ) -> Result<Vec<Option<Matrix>>, LabError> {
        if places.is_empty() {
            return Ok(Vec::new());
        }
        let scene = self.scene.with_spots_at(places)?;
        let model = self.model(&scene)?;
        let slopes = self.slopes(&scene)?;
        let r = model.albedo.len();
        let one = |l: usize| -> Result<Option<Matrix>, LabError> {
            control.check()?;
            let a = sensitivity(&model, l);
            let grey = a.column_sum() * GREY;
            if grey.amax() <= 0.0 {
                return Ok(None);
            }
            let mut j = Matrix::zeros(a.nrows(), r + slopes.len());
            j.columns_mut(0, r).copy_from(&product(&a, &self.factor));
            for (k, slope) in slopes.iter().enumerate() {
                j.column_mut(r + k).copy_from(&slope.column(l));
            }
            for (mut row, grey) in j.row_iter_mut().zip(grey.iter()) {
                row /= self.level * self.noise.stderr(*grey, self.top);
            }
            Ok(Some(reduced(&j)?))
        };
        (0..places.len()).into_par_iter().map(one).collect()
    }

    /// σ_θ ∂φ/∂θ of a grey surface for each θ, pixels × spots, W.
    fn slopes(&self, scene: &Scene) -> Result<Vec<Matrix>, LabError> {
        let grey = |scene: &Scene| -> Result<Matrix, LabError> {
            // These are held at once.
            let model = MatrixModel::new(scene, Kernel::Physical, self.elements)?;
            Ok(model.phi_of(&vec![GREY; model.albedo.len()]))
        };
        self.unsure.iter().map(|u| u.slope(scene, grey)).collect()
    }

    fn model(&self, scene: &Scene) -> Result<MatrixModel, LabError> {
        let (kernel, elements) = (Kernel::Physical, self.elements);
        let considered = Occlusion::Considered;
        Ok(MatrixModel::without_photographs(
            scene, kernel, elements, considered,
        )?)
    }
}
