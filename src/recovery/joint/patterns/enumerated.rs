//! The probabilities of all patterns of few elements, one by one.

use std::collections::HashMap;

use nalgebra::DVector;

use super::levels::{ALL, rule};
use super::pattern_likelihood::{PatternLikelihood, Weighed};
use super::pattern_sums::{Moments, Summed, WeighedPatterns};
use crate::recovery::Sum;

/// Most elements whose patterns are all summed, with given levels and without.
const MOST: [usize; 2] = [18, 16];
/// A pattern whose weight is below the best's by e to this adds nothing.
const NEGLIGIBLE: f64 = 40.0;

/// Whether all patterns of so many elements are summed.
pub(super) fn can(likelihood: &PatternLikelihood<'_>) -> bool {
    likelihood.r.ncols() <= MOST[usize::from(likelihood.given.is_none())]
}

/// The sum over all 2ⁿ patterns, those that are likely beforehand the more; the best is the
/// likeliest: of given levels and even patterns that of the least χ².
pub(super) fn sum(likelihood: &PatternLikelihood<'_>) -> Summed {
    let n = likelihood.r.ncols();
    // ln weights by pattern number, pattern after pattern by one element (Gray).
    let mut lit = DVector::zeros(likelihood.d.len());
    let mut at = 0usize;
    let quadrature = rule();
    let mut weights: Vec<(usize, Weighed)> = Vec::new();
    let mut top = f64::NEG_INFINITY;
    let pattern = |at: usize| -> Vec<bool> { (0..n).map(|j| at >> j & 1 == 1).collect() };
    let all = n as f64 * std::f64::consts::LN_2;
    // A pattern is likelier beforehand than of fair coins by 2ⁿ at most.
    let more = likelihood.alike.map_or(0.0, |_| all);
    for step in 0..1usize << n {
        if step > 0 {
            let j = step.trailing_zeros() as usize;
            at ^= 1 << j;
            let sign = if at >> j & 1 == 1 { 1.0 } else { -1.0 };
            lit.axpy(sign, &likelihood.r.column(j), 1.0);
            if step % 256 == 0 {
                lit = likelihood.lit(&pattern(at));
            }
        }
        let count = at.count_ones() as usize;
        let least = top - NEGLIGIBLE - more;
        let Some(mut found) = likelihood.weigh_lit((&lit, count), &quadrature, ALL, least) else {
            continue;
        };
        let Some(beforehand) = likelihood.beforehand(&pattern(at)) else {
            continue;
        };
        found.log += beforehand;
        top = top.max(found.log);
        weights.push((at, found));
    }
    weights.retain(|w| w.1.log > top - NEGLIGIBLE);
    let mut moments = Moments::new(n);
    let mut shares = HashMap::new();
    let mut best = (0, f64::NEG_INFINITY);
    for (at, found) in weights {
        let (light, weight) = (pattern(at), libm::exp(found.log - top));
        moments.add(&light, weight, found.levels);
        shares.insert(light, weight);
        if found.log > best.1 {
            best = (at, found.log);
        }
    }
    Summed {
        log_evidence: top + libm::log(moments.weight) - all,
        patterns: WeighedPatterns {
            moments,
            weights: shares,
        },
        sum: Sum::Exhaustive,
        best: pattern(best.0),
    }
}
