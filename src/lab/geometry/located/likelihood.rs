//! How likely photographs are if the reflectances are unknown.

use nalgebra::DVector;

use crate::lab::geometry::normal::Normal;
use crate::matrix::Matrix;
use crate::num::linalg::{LinalgError, columns_times, product, svd, tr_product};
use crate::num::search::largest;

/// Signal-to-noise ratios μ₁/λ, 10⁻² to 10¹²; those that are tried by prediction, four a decade.
const DECADES: [i32; 2] = [-2, 12];
const PER_DECADE: i32 = 4;
/// What is left of a fit by rounding, of the squares.
const ROUNDING: f64 = 1e-13;

/// Photographs in the coordinates in which the prior is white and the data are uncorrelated:
/// K^½ᵀ H K^½ = U diag(μ) Uᵀ, g = Uᵀ K^½ᵀ h.
#[derive(Debug)]
pub(super) struct Spectrum<'a> {
    root: &'a Matrix,
    u: Matrix,
    g: DVector<f64>,
    /// μ, falling.
    pub mu: DVector<f64>,
    square: f64,
    count: f64,
}

impl<'a> Spectrum<'a> {
    /// Of `all` photographs with K^½ = `root`; none where there is no light.
    ///
    /// # Errors
    /// [`LinalgError`].
    pub(super) fn new(all: &Normal, root: &'a Matrix) -> Result<Option<Self>, LinalgError> {
        let h = tr_product(root, &product(&all.h, root));
        if !(h.amax() > 0.0 && all.square > 0.0 && all.count > 1.0) {
            return Ok(None);
        }
        let found = svd(&h)?;
        Ok(Some(Self {
            root,
            g: found.u.tr_mul(&root.tr_mul(&all.side)),
            u: found.u,
            mu: found.sigma,
            square: all.square,
            count: all.count,
        }))
    }

    /// λ of μ₁/λ = exp(`log_ratio`).
    pub(super) fn lambda(&self, log_ratio: f64) -> f64 {
        self.mu[0] * libm::exp(-log_ratio)
    }

    /// A root R of the posterior covariance of ρ over ν², K^½ U (μ + λ)^−½: R Rᵀ.
    pub(super) fn spread(&self, lambda: f64) -> Matrix {
        let scale: Vec<f64> = self
            .mu
            .iter()
            .map(|mu| 1.0 / (mu + lambda).sqrt())
            .collect();
        columns_times(product(self.root, &self.u), &scale)
    }

    /// Posterior mean of ρ.
    pub(super) fn rho(&self, lambda: f64) -> DVector<f64> {
        self.root * (&self.u * self.white(lambda))
    }

    /// Degrees of freedom that the picture takes, Σ_i μ_i/(μ_i + λ).
    pub(super) fn freedom(&self, lambda: f64) -> f64 {
        self.mu.iter().map(|mu| mu / (mu + lambda)).sum()
    }

    fn white(&self, lambda: f64) -> DVector<f64> {
        DVector::from_fn(self.g.len(), |i, _| self.g[i] / (self.mu[i] + lambda))
    }

    /// ‖what is not explained‖/‖what other light leaves‖, weighted.
    pub(super) fn misfit(&self, lambda: f64) -> f64 {
        let (z, g, mu) = (self.white(lambda), &self.g, &self.mu);
        let explained = (0..z.len()).map(|i| z[i] * (2.0 * g[i] - mu[i] * z[i]));
        let left = self.square - explained.sum::<f64>();
        (left.max(0.0) / self.square).sqrt()
    }

    /// S(λ), not below what rounding leaves.
    fn left(&self, lambda: f64) -> f64 {
        let explained = |(g, mu): (&f64, &f64)| g * g / (mu + lambda);
        let s = self.square - self.g.iter().zip(&self.mu).map(explained).sum::<f64>();
        s.max(ROUNDING * self.square)
    }

    fn log_likelihood(&self, lambda: f64) -> f64 {
        let occam: f64 = self.mu.iter().map(|mu| libm::log1p(mu / lambda)).sum();
        -0.5 * (self.count * libm::log(self.left(lambda)) + occam)
    }
}

/// ln(μ₁/λ) that are tried by prediction.
pub(super) fn log_ratios() -> impl Iterator<Item = f64> {
    let step = std::f64::consts::LN_10 / f64::from(PER_DECADE);
    (DECADES[0] * PER_DECADE..=DECADES[1] * PER_DECADE).map(move |k| f64::from(k) * step)
}

/// The likelihood of photographs, ρ ~ N(0, τ²K), noise of variance ν² (of the stated one):
///
/// > ln p(Φ) = −n/2 · ln S(λ) − ½ Σ_i ln(1 + μ_i/λ) + constant,   S = s − Σ_i g_i²/(μ_i + λ)
///
/// at the largest over λ = ν²/τ² and ν² = S/n. It is the restricted likelihood (Patterson and
/// Thompson 1971) where patterns have been eliminated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    /// ln p(Φ) up to a constant of the photographs.
    pub log_likelihood: f64,
    /// ‖what is not explained‖/‖what other light leaves‖, weighted.
    pub misfit: f64,
    /// ν, in units of the stated standard errors.
    pub noise: f64,
    /// λ.
    pub lambda: f64,
}

impl Fit {
    /// The fit to `all` photographs with K^½ = `root`; none where there is no light.
    ///
    /// # Errors
    /// [`LinalgError`].
    pub(super) fn new(all: &Normal, root: &Matrix) -> Result<Option<Self>, LinalgError> {
        let Some(found) = Spectrum::new(all, root)? else {
            return Ok(None);
        };
        let ends = DECADES.map(|decade| found.lambda(f64::from(decade) * std::f64::consts::LN_10));
        let (lambda, log_likelihood) = largest(ends[1], ends[0], |x| found.log_likelihood(x));
        Ok(Some(Self {
            log_likelihood,
            misfit: found.misfit(lambda),
            noise: (found.left(lambda) / all.count).sqrt(),
            lambda,
        }))
    }
}
