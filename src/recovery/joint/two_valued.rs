//! Least squares over all pixels and spots with reflectances of two values only, ρ_j ∈ {dark,
//! light}.
//!
//! A combinatorial problem, searched in two ways. Descent: from the minimiser over all 0 ≤ ρ ≤ 1,
//! cut at several thresholds, the change of one or two elements that lowers ‖R ρ − d‖ most is made
//! until none lowers it; without given levels also from the minimisers between pairs of levels.
//! Branch and bound ([`super::branch`]): with the levels held, elements are
//! put to one level after the other, and what relaxation shows to be hopeless is left out; it ends
//! with a proof or after a fixed number of relaxations. Where the levels are not given they are the
//! best for each pattern (least squares in [0, 1]), found anew after every search, until nothing
//! improves. Misfits are norms of R ρ − d itself, never differences of Gram products, which would
//! lose what little noise leaves.
//!
//! So the result is a pattern that no change of one or two elements improves, and not always the
//! best of all. The reported gap says how far it can be above that: with given levels above what
//! branch and bound left open (zero: proved best), with estimated ones above the minimum over all 0
//! ≤ ρ ≤ 1.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::branch;
use super::coordinates::Coordinates;
use super::ground::Ground;
use super::{enumerated, tempered};
use crate::num::linalg::gram_product;
use crate::num::quadratic::{Bounds, box_least_squares, box_least_squares_from};
use crate::recovery::{
    Choice, Method, Options, Parameter, Problem, Recovered, RecoveryError, Solver, Sum,
};

/// Thresholds that the relaxation is cut at.
const STARTS: usize = 12;
/// Steps of the lattice of levels.
const LEVELS: usize = 10;
/// Above this many elements pairs are not tried: their number times the rows is the cost of one
/// step.
const MOST_PAIRED: usize = 2048;
/// Above this many elements patterns are not sampled.
const MOST_SAMPLED: usize = 1024;
/// Searches by branch and bound, each with the levels of the best pattern so far.
const ROUNDS: usize = 8;
/// Of the best descents so many have their levels searched with.
const TRIALS: usize = 6;
/// Levels that differ by less, relative to the light one, are searched with once.
const SAME: f64 = 1e-3;
/// A change must lower ‖R ρ − d‖² by more than this fraction, or rounding would go round in
/// circles.
const WORTH: f64 = 1e-10;

