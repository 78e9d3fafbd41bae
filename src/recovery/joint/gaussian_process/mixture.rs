//! The mixture of all priors that count, and its bands.

use nalgebra::{DMatrix, DVector};

use super::{Length, MEAN, Seen, Triple};
use crate::num::linalg::{gram_product, tr_product};
use crate::recovery::joint::exponential::Exponential;
use crate::recovery::joint::reduced::over_brightest;
use crate::recovery::{BandKind, Bands, RecoveryError, bands};

/// Elements up to which the covariance matrix is made.
const MOST_COVARIANCE: usize = 2048;

/// The least probability of the shortest length at which the photographs do not speak against it:
/// it is then within the middle 95 % of lengths.
const NOT_EXCLUDED: f64 = 0.025;

/// The first two moments of some triples' pictures, by their weights.
struct Moments {
    weight: f64,
    mean: DVector<f64>,
    square: DVector<f64>,
}

impl Moments {
    fn zero(n: usize) -> Self {
        Self {
            weight: 0.0,
            mean: DVector::zeros(n),
            square: DVector::zeros(n),
        }
    }

    fn add(&mut self, weight: f64, mean: &DVector<f64>, variance: &DVector<f64>) {
        let square = mean.component_mul(mean) + variance;
        self.weight += weight;
        self.mean.axpy(weight, mean, 1.0);
        self.square.axpy(weight, &square, 1.0);
    }

    /// E (ρ − m)² of each element where these are all there are.
    fn square_about(&self, m: &DVector<f64>) -> DVector<f64> {
        let mean = &self.mean / self.weight;
        let off = &mean - m;
        &self.square / self.weight - mean.component_mul(&mean) + off.component_mul(&off)
    }

    /// Their variances.
    fn variance(&self) -> DVector<f64> {
        self.square_about(&(&self.mean / self.weight))
    }
}

/// The mixture of all triples.
pub(super) struct Mixture {
    pub(super) mean: DVector<f64>,
    pub(super) standard_error: DVector<f64>,
    pub(super) covariance: Option<DMatrix<f64>>,
    pub(super) bands: Option<Bands>,
    pub(super) freedom: f64,
    /// As of [`Choice::Averaged`](crate::recovery::Choice::Averaged).
    pub(super) if_unalike: Option<f64>,
}

impl Mixture {
    /// The same over the brightest element; bands to first order in the errors.
    pub(super) fn relative(&mut self, reflectance: &DVector<f64>, confidence: Option<f64>) {
        self.standard_error /= self.mean.max();
        if let Some(covariance) = &mut self.covariance {
            *covariance = over_brightest(covariance, &self.mean);
            self.standard_error = covariance.diagonal().map(|x| x.max(0.0).sqrt());
        }
        self.bands = confidence.map(|confidence| Bands {
            kind: BandKind::Posterior,
            ..bands::gaussian(reflectance, &self.standard_error, confidence)
        });
    }
}

/// Between which values element j lies, as much of it beyond either, by bisection of
/// Σ w Φ((x − m)/s).
fn interval(parts: &[(f64, DVector<f64>, DVector<f64>)], j: usize, confidence: f64) -> [f64; 2] {
    let below = |x: f64| -> f64 {
        let of = |(w, m, v): &(f64, DVector<f64>, DVector<f64>)| {
            let z = (x - m[j]) / v[j].sqrt().max(f64::MIN_POSITIVE);
            0.5 * w * libm::erfc(-z * std::f64::consts::FRAC_1_SQRT_2)
        };
        parts.iter().map(of).sum()
    };
    let reach = |(_, m, v): &(f64, DVector<f64>, DVector<f64>)| m[j].abs() + 40.0 * v[j].sqrt();
    let far = parts.iter().map(reach).fold(0.0, f64::max);
    [0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence].map(|share| {
        let (mut low, mut high) = (-far, far);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if below(middle) < share {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    })
}

impl Seen {
    pub(super) fn mixture(
        &self,
        prior: &Exponential,
        lengths: &[Length],
        triples: &[Triple],
        confidence: Option<f64>,
    ) -> Result<Mixture, RecoveryError> {
        let n = self.v.ncols();
        let left = self.left();
        let level = self.v.column_sum();
        let (mut all, mut unalike) = (Moments::zero(n), Moments::zero(n));
        let mut covariance = (n <= MOST_COVARIANCE).then(|| DMatrix::zeros(n, n));
        let mut parts: Vec<(f64, DVector<f64>, DVector<f64>)> = Vec::new();
        let mut freedom = 0.0;
        let mut alike: Option<(usize, DMatrix<f64>)> = None;
        let mut order: Vec<&Triple> = triples.iter().collect();
        order.sort_by_key(|triple| triple.length);
        for triple in order {
            let (of, [shared, own]) = (&lengths[triple.length], triple.variance.parts());
            let factor = self
                .factor(of, triple.variance)
                .ok_or(RecoveryError::NO_DIRECTION)?;
            let mut vk = &of.vk * shared + &self.v * own;
            for mut column in vk.column_iter_mut() {
                column.axpy(MEAN * MEAN, &level, 1.0);
            }
            let towards = factor.forward(vk);
            let seen = factor.forward(left.clone());
            let found = (tr_product(&towards, &seen).column(0)).add_scalar(MEAN);
            let variance = DVector::from_fn(n, |j, _| {
                (shared + own + MEAN * MEAN - towards.column(j).norm_squared()).max(0.0)
            });
            // tr(S⁻¹ (S − E)): how much of the data's directions goes into the picture.
            let errors = factor.forward(self.errors.clone());
            let unseen = factor.forward(errors.transpose()).trace();
            freedom += triple.weight * (self.y.len() as f64 - unseen);
            all.add(triple.weight, &found, &variance);
            if triple.length == 0 && triple.variance.spread > 0.0 {
                unalike.add(triple.weight, &found, &variance);
            }
            if let Some(covariance) = &mut covariance {
                if alike.as_ref().is_none_or(|(of, _)| *of != triple.length) {
                    alike = Some((triple.length, prior.matrix(of.length)));
                }
                let k = alike.as_ref().map(|(_, k)| k);
                let mut told = DMatrix::zeros(n, n);
                gram_product(&mut told, &towards);
                *covariance -= told * triple.weight;
                if let Some(k) = k {
                    *covariance += k * (triple.weight * shared);
                }
                for j in 0..n {
                    covariance[(j, j)] += triple.weight * own;
                }
                covariance.add_scalar_mut(triple.weight * MEAN * MEAN);
                covariance.ger(triple.weight, &found, &found, 1.0);
            }
            parts.push((triple.weight, found, variance));
        }
        if let Some(covariance) = &mut covariance {
            covariance.ger(-1.0, &all.mean, &all.mean, 1.0);
            *covariance *= self.unit * self.unit;
        }
        let variance = all.variance();
        let if_unalike = (unalike.weight > NOT_EXCLUDED)
            .then(|| (unalike.square_about(&all.mean).mean() / variance.mean()).sqrt());
        let bands = confidence.map(|confidence| Bands {
            confidence,
            intervals: (0..n).map(|j| interval(&parts, j, confidence)).collect(),
            kind: BandKind::Posterior,
        });
        Ok(Mixture {
            mean: all.mean * self.unit,
            standard_error: variance.map(|x| x.max(0.0).sqrt()) * self.unit,
            covariance,
            bands,
            freedom,
            if_unalike,
        })
    }
}
