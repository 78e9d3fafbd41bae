//! Patterns of two levels whose neighbours may be alike, in fields of one element or of more.
//!
//! A board or a letter has fields that are larger than an element, and those may be alike in turn.
//! Beforehand fields of 2 × 2 elements, where these divide all grids evenly, and of one are as
//! likely, and of a size the patterns t of its fields by the prior of neighbours
//! ([`super::neighbours`]),
//!
//! > P(s) = (1/m) Σ_b P_b(t),   over the m sizes b of which s is t, the same throughout each field.
//!
//! The columns of R of one field add up, so each size is a problem of its own, of as many unknowns
//! as it has fields, and
//!
//! > Σ_s P(s) w(s) f(s) = (1/m) Σ_b Σ_t P_b(t) w(t) f(t).

use std::collections::HashMap;

use nalgebra::DMatrix;

use super::neighbours::AlikePrior;
use super::pattern_likelihood::PatternLikelihood;
use super::pattern_sums::{Moments, Summed, WeighedPatterns};
use super::{enumerated, sampled};
use crate::num::linalg::svd;
use crate::num::summation::log_sum_exp;
use crate::recovery::{RecoveryError, Sum};

/// Elements along a side of a field, and the fewest fields larger than an element. Of four fields
/// there are few patterns, and one of little contrast is then likelier than a fine picture that
/// noise hides: at 3 % noise with a probability of 0.95 where a board of 4 × 4 fields was
/// photographed.
const SIDES: [usize; 2] = [2, 1];
const FEWEST: usize = 16;
/// By how much the evidence of a sum that has not converged may be larger.
pub(super) const DOUBTED: f64 = 1e6;
/// Patterns of fields that are larger than an element that are drawn, at most.
const DRAWS: usize = 16_000;
/// A size that is less likely than others by e to this, whatever its pattern, adds nothing.
const NEGLIGIBLE: f64 = 40.0;

/// Fields of one size, and how likely their patterns are beforehand.
pub(super) struct Fields {
    /// The field of each element.
    of: Vec<usize>,
    count: usize,
    /// What neighbours say; else every pattern is as likely.
    pub(super) prior: Option<AlikePrior>,
}

impl Fields {
    /// Each of n elements by itself, every pattern as likely.
    pub(super) fn even(n: usize) -> Self {
        Self {
            of: (0..n).collect(),
            count: n,
            prior: None,
        }
    }

    /// Fields of all sizes that divide the grids evenly, single elements last, neighbours alike;
    /// none without grids, or where one is too wide.
    pub(super) fn alike(grids: &[[usize; 2]]) -> Vec<Self> {
        let divides = |b: &usize| grids.iter().flatten().all(|n| n.is_multiple_of(*b));
        let sides = SIDES.into_iter().filter(divides);
        let all = sides.map(|b| Self::of_size(grids, b));
        let all = all.filter(|fields| fields.count > 1);
        let all = all.filter(|fields| fields.is_single() || fields.count >= FEWEST);
        let all: Vec<Self> = all.collect();
        let known = all.iter().all(|fields| fields.prior.is_some());
        if known { all } else { Vec::new() }
    }

    /// Fields of b × b elements.
    fn of_size(grids: &[[usize; 2]], b: usize) -> Self {
        let (mut of, mut count) = (Vec::new(), 0);
        let coarse: Vec<[usize; 2]> = grids.iter().map(|grid| grid.map(|n| n / b)).collect();
        for ([nu, nv], [across, along]) in grids.iter().zip(&coarse) {
            of.extend((0..nu * nv).map(|j| count + j / nu / b * across + j % nu / b));
            count += across * along;
        }
        Self {
            of,
            count,
            prior: AlikePrior::new(&coarse),
        }
    }

    /// Whether each element is a field.
    fn is_single(&self) -> bool {
        self.count == self.of.len()
    }

    /// The pattern of elements.
    fn elements(&self, fields: &[bool]) -> Vec<bool> {
        self.of.iter().map(|field| fields[*field]).collect()
    }

    /// The pattern of fields; none where a field is not the same throughout.
    fn fields(&self, elements: &[bool]) -> Option<Vec<bool>> {
        let mut fields = vec![false; self.count];
        for (field, light) in self.of.iter().zip(elements) {
            fields[*field] = *light;
        }
        (self.elements(&fields) == elements).then_some(fields)
    }