pub(in crate::recovery) fn recover(
    problem: &Problem<'_>,
    options: &Options,
) -> Result<Recovered, RecoveryError> {
    let method = Method::JointTwoValued;
    if let Some([dark, light]) = options.levels
        && !(0.0 <= dark && dark < light && light <= 1.0)
    {
        return Err(RecoveryError::BadParameter {
            method,
            name: "the light level",
            value: light,
            cure: "give two reflectances, 0 ≤ dark < light ≤ 1",
        });
    }
    let free = problem.nuisance.free_scale;
    let unit = if free {
        problem.brightness().abs()
    } else {
        1.0
    };
    let coordinates = Coordinates::new(method, problem, options, unit)?;
    let (r, d) = coordinates.whitened();
    let n = problem.c.ncols();
    let top = if free { f64::INFINITY } else { 1.0 };
    let given = options.levels.filter(|_| top == 1.0);
    let bounds = match given {
        Some([dark, light]) => Bounds::all(n, dark, light),
        None => Bounds::all(n, 0.0, top),
    };
    let relaxed = box_least_squares(&r, &d, &bounds)?;
    let mut gram = DMatrix::zeros(n, n);
    gram_product(&mut gram, &r);
    let search = Search {
        r: &r,
        d: &d,
        gram,
        levels: match (options.levels, top == 1.0) {
            (Some(levels), true) => Levels::Given(levels),
            (Some(levels), false) => Levels::Ratio(levels),
            (None, _) => Levels::Within(top),
        },
    };
    let starts = starts(&r, &d, &relaxed.solution, given, top)?;
    let descents: Result<Vec<(Pattern, usize)>, RecoveryError> = starts
        .into_par_iter()
        .map(|start| {
            let mut changes = 0;
            Ok((search.descend(start, &mut changes)?, changes))
        })
        .collect();
    let mut descents = descents?;
    let mut changes = descents.iter().map(|(_, changes)| changes).sum();
    descents.sort_by(|(a, _), (b, _)| a.misfit.total_cmp(&b.misfit));
    let Some((mut best, _)) = descents.first().cloned() else {
        return Err(RecoveryError::NO_DIRECTION);
    };
    let mut bound = relaxed.objective - relaxed.gap;
    // Levels yet to be searched with, last first.
    let mut trials = match given {
        Some(levels) => vec![levels],
        None if top == 1.0 => vec![[relaxed.solution.min(), relaxed.solution.max()], [0.0, 1.0]],
        None => vec![[relaxed.solution.min(), relaxed.solution.max()]],
    };
    if given.is_none() {
        let known = descents.iter().take(TRIALS).rev();
        trials.extend(known.map(|(found, _)| {
            let [a, b] = found.levels;
            [a.min(b), a.max(b)]
        }));
    }
    let mut tried: Vec<[f64; 2]> = Vec::new();
    for _ in 0..ROUNDS {
        let Some(levels) = trials.pop() else { break };
        let near = |old: &[f64; 2]| {
            (old[0] - levels[0]).abs() + (old[1] - levels[1]).abs() < SAME * levels[1]
        };
        if levels[0] >= levels[1] || tried.iter().any(near) {
            continue;
        }
        tried.push(levels);
        // Misfits at other levels than a pattern's best do not compare.
        let known = match given {
            Some(_) => 0.5 * best.misfit,
            None => f64::INFINITY,
        };
        let searched = branch::search(&r, &d, levels, &relaxed.solution, known)?;
        if given.is_some() {
            bound = bound.max(searched.bound);
        }
        let Some(light) = searched.light else {
            continue;
        };
        let found = search.descend(light, &mut changes)?;
        if found.misfit < best.misfit * (1.0 - WORTH) {
            best = found;
            let [a, b] = best.levels;
            trials.push([a.min(b), a.max(b)]);
        }
    }
    // A scale that is free has no measure of what is likely.
    let ground = Ground::new(&r, &d, given);
    let summed = if free || n > MOST_SAMPLED {
        None
    } else if enumerated::can(&ground) {
        Some(enumerated::sum(&ground))
    } else {
        Some(tempered::sample(&ground, &best.light)?)
    };
    if let Some(summed) = &summed {
        let found = search.descend(summed.best.clone(), &mut changes)?;
        if found.misfit < best.misfit {
            best = found;
        }
    }
    let objective = 0.5 * best.misfit;
    if given.is_some() && summed.as_ref().is_some_and(|s| s.sum == Sum::Exhaustive) {
        bound = objective;
    }
    let mut recovered = coordinates.finish(method, problem, options, best.values())?;
    // The pattern alone is no more than all of them.
    let own = ground.log_weight(&best.light).unwrap_or(f64::NEG_INFINITY);
    let own = own - n as f64 * std::f64::consts::LN_2;
    let patterns = summed.map(|summed| summed.finish(&best.light));
    recovered.log_evidence = patterns.as_ref().map(|p| p.log_evidence.max(own));
    let known = patterns.as_ref().filter(|p| p.sum.converged());
    recovered.standard_error = known.map(|p| p.deviation.clone());
    recovered.patterns = patterns;
    let levels = [recovered.reflectance.min(), recovered.reflectance.max()];
    recovered.parameter = Parameter::Levels(given.unwrap_or(levels));
    recovered.choice = match given {
        Some(_) => Choice::Given,
        None => Choice::Estimated,
    };
    recovered.solver = Some(Solver {
        status: "no change of one or two elements improves".to_owned(),
        iterations: relaxed.iterations,
        refinements: changes,
        objective,
        gap: (objective - bound).max(0.0),
    });
    Ok(recovered)
}

#[derive(Clone, Copy)]
enum Levels {
    /// As given.
    Given([f64; 2]),
    /// A common factor of the given ones, 0 or more, is free.
    Ratio([f64; 2]),
    /// Both free from 0 to this.
    Within(f64),
}

#[derive(Clone)]
struct Pattern {
    light: Vec<bool>,
    levels: [f64; 2],
    /// ‖R ρ − d‖².
    misfit: f64,
}

impl Pattern {
    fn values(&self) -> DVector<f64> {
        let [dark, light] = self.levels;
        DVector::from_fn(
            self.light.len(),
            |j, _| if self.light[j] { light } else { dark },
        )
    }
}

struct Search<'a> {
    r: &'a DMatrix<f64>,
    d: &'a DVector<f64>,
    /// RᵀR.
    gram: DMatrix<f64>,
    levels: Levels,
}

