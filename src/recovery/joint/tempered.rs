//! The probabilities of patterns of many elements, by sampling.
//!
//! Parallel tempering (Geyer 1991): copies k of pattern and levels walk in exp(−β_k ½ χ²), from the
//! photographs' own β = 1 to β = 0 where every pattern is alike, and neighbours exchange their places.
//! Moves of one copy: one element changes; a light and a dark one change places; an element changes
//! and the levels are drawn anew from their Gaussian for that pattern; the levels alone are. Two
//! ladders run from different starts, the best pattern known and chance; what their halves disagree in
//! is what the probabilities are not known by. Where the ladders end apart (little noise sets one
//! pattern apart from all others, and chance does not find it), each counts by its evidence: that from
//! the best pattern by the patterns that it met, added up. The evidence follows from steps between neighbours,
//!
//! > p(y) = Π_k ⟨exp(−(β_k − β_k+1) ½ χ²)⟩_k+1.

use std::collections::{BTreeMap, HashMap};

use nalgebra::DVector;
use rayon::prelude::*;

use super::ground::{Ground, Moments, Summed};
use super::walker::{Land, Walker, accepted};
use crate::num::linalg::{LinalgError, svd};
use crate::num::stream::{Key, Sampling, Stream};
use crate::recovery::RecoveryError;
use crate::recovery::Sum;

/// Multiplications that one ladder may take for what is shown.
pub(super) const MOST_WORK: f64 = 6e8;
/// Fewest and most sweeps.
const SWEEPS: [usize; 2] = [60, 8_000];
/// Most copies in a ladder.
const MOST_COPIES: usize = 72;
/// Evidences that differ by less, ln, tell nothing of which is larger.
const CLEAR: f64 = 5.0;
/// Patterns of chance from which the hottest step is taken.
const CHANCE: usize = 64;
/// Patterns with their levels that are kept of a ladder.
const DRAWN: usize = 200;

/// What one ladder has found.
struct Ladder {
    halves: [Moments; 2],
    log_evidence: f64,
    best: (f64, Vec<bool>),
    /// How often each pattern was met, in an order of their own, so that sums have the same bits.
    patterns: BTreeMap<Vec<bool>, f64>,
    /// Some of them with their levels, evenly over the sweeps.
    drawn: Vec<(Vec<bool>, [f64; 2])>,
}

fn ladder(
    land: &Land<'_>,
    betas: &[f64],
    sweeps: usize,
    start: Option<&[bool]>,
    key: Key,
) -> Ladder {
    let random = &mut Stream::new(Sampling::Pcg, key);
    let n = land.ground.r.ncols();
    let mut first = || {
        let chance = Walker::of_chance(land, random);
        let Some(start) = start else { return chance };
        let mut known = Walker::new(land, start.to_vec(), chance.levels);
        known.settle(land);
        known
    };
    let mut copies: Vec<Walker> = betas.iter().map(|_| first()).collect();
    let mut best = (f64::INFINITY, copies[0].light.clone());
    let mut halves = [Moments::new(n), Moments::new(n)];
    let mut steps = vec![Vec::with_capacity(sweeps); betas.len() - 1];
    let (mut patterns, mut drawn) = (BTreeMap::new(), Vec::with_capacity(DRAWN));
    let first = sweeps / 5;
    let every = ((sweeps - first) / DRAWN).max(1);
    for sweep in 0..sweeps {
        if land.ground.control.stopped() {
            break;
        }
        for (copy, &beta) in copies.iter_mut().zip(betas) {
            if beta == 0.0 {
                *copy = Walker::of_chance(land, random);
            } else {
                copy.sweep(land, beta, random);
            }
            if copy.chi2 < best.0 {
                best = (copy.chi2, copy.light.clone());
            }
        }
        for k in (sweep % 2..betas.len() - 1).step_by(2) {
            let gain = 0.5 * (betas[k] - betas[k + 1]) * (copies[k].chi2 - copies[k + 1].chi2);
            if accepted(gain, random) {
                copies.swap(k, k + 1);
            }
        }
        if sweep < first {
            continue;
        }
        for (k, steps) in steps.iter_mut().enumerate() {
            steps.push(-0.5 * (betas[k] - betas[k + 1]) * copies[k + 1].chi2);
        }
        let half = usize::from(2 * (sweep - first) >= sweeps - first);
        let own = &copies[0];
        halves[half].add(&own.light, 1.0, own.levels.map(|x| [x, x * x]));
        *patterns.entry(own.light.clone()).or_insert(0.0) += 1.0;
        if (sweep - first).is_multiple_of(every) {
            drawn.push((own.light.clone(), own.levels));
        }
    }
    Ladder {
        halves,
        log_evidence: steps.iter().map(|logs| log_mean(logs)).sum(),
        best,
        patterns,
        drawn,
    }
}

/// ln of the mean of exp.
fn log_mean(logs: &[f64]) -> f64 {
    let top = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let sum: f64 = logs.iter().map(|log| libm::exp(log - top)).sum();
    top + libm::log(sum / logs.len() as f64)
}

