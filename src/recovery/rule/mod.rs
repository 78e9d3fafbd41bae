//! Rules that choose a regularisation parameter from the data and what is known of their noise.

pub(super) mod discrepancy;
pub(super) mod gcv;
pub(super) mod l_curve;

use super::{Problem, Spectrum};
use crate::num::linalg::{product, subtract_product};

/// What projections round, relative to Φ.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Φ in the directions of a spectrum: all that residual and solution depend on.
pub(in crate::recovery) struct Data<'s> {
    spectrum: &'s Spectrum,
    /// ‖Φ v_i‖², and what lies outside all v_i.
    along: Vec<f64>,
    outside: f64,
    /// Rows and columns of Φ.
    pixels: f64,
    spots: f64,
}

impl<'s> Data<'s> {
    pub(in crate::recovery) fn new(problem: &Problem<'_>, spectrum: &'s Spectrum) -> Self {
        let coordinates = product(problem.phi, &spectrum.data.transpose());
        let mut outside = problem.phi.clone();
        subtract_product(&mut outside, &coordinates, &spectrum.data);
        // Of no more spots than directions nothing lies outside but this.
        let rounding = ROUNDING * problem.phi.norm();
        Data {
            spectrum,
            outside: if outside.norm() > rounding {
                outside.norm_squared()
            } else {
                0.0
            },
            along: coordinates
                .column_iter()
                .map(|c| c.norm_squared())
                .collect(),
            pixels: problem.phi.nrows() as f64,
            spots: problem.phi.ncols() as f64,
        }
    }

    /// ‖Φ P − Φ‖² for filter factors f_i on all directions, P = Σ f_i v_i v_iᵀ.
    fn residual(&self, filter: &[f64]) -> f64 {
        let missed = self.along.iter().zip(filter);
        self.outside + missed.map(|(z, f)| z * (1.0 - f) * (1.0 - f)).sum::<f64>()
    }

    /// Square of what is penalised: ‖X‖², or ‖X diag(c̄)⁻¹ Lᵀ‖² of `tikhonov-gradient`; Σ
    /// (f_i/σ_i)² ‖Φ v_i‖² over the directions that are filtered.
    fn penalty(&self, filter: &[f64]) -> f64 {
        let free = self.spectrum.free;
        let directions = self.along[free..].iter().zip(&filter[free..]);
        directions
            .zip(self.spectrum.filtered())
            .map(|((z, f), s)| z * (f / s) * (f / s))
            .sum()
    }
}
