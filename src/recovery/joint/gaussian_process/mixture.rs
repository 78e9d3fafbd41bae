//! The mixture of all priors that count, and its bands.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use nalgebra::{DMatrix, DVector};

use super::{Length, MEAN, Seen, Triple};
use crate::num::linalg::{gram_product, tr_product};
use crate::recovery::joint::exponential::Exponential;
use crate::recovery::joint::reduced::over_brightest;
use crate::recovery::{BandKind, Bands, RecoveryError, bands};

/// Elements up to which the covariance matrix is made.
const MOST_COVARIANCE: usize = 2048;

/// The least probability of the shortest length, or of one reflectance throughout, at which the
/// photographs do not speak against it: it is then within the middle 95 %.
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
    pub(super) if_uneven: Option<[f64; 2]>,
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

/// Newton steps at most, and the step at which they end, over what is possible.
const MOST_STEPS: usize = 100;
const ENOUGH: f64 = 1e-13;

/// Between which values element j lies, as much of it beyond either: the x of
/// Σ w Φ((x − m)/s) = ½ (1 ∓ confidence), by Newton's method, halving where a step leaves what is
/// possible.
fn interval(parts: &[(f64, DVector<f64>, DVector<f64>)], j: usize, confidence: f64) -> [f64; 2] {
    let each = parts.iter().map(|(w, m, v)| {
        let s = v[j].sqrt();
        (*w, m[j], s, 1.0 / s.max(f64::MIN_POSITIVE))
    });
    let each: Vec<(f64, f64, f64, f64)> = each.collect();
    // What lies below x, and how densely about it.
    let about = |x: f64| -> [f64; 2] {
        let of = |&(w, m, _, one_over_s): &(f64, f64, f64, f64)| {
            let z = (x - m) * one_over_s;
            let density = libm::exp(-0.5 * z * z) * one_over_s / (2.0 * PI).sqrt();
            [0.5 * w * libm::erfc(-z * FRAC_1_SQRT_2), w * density]
        };
        each.iter()
            .map(of)
            .fold([0.0; 2], |[a, b], [x, y]| [a + x, b + y])
    };
    let middle: f64 = each.iter().map(|(w, m, ..)| w * m).sum();
    let far = each.iter().map(|(_, m, s, _)| m.abs() + 40.0 * s);
    let far = far.fold(0.0, f64::max);
    [0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence].map(|share| {
        let (mut low, mut high, mut x) = (-far, far, middle);
        for _ in 0..MOST_STEPS {
            let [below, density] = about(x);
            if below < share {
                low = x;
            } else {
                high = x;
            }
            let newton = x + (share - below) / density;
            let is_within = low < newton && newton < high;
            let next = if is_within {
                newton
            } else {
                0.5 * (low + high)
            };
            let step = (next - x).abs();
            x = next;
            if step <= ENOUGH * far {
                break;
            }
        }
        x
    })
}

/// The mean of a_j/b_j, of those that have a b.
fn mean_ratio(a: &DVector<f64>, b: &DVector<f64>) -> f64 {
    let ratios = a.iter().zip(b.iter()).filter(|(_, b)| **b > 0.0);
    let (sum, count) = ratios.fold((0.0, 0.0), |(sum, n), (a, b)| (sum + a / b, n + 1.0));
    if count > 0.0 { sum / count } else { 1.0 }
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
        let [mut all, mut unalike, mut uneven] = [(); 3].map(|()| Moments::zero(n));
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
            if triple.variance.spread > 0.0 {
                uneven.add(triple.weight, &found, &variance);
                if triple.length == 0 {
                    unalike.add(triple.weight, &found, &variance);
                }
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
        let times = |part: &Moments| mean_ratio(&part.square_about(&all.mean), &variance).sqrt();
        let if_unalike = (unalike.weight > NOT_EXCLUDED).then(|| times(&unalike));
        let is_asked = uneven.weight > 0.0 && 1.0 - uneven.weight > NOT_EXCLUDED;
        let if_uneven = is_asked.then(|| [1.0 - uneven.weight, times(&uneven)]);
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
            if_uneven,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of one normal distribution its ± 1.96 σ; of two that are apart, by hand: 2.5 % of all is 5 %
    /// of the first, and 97.5 % where 5 % of the second are above, at once where it has no width.
    #[test]
    fn intervals_by_hand() {
        let part = |w: f64, m: f64, s: f64| {
            (
                w,
                DVector::from_element(1, m),
                DVector::from_element(1, s * s),
            )
        };
        let near = |found: [f64; 2], want: [f64; 2]| {
            let off = found.iter().zip(want).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 1e-9, "{found:?} {want:?}");
        };
        // Φ⁻¹(0.975) and Φ⁻¹(0.95), by tables.
        let (two_sided, one_sided) = (1.959_963_984_540_054, 1.644_853_626_951_472_7);
        let one = [part(1.0, 0.3, 0.02)];
        near(
            interval(&one, 0, 0.95),
            [0.3 - 0.02 * two_sided, 0.3 + 0.02 * two_sided],
        );
        let apart = [part(0.5, -1.0, 0.01), part(0.5, 2.0, 0.1)];
        let want = [-1.0 - 0.01 * one_sided, 2.0 + 0.1 * one_sided];
        near(interval(&apart, 0, 0.95), want);
        let sharp = [part(0.5, -1.0, 0.01), part(0.5, 2.0, 0.0)];
        near(interval(&sharp, 0, 0.95), [-1.0 - 0.01 * one_sided, 2.0]);
    }
}
