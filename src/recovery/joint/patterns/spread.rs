//! Two levels that the elements keep to within a spread.
//!
//! That a picture has two reflectances and no more makes its standard errors small, and where it is
//! not so they are wrong. So the photographs are asked whether elements differ from their level
//! ([`super::part`]).
//!
//! Beforehand patterns are as likely as where the levels are exact, and that these are so as all
//! else together. One half of that is a spread τ of all elements, each τ up to the largest of
//! [`SPREADS`] as likely (Gelman 2006), of which one of these stands for those that are nearer to
//! it than to others by their ratio. The other half are single elements that are of neither level,
//! each as likely ([`super::apart`]), the others exact, or as likely of the likeliest spread.
//! Errors are the larger of those with single elements and without: a simpler account of elements
//! that all differ, which one of them is, has less.

use nalgebra::DVector;
use rayon::prelude::*;

use super::apart;
use super::fields::Fields;
use super::part::{Part, Whitened};
use super::pattern_likelihood::PatternLikelihood;
use super::pattern_sums::{Moments, Summed};
use crate::recovery::Patterns;
use crate::recovery::RecoveryError;

/// Spreads τ that are tried, from hardly any to no levels at all.
const SPREADS: [f64; 5] = [0.003, 0.01, 0.03, 0.1, 0.3];

/// How likely it is beforehand that levels are exact, that all elements differ from theirs, and
/// that one does.
const EXACT: f64 = 0.5;
const SPREAD: f64 = 0.25;
const APART: f64 = 0.25;
/// The second beside the first where no single element does.
const SPREADS_ALONE: f64 = (1.0 - EXACT) / SPREAD;

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

/// Of a picture of two levels that are not given, its pattern and its values; `exact` are the sums
/// over patterns of these fields where the levels are exact.
pub(super) fn sum(
    likelihood: &PatternLikelihood<'_>,
    (sizes, exact): (&[Fields], &Summed),
    (light, shown): (&[bool], &DVector<f64>),
) -> Result<Spread, RecoveryError> {
    let of = (light, shown);
    let n = light.len();
    let spreads: Result<Vec<Option<Part>>, RecoveryError> = SPREADS
        .par_iter()
        .map(|tau| {
            let white = Whitened::new(likelihood, DVector::from_element(n, tau * tau))?;
            Part::new(likelihood, sizes, &white, of)
        })
        .collect();
    // Each with the share of all that is believed beforehand: half of it is for exact levels.
    let mut parts: Vec<(f64, Part)> = Vec::new();
    let mut likeliest = (f64::NEG_INFINITY, 0.0, 0.0);
    for ((tau, before), part) in SPREADS.into_iter().zip(beforehand()).zip(spreads?) {
        let Some(part) = part else { continue };
        let log = part.log_evidence + libm::log(before);
        if log > likeliest.0 {
            likeliest = (log, tau, before);
        }
        parts.push((SPREAD * before, part));
    }
    let count = parts.len();
    let (_, tau, before) = likeliest;
    let single: Vec<(usize, f64, f64)> = apart::elements(likelihood, light)
        .into_iter()
        .flat_map(|element| [(element, 0.0, 0.5), (element, tau, 0.5 * before)])
        .filter(|(_, _, share)| *share > 0.0)
        .collect();
    let single: Result<Vec<Option<(f64, Part)>>, RecoveryError> = single
        .into_par_iter()
        .map(|(element, tau, share)| {
            let Some(white) = apart::whitened(likelihood, element, tau)? else {
                return Ok(None);
            };
            let part = Part::new(likelihood, sizes, &white, of)?;
            Ok(part.map(|part| (APART * share / n as f64, part)))
        })
        .collect();
    parts.extend(single?.into_iter().flatten());
    let logs = parts
        .iter()
        .map(|(share, part)| part.log_evidence + libm::log(share / EXACT));
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
    for ((_, part), weight) in parts.iter().zip(&weights) {
        let of = &part.summed.patterns.moments;
        sums.push(of.scaled(weight / all / of.weight));
    }
    // With spreads of all elements alone, and with single elements too.
    let exactly = exact.patterns.moments.square_about(shown) * own;
    let spreads = own + SPREADS_ALONE * weights[..count].iter().sum::<f64>();
    let square = |factor: f64, count: usize| {
        let each = parts[..count].iter().zip(&weights);
        each.fold(exactly.clone(), |sum, ((_, part), weight)| {
            sum + &part.square * (factor * weight)
        })
    };
    let alone = square(SPREADS_ALONE, count) / spreads;
    let square = (square(1.0, parts.len()) / all).sup(&alone);
    Ok(Spread {
        moments: Moments::together(&sums),
        exact: own / all,
        likeliest: tau,
        error: square.map(f64::sqrt),
    })
}

#[cfg(test)]
mod tests;
