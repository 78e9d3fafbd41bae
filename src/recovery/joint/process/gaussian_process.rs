//! Reflectances as a Gaussian process on the surfaces: pictures whose elements resemble their
//! neighbours, without bounds and without edges known beforehand.
//!
//! > ρ_j = m + f_j,   m ~ N(½, ½²),   cov(f_i, f_j) = τ² k_ij,
//! > k_ij = (1 − η) exp(−|x_i − x_j|/ℓ) on one surface + η where i = j
//!
//! (with a free scale x/s₀ in place of ρ, see [`scale`]). The share η is of what has no alike
//! neighbours: texture finer than the elements. The photographs know ρ by the coordinates y = V ρ +
//! errors of covariance E ([`Coordinates`]), V Vᵀ = 1. So with K = ¼ 11ᵀ + τ² k(ℓ, η), all is
//! closed (Rasmussen and Williams 2006):
//!
//! > S = V K Vᵀ + E,   z = y − ½ V 1
//! > ln p(y | τ, ℓ, η)/p_best = −½ (zᵀS⁻¹z + ln det S − ln det E),   p_best that of an exact fit
//! > E\[ρ | y\] = ½ + K Vᵀ S⁻¹ z,   cov\[ρ | y\] = K − K Vᵀ S⁻¹ V K
//!
//! Where the scale is known to σ_s only, the photographs know the light x = (1 + ε) ρ, and ε ~ N(0,
//! σ_s²) is one more number of the prior, over which is summed ([`level`]): τ stands for (1 + ε) τ
//! on the lattice below, so that one S serves all ε.
//!
//! How much and over what length a picture varies (τ, ℓ, η) the photographs say only roughly, and
//! of what is finer than they resolve nothing: one best triple gives errors that are too small. So
//! all triples of a lattice count, each by its evidence p(y | τ, ℓ, η) and by how often pictures
//! are such: ln ℓ evenly from less than the distance of neighbours to a slope over the whole
//! surface, ln τ normal, each η of [`INDEPENDENT`] alike; one surface in fifty is of one
//! reflectance throughout, τ = 0. The estimate is the mean of that mixture, its covariance and
//! bands those of the mixture. They hold over all pictures that are such, not for each length:
//! where the photographs leave the shortest ℓ as likely as others, those of elements that nothing
//! ties to their neighbours are too small, and by how much is said with them. So are they where one
//! reflectance throughout is likely only because the photographs hardly show that it is not. Bands
//! of 95 % of 16 × 16 elements (rings of 3 and 6 in., noise of 1e-3 to 1e-1) covered 99 % of 34
//! crops of photographs and of fields of spectrum 1/f², 97 % of dead leaves and 69 % of elements
//! that were drawn one by one. Of whole pictures of the first and the third 95 and 80 % are
//! likeliest with η = 0; were that believed, dead leaves would be covered to 93 %, at worst 89 %.

mod interval;
mod level;
mod mixture;

use nalgebra::{DMatrix, DVector};

use super::exponential::Exponential;
use crate::num::control::{Control, Steps};
use crate::num::linalg::product;
use crate::num::summation::log_sum_exp;
use crate::recovery::joint::coordinates::Coordinates;
use crate::recovery::joint::operator::scale;
use crate::recovery::{
    Choice, Deviations, Method, Options, Parameter, Problem, Recovered, RecoveryError,
};
use level::{Level, scales};

/// Mean and standard deviation of a picture's mean.
pub(super) const MEAN: f64 = 0.5;
/// ln τ of pictures, mean and standard deviation: of best fits to 96 crops of 16 × 16 elements of
/// eight photographs.
const LN_SPREAD: [f64; 2] = [-2.13, 0.98];
/// Step of ln τ, and how many of them from the mean down and up.
const STEP: f64 = 0.35;
const STEPS: [i32; 2] = [-9, 9];
/// Shares η of the variance that neighbours do not share.
const INDEPENDENT: [f64; 3] = [0.0, 0.1, 0.3];
/// Share of surfaces of one reflectance throughout.
const FLAT: f64 = 0.02;
/// What is less likely than the likeliest by more than e to this counts for nothing.
const NEGLIGIBLE: f64 = 6.0;

/// What the photographs say: y = V ρ + errors.
struct Seen {
    v: DMatrix<f64>,
    y: DVector<f64>,
    errors: DMatrix<f64>,
    /// ln det of the errors.
    log_errors: f64,
    /// The unit of the reflectances, s₀: 1 unless the scale is free.
    unit: f64,
    /// 1 + ε, and ln of the share of each.
    scales: Vec<[f64; 2]>,
}

