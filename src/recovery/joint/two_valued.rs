//! Least squares over all pixels and spots with reflectances of two values only, ρ_j ∈ {dark, light}.
//!
//! A combinatorial problem: what is found is a pattern that no change of one or two elements improves, the best from several starts, and not proved the
//! best of all. Starts are the minimiser over all 0 ≤ ρ ≤ 1, cut at several thresholds. From each, the change of one or two elements that lowers
//! ‖R ρ − d‖ most is made until none lowers it. Where the levels are not given they are the best for each pattern (least squares in [0, 1]), found anew whenever
//! no change is left, until nothing moves. Misfits are norms of R ρ − d itself, never differences of Gram products, which would lose what little noise
//! leaves.
//!
//! The reported gap is to the minimum over all reflectances between the levels (in [0, 1] where these are estimated): no pattern can lie below it.

use nalgebra::{DMatrix, DVector};

use super::reduced::Reduced;
use crate::num::quadratic::{Bounds, box_least_squares};
use crate::recovery::{
    Choice, Method, Options, Parameter, Problem, Recovered, RecoveryError, Solver,
};

/// Thresholds that the relaxation is cut at.
const STARTS: usize = 12;
/// Above this many elements pairs are not tried: their number times the rows is the cost of one step.
const MOST_PAIRED: usize = 512;
/// A change must lower ‖R ρ − d‖² by more than this fraction, or rounding would go round in circles.
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
    let Some(best) = best else {
        return Err(RecoveryError::RankZero {
            side: "model C, D as a whole",
        });
    };
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
        gap: (objective - (relaxed.objective - relaxed.gap)).max(0.0),
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

/// Patterns of a relaxation: light where it exceeds a threshold, thresholds between neighbouring values, spread over the values' ranks.
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
