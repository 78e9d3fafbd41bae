//! What photographs say of a picture about which nothing is known: of an even grey surface.
//!
//! The photographs are those of ρ = ½ everywhere, with the noise of a law. A = ∂Φ/∂ρ in units of
//! that noise at level 1 has singular values s_k. A direction of the picture with the standard
//! deviation τ = ½ of the prior is above a noise ε where τ s_k > ε, and of its prior variance the
//! share 1/(1 + (τ s_k/ε)²) is left.

use crate::lab::error::LabError;
use crate::lab::finding::Column;
use crate::lab::problem::problem;
use crate::lab::uncertainty::noise_law::NoiseLaw;
use crate::matrix::Matrix;
use crate::model::MatrixModel;
use crate::num::digits::figure;
use crate::recovery::{Options, WeightRule, determined, picard_joint};

/// Standard deviation of the prior, about ½.
const BEFORE: f64 = 0.5;

/// Noise levels at which directions are counted.
pub(super) const LEVELS: [f64; 4] = [0.1, 0.01, 1e-3, 1e-4];

/// Photographs of a grey surface.
#[derive(Debug)]
pub(super) struct Grey<'a> {
    model: &'a MatrixModel,
    noise: NoiseLaw,
    phi: Matrix,
}

impl<'a> Grey<'a> {
    pub(super) fn new(model: &'a MatrixModel, noise: NoiseLaw) -> Self {
        let phi = model.phi_of(&vec![BEFORE; model.albedo.len()]);
        Self { model, noise, phi }
    }

    /// Whether no light of the surface comes into view: the photographs then tell nothing.
    fn is_dark(&self) -> bool {
        self.phi.amax() == 0.0
    }

    /// How many directions of the picture are above a noise of 10 %, 1 %, 0.1 %, 0.01 %.
    ///
    /// # Errors
    /// [`LabError::Recovery`].
    pub(super) fn directions(&self) -> Result<Vec<usize>, LabError> {
        if self.is_dark() {
            return Ok(vec![0; LEVELS.len()]);
        }
        // By the least noise: what is lost below a larger one would be counted out.
        let least = LEVELS[LEVELS.len() - 1];
        let stderr = self.noise.stderrs(&self.phi, least);
        let problem = problem(self.model, &self.phi, Some(&stderr))?;
        let by_entry = Options {
            weighting: WeightRule::Entries,
            ..Options::default()
        };
        let sigma = picard_joint(&problem, &by_entry)?.sigma;
        let above = |level: &f64| {
            let signals = sigma.iter().map(|s| s * BEFORE * least);
            signals.filter(|signal| signal > level).count()
        };
        Ok(LEVELS.iter().map(above).collect())
    }

    /// Share of the prior variance of an element that is left at a noise of `level`, the mean over
    /// the elements.
    ///
    /// # Errors
    /// [`LabError::Recovery`].
    pub(super) fn risk(&self, level: f64) -> Result<f64, LabError> {
        if self.is_dark() {
            return Ok(1.0);
        }
        let stderr = self.noise.stderrs(&self.phi, level);
        let shares = determined(&problem(self.model, &self.phi, Some(&stderr))?)?;
        Ok(1.0 - shares.rank / self.model.albedo.len() as f64)
    }
}

/// Columns of a table for [`Grey::directions`] and [`Grey::risk`].
pub(super) fn columns() -> impl Iterator<Item = Column> {
    let above = |level: &f64| {
        let name = format!("above {} %", figure(100.0 * level, 1));
        Column::text(&name, &format!("directions_{level:e}"))
    };
    let risk = Column::number("risk", "risk", "", 2);
    LEVELS.iter().map(above).chain([risk])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::linalg::svd;

    /// Sides whose light hangs together over neighbours: singular values of all rows written out
    /// fall to 3e-6 of the largest, of which the squares are rounding, and still count.
    #[test]
    fn directions_are_those_of_all_rows() {
        let (pixels, n, spots) = (240, 14, 120);
        let near = |a: f64, b: usize| libm::exp(-(a - b as f64) * (a - b as f64) / 14.0);
        let along = |k: usize, of: usize| (n * k) as f64 / of as f64;
        let camera = Matrix::from_fn(pixels, n, |p, j| near(along(p, pixels), j));
        let laser = Matrix::from_fn(n, spots, |j, l| 1.0 + near(along(l, spots), j));
        let model = MatrixModel::of_sides(camera, laser, [n, 1]).unwrap();
        for noise in [NoiseLaw::Relative, NoiseLaw::Read] {
            let grey = Grey::new(&model, noise);
            let stderr = noise.stderrs(&grey.phi, 1.0);
            let rows = Matrix::from_fn(pixels * spots, n, |row, j| {
                let (p, l) = (row % pixels, row / pixels);
                model.camera_side[(p, j)] * model.laser_side[(j, l)] / stderr[(p, l)]
            });
            let sigma = svd(&rows).unwrap().sigma;
            let above = |level: &f64| sigma.iter().filter(|s| 0.5 * **s > *level).count();
            let expected: Vec<usize> = LEVELS.iter().map(above).collect();
            assert_eq!(grey.directions().unwrap(), expected, "{sigma}");
            assert!(sigma[n - 1] < 5e-6 * sigma[0], "{sigma}");
        }
    }
}