/// One length: V k and V k Vᵀ.
struct Length {
    length: f64,
    vk: DMatrix<f64>,
    vkv: DMatrix<f64>,
}

/// τ and η.
#[derive(Clone, Copy, PartialEq)]
struct Variance {
    spread: f64,
    independent: f64,
}

impl Variance {
    /// τ², of it what neighbours share and what they do not.
    fn parts(self) -> [f64; 2] {
        let whole = self.spread * self.spread;
        [whole * (1.0 - self.independent), whole * self.independent]
    }
}

/// The likeliest prior: ℓ, and τ and η.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Likeliest {
    length: f64,
    variance: Variance,
}

impl Likeliest {
    /// Of pictures of the usual spread, before the photographs say more.
    pub(super) fn usual(prior: &Exponential) -> Self {
        let lengths = prior.lengths();
        Self {
            length: lengths[lengths.len() / 2],
            variance: Variance {
                spread: libm::exp(LN_SPREAD[0]),
                independent: INDEPENDENT[0],
            },
        }
    }

    /// K, n × n, about a mean of ½.
    pub(super) fn covariance(self, prior: &Exponential) -> DMatrix<f64> {
        let [alike, own] = self.variance.parts();
        let mut k = (prior.matrix(self.length) * alike).add_scalar(MEAN * MEAN);
        (0..k.nrows()).for_each(|j| k[(j, j)] += own);
        k
    }
}

/// A triple (τ, ℓ, η) of the lattice.
struct Triple {
    length: usize,
    variance: Variance,
    /// ln of evidence times prior.
    weight: f64,
}

/// The recovery and its likeliest prior; noise that is not known hangs together over `alike`
/// pixels.
pub(super) fn with_alike(
    problem: &Problem<'_>,
    options: &Options,
    alike: f64,
) -> Result<(Recovered, Likeliest), RecoveryError> {
    let unit = scale::unit(problem)?;
    let coordinates = Coordinates::new(Method::JointGp, problem, options, unit, alike)?;
    let scale_error = problem.nuisance.scale_error;
    let seen = Seen::new(&coordinates, unit, scales(scale_error));
    let prior = Exponential::new(problem);
    let (lengths, triples, evidence) = seen.lattice(&prior, problem.control)?;
    let mut found = seen.mixture(&prior, &lengths, &triples, options.bands)?;
    let best = &triples[0];
    let likeliest = Likeliest {
        length: lengths[best.length].length,
        variance: best.variance,
    };
    let light = found.light.mean.clone();
    let mut recovered = coordinates.finish(Method::JointGp, problem, options, light)?;
    coordinates.add_errors(problem, &mut recovered, found.light.covariance.as_ref());
    if let Some(known_to) = scale_error {
        recovered.reflectance = found.mean.clone();
        let gains = &mut recovered.nuisance.get_or_insert_default().gains;
        let [factor, standard_error] = found.scale;
        gains.get_or_insert_default().whole = Some(Deviations {
            size: DVector::from_element(1, factor - 1.0),
            standard_error: DVector::from_element(1, standard_error),
            known_to,
            picture_given: false,
        });
    }
    if problem.nuisance.free_scale {
        found.relative(&recovered.reflectance, options.bands);
    }
    recovered.effective_rank = found.freedom;
    let scale = recovered.nuisance.as_ref().and_then(|n| n.scale);
    recovered.parameter = Parameter::GaussianProcess {
        spread: best.variance.spread * (unit / (scale.unwrap_or(1.0) * found.scale[0])),
        length: likeliest.length,
    };
    recovered.choice = Choice::Averaged {
        if_unalike: found.if_unalike,
        if_uneven: found.if_uneven,
    };
    recovered.log_evidence = Some(evidence);
    recovered.standard_error = Some(found.standard_error);
    recovered.covariance = found.covariance;
    recovered.bands = found.bands;
    Ok((recovered, likeliest))
}

impl Seen {
    fn new(coordinates: &Coordinates, unit: f64, scales: Vec<[f64; 2]>) -> Self {
        let k = coordinates.y.len() as f64;
        Self {
            v: coordinates.v.clone(),
            y: &coordinates.y / unit,
            errors: &coordinates.errors / (unit * unit),
            log_errors: coordinates.factor.log_det() - 2.0 * k * libm::log(unit),
            unit,
            scales,
        }
    }

