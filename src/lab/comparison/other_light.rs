//! Photographs without other light and in the model's unit, ready to be tested.
//!
//! > Φ' = M + T (Φ − s M)/s with the standard errors σ/s,
//!
//! T what the terms of [`Eliminated`] leave, and s its scale, 1 where it is known.

use super::eliminated::Eliminated;
use super::evidence::{Evidence, Test};
use super::residual::{Residual, Weights};
use crate::matrix::Matrix;
use crate::num::linalg::LinalgError;
use crate::recovery::{Gains, Nuisance};

/// Photographs as the terms leave them.
#[derive(Debug)]
pub(super) struct Left {
    /// Φ', W.
    pub phi: Matrix,
    /// σ/s, W.
    pub stderr: Matrix,
    /// s with its standard error and its deviate from 0; none where it is known to be 1.
    pub scale: Option<[f64; 3]>,
    /// ‖Σ f F + a‖/‖Φ‖ over the entries that count.
    pub other: f64,
    /// What was found of factors that are known roughly.
    pub gains: Option<Gains>,
    /// What was taken out.
    pub eliminated: Eliminated,
}

impl Left {
    /// Of `evidence`, whose model is M, with what is `beside` that. None if it could be all of the
    /// model's light.
    pub(super) fn of(
        evidence: &Evidence<'_>,
        test: Test,
        beside: &Nuisance<'_>,
    ) -> Result<Option<Self>, LinalgError> {
        let (phi, model) = (evidence.traced, evidence.model);
        let roots = Residual::new(*evidence, test, Weights::Least).roots();
        let Some(eliminated) = Eliminated::new(roots, beside, model)? else {
            return Ok(None);
        };
        let free = || scale(evidence, test, &eliminated, beside.frame_gain);
        let scale = beside.free_scale.then(free);
        let s = scale.map_or(1.0, |[s, ..]| s);
        let eliminated = eliminated.with_factors(beside, model, s)?;
        let off = phi - model * s;
        let (beside_free, rest, gains) = eliminated.split(&off);
        let other = &off - beside_free;
        let norm = |m: &Matrix| {
            let counted = m.iter().enumerate().filter(|(i, _)| eliminated.counts(*i));
            counted.map(|(_, x)| x * x).sum::<f64>().sqrt()
        };
        Ok(Some(Self {
            other: norm(&other) / norm(phi),
            phi: model + rest / s,
            stderr: evidence.stderr / s,
            scale,
            gains,
            eliminated,
        }))
    }
}

/// s with its standard error and its deviate from 0: the fit of what the patterns leave of M to
/// what they leave of Φ. Factors of the frames, known to σ_g, add s σ_g √Σ h², h the share of each
/// frame in the fit, to its error.
fn scale(
    evidence: &Evidence<'_>,
    test: Test,
    eliminated: &Eliminated,
    frame_gain: Option<f64>,
) -> [f64; 3] {
    let model = eliminated.without_others(evidence.model);
    // s is 1 and the fit of what is left: the weights are those of the model's light.
    let phi = evidence.model + eliminated.without_others(&(evidence.traced - evidence.model));
    let own = Evidence {
        traced: &phi,
        bound: None,
        ..*evidence
    };
    let residual = Residual::new(own, test, Weights::Least);
    let Some(mut fit) = residual.fit(&model, &(0..phi.ncols())) else {
        return [0.0; 3];
    };
    fit.value += 1.0;
    let roots = residual.roots();
    let [left, whole] = [&model, evidence.model].map(|m| roots.component_mul(m));
    let shares = left.column_iter().zip(whole.column_iter());
    let shares = shares.map(|(a, b)| a.dot(&b) / left.norm_squared());
    let squares: f64 = shares.map(|h| h * h).sum();
    let of_factors = fit.value * frame_gain.unwrap_or(0.0) * squares.sqrt();
    [fit.value, fit.stderr.hypot(of_factors), fit.z()]
}

#[cfg(test)]
mod tests;
