//! What the unknowns may be by other priors of the picture.
//!
//! Spread and length of the picture are the likeliest of a few ([`Prior`]). Where photographs
//! hardly tell them, others explain these as well with another geometry: of a board in black and
//! white few entries are likeliest from a grey one that stands elsewhere. From the estimate θ̂
//! one Newton step by prior k leads to
//!
//! > θ_k = θ̂ − C_k s_k,   C_k = (F_k + Λ)⁻¹,   ln p(y|k) = −cost_k + ½ s_kᵀC_k s_k + ½ ln det C_k
//!
//! (Laplace's approximation), and (C_k)_jj + (θ_k − θ̂)_j² is the square of an error. The largest
//! counts, of all priors that the photographs do not exclude.

use nalgebra::DVector;

use super::descent::{Problem, State};
use super::edge::AtEdge;
use super::geometry::Light;
use super::picture::Prior;
use crate::lab::error::LabError;
use crate::num::linalg::Cholesky;

/// ln of how many times less likely an excluded prior is than the likeliest: 10⁴. Of boards in
/// black and white the right one was up to e⁸ less likely than a grey one.
const EXCLUDED: f64 = 9.2;
/// What a step may make likelier at most: five standard errors.
const STEP: f64 = 12.5;

impl Problem<'_> {
    /// The error of every unknown, by the light at the estimate. Of those that an edge of the scene
    /// holds the slope that they have there is no other picture's.
    pub(super) fn by_pictures(
        &self,
        best: &State,
        light: &Light,
        held: &[AtEdge],
    ) -> Result<DVector<f64>, LabError> {
        let normal = self.seen(best.factor).normal(light)?;
        let margin = EXCLUDED + STEP;
        let own = self.whole_slope(best);
        let tried = Prior::plausible(self.pictures, &normal, self.is_scale_free, margin)?;
        let mut all: Vec<(f64, DVector<f64>)> = Vec::new();
        for prior in tried {
            let state = self.state_by((&best.values, best.factor), (light, &normal), prior)?;
            let mut slope = self.whole_slope(&state);
            held.iter().for_each(|h| slope[h.index] -= own[h.index]);
            let Some(information) = Cholesky::new(&self.information(&state.slope)) else {
                continue;
            };
            let covariance = information.inverse();
            let step = &covariance * &slope;
            let gain = 0.5 * slope.dot(&step) - 0.5 * information.log_det();
            let squares = covariance.diagonal() + step.component_mul(&step);
            all.push((gain - state.value.cost, squares));
        }
        let most = all.iter().map(|(log, _)| *log);
        let most = most.fold(f64::NEG_INFINITY, f64::max);
        let open = all.iter().filter(|(log, _)| *log > most - EXCLUDED);
        let none = DVector::zeros(self.unknowns());
        let largest = open.fold(none, |sum, (_, squares)| sum.zip_map(squares, f64::max));
        Ok(largest.map(f64::sqrt))
    }
}
