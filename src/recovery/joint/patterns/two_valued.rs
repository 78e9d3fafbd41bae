//! Least squares over all pixels and spots with reflectances of two values only, ρ_j ∈ {dark,
//! light}, and how likely each element is to be the light one.
//!
//! The pattern is one that no change of one or two elements improves, and not always the best of
//! all ([`super::pattern_search`]); or the likeliest where neighbours may be alike, if that is
//! settled and the photographs say that they are. Else, where levels are given and all patterns
//! were summed, it is the one of those that fit that is expected to have the most elements right:
//! the best fit is to noise too. The reported gap says how far it can be above the best: with given
//! levels above what branch and bound left open (zero: proved best), with estimated ones above the
//! minimum over all 0 ≤ ρ ≤ 1.
//!
//! The probabilities are sums over all patterns of few elements ([`super::enumerated`]), of more
//! over the likeliest and by sampling ([`super::sampled`]), every pattern as likely beforehand.
//! What they are where neighbours may be alike, in fields of one element or of more
//! ([`super::fields`]), stands beside them, and the evidence against what other methods assume is
//! of that. The standard errors are of the assumption that the picture goes by. Where the levels
//! are not given, these errors and the levels allow for elements that differ from their level, as
//! far as the photographs do ([`super::spread`]).

use super::alike::{settled_pattern, where_alike};
use super::fields::{self, Fields};
use super::pattern_likelihood::PatternLikelihood;
use super::pattern_search::{Found, Levels, Search};
use super::scaled::Scaled;
use super::{enumerated, pattern_lattice, sampled, spread};
use crate::recovery::joint::coordinates::Coordinates;
use crate::recovery::joint::operator::scale;
use crate::recovery::{
    Choice, Method, Options, Parameter, Patterns, Problem, Recovered, RecoveryError, Solver, Sum,
};

/// Above this many elements patterns are not sampled.
const MOST_SAMPLED: usize = 400;
/// Patterns that are drawn, times n², and at least and at most.
const DRAWS: f64 = 1.6e9;
const FEWEST: f64 = 2000.0;
const MOST: f64 = 400_000.0;
/// Probability of the likeliest patterns together, of which the picture is one: what is likelier of
/// each element need not fit the photographs as a whole.
const CREDIBLE: f64 = 0.95;

/// Bytes that this method takes of so many elements beside what every joint method does, at most:
/// two matrices of n × n numbers for each lattice that is held.
pub fn two_valued_bytes(elements: usize) -> f64 {
    let held = if elements <= MOST_SAMPLED {
        sampled::MOST_LATTICES
    } else if elements <= pattern_lattice::MOST {
        2 * rayon::current_num_threads()
    } else {
        0
    };
    16.0 * held as f64 * (elements as f64).powi(2)
}