    /// The sum over patterns of these fields, by so many draws where they are too many to be summed
    /// one by one, those of `known` listed. None where no pattern is possible, where the lattices
    /// are beyond double precision, and of larger fields where none is likelier than e to `least`.
    fn sum(
        &self,
        likelihood: &PatternLikelihood<'_>,
        known: &[Vec<bool>],
        (draws, least): (usize, f64),
    ) -> Result<Option<Summed>, RecoveryError> {
        let mut r = DMatrix::zeros(likelihood.r.nrows(), self.count);
        for (field, column) in self.of.iter().zip(likelihood.r.column_iter()) {
            r.column_mut(*field).axpy(1.0, &column, 1.0);
        }
        if !self.is_single() && least.is_finite() {
            let along = svd(&r)?.u.tr_mul(likelihood.d);
            let left = likelihood.d.norm_squared() - along.norm_squared();
            if -0.5 * left < least {
                return Ok(None);
            }
        }
        let most = if self.is_single() { draws } else { DRAWS };
        let own = PatternLikelihood {
            alike: self.prior.as_ref(),
            control: likelihood.control,
            scale_error: likelihood.scale_error,
            ..PatternLikelihood::new(&r, likelihood.d, likelihood.given)
        };
        let summed = if enumerated::can(&own) {
            Some(enumerated::sum(&own))
        } else {
            let known: Vec<Vec<bool>> = known.iter().filter_map(|s| self.fields(s)).collect();
            sampled::sample(&own, &known, draws.min(most))?
        };
        Ok(summed.filter(|summed| summed.log_evidence.is_finite()))
    }
}

/// The sum over patterns of fields of any of these sizes; `own` in place of that of single elements
/// where it is known. None where that of single elements is not to be had.
pub(super) fn sum(
    likelihood: &PatternLikelihood<'_>,
    sizes: &[Fields],
    known: &[Vec<bool>],
    (draws, own): (usize, Option<Summed>),
) -> Result<Option<Summed>, RecoveryError> {
    let mut known = known.to_vec();
    let mut parts: Vec<(&Fields, Summed)> = Vec::new();
    let mut best = own
        .as_ref()
        .map_or(f64::NEG_INFINITY, |own| own.log_evidence);
    let (mut own, mut whole) = (own, true);
    for fields in sizes {
        let summed = match own.take_if(|_| fields.is_single()) {
            Some(own) => Some(own),
            None => fields.sum(likelihood, &known, (draws, best - NEGLIGIBLE))?,
        };
        let Some(summed) = summed else {
            whole &= !fields.is_single();
            continue;
        };
        best = best.max(summed.log_evidence);
        let likeliest = summed.patterns.likeliest();
        known.extend(likeliest.map(|(light, _)| fields.elements(light)));
        parts.push((fields, summed));
    }
    Ok(whole.then(|| together(&parts, sizes.len())).flatten())
}

/// Sums over patterns of fields of several sizes as one over patterns of elements, each of so many
/// sizes as likely.
fn together(parts: &[(&Fields, Summed)], sizes: usize) -> Option<Summed> {
    let logs: Vec<f64> = parts
        .iter()
        .map(|(_, summed)| summed.log_evidence)
        .collect();
    let whole = log_sum_exp(&logs);
    let (mut moments, mut weights) = (Vec::new(), HashMap::<Vec<bool>, f64>::new());
    let (mut drawn, mut listed, mut disagreement, mut exhaustive) = (0, 0.0, 0.0, true);
    for (fields, summed) in parts {
        let share = libm::exp(summed.log_evidence - whole);
        let own = &summed.patterns;
        let factor = share / own.moments.weight;
        moments.push(own.moments.of_elements(&fields.of).scaled(factor));
        for (light, weight) in &own.weights {
            *weights.entry(fields.elements(light)).or_insert(0.0) += factor * weight;
        }
        match summed.sum {
            Sum::Exhaustive => listed += share,
            Sum::Sampled {
                draws,
                listed: of,
                disagreement: off,
            } => {
                drawn += draws;
                listed += share * of;
                // The share of what has not converged may be larger as well.
                let counted = if summed.sum.converged() {
                    share
                } else {
                    (DOUBTED * share).min(1.0)
                };
                disagreement += counted * off;
                exhaustive = false;
            }
        }
    }
    let (fields, likeliest) = parts
        .iter()
        .max_by(|a, b| a.1.log_evidence.total_cmp(&b.1.log_evidence))?;
    Some(Summed {
        patterns: WeighedPatterns {
            moments: Moments::together(&moments),
            weights,
        },
        log_evidence: whole - libm::log(sizes as f64),
        sum: if exhaustive {
            Sum::Exhaustive
        } else {
            Sum::Sampled {
                draws: drawn,
                listed,
                disagreement,
            }
        },
        best: fields.elements(&likeliest.best),
    })
}

#[cfg(test)]
mod tests;
