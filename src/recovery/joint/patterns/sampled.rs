//! The probabilities of patterns of many elements: those near the best one by one, the others by
//! chance.
//!
//! Patterns are points of a lattice ([`super::pattern_lattice`]). The nearest of them are summed.
//! All others p are drawn with a probability q(p) that is known ([`Lattice::draw`]) and, w(p) the
//! weight of a pattern over all its levels,
//!
//! > Σ_p w(p) f(p) = Σ_listed w f + E_q \[f w/q, p not listed\],
//!
//! without bias and with an error that is known. Where the levels are not given, contrasts are
//! divided into cells, each with its own lattice, and w of a pattern that is drawn is the weight
//! over the levels of the cell. Two sets of lattices are used: what they disagree in is not known,
//! nor what the errors of both allow. Where neighbours may be alike their prior is part of w, and
//! the lattices take them to be so about as much as those of the likeliest pattern listed.

use std::collections::{BTreeMap, HashMap};

use nalgebra::DVector;

use super::levels::{ALL, rule};
use super::pattern_lattice::{Dark, PatternLattice};
use super::pattern_likelihood::{PatternLikelihood, Weighed};
use super::pattern_sums::{Moments, Summed, WeighedPatterns};
use super::sampler::{List, Met, Sampler, Side, counts, effective};
use super::scaled::Scaled;
use crate::recovery::{RecoveryError, Sum};

/// Of the weight that lets a third of all draws be patterns, those of the two lattices.
const WEIGHTS: [f64; 2] = [0.94, 1.06];
/// Of the degree to which neighbours are alike, those of the two lattices.
const DEGREES: [f64; 2] = [0.85, 1.15];
/// Share ε of the contrast in a cell, to find where the likely ones are; and the parts of each of
/// these that are drawn from.
const COARSE: f64 = 0.1;
const PARTS: usize = 5;
/// Lattices of fine cells that are held at most, and with them of the coarse ones.
const MOST_FINE: usize = 300;
pub(super) const MOST_LATTICES: usize = MOST_FINE + 200;
/// Share of the draws by which the others are distributed over the cells.
const FIRST: f64 = 0.2;

/// The sum over patterns by so many draws; `known` ones are listed. `None` where the lattices are
/// beyond double precision.
pub(super) fn sample(
    likelihood: &PatternLikelihood<'_>,
    known: &[Vec<bool>],
    draws: usize,
) -> Result<Option<Summed>, RecoveryError> {
    let quadrature = rule();
    let mut sampler = Sampler {
        likelihood,
        list: List::new(),
        quadrature: &quadrature,
    };
    let n = likelihood.r.ncols();
    sampler.list(known);
    sampler.list(&[vec![false; n], vec![true; n]]);
    // A factor of the light is linear about the likeliest pattern; the weights hold all of it.
    let scaled = Scaled::of(likelihood).zip(sampler.likeliest());
    let linear = scaled.map(|(scaled, light)| scaled.about(light));
    let (r, d) = match &linear {
        Some((r, d)) => (r, d),
        None => (likelihood.r, likelihood.d),
    };
    let pairs = likelihood.alike.map_or(&[][..], |prior| &prior.pairs);
    let lattice = PatternLattice {
        r,
        d,
        dark: likelihood
            .given
            .map_or(Dark::Free, |[dark, _]| Dark::Given(dark)),
        alike: (pairs, 0.0),
        control: likelihood.control,
    };
    let contrasts = match likelihood.given {
        Some([dark, light]) => vec![light - dark],
        None => lattice.contrasts(1.0, COARSE),
    };
    let share = likelihood.given.map_or(COARSE, |_| 0.0);
    let both = |contrasts: &[f64], share: f64, ends: [f64; 2], degree: f64| {
        let side = |number: usize| -> Result<Option<Side>, RecoveryError> {
            let weight = WEIGHTS[number] * lattice.weight();
            let lattice = PatternLattice {
                alike: (pairs, DEGREES[number] * degree),
                ..lattice
            };
            let mut cells = lattice.cells(contrasts, share, weight)?;
            let whole = cells.len() == contrasts.len();
            if let Some(first) = cells.first_mut() {
                first.contrasts[0] = ends[0];
            }
            if let Some(last) = cells.last_mut() {
                last.contrasts[1] = ends[1];
            }
            let number = number as u32;
            Ok(whole.then_some(Side { cells, number }))
        };
        Ok::<_, RecoveryError>(side(0)?.zip(side(1)?).map(|(a, b)| [a, b]))
    };
    let Some(coarse) = both(&contrasts, share, ALL, sampler.degree())? else {
        return Ok(None);
    };
    let mut missed = sampler.list_near(&coarse);
    let mut fine = coarse;
    if likelihood.given.is_none() {
        let [first, last] = sampler.likely(&fine)?;
        let cells = &fine[0].cells;
        let ends = [cells[first].contrasts[0], cells[last].contrasts[1]];
        let likely = &contrasts[first..=last];
        let parts = (MOST_FINE / 2 / likely.len()).clamp(1, PARTS);
        let share = COARSE / parts as f64;
        let middle = 0.5 * (parts as f64 - 1.0);
        let step = |k: usize| libm::exp(2.0 * share * (k as f64 - middle));
        let part =
            |contrast: &f64| -> Vec<f64> { (0..parts).map(|k| contrast * step(k)).collect() };
        let likely: Vec<f64> = likely.iter().flat_map(part).collect();
        let Some(own) = both(&likely, share, ends, sampler.degree())? else {
            return Ok(None);
        };
        fine = own;
        missed = sampler.list_near(&fine);
    }
    let even = |side: &Side| {
        let count = FIRST * draws as f64 / 2.0 / side.cells.len() as f64;
        vec![count.ceil() as usize; side.cells.len()]
    };
    let first = [
        sampler.draw(&fine[0], &even(&fine[0]), 1)?,
        sampler.draw(&fine[1], &even(&fine[1]), 1)?,
    ];
    let rest = (1.0 - FIRST) * draws as f64 / 2.0;
    let counts = [0, 1].map(|k| counts(&first[k], fine[k].cells.len(), rest));
    let trusts = first.each_ref().map(|met| effective(met));
    // The later draws are independent of the first, which may so be listed too.
    let first = first.into_iter().flatten();
    let first: Vec<Vec<bool>> = first.map(|met| met.light).collect();
    sampler.list(&first);
    let met = [
        sampler.draw(&fine[0], &counts[0], 2)?,
        sampler.draw(&fine[1], &counts[1], 2)?,
    ];
    let known = Known {
        met,
        trusts,
        missed,
        draws,
    };
    Ok(known.together(n, &sampler.list))
}

