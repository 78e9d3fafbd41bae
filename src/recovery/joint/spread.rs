//! Two levels that the elements keep to within a spread.
//!
//! That a picture has two reflectances and no more makes its standard errors small, and where it is
//! not so they are wrong. So the photographs are asked whether each element may differ from its
//! level,
//!
//! > x = ℓ + τ n,   n ~ N(0, 1),   d ~ N(R ℓ, L Lᵀ),   L Lᵀ = 1 + τ² R Rᵀ,
//!
//! ℓ the levels of a pattern. L⁻¹R and L⁻¹d are again those of two levels, the evidence is less by
//! ln det L, and given ℓ
//!
//! > x ~ N(M (ℓ + τ² Rᵀd), τ² M),   M = (1 + τ² RᵀR)⁻¹.
//!
//! Beforehand patterns are as likely as where the levels are exact, and τ = 0 as all other τ
//! together, of which each up to the largest of [`SPREADS`] is as likely (Gelman 2006); one of
//! these stands for those that are nearer to it than to others by their ratio.

use nalgebra::DVector;
use rayon::prelude::*;

use super::fields::{self, Fields};
use super::levels::{LevelFit, possible};
use super::pattern_likelihood::PatternLikelihood;
use super::pattern_sums::{Moments, Summed};
use crate::num::linalg::{Svd, rows_times, svd};
use crate::num::stream::{Key, Sampling, Stream};
use crate::recovery::Patterns;
use crate::recovery::RecoveryError;

/// Spreads τ that are tried, from hardly any to no levels at all.
const SPREADS: [f64; 5] = [0.003, 0.01, 0.03, 0.1, 0.3];
/// Patterns that are drawn for one of them.
const DRAWS: usize = 16_000;
/// Patterns with their levels that are drawn from all that were met, and tries to draw possible
/// levels.
const DRAWN: usize = 200;
const TRIES: usize = 100;

/// How likely each of [`SPREADS`] is beforehand, together 1.
pub(super) fn beforehand() -> [f64; SPREADS.len()] {
    let last = SPREADS.len() - 1;
    let edge = |k: usize| (SPREADS[k] * SPREADS[k + 1]).sqrt();
    std::array::from_fn(|k| {
        let lower = if k == 0 { 0.0 } else { edge(k - 1) };
        let upper = if k == last { SPREADS[last] } else { edge(k) };
        (upper - lower) / SPREADS[last]
    })
}

/// What the photographs say of patterns whose levels are exact or spread.
pub(super) struct Spread {
    /// Sums over patterns and levels, exact and spread together.
    pub(super) moments: Moments,
    /// Probability that the levels are exact.
    pub(super) exact: f64,
    /// The likeliest of [`SPREADS`].
    pub(super) likeliest: f64,
    /// √E (x_j − shown_j)² of each element.
    pub(super) error: DVector<f64>,
}

impl Spread {
    /// What is known of a pattern, its levels spread or exact, from where they are exact.
    pub(super) fn finish(&self, exact: Patterns) -> Patterns {
        let pattern = exact.pattern * self.exact;
        Patterns {
            exact: Some(self.exact),
            spread: Some(self.likeliest),
            ..self.moments.finish(pattern, exact.log_evidence, exact.sum)
        }
    }
}

/// One spread's share.
struct Part {
    summed: Summed,
    log_evidence: f64,
    /// E (x_j − shown_j)².
    square: DVector<f64>,
}

/// Of a picture of two levels that are not given, its pattern and its values; `exact` are the sums
/// over patterns of these fields where the levels are exact.
pub(super) fn sum(
    likelihood: &PatternLikelihood<'_>,
    (sizes, exact): (&[Fields], &Summed),
    (light, shown): (&[bool], &DVector<f64>),
) -> Result<Spread, RecoveryError> {
    let axes = svd(likelihood.r)?;
    let parts: Result<Vec<Option<Part>>, RecoveryError> = SPREADS
        .par_iter()
        .map(|tau| part(likelihood, sizes, (&axes, *tau), (light, shown)))
        .collect();
    let parts: Vec<(f64, f64, Part)> = SPREADS
        .into_iter()
        .zip(beforehand())
        .zip(parts?)
        .filter_map(|((tau, before), part)| Some((tau, before, part?)))
        .collect();
    // ln of each share: half of all that is believed beforehand is for exact levels.
    let logs = parts
        .iter()
        .map(|(_, before, part)| part.log_evidence + libm::log(*before));
    let top = logs.clone().fold(exact.log_evidence, f64::max);
    let weights: Vec<f64> = logs.map(|log| libm::exp(log - top)).collect();
    let own = libm::exp(exact.log_evidence - top);
    let all = own + weights.iter().sum::<f64>();
    let mut sums = vec![
        exact
            .patterns
            .moments
            .scaled(own / all / exact.patterns.moments.weight),
    ];
    let mut square = exact.patterns.moments.square_about(shown) * (own / all);
    for ((_, _, part), weight) in parts.iter().zip(&weights) {
        let of = &part.summed.patterns.moments;
        sums.push(of.scaled(weight / all / of.weight));
        square += &part.square * (weight / all);
    }
    let largest = parts.iter().zip(&weights);
    let largest = largest.max_by(|a, b| a.1.total_cmp(b.1));
    Ok(Spread {
        moments: Moments::together(&sums),
        exact: own / all,
        likeliest: largest.map_or(0.0, |((tau, _, _), _)| *tau),
        error: square.map(f64::sqrt),
    })
}

