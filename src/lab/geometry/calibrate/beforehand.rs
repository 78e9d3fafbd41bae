//! Whether the estimates are as far from the scene as what was known beforehand lets expect.
//!
//! Unknowns that are drawn as their priors N(0, Λ⁻¹) say are found at
//!
//! > θ̂ ~ N(0, S),   S = Λ⁻¹ − (F + Λ)⁻¹ + E
//!
//! E their errors that are not those of noise (other pictures, finer rules and elements), so that
//! θ̂ᵀS⁻¹θ̂ is χ² of as many degrees of freedom as the photographs tell directions (Box
//! 1980, of the prior predictive distribution). A model that lacks something often fits all the
//! same, for the geometry takes up what is missing: many unknowns a little each, which only all
//! together tell.

use serde::Serialize;

use super::Calibrated;
use crate::matrix::Matrix;
use crate::num::linalg::svd;
use crate::num::statistics::squares_or_largest;

/// Of a direction's variance what the photographs must tell, for it to count: where that is less,
/// S is a small difference of numbers that hold to first order.
const TOLD: f64 = 0.2;

/// What the geometric parameters whose size was known are together.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Beforehand {
    /// θ̂ᵀS⁻¹θ̂.
    pub chi2: f64,
    /// Directions that the photographs tell.
    pub directions: usize,
    /// The largest deviation along one of them, in its expected scatter.
    pub largest: f64,
    /// Probability of as large a sum or of as large a deviation.
    pub p: f64,
}

impl Beforehand {
    /// Of these estimates, the first of all unknowns, with covariance (F + Λ)⁻¹; none where nothing
    /// that was known is told.
    pub(super) fn of(found: &[Calibrated], covariance: &Matrix) -> Option<Self> {
        let known = found.iter().enumerate();
        let known = known.filter_map(|(k, own)| Some((k, own, own.prior?)));
        let known: Vec<(usize, &Calibrated, f64)> = known.collect();
        // In units of what was known, where Λ is the identity.
        let scatter = Matrix::from_fn(known.len(), known.len(), |a, b| {
            let ((i, own, prior), (j, _, other)) = (known[a], known[b]);
            let beside = own.beside_noise / (prior * prior);
            f64::from(a == b) * (1.0 + beside) - covariance[(i, j)] / (prior * other)
        });
        let scatter = svd(&scatter).ok()?;
        let told = (0..scatter.sigma.len()).filter(|k| scatter.sigma[*k] > TOLD);
        let deviations: Vec<f64> = told
            .map(|k| {
                let parts = known.iter().enumerate();
                let along =
                    parts.map(|(own, (_, of, prior))| scatter.u[(own, k)] * of.value / prior);
                along.sum::<f64>() / scatter.sigma[k].sqrt()
            })
            .collect();
        let directions = deviations.len();
        let chi2 = deviations.iter().map(|z| z * z).sum();
        let largest = deviations
            .iter()
            .fold(0.0, |most: f64, z| most.max(z.abs()));
        (directions > 0).then(|| Self {
            chi2,
            directions,
            largest,
            p: squares_or_largest(chi2, largest, directions as f64),
        })
    }
}
