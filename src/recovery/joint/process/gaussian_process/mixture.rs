//! The mixture of all priors that count, and its bands.

use nalgebra::{DMatrix, DVector};

use super::interval::interval;
use super::{Length, Level, Seen, Triple};
use crate::num::linalg::{gram_product, tr_product};
use crate::num::summation::log_sum_exp;
use crate::recovery::joint::operator::reduced::over_brightest;
use crate::recovery::joint::process::exponential::Exponential;
use crate::recovery::{BandKind, Bands, RecoveryError, bands};

/// Elements up to which the covariance matrix is made.
const MOST_COVARIANCE: usize = 2048;

/// The least probability of the shortest length, or of one reflectance throughout, at which the
/// photographs do not speak against it: it is then within the middle 95 %.
const NOT_EXCLUDED: f64 = 0.025;

/// A factor of the light less likely than the likeliest by more than e to this counts for nothing.
const FOR_NOTHING: f64 = 25.0;

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

/// The light (1 + ε) ρ, or ρ.
pub(super) struct Picture {
    pub(super) mean: DVector<f64>,
    /// None of more than [`MOST_COVARIANCE`] elements.
    pub(super) covariance: Option<DMatrix<f64>>,
}

impl Picture {
    fn zero(n: usize) -> Self {
        Self {
            mean: DVector::zeros(n),
            covariance: (n <= MOST_COVARIANCE).then(|| DMatrix::zeros(n, n)),
        }
    }

    /// Adds x/s^power of parts of one triple, x = g + M h + errors of covariance C, where the mean
    /// M has the moments of each part; the covariance is that of the second moments until
    /// [`Picture::centred`].
    fn add(&mut self, power: i32, parts: &[Part], [g, h]: [&DVector<f64>; 2], c: &DMatrix<f64>) {
        let [mut all, mut first, mut second] = [0.0; 3];
        for part in parts {
            let [mean, variance] = part.mean;
            let over = part.scale.powi(power);
            self.mean.axpy(part.weight / over, g, 1.0);
            self.mean.axpy(part.weight / over * mean, h, 1.0);
            let weight = part.weight / (over * over);
            all += weight;
            first += weight * mean;
            second += weight * (mean * mean + variance);
        }
        let Some(covariance) = &mut self.covariance else {
            return;
        };
        let middle = first / all;
        let found = g + h * middle;
        *covariance += c * all;
        covariance.ger(all, &found, &found, 1.0);
        covariance.ger(second - first * middle, h, h, 1.0);
    }

    /// The same in another unit, about its mean.
    fn centred(mut self, unit: f64) -> Self {
        if let Some(covariance) = &mut self.covariance {
            covariance.ger(-1.0, &self.mean, &self.mean, 1.0);
            *covariance *= unit * unit;
        }
        self.mean *= unit;
        self
    }
}

/// A triple with one factor of the light: its weight, 1 + ε, and the picture's mean with its
/// variance.
struct Part {
    weight: f64,
    scale: f64,
    mean: [f64; 2],
}

/// The mixture of all triples.
pub(super) struct Mixture {
    /// (1 + ε) ρ.
    pub(super) light: Picture,
    /// 1/E(1/(1 + ε)), by which the mean of ρ makes the mean of the light where that is known, and
    /// the standard deviation of ε.
    pub(super) scale: [f64; 2],
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

/// The mean of a_j/b_j, of those that have a b.
fn mean_ratio(a: &DVector<f64>, b: &DVector<f64>) -> f64 {
    let ratios = a.iter().zip(b.iter()).filter(|(_, b)| **b > 0.0);
    let (sum, count) = ratios.fold((0.0, 0.0), |(sum, n), (a, b)| (sum + a / b, n + 1.0));
    if count > 0.0 { sum / count } else { 1.0 }
}

impl Seen {
    /// A triple by factors of the light; those that count for nothing are left out.
    fn parts(&self, level: &Level, triple: &Triple) -> Vec<Part> {
        let each = self.by_scale(level, triple.variance);
        let most = each.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let all = log_sum_exp(&each);
        let parts = self.scales.iter().zip(&each);
        let parts = parts.filter(|(_, log)| **log > most - FOR_NOTHING);
        let part = |(&[scale, _], log): (&[f64; 2], &f64)| Part {
            weight: triple.weight * libm::exp(log - all),
            scale,
            mean: level.mean(scale),
        };
        parts.map(part).collect()
    }