/// What is known beside the list.
struct Known {
    /// Patterns that were drawn, by side.
    met: [Vec<Met>; 2],
    /// How much each side tells.
    trusts: [f64; 2],
    /// Share of the listed weight that both sides are likely to have missed.
    missed: f64,
    draws: usize,
}

impl Known {
    /// List and draws as one; none where no pattern is possible.
    fn together(self, n: usize, list: &List) -> Option<Summed> {
        let drawn = self.met.iter().flatten().map(|met| met.log);
        let logs = list.values().map(|weighed| weighed.log).chain(drawn);
        let top = logs.fold(f64::NEG_INFINITY, f64::max);
        if !top.is_finite() {
            return None;
        }
        let all = self.trusts[0] + self.trusts[1];
        let shares = self
            .trusts
            .map(|own| if all > 0.0 { own / all } else { 0.5 });
        let mut best = (f64::INFINITY, vec![false; n]);
        let mut weights: BTreeMap<Vec<bool>, f64> = BTreeMap::new();
        let mut add = |sum: &mut Moments, light: &Vec<bool>, of: &Weighed, log: f64, share: f64| {
            let weight = libm::exp(log - top);
            sum.add(light, weight, of.levels);
            *weights.entry(light.clone()).or_insert(0.0) += share * weight;
            if of.chi2 < best.0 {
                best = (of.chi2, light.clone());
            }
        };
        let mut listed = Moments::new(n);
        for (light, weighed) in list {
            add(&mut listed, light, weighed, weighed.log, 1.0);
        }
        let mut drawn = [Moments::new(n), Moments::new(n)];
        for ((sum, met), share) in drawn.iter_mut().zip(&self.met).zip(shares) {
            for met in met {
                add(sum, &met.light, &met.weighed, met.log, share);
            }
        }
        let with = |of: [Moments; 2]| {
            let [first, second] = of;
            Moments::together(&[listed.clone(), first, second])
        };
        let none = Moments::new(n);
        let halves = drawn
            .each_ref()
            .map(|own| with([own.clone(), none.clone()]).light());
        let moments = with([drawn[0].scaled(shares[0]), drawn[1].scaled(shares[1])]);
        let light = moments.light();
        let mut variance = DVector::<f64>::zeros(n);
        for (met, share) in self.met.iter().zip(shares) {
            for met in met {
                let weight = share * libm::exp(met.log - top) / moments.weight;
                for (j, sum) in variance.iter_mut().enumerate() {
                    let off = f64::from(u8::from(met.light[j])) - light[j];
                    *sum += (weight * off).powi(2);
                }
            }
        }
        let between = 2.0 * shares[0].min(shares[1]) * (&halves[0] - &halves[1]).amax();
        let listed = listed.weight / moments.weight;
        let error = 2.0 * variance.max().sqrt();
        Some(Summed {
            log_evidence: top + libm::log(moments.weight) - n as f64 * std::f64::consts::LN_2,
            patterns: WeighedPatterns {
                weights: weights.into_iter().collect::<HashMap<_, _>>(),
                moments,
            },
            sum: Sum::Sampled {
                draws: self.draws,
                listed,
                disagreement: error.max(between).max(self.missed * listed),
            },
            best: best.1,
        })
    }
}