impl Search<'_> {
    /// The pattern with its best levels.
    fn fit(&self, light: Vec<bool>) -> Result<Pattern, RecoveryError> {
        let of = |which: bool| {
            let set = DVector::from_fn(light.len(), |j, _| f64::from(u8::from(light[j] == which)));
            self.r * set
        };
        let columns = [of(false), of(true)];
        let levels = match self.levels {
            Levels::Given(levels) => levels,
            Levels::Ratio([a, b]) => {
                let one = &columns[0] * a + &columns[1] * b;
                let factor = (one.dot(self.d) / one.norm_squared()).max(0.0);
                [factor * a, factor * b]
            }
            Levels::Within(top) => {
                let x = box_least_squares(
                    &DMatrix::from_columns(&columns),
                    self.d,
                    &Bounds::all(2, 0.0, top),
                )?
                .solution;
                [x[0], x[1]]
            }
        };
        let misfit = (&columns[0] * levels[0] + &columns[1] * levels[1] - self.d).norm_squared();
        Ok(Pattern {
            light,
            levels,
            misfit,
        })
    }

    /// Changes and levels in turn until neither lowers the misfit.
    fn descend(&self, start: Vec<bool>, changes: &mut usize) -> Result<Pattern, RecoveryError> {
        let mut best = self.fit(start)?;
        loop {
            let before = best.misfit;
            let mut light = best.light.clone();
            *changes += self.change(&mut light, best.levels);
            let found = self.fit(light)?;
            if found.misfit < before * (1.0 - WORTH) {
                best = found;
            } else {
                return Ok(best);
            }
        }
    }

    /// Makes the best change of one or two elements until none is worth it; how many were made. With
    /// x_j changed by t, ‖R x − d‖² changes by −2 t g_j + t² G_jj, g = Rᵀ(d − R x), G = RᵀR.
    fn change(&self, light: &mut [bool], [dark, bright]: [f64; 2]) -> usize {
        let n = light.len();
        let mut made = 0;
        loop {
            let values = DVector::from_fn(n, |j, _| if light[j] { bright } else { dark });
            let residual = self.d - self.r * values;
            let slope = self.r.tr_mul(&residual);
            let step = |j: usize| {
                if light[j] {
                    dark - bright
                } else {
                    bright - dark
                }
            };
            let single: Vec<f64> = (0..n)
                .map(|j| step(j) * (step(j) * self.gram[(j, j)] - 2.0 * slope[j]))
                .collect();
            let (mut least, mut which) = (-WORTH * residual.norm_squared(), None);
            for i in 0..n {
                if single[i] < least {
                    (least, which) = (single[i], Some((i, None)));
                }
                let others = if n <= MOST_PAIRED { i + 1..n } else { n..n };
                let column = self.gram.column(i);
                for j in others {
                    let change = single[i] + single[j] + 2.0 * step(i) * step(j) * column[j];
                    if change < least {
                        (least, which) = (change, Some((i, Some(j))));
                    }
                }
            }
            let Some((i, j)) = which else { return made };
            for at in std::iter::once(i).chain(j) {
                light[at] = !light[at];
            }
            // Measured: what little noise leaves is not told by differences.
            let values = DVector::from_fn(n, |j, _| if light[j] { bright } else { dark });
            let found = (self.d - self.r * values).norm_squared();
            if found >= residual.norm_squared() * (1.0 - WORTH) {
                for at in std::iter::once(i).chain(j) {
                    light[at] = !light[at];
                }
                return made;
            }
            made += 1;
        }
    }
}

/// Patterns to descend from: those of the relaxation to all values, and, where the levels are not
/// given, of the relaxations between the pairs of levels of a lattice. Near the true levels a
/// relaxation between them is nearly the pattern; between others it is not.
fn starts(
    r: &DMatrix<f64>,
    d: &DVector<f64>,
    relaxed: &DVector<f64>,
    given: Option<[f64; 2]>,
    top: f64,
) -> Result<Vec<Vec<bool>>, RecoveryError> {
    let mut starts = thresholds(relaxed);
    if given.is_some() || top > 1.0 {
        return Ok(starts);
    }
    let level = |k: usize| k as f64 / LEVELS as f64;
    let pairs: Vec<[f64; 2]> = (0..LEVELS)
        .flat_map(|a| (a + 1..=LEVELS).map(move |b| [level(a), level(b)]))
        .collect();
    let between = |[dark, light]: &[f64; 2]| -> Result<Vec<bool>, RecoveryError> {
        let bounds = Bounds::all(r.ncols(), *dark, *light);
        let found = box_least_squares_from(r, d, &bounds, relaxed)?.solution;
        let middle = 0.5 * (dark + light);
        Ok(found.iter().map(|x| *x > middle).collect())
    };
    let found: Result<Vec<Vec<bool>>, RecoveryError> = pairs.par_iter().map(between).collect();
    for start in found? {
        if !starts.contains(&start) {
            starts.push(start);
        }
    }
    Ok(starts)
}

/// Patterns of a relaxation: light where it exceeds a threshold, thresholds between neighbouring
/// values, spread over the values' ranks.
fn thresholds(relaxed: &DVector<f64>) -> Vec<Vec<bool>> {
    let mut values: Vec<f64> = relaxed.iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let middles: Vec<f64> = values.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
    let half = 0.5 * (values[0] + values[values.len() - 1]);
    let chosen = (0..STARTS).filter_map(|k| middles.get(k * middles.len() / STARTS).copied());
    let mut starts: Vec<Vec<bool>> = Vec::new();
    for threshold in chosen.chain([half]) {
        let start: Vec<bool> = relaxed.iter().map(|x| *x > threshold).collect();
        if !starts.contains(&start) {
            starts.push(start);
        }
    }
    starts
}

#[cfg(test)]
mod tests;
