//! Photographs without other light and in the model's unit, ready to be tested.
//!
//! > Φ' = (Φ − Σ_k f_kl F)/s with the standard errors σ/s,
//!
//! s and f as of [`Eliminated`].

use super::eliminated::Eliminated;
use super::evidence::{Evidence, Test};
use super::residual::{Residual, Weights};
use crate::matrix::Matrix;
use crate::num::linalg::LinalgError;

/// What is fitted to the photographs before they are tested.
#[derive(Clone, Copy, Debug, Default)]
pub struct OtherLight<'a> {
    /// Patterns of other light, pixels × patterns, any unit, each with a strength of its own in
    /// each frame.
    pub patterns: Option<&'a Matrix>,
    /// Whether the photographs' unit per W is not known.
    pub is_scale_free: bool,
}

/// Photographs as the terms leave them.
#[derive(Debug)]
pub(super) struct Left {
    /// Φ', W.
    pub phi: Matrix,
    /// σ/s, W.
    pub stderr: Matrix,
    /// s with its standard error and its deviate from 0; none where it is known to be 1.
    pub scale: Option<[f64; 3]>,
    /// ‖Σ f F‖/‖Φ‖ over the entries that count.
    pub other: f64,
    /// What was taken out.
    pub eliminated: Eliminated,
}

impl OtherLight<'_> {
    /// Whether anything is fitted.
    pub(super) fn is_some(&self) -> bool {
        self.patterns.is_some() || self.is_scale_free
    }

    /// Takes it out of `evidence`, whose model is M. None if the patterns could be all of the
    /// model's light.
    pub(super) fn taken_out(
        &self,
        evidence: &Evidence<'_>,
        test: Test,
    ) -> Result<Option<Left>, LinalgError> {
        let (phi, model) = (evidence.traced, evidence.model);
        let roots = Residual::new(*evidence, test, Weights::Smoothed).roots();
        let found = Eliminated::new(roots, self.patterns, model, self.is_scale_free)?;
        let Some(eliminated) = found else {
            return Ok(None);
        };
        let scale = self
            .is_scale_free
            .then(|| scale(evidence, test, &eliminated));
        let s = scale.map_or(1.0, |[s, ..]| s);
        let rest = eliminated.without(&(phi - model));
        let other = phi - model * s - &rest;
        let norm = |m: &Matrix| {
            let counted = m.iter().enumerate().filter(|(i, _)| eliminated.counts(*i));
            counted.map(|(_, x)| x * x).sum::<f64>().sqrt()
        };
        Ok(Some(Left {
            other: norm(&other) / norm(phi),
            phi: model + rest / s,
            stderr: evidence.stderr / s,
            scale,
            eliminated,
        }))
    }
}

/// s with its standard error and its deviate from 0: the fit of what the patterns leave of M to
/// what they leave of Φ.
fn scale(evidence: &Evidence<'_>, test: Test, eliminated: &Eliminated) -> [f64; 3] {
    let [phi, model] = [evidence.traced, evidence.model].map(|m| eliminated.without_patterns(m));
    let dark = &model * 0.0;
    let own = Evidence {
        traced: &phi,
        model: &dark,
        bound: None,
        ..*evidence
    };
    let fit = Residual::new(own, test, Weights::Smoothed).fit(&model, &(0..phi.ncols()));
    fit.map_or([0.0; 3], |fit| [fit.value, fit.stderr, fit.z()])
}

#[cfg(test)]
mod tests;
