//! Least squares over all pixels and spots with reflectances of two values only, ρ_j ∈ {dark,
//! light}.
//!
//! A combinatorial problem, searched in two ways. Descent: from the minimiser over all 0 ≤ ρ ≤ 1,
//! cut at several thresholds, the change of one or two elements that lowers ‖R ρ − d‖ most is made
//! until none lowers it. Branch and bound ([`super::branch`]): with the levels held, elements are
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

use super::branch;
use super::reduced::Reduced;
use crate::num::quadratic::{Bounds, box_least_squares};
use crate::recovery::{
    Choice, Method, Options, Parameter, Problem, Recovered, RecoveryError, Solver,
};

/// Thresholds that the relaxation is cut at.
const STARTS: usize = 12;
/// Above this many elements pairs are not tried: their number times the rows is the cost of one
/// step.
const MOST_PAIRED: usize = 512;
/// Searches by branch and bound, each with the levels of the best pattern so far.
const ROUNDS: usize = 5;
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
    let reduced = Reduced::new(problem, options)?;
    let n = problem.c.ncols();
    let top = if problem.nuisance.free_scale {
        f64::INFINITY
    } else {
        1.0
    };
    let given = options.levels.filter(|_| top == 1.0);
    let bounds = match given {
        Some([dark, light]) => Bounds::all(n, dark, light),
        None => Bounds::all(n, 0.0, top),
    };
    let relaxed = box_least_squares(&reduced.r, &reduced.d, &bounds)?;
    let search = Search {
        r: &reduced.r,
        d: &reduced.d,
        levels: match (options.levels, top == 1.0) {
            (Some(levels), true) => Levels::Given(levels),
            (Some(levels), false) => Levels::Ratio(levels),
            (None, _) => Levels::Within(top),
        },
    };
    let mut best: Option<Pattern> = None;
    let mut changes = 0;
    for start in thresholds(&relaxed.solution) {
        let found = search.descend(start, &mut changes)?;
        if best.as_ref().is_none_or(|b| found.misfit < b.misfit) {
            best = Some(found);
        }
    }
    let Some(mut best) = best else {
        return Err(RecoveryError::NO_DIRECTION);
    };
    let mut bound = relaxed.objective - relaxed.gap;
    // Levels yet to be searched with, last first.
    let mut trials = match given {
        Some(levels) => vec![levels],
        None if top == 1.0 => vec![[relaxed.solution.min(), relaxed.solution.max()], [0.0, 1.0]],
        None => vec![[relaxed.solution.min(), relaxed.solution.max()]],
    };
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
        let searched = branch::search(&reduced.r, &reduced.d, levels, &relaxed.solution, known)?;
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
    let objective = 0.5 * best.misfit;
    let mut recovered = reduced.finish(method, problem, options, best.values())?;
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

    /// Makes the best change of one or two elements until none is worth it; how many were made.
    fn change(&self, light: &mut [bool], [dark, bright]: [f64; 2]) -> usize {
        let n = light.len();
        let mut made = 0;
        loop {
            let values = DVector::from_fn(n, |j, _| if light[j] { bright } else { dark });
            let residual = self.r * values - self.d;
            let step = |j: usize| {
                if light[j] {
                    dark - bright
                } else {
                    bright - dark
                }
            };
            let (mut least, mut which) = (residual.norm_squared() * (1.0 - WORTH), None);
            for i in 0..n {
                let one = &residual + self.r.column(i) * step(i);
                let misfit = one.norm_squared();
                if misfit < least {
                    (least, which) = (misfit, Some((i, None)));
                }
                let others = if n <= MOST_PAIRED { i + 1..n } else { n..n };
                for j in others {
                    let by = step(j);
                    let misfit: f64 = one
                        .iter()
                        .zip(self.r.column(j).iter())
                        .map(|(e, c)| (e + c * by) * (e + c * by))
                        .sum();
                    if misfit < least {
                        (least, which) = (misfit, Some((i, Some(j))));
                    }
                }
            }
            let Some((i, j)) = which else { return made };
            for at in std::iter::once(i).chain(j) {
                light[at] = !light[at];
            }
            made += 1;
        }
    }
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