/// 1 = β_0 > β_1 > … > β_m = 0, to where patterns of chance differ by about one. At β so many
/// directions count, σ_i the singular values of R and ¼ the variance of an element,
///
/// > k(β) = Σ_i β σ_i²/(4 + β σ_i²),
///
/// and χ² fluctuates by √(2 k): steps of ln β of 1/√(1 + ½ k) let neighbours exchange.
fn temperatures(land: &Land<'_>) -> Result<Vec<f64>, LinalgError> {
    let random = &mut Stream::new(Sampling::Pcg, key(2));
    let chance = (0..CHANCE).map(|_| Walker::of_chance(land, random).chi2);
    let hottest = 2.0 / (chance.sum::<f64>() / CHANCE as f64).max(2.0);
    let sigma = svd(land.ground.r)?.sigma;
    let mut betas = vec![1.0];
    let mut beta = 1.0;
    while beta > hottest && betas.len() < MOST_COPIES {
        let count = |s: &f64| beta * s * s / (4.0 + beta * s * s);
        let counted: f64 = sigma.iter().map(count).sum();
        beta *= libm::exp(-1.0 / (1.0 + 0.5 * counted).sqrt());
        betas.push(beta);
    }
    betas.push(0.0);
    Ok(betas)
}

/// The random numbers of a ladder.
fn key(ladder: u32) -> Key {
    Key {
        seed: 0,
        spot: ladder,
        pixel: 0,
        block: 0,
    }
}

/// Probabilities by sampling, from the best pattern known, and the pattern of the least χ² that was
/// met; each ladder takes so many multiplications.
pub(super) fn sample(
    ground: &Ground<'_>,
    start: &[bool],
    multiplications: f64,
) -> Result<Summed, RecoveryError> {
    let land = &Land::new(ground);
    let betas = temperatures(land)?;
    let n = ground.r.ncols();
    let work = betas.len() as f64 * (2 * n * (ground.d.len() + n)) as f64;
    let [fewest, most] = SWEEPS;
    let sweeps = ((multiplications / work) as usize).clamp(fewest, most);
    let ladders: Vec<Ladder> = [Some(start), None]
        .into_par_iter()
        .enumerate()
        .map(|(number, start)| ladder(land, &betas, sweeps, start, key(number as u32)))
        .collect();
    ground.control.check()?;
    let halves = |l: &Ladder| [&l.halves[0], &l.halves[1]].map(Moments::light);
    let apart = |a: &DVector<f64>, b: &DVector<f64>| (a - b).amax();
    let [own, other] = [&ladders[0], &ladders[1]];
    let whole = [own, other].map(|l| Moments::together(&l.halves));
    let between = apart(&whole[0].light(), &whole[1].light());
    // Of ladders that end apart the one from the best pattern counts by what it met, pattern by
    // pattern: a lower bound.
    let known: Vec<f64> = if between <= Sum::AGREEMENT {
        Vec::new()
    } else {
        let met = own.patterns.keys();
        met.filter_map(|light| ground.log_weight(light)).collect()
    };
    let (shares, log_evidence) = if known.is_empty() {
        let logs = [own.log_evidence, other.log_evidence];
        ([0.5, 0.5], log_mean(&logs))
    } else {
        let all = n as f64 * std::f64::consts::LN_2;
        let met = log_mean(&known) + libm::log(known.len() as f64) - all;
        let ahead = met - other.log_evidence;
        let share = if ahead.abs() < CLEAR {
            0.5
        } else {
            1.0 / (1.0 + libm::exp(-ahead))
        };
        let logs = [met, other.log_evidence];
        (
            [share, 1.0 - share],
            log_mean(&logs) + std::f64::consts::LN_2,
        )
    };
    let within = [own, other].map(|l| {
        let [first, second] = halves(l);
        apart(&first, &second)
    });
    let disagreement = (shares[0] * within[0])
        .max(shares[1] * within[1])
        .max(2.0 * shares[0].min(shares[1]) * between);
    let best = if own.best.0 <= other.best.0 {
        own.best.1.clone()
    } else {
        other.best.1.clone()
    };
    let mut weights = HashMap::new();
    for (ladder, (share, whole)) in [own, other].into_iter().zip(shares.iter().zip(&whole)) {
        for (pattern, count) in &ladder.patterns {
            *weights.entry(pattern.clone()).or_insert(0.0) += count * share / whole.weight;
        }
    }
    let mut drawn = Vec::with_capacity(2 * DRAWN);
    for (ladder, share) in ladders.iter().zip(shares) {
        let each = share / ladder.drawn.len() as f64;
        let with_share = |(light, levels): &(Vec<bool>, _)| (each, light.clone(), *levels);
        drawn.extend(ladder.drawn.iter().map(with_share));
    }
    let parts: Vec<Moments> = whole
        .iter()
        .zip(shares)
        .map(|(whole, share)| whole.scaled(share / whole.weight))
        .collect();
    Ok(Summed {
        moments: Moments::together(&parts),
        weights,
        log_evidence,
        sum: Sum::Sampled {
            sweeps: sweeps - sweeps / 5,
            disagreement,
        },
        best,
        drawn,
    })
}