/// Patterns of n elements that are drawn.
fn draws(n: usize) -> usize {
    (DRAWS / (n * n) as f64).clamp(FEWEST, MOST) as usize
}

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
    let unit = scale::unit(problem)?;
    let coordinates = Coordinates::new(method, problem, options, unit, 1.0)?;
    let (mut r, d) = coordinates.whitened();
    r *= unit;
    let n = problem.c.ncols();
    let given = options.levels.filter(|_| !free);
    let levels = match (options.levels, free) {
        (Some(levels), false) => Levels::Given(levels),
        (Some(levels), true) => Levels::Ratio(levels),
        (None, true) => Levels::Within(f64::INFINITY),
        (None, false) => Levels::Within(1.0),
    };
    // About estimates of picture and scale the problem is linear, and holds near these.
    let whole = problem.soft.and_then(|soft| soft.whole.as_ref());
    let contrast = whole.filter(|_| options.levels.is_none());
    let contrast = contrast.map(|(z, _)| (z.max() - z.min()) / unit);
    let likelihood = PatternLikelihood {
        control: problem.control,
        scale_error: problem.nuisance.scale_error,
        ..PatternLikelihood::new(&r, &d, given)
    };
    let scaled = Scaled::of(&likelihood);
    let near = scaled.map(|scaled| scaled.search()).transpose()?;
    let (near, linear) = near
        .map(|near| ((near.light, near.found), near.linear))
        .unzip();
    let (own, seen) = linear.as_ref().map_or((&r, &d), |(r, d)| (r, d));
    let search = Search::new(own, seen, levels)
        .about(contrast)
        .under(problem.control);
    let Found {
        mut best,
        mut bound,
        mut changes,
        iterations,
    } = match near {
        Some((light, found)) => Found {
            best: search.fit(light),
            ..found
        },
        None => search.best()?,
    };
    let grids = problem.grids.unwrap_or(&[]);
    let mut known = Vec::new();
    let even = [Fields::even(n)];
    // A scale that is free has no measure of what is likely.
    let summed = if free || n > MOST_SAMPLED || !options.probabilities {
        None
    } else {
        if !enumerated::can(&likelihood) {
            // Where little is told, rough patterns fit better than those that are likely
            // beforehand.
            known = search.alike(grids)?;
            known.push(best.light.clone());
        }
        fields::sum(&likelihood, &even, &known, (draws(n), None))?
    };
    if let (Some(summed), Some(_)) = (&summed, scaled) {
        let likeliest = summed.patterns.likeliest().map(|of| of.0.clone());
        best = search.fit(likeliest.unwrap_or(best.light));
    } else if let Some(summed) = &summed {
        let found = search.descend(summed.best.clone(), &mut changes);
        if search.can(&found) && found.misfit < best.misfit {
            best = found;
        }
    }
    if given.is_some() && summed.as_ref().is_some_and(|s| s.sum == Sum::Exhaustive) {
        bound = 0.5 * best.misfit;
    }
    let sizes = match summed {
        Some(_) => Fields::alike(grids),
        None => Vec::new(),
    };
    let (gained, alike) = match &summed {
        Some(summed) => {
            known.push(best.light.clone());
            where_alike(&likelihood, (&sizes, &known), (summed, draws(n)))?
        }
        None => (None, None),
    };
    let mut status = "no change of one or two elements improves";
    let settled = summed.as_ref();
    let settled = settled.and_then(|even| settled_pattern(gained, alike.as_ref(), even));
    let settled = settled.map(|light| search.fit(light));
    let settled = settled.filter(|found| search.can(found));
    let settled_if_alike = settled.is_some();
    if let Some(found) = settled.filter(|found| found.light != best.light) {
        status = "the likeliest pattern where neighbours are alike";
        best = found;
    }
    let all = summed.as_ref().filter(|s| s.sum == Sum::Exhaustive);
    let all = all.filter(|_| given.is_some() && !settled_if_alike);
    let nearest = all.and_then(|all| all.patterns.nearest(CREDIBLE));
    if let Some(light) = nearest.filter(|light| **light != best.light) {
        status = "the pattern that is expected to have most elements right";
        best = search.fit(light.clone());
    }
    let objective = 0.5 * best.misfit;
    let shown = best.values();
    let (sizes, assumed) = if settled_if_alike {
        (&sizes[..], alike.as_ref())
    } else {
        (&even[..], summed.as_ref())
    };
    let spread = match assumed {
        Some(exact) if given.is_none() && options.spreads => Some(spread::sum(
            &likelihood,
            (sizes, exact),
            (&best.light, &shown),
        )?),
        _ => None,
    };
    let converged = assumed.filter(|exact| exact.sum.converged());
    let told = converged.map(|exact| &exact.patterns);
    let whole = scaled.map(|scaled| scaled.deviation(&best.light, told));
    let factor = whole.as_ref().map_or(1.0, |of| 1.0 + of.size[0]);
    let mut recovered = coordinates.finish(method, problem, options, &shown * (unit * factor))?;
    if whole.is_some() {
        recovered.reflectance = shown.clone();
        let gains = &mut recovered.nuisance.get_or_insert_default().gains;
        gains.get_or_insert_default().whole = whole;
    }
    recovered.standard_error = converged.map(|exact| match &spread {
        Some(spread) => spread.error.clone(),
        None => exact.patterns.moments.square_about(&shown).map(f64::sqrt),
    });
    recovered.patterns = summed.map(|summed| {
        let own = summed.finish(&best.light);
        let alike = alike.map(|alike| alike.finish(&best.light));
        let told = |of: Patterns| match &spread {
            Some(spread) => spread.finish(of),
            None => of,
        };
        let (own, alike) = if settled_if_alike {
            (own, alike.map(told))
        } else {
            (told(own), alike)
        };
        Patterns {
            if_alike: alike.map(Box::new),
            settled_if_alike,
            ..own
        }
    });
    let of_patterns = recovered.patterns.as_ref().map(|p| p.log_evidence);
    recovered.log_evidence = gained.and_then(|gained| Some(of_patterns? + gained));
    let levels = [recovered.reflectance.min(), recovered.reflectance.max()];
    recovered.parameter = Parameter::Levels(given.unwrap_or(levels));
    recovered.choice = match options.levels {
        Some(_) => Choice::Given,
        None => Choice::Estimated,
    };
    recovered.solver = Some(Solver {
        status: status.to_owned(),
        iterations,
        refinements: changes,
        objective,
        gap: (objective - bound).max(0.0),
    });
    Ok(recovered)
}

#[cfg(test)]
mod boards;
#[cfg(test)]
mod tests;