    /// ln of p(y | τ, ℓ, η) p(τ) over p of a picture that fits y exactly, but for the common factor
    /// of p(τ); that of τ = 0 is 1.
    fn weight(&self, of: &Length, variance: Variance) -> f64 {
        let Some(level) = Level::new(self, of, variance) else {
            return f64::NEG_INFINITY;
        };
        log_sum_exp(&self.by_scale(&level, variance)) + 0.5 * self.log_errors
    }

    /// The same of each scale, but for the errors.
    fn by_scale(&self, level: &Level, variance: Variance) -> Vec<f64> {
        let own = |&[scale, share]: &[f64; 2]| {
            let z = (libm::log(variance.spread / scale) - LN_SPREAD[0]) / LN_SPREAD[1];
            let varied = if variance.spread > 0.0 {
                0.5 * z * z
            } else {
                0.0
            };
            level.log(scale) + share - varied
        };
        self.scales.iter().map(own).collect()
    }

    /// The triples that count, likeliest first, with weights that sum to 1, and ln of p(y) over
    /// that of a picture that fits y exactly.
    fn lattice(
        &self,
        prior: &Exponential,
        control: Control<'_>,
    ) -> Result<(Vec<Length>, Vec<Triple>, f64), RecoveryError> {
        let steps_to = |scale: f64| libm::log(scale) / STEP;
        let [low, high] = [self.scales.first(), self.scales.last()];
        let least = STEPS[0] + low.map_or(0, |of| steps_to(of[0]).floor() as i32);
        let most = STEPS[1] + high.map_or(0, |of| steps_to(of[0]).ceil() as i32);
        let (mut lengths, mut triples, mut best) = (Vec::new(), Vec::new(), f64::NEG_INFINITY);
        let mut start = 0;
        let tried = prior.lengths();
        let count = tried.len();
        let steps = Steps::new(control, 60, count);
        for length in tried {
            steps.done()?;
            let vk = product(&self.v, &prior.matrix(length));
            let vkv = product(&vk, &self.v.transpose());
            let of = Length { length, vk, vkv };
            for independent in INDEPENDENT {
                let variance = |step: i32| Variance {
                    spread: libm::exp(LN_SPREAD[0] + STEP * f64::from(step)),
                    independent,
                };
                let mut known: Vec<(i32, f64)> = Vec::new();
                let mut at = |step: i32| {
                    let weight = self.weight(&of, variance(step));
                    known.push((step, weight));
                    weight
                };
                // From the best spread before down and up as far as it counts.
                let mut top = at(start);
                for way in [-1, 1] {
                    let mut step = start + way;
                    let mut before = top;
                    while (least..=most).contains(&step) {
                        let weight = at(step);
                        top = top.max(weight);
                        if weight < before && weight < top.max(best) - NEGLIGIBLE {
                            break;
                        }
                        before = weight;
                        step += way;
                    }
                }
                best = best.max(top);
                if let Some((step, _)) = known.iter().find(|known| known.1 == top) {
                    start = *step;
                }
                triples.extend(known.into_iter().map(|(step, weight)| Triple {
                    length: lengths.len(),
                    variance: variance(step),
                    weight,
                }));
            }
            lengths.push(of);
        }
        let spreads: f64 = (STEPS[0]..=STEPS[1])
            .map(|step| (f64::from(step) * STEP / LN_SPREAD[1]).powi(2))
            .map(|z2| libm::exp(-0.5 * z2))
            .sum();
        let all = spreads * (count * INDEPENDENT.len()) as f64;
        if let Some(of) = lengths.first() {
            let share = libm::log(FLAT / (1.0 - FLAT) * all);
            let variance = Variance {
                spread: 0.0,
                independent: 0.0,
            };
            let weight = self.weight(of, variance) + share;
            best = best.max(weight);
            triples.push(Triple {
                length: 0,
                variance,
                weight,
            });
        }
        if !best.is_finite() {
            return Err(RecoveryError::NO_DIRECTION);
        }
        triples.retain(|triple| triple.weight > best - NEGLIGIBLE);
        triples.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        let sum: f64 = triples.iter().map(|t| libm::exp(t.weight - best)).sum();
        for triple in &mut triples {
            triple.weight = libm::exp(triple.weight - best) / sum;
        }
        let evidence = best + libm::log((1.0 - FLAT) * sum / all);
        Ok((lengths, triples, evidence))
    }
}

#[cfg(test)]
mod tests;
