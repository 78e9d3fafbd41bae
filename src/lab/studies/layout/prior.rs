//! What is known of the picture before the photographs.

use crate::lab::error::LabError;
use crate::lab::problem::problem;
use crate::matrix::Matrix;
use crate::model::MatrixModel;
use crate::num::digits::figure;
use crate::num::linalg::Cholesky;
use crate::recovery::Exponential;

/// Names on the command line, with what they mean.
pub(super) const PRIORS: &[(&str, &str)] = &[
    (
        "smooth",
        "Neighbours are alike: covariance τ² exp(−distance/length)",
    ),
    ("white", "Every element by itself: covariance τ² 1"),
];

/// A normal prior of the reflectances about ½, of covariance K.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Prior {
    /// Standard deviation τ of a reflectance.
    pub deviation: f64,
    /// Length over which it varies; none where elements are independent.
    pub length: Option<f64>,
}

impl Prior {
    /// What it is, in words.
    pub(super) fn told(&self, unit: &str) -> String {
        let deviation = figure(self.deviation, 3);
        match self.length {
            None => format!("white, of deviation {deviation}"),
            Some(length) => {
                let length = figure(length, 3);
                format!("smooth, of deviation {deviation} and length {length} {unit}")
            }
        }
    }

    /// L of K = L Lᵀ, elements × elements.
    ///
    /// # Errors
    /// [`LabError::Unsuited`] where K is singular to rounding.
    pub(super) fn factor(&self, model: &MatrixModel) -> Result<Matrix, LabError> {
        let n = model.albedo.len();
        let Some(length) = self.length else {
            return Ok(Matrix::identity(n, n) * self.deviation);
        };
        let phi = Matrix::zeros(model.camera_side.nrows(), model.laser_side.ncols());
        let grids: Vec<[usize; 2]> = model.grids.iter().map(|grid| grid.count).collect();
        let problem = problem(model, &phi, None)?.with_grids(&grids)?;
        let problem = problem.with_places(&model.places)?;
        let alike = Exponential::new(&problem).matrix(length);
        let factor = Cholesky::new(&alike).ok_or(LabError::Unsuited(
            "the prior cannot tell elements apart; use a smaller --length or fewer --elements",
        ))?;
        Ok(factor.lower() * self.deviation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Kernel;
    use crate::scene::Scene;

    /// On the thesis' 2 × 2 elements neighbours are 2 in. apart, others 2√2: K by hand.
    #[test]
    fn covariances_by_hand() {
        let scene = Scene::load("thesis").unwrap();
        let model = MatrixModel::new(&scene, Kernel::Physical, Some([2; 2])).unwrap();
        let of = |length| {
            let deviation = 0.5;
            let l = Prior { deviation, length }.factor(&model).unwrap();
            &l * l.transpose()
        };
        assert_eq!(of(None), Matrix::identity(4, 4) * 0.25);
        let k = of(Some(3.0));
        let alike = |d: f64| 0.25 * libm::exp(-d / 3.0);
        for (at, d) in [
            ((0, 0), 0.0),
            ((0, 1), 2.0),
            ((0, 2), 2.0),
            ((0, 3), 8f64.sqrt()),
        ] {
            assert!((k[at] - alike(d)).abs() < 1e-12, "{at:?}: {}", k[at]);
        }
    }
}
