//! Least squares over all pixels and spots with reflectances of two values only, ρ_j ∈ {dark,
//! light}, and how likely each element is to be the light one.
//!
//! The pattern is one that no change of one or two elements improves, and not always the best of all
//! ([`super::pattern_search`]). The reported gap says how far it can be above that: with given levels
//! above what branch and bound left open (zero: proved best), with estimated ones above the minimum
//! over all 0 ≤ ρ ≤ 1. The probabilities are sums over all patterns of few elements
//! ([`super::enumerated`]), of more by sampling ([`super::tempered`]).
//!
//! A model that is not exact, or a surface that is not quite of two values, fits no pattern, and least
//! squares then takes noise for what the model lacks. Where the best pattern is refuted, elements may
//! therefore deviate from their level, x_j = level + N(0, ν²): of a few ν the one whose best pattern
//! makes the photographs likeliest; patterns are summed with it, and it is told.

use nalgebra::{DMatrix, DVector};

use super::coordinates::Coordinates;
use super::ground::Ground;
use super::pattern_search::{Found, Levels, Search};
use super::{enumerated, tempered};
use crate::num::linalg::{Cholesky, product};
use crate::num::statistics::chi_square_sf;
use crate::recovery::{
    Choice, Method, Options, Parameter, Patterns, Problem, Recovered, RecoveryError, Solver, Sum,
};

/// Above this many elements patterns are not sampled.
const MOST_SAMPLED: usize = 1024;
/// A pattern of two values is refuted below this probability.
const REFUTED: f64 = 1e-3;
/// Deviations from a level that are tried.
const DEVIATIONS: [f64; 5] = [1e-3, 3e-3, 1e-2, 3e-2, 1e-1];

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
    let (mut r, mut d) = coordinates.whitened();
    let given = options.levels.filter(|_| !free);
    let levels = match (options.levels, free) {
        (Some(levels), false) => Levels::Given(levels),
        (Some(levels), true) => Levels::Ratio(levels),
        (None, true) => Levels::Within(f64::INFINITY),
        (None, false) => Levels::Within(1.0),
    };
    let mut found = Search::new(&r, &d, levels).best()?;
    let (mut deviation, mut log_width) = (0.0, 0.0);
    if chi_square_sf(found.best.misfit, d.len() as f64) < REFUTED {
        let mut score = found.best.misfit;
        let (exact_r, exact_d) = (r.clone(), d.clone());
        for own in DEVIATIONS {
            let (wide_r, wide_d, width) = widened(&exact_r, &exact_d, own)?;
            let tried = Search::new(&wide_r, &wide_d, levels).best()?;
            if tried.best.misfit + width < score {
                score = tried.best.misfit + width;
                (deviation, log_width) = (own, width);
                (r, d, found) = (wide_r, wide_d, tried);
            }
        }
    }
    let search = Search::new(&r, &d, levels);
    let Found {
        mut best,
        mut bound,
        mut changes,
        iterations,
    } = found;
    // A scale that is free has no measure of what is likely.
    let n = problem.c.ncols();
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
    recovered.patterns = summed.map(|summed| {
        let of = summed.finish(&best.light);
        Patterns {
            log_evidence: of.log_evidence.max(own) - 0.5 * log_width,
            spread: deviation,
            ..of
        }
    });
    recovered.log_evidence = recovered.patterns.as_ref().map(|p| p.log_evidence);
    let known = recovered.patterns.as_ref().filter(|p| p.sum.converged());
    let error = |s: f64| (s * s + deviation * deviation).sqrt();
    recovered.standard_error = known.map(|p| p.deviation.map(error));
    let levels = [recovered.reflectance.min(), recovered.reflectance.max()];
    recovered.parameter = Parameter::Levels(given.unwrap_or(levels));
    recovered.choice = match given {
        Some(_) => Choice::Given,
        None => Choice::Estimated,
    };
    recovered.solver = Some(Solver {
        status: "no change of one or two elements improves".to_owned(),
        iterations,
        refinements: changes,
        objective,
        gap: (objective - bound).max(0.0),
    });
    Ok(recovered)
}

/// R and d in standard deviations where elements deviate by ν from their level, whose errors have the
/// covariance 1 + ν² R Rᵀ, and ln det of that.
fn widened(
    r: &DMatrix<f64>,
    d: &DVector<f64>,
    nu: f64,
) -> Result<(DMatrix<f64>, DVector<f64>, f64), RecoveryError> {
    let identity = DMatrix::identity(d.len(), d.len());
    let errors = identity + product(r, &r.transpose()) * (nu * nu);
    let factor = Cholesky::new(&errors).ok_or(RecoveryError::NO_DIRECTION)?;
    let column = DMatrix::from_column_slice(d.len(), 1, d.as_slice());
    let d = factor.forward(column).column(0).into_owned();
    Ok((factor.forward(r.clone()), d, factor.log_det()))
}

#[cfg(test)]
mod tests;
