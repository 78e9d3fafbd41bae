//! The picture at one place, as smooth as predicts photographs best.

use nalgebra::DVector;

use super::Bright;
use super::frames::Frame;
use super::likelihood::{Spectrum, log_ratios};
use super::place::jackknifed;
use crate::matrix::Matrix;
use crate::num::linalg::LinalgError;

/// Posterior mean of the reflectances, the prior's λ and length being those by which each frame is
/// best predicted from the others:
///
/// > Σ_l ‖√w (Φ_l − C diag(d_l) ρ_(l))‖² = least,   ρ_(l) from all frames but l.
///
/// Where the model lacks something, neighbouring pixels err alike; a likelihood that takes them for
/// independent would keep directions of the picture that no other frame confirms.
pub(super) struct Pictured {
    /// ρ.
    pub rho: DVector<f64>,
    /// ρ_(l), by frames.
    pub without: Vec<DVector<f64>>,
    /// Directions above the noise: how many μ_i exceed λ.
    pub directions: usize,
    /// ‖what is not explained‖/‖what other light leaves‖.
    pub misfit: f64,
    /// The same of each frame as the others predict it.
    pub predicted: f64,
}

impl Pictured {
    /// From at least 3 frames, with each K^½ of `roots`; none of fewer, and without light.
    pub(super) fn new(frames: &[Frame], roots: &[Matrix]) -> Result<Option<Self>, LinalgError> {
        let Some(elements) = frames.first().map(|frame| frame.side.len()) else {
            return Ok(None);
        };
        if frames.len() < 3 {
            return Ok(None);
        }
        let all = Frame::sum(frames.iter(), elements);
        let mut best: Option<Self> = None;
        for root in roots {
            let Some(whole) = Spectrum::new(&all, root)? else {
                return Ok(None);
            };
            let parts = Frame::all_but_one(frames, elements).map(|rest| Spectrum::new(&rest, root));
            let parts: Option<Vec<Spectrum<'_>>> = parts.collect::<Result<_, _>>()?;
            let Some(parts) = parts else {
                return Ok(None);
            };
            for lambda in log_ratios().map(|k| whole.lambda(k)) {
                let without: Vec<_> = parts.iter().map(|part| part.rho(lambda)).collect();
                let left = frames
                    .iter()
                    .zip(&without)
                    .map(|(frame, rho)| frame.left(rho));
                let predicted = (left.sum::<f64>().max(0.0) / all.square).sqrt();
                if best.as_ref().is_none_or(|b| predicted < b.predicted) {
                    best = Some(Self {
                        rho: whole.rho(lambda),
                        without,
                        directions: whole.mu.iter().filter(|mu| **mu > lambda).count(),
                        misfit: whole.misfit(lambda),
                        predicted,
                    });
                }
            }
        }
        Ok(best)
    }

    /// Standard error of each ρ, by leaving frames out.
    pub(super) fn stderr(&self) -> Vec<f64> {
        let of = |j: usize| {
            let values: Vec<f64> = self.without.iter().map(|rho| rho[j]).collect();
            jackknifed(&values).unwrap_or(0.0)
        };
        (0..self.rho.len()).map(of).collect()
    }

    /// The bright part of the picture of elements at `places`.
    pub(super) fn bright(&self, places: &[[f64; 3]]) -> Option<Bright> {
        let (own, elements) = middle(&self.rho, places)?;
        let without = self.without.iter().map(|rho| Some(middle(rho, places)?.0));
        let without: Option<Vec<[f64; 3]>> = without.collect();
        let spread = |k: usize| {
            let values: Vec<f64> = without.as_ref()?.iter().map(|m| m[k]).collect();
            jackknifed(&values)
        };
        let stderr = match [0, 1, 2].map(spread) {
            [Some(x), Some(y), Some(z)] => Some([x, y, z]),
            _ => None,
        };
        Some(Bright {
            middle: own,
            stderr,
            elements,
        })
    }
}

/// The mean place of the elements of at least half the largest reflectance, weighted by it, and
/// their number.
fn middle(rho: &DVector<f64>, places: &[[f64; 3]]) -> Option<([f64; 3], usize)> {
    let largest = rho.max();
    let bright = || {
        let all = rho.iter().zip(places);
        all.filter(|(rho, _)| **rho >= 0.5 * largest)
    };
    let sum: f64 = bright().map(|(rho, _)| rho).sum();
    let mean = |k: usize| bright().map(|(rho, place)| rho * place[k]).sum::<f64>() / sum;
    (largest > 0.0).then(|| ([0, 1, 2].map(mean), bright().count()))
}