/// The sums at one spread, along the singular vectors of R = U S Vᵀ: with e = 1 + τ² s² a row of
/// L⁻¹R is s vᵀ/√e, and x of levels ℓ is ℓ + V (τ² s/e)(Uᵀd − S Vᵀℓ) on average.
fn part(
    likelihood: &PatternLikelihood<'_>,
    sizes: &[Fields],
    (axes, tau): (&Svd, f64),
    (light, shown): (&[bool], &DVector<f64>),
) -> Result<Option<Part>, RecoveryError> {
    let s = &axes.sigma;
    let excess = s.map(|s| 1.0 + (tau * s).powi(2));
    let along = axes.u.tr_mul(likelihood.d);
    let beside = (likelihood.d - &axes.u * &along).norm_squared();
    let scale = s.zip_map(&excess, |s, e| s / e.sqrt());
    let r = rows_times(axes.vt.clone(), &scale);
    let d = along.zip_map(&excess, |d, e| d / e.sqrt());
    let own = PatternLikelihood {
        control: likelihood.control,
        ..PatternLikelihood::new(&r, &d, None)
    };
    let Some(summed) = fields::sum(&own, sizes, &[light.to_vec()], (DRAWS, None))? else {
        return Ok(None);
    };
    let told = s.zip_map(&excess, |s, e| (tau * s).powi(2) / e);
    let share = axes.vt.map(|v| v * v).tr_mul(&told);
    let mut square = share.map(|share| tau * tau * (1.0 - share).max(0.0));
    let gain = s.zip_map(&excess, |s, e| tau * tau * s / e);
    let drawn = draw(&summed, &own);
    let each = 1.0 / drawn.len() as f64;
    for (light, levels) in drawn {
        let level = DVector::from_fn(light.len(), |j, _| levels[usize::from(light[j])]);
        let left = &along - (&axes.vt * &level).component_mul(s);
        let mean = level + axes.vt.tr_mul(&left.component_mul(&gain));
        square += (mean - shown).map(|off| off * off * each);
    }
    let log_det: f64 = excess.iter().map(|e| libm::log(*e)).sum();
    Ok(Some(Part {
        log_evidence: summed.log_evidence - 0.5 * (log_det + beside),
        summed,
        square,
    }))
}

/// Some patterns in proportion to their weights, with levels of each as likely as they are.
pub(super) fn draw<'a>(
    summed: &'a Summed,
    likelihood: &PatternLikelihood<'_>,
) -> Vec<(&'a Vec<bool>, [f64; 2])> {
    let key = Key {
        seed: 3,
        spot: 0,
        pixel: 0,
        block: 0,
    };
    let random = &mut Stream::new(Sampling::Pcg, key);
    let patterns = &summed.patterns;
    let mut weights: Vec<(&Vec<bool>, &f64)> = patterns.weights.iter().collect();
    weights.sort_unstable_by_key(|of| of.0);
    let step = patterns.moments.weight / DRAWN as f64;
    let mut next = random.uniform() * step;
    let mut drawn = Vec::with_capacity(DRAWN);
    for (light, weight) in weights {
        next -= weight;
        while next < 0.0 {
            drawn.extend(levels(likelihood, light, random).map(|levels| (light, levels)));
            next += step;
        }
    }
    drawn
}

/// Levels of a pattern, as likely as they are.
fn levels(
    likelihood: &PatternLikelihood<'_>,
    light: &[bool],
    random: &mut Stream,
) -> Option<[f64; 2]> {
    if likelihood.given.is_some() {
        return likelihood.given;
    }
    let lit = likelihood.lit(light);
    let fit = LevelFit::new(likelihood.d, &(&likelihood.all - &lit), &lit)?;
    let mut tries = (0..TRIES).map(|_| fit.draw([random.normal(), random.normal()]));
    tries.find(|levels| possible(*levels))
}

#[cfg(test)]
mod tests;