    pub(super) fn mixture(
        &self,
        prior: &Exponential,
        lengths: &[Length],
        triples: &[Triple],
        confidence: Option<f64>,
    ) -> Result<Mixture, RecoveryError> {
        let n = self.v.ncols();
        let [mut all, mut unalike, mut uneven] = [(); 3].map(|()| Moments::zero(n));
        let [mut light, mut picture] = [(); 2].map(|()| Picture::zero(n));
        // E 1/(1 + ε), E (1 + ε) and E (1 + ε)².
        let mut scale = [0.0; 3];
        let mut parts: Vec<(f64, DVector<f64>, DVector<f64>)> = Vec::new();
        let mut freedom = 0.0;
        let mut alike: Option<(usize, DMatrix<f64>)> = None;
        let mut order: Vec<&Triple> = triples.iter().collect();
        order.sort_by_key(|triple| triple.length);
        for triple in order {
            let (of, [shared, own]) = (&lengths[triple.length], triple.variance.parts());
            let level = Level::new(self, of, triple.variance).ok_or(RecoveryError::NO_DIRECTION)?;
            let factor = &level.factor;
            let towards = factor.forward(&of.vk * shared + &self.v * own);
            // x = g + M h, M the mean, and the variance about it.
            let g = tr_product(&towards, &level.data).column(0).into_owned();
            let h = tr_product(&towards, &level.level)
                .column(0)
                .map(|x| 1.0 - x);
            let about = DVector::from_fn(n, |j, _| {
                (shared + own - towards.column(j).norm_squared()).max(0.0)
            });
            let own_parts = self.parts(&level, triple);
            // tr(S⁻¹ (S − E)): how much of the data's directions goes into the picture.
            let errors = factor.forward(self.errors.clone());
            let errors = factor.forward(errors.transpose());
            let by_level = tr_product(&level.level, &(&errors * &level.level))[(0, 0)];
            let seen = self.y.len() as f64 - errors.trace();
            for part in &own_parts {
                let [mean, of_mean] = part.mean;
                freedom += part.weight * (seen + of_mean * by_level);
                for (sum, power) in scale.iter_mut().zip([-1, 1, 2]) {
                    *sum += part.weight * part.scale.powi(power);
                }
                let found = (&g + &h * mean) / part.scale;
                let variance = (&about + h.map(|h| h * h * of_mean)) / part.scale.powi(2);
                all.add(part.weight, &found, &variance);
                if triple.variance.spread > 0.0 {
                    uneven.add(part.weight, &found, &variance);
                    if triple.length == 0 {
                        unalike.add(part.weight, &found, &variance);
                    }
                }
                parts.push((part.weight, found, variance));
            }
            let mut c = DMatrix::zeros(0, 0);
            if picture.covariance.is_some() {
                if alike.as_ref().is_none_or(|(of, _)| *of != triple.length) {
                    alike = Some((triple.length, prior.matrix(of.length)));
                }
                c = DMatrix::zeros(n, n);
                gram_product(&mut c, &towards);
                c.neg_mut();
                if let Some((_, k)) = &alike {
                    c += k * shared;
                }
                (0..n).for_each(|j| c[(j, j)] += own);
            }
            picture.add(1, &own_parts, [&g, &h], &c);
            light.add(0, &own_parts, [&g, &h], &c);
        }
        let [picture, light] = [picture, light].map(|of| of.centred(self.unit));
        let [over, first, second] = scale;
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
            light,
            scale: [1.0 / over, (second - first * first).max(0.0).sqrt()],
            mean: picture.mean,
            standard_error: variance.map(|x| x.max(0.0).sqrt()) * self.unit,
            covariance: picture.covariance,
            bands,
            freedom,
            if_unalike,
            if_uneven,
        })
    }
}
