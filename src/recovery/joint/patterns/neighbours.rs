//! How likely a pattern of two levels is beforehand, where neighbours may be alike.
//!
//! Of the patterns s_j = ±1 on a grid of elements the Ising model says
//!
//! > P(s | β) = exp(β Σ_⟨ij⟩ s_i s_j)/Z(β),
//!
//! the sum over neighbours along u and v, of the patterns in which both levels are seen. β = 0 is a
//! fair coin for each element, 2⁻ⁿ for each pattern; the larger β, the larger the patches (above
//! 0.44 they fill the grid, Onsager 1944). β is not known: each of eleven values from 0 to 1 is as
//! likely.

use std::collections::HashMap;

use rayon::prelude::*;

use super::pattern_sums::{Moments, WeighedPatterns};
use crate::num::summation::log_sum_exp;

/// Values of β, every tenth from 0 to 1.
const COUPLINGS: u32 = 11;
/// Elements across a grid, at most, whose Z is found: 2 to this numbers are held for each β.
const MOST_ACROSS: usize = 20;
/// Patterns whose levels are summed, at most, the likeliest first, and the share of the weight of
/// all that they must have.
const MOST_SUMMED: usize = 4096;
const LEAST_SUMMED: f64 = 0.999;
/// What of it is left to patterns that are not looked at.
const ROUNDED: f64 = 1e-12;

/// P(s), against the 2⁻ⁿ of fair coins.
pub(super) struct AlikePrior {
    /// Neighbours on all grids.
    pub(super) pairs: Vec<[usize; 2]>,
    /// Each β, with ln of 2ⁿ/Z over the number of β.
    couplings: Vec<(f64, f64)>,
    /// ln of P(s)/2⁻ⁿ by Σ s_i s_j, from its least value on.
    sums: Vec<f64>,
}

impl AlikePrior {
    /// None without grids, or where one is too wide.
    pub(super) fn new(grids: &[[usize; 2]]) -> Option<Self> {
        if grids.is_empty() || grids.iter().any(|[nu, nv]| *nu.min(nv) > MOST_ACROSS) {
            return None;
        }
        let n: usize = grids.iter().map(|[nu, nv]| nu * nv).sum();
        let pairs = pairs(grids);
        let fair = n as f64 * std::f64::consts::LN_2 - libm::log(f64::from(COUPLINGS));
        let couplings: Vec<(f64, f64)> = (0..COUPLINGS)
            .into_par_iter()
            .map(|k| {
                let beta = f64::from(k) / f64::from(COUPLINGS - 1);
                let z: f64 = grids.iter().map(|grid| log_sum(*grid, beta)).sum();
                let one = beta * pairs.len() as f64 + std::f64::consts::LN_2;
                (beta, fair - z - libm::log1p(-libm::exp(one - z)))
            })
            .collect();
        let most = pairs.len() as i64;
        let sum = |alike: i64| {
            let of = |(beta, rest): &(f64, f64)| beta * alike as f64 + rest;
            log_sum_exp(&couplings.iter().map(of).collect::<Vec<f64>>())
        };
        let sums = (-most..=most).map(sum).collect();
        Some(Self {
            pairs,
            couplings,
            sums,
        })
    }

    /// ln of P(s | β)/2⁻ⁿ over the number of β, for each β; none of a pattern of one level.
    fn logs(&self, light: &[bool]) -> Option<impl Iterator<Item = f64>> {
        let both = light.contains(&true) && light.contains(&false);
        let alike = alike(&self.pairs, light) as f64;
        let logs = self
            .couplings
            .iter()
            .map(move |(beta, rest)| beta * alike + rest);
        both.then_some(logs)
    }

    /// ln of P(s)/2⁻ⁿ; none of a pattern of one level.
    pub(super) fn log(&self, light: &[bool]) -> Option<f64> {
        let both = light.contains(&true) && light.contains(&false);
        let at = alike(&self.pairs, light) + self.pairs.len() as i64;
        both.then(|| self.sums[at as usize])
    }

    /// E β of the likeliest of some patterns, each with ln of its weight, P(s) in it; 0 of none.
    pub(super) fn degree<'p>(&self, weighed: impl Iterator<Item = (&'p Vec<bool>, f64)>) -> f64 {
        let likeliest = weighed.max_by(|a, b| a.1.total_cmp(&b.1));
        let Some(logs) = likeliest.and_then(|(light, _)| self.logs(light)) else {
            return 0.0;
        };
        let logs: Vec<f64> = logs.collect();
        let top = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let shares = logs.iter().map(|log| libm::exp(log - top));
        let each = self.couplings.iter().zip(shares);
        let (sum, all) = each.fold((0.0, 0.0), |(sum, all), ((beta, _), share)| {
            (sum + beta * share, all + share)
        });
        sum / all
    }
}

/// Patterns weighed anew: of those with both levels, in an order of their own so that sums have the
/// same bits, ln of w_s P(s | β)/2⁻ⁿ over the number of β and Σ_s w_s, for each β.
pub(super) struct Reweighed<'a> {
    /// Whether there is a prior; else nothing is weighed.
    tells: bool,
    patterns: Vec<&'a Vec<bool>>,
    /// β by β of each pattern.
    logs: Vec<f64>,
}

impl<'a> Reweighed<'a> {
    /// By `weights`, those of the patterns where every one is as likely beforehand.
    pub(super) fn new(prior: Option<&AlikePrior>, weights: &'a HashMap<Vec<bool>, f64>) -> Self {
        let mut found = Self {
            tells: prior.is_some(),
            patterns: Vec::new(),
            logs: Vec::new(),
        };
        let Some(prior) = prior else {
            return found;
        };
        let mut patterns: Vec<(&Vec<bool>, f64)> = weights.iter().map(|(s, w)| (s, *w)).collect();
        patterns.sort_unstable_by(|a, b| a.0.cmp(b.0));
        let total: f64 = patterns.iter().map(|p| p.1).sum();
        for (pattern, weight) in patterns.into_iter().filter(|p| p.1 > 0.0) {
            let Some(logs) = prior.logs(pattern) else {
                continue;
            };
            let share = libm::log(weight / total);
            found.logs.extend(logs.map(|log| share + log));
            found.patterns.push(pattern);
        }
        found
    }

    /// ln of Σ_s w_s P(s)/2⁻ⁿ over Σ_s w_s: what the patterns' evidence gains where neighbours may
    /// be alike. 0 where nothing tells; `None` where no pattern has both levels: one reflectance
    /// throughout is no pattern.
    pub(super) fn gained(&self) -> Option<f64> {
        if !self.tells {
            return Some(0.0);
        }
        let gained = log_sum_exp(&self.logs);
        gained.is_finite().then_some(gained)
    }

    /// The patterns by these weights, with the `levels` of each, the means of dark and light level
    /// and of their squares. None where nothing tells, or where too few of the patterns have too
    /// little of the weight.
    pub(super) fn sum(
        &self,
        levels: impl Fn(&[bool]) -> Option<[[f64; 2]; 2]>,
    ) -> Option<WeighedPatterns> {
        let top = self.logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let each = self.logs.chunks_exact(COUPLINGS as usize);
        let each = each.map(|logs| logs.iter().map(|log| libm::exp(log - top)).sum::<f64>());
        let patterns = self.patterns.iter().copied();
        let mut shares: Vec<(&Vec<bool>, f64)> = patterns.zip(each).collect();
        let whole: f64 = shares.iter().map(|p| p.1).sum();
        shares.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut moments = Moments::new(shares.first()?.0.len());
        let mut weights = HashMap::new();
        for (light, weight) in shares.into_iter().take(MOST_SUMMED) {
            if moments.weight > (1.0 - ROUNDED) * whole {
                break;
            }
            if let Some(levels) = levels(light) {
                moments.add(light, weight, levels);
                weights.insert(light.clone(), weight);
            }
        }
        let enough = whole > 0.0 && moments.weight >= LEAST_SUMMED * whole;
        enough.then_some(WeighedPatterns { moments, weights })
    }
}

/// Σ_⟨ij⟩ s_i s_j over the neighbours.
pub(super) fn alike(pairs: &[[usize; 2]], light: &[bool]) -> i64 {
    let of = |[a, b]: &[usize; 2]| if light[*a] == light[*b] { 1 } else { -1 };
    pairs.iter().map(of).sum()
}

/// The neighbours along u and v on each grid.
pub(super) fn pairs(grids: &[[usize; 2]]) -> Vec<[usize; 2]> {
    let mut pairs = Vec::new();
    let mut first = 0;
    for &[nu, nv] in grids {
        for j in 0..nu * nv {
            if (j + 1) % nu != 0 {
                pairs.push([first + j, first + j + 1]);
            }
            if j + nu < nu * nv {
                pairs.push([first + j, first + j + nu]);
            }
        }
        first += nu * nv;
    }
    pairs
}

/// ln Z(β) of a grid, element by element: of each state of the last `across` elements the sum over
/// all before them. Bit i of a state is the last element of column i. An element at column i takes
/// the place of the one above it, so states that differ in bit i alone pass into one another.
fn log_sum([nu, nv]: [usize; 2], beta: f64) -> f64 {
    let (across, along) = (nu.min(nv), nu.max(nv));
    let [same, other] = [beta, -beta].map(libm::exp);
    let mut sums = vec![0.0; 1 << across];
    sums[0] = 1.0;
    let mut log = 0.0;
    for row in 0..along {
        // Above the first row is nothing: bits not yet set are 0, and count once.
        let [up, cross] = if row > 0 { [same, other] } else { [1.0; 2] };
        for column in 0..across {
            let half = 1 << column;
            for block in sums.chunks_exact_mut(2 * half) {
                let (dark, light) = block.split_at_mut(half);
                // By the bit to the left, which the first column has not.
                let left = if column > 0 { half / 2 } else { 0 };
                let turn = |states: (&mut [f64], &mut [f64]), [to_dark, to_light]: [f64; 2]| {
                    for (dark, light) in states.0.iter_mut().zip(states.1) {
                        let (d, l) = (*dark, *light);
                        *dark = to_dark * (up * d + cross * l);
                        *light = to_light * (cross * d + up * l);
                    }
                };
                let (dark_left, dark) = dark.split_at_mut(left);
                let (light_left, light) = light.split_at_mut(left);
                turn((dark_left, light_left), [same, other]);
                let right = if column > 0 { [other, same] } else { [1.0; 2] };
                turn((dark, light), right);
            }
        }
        let top = sums.iter().copied().fold(0.0, f64::max);
        sums.iter_mut().for_each(|sum| *sum /= top);
        log += libm::log(top);
    }
    log + libm::log(sums.iter().sum())
}

#[cfg(test)]
mod tests;
