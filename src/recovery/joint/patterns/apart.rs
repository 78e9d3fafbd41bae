//! Single elements that are of neither level.
//!
//! The others keep their levels exactly, or to within the spread that all have; the one differs by
//! a normal deviate of [`TAU`].

use nalgebra::DVector;
use rayon::prelude::*;

use super::levels::{ALL, rule};
use super::part::Whitened;
use super::pattern_likelihood::PatternLikelihood;
use crate::recovery::RecoveryError;

/// The largest spread that all elements may have.
const TAU: f64 = 0.3;
/// Up to so many elements each is asked; of more those that promise most, so many.
const FEW: usize = 16;
const MOST: usize = 3;

/// The elements that are asked: of many those without which the pattern, or one that differs from
/// it in one element, explains the photographs best.
pub(super) fn elements(likelihood: &PatternLikelihood<'_>, light: &[bool]) -> Vec<usize> {
    let n = light.len();
    if n <= FEW {
        return (0..n).collect();
    }
    let quadrature = rule();
    let count = light.iter().filter(|light| **light).count();
    let best = |j: usize| -> Option<f64> {
        let white = Whitened::of_one(likelihood, (j, TAU * TAU))?;
        let own = white.likelihood(likelihood);
        let lit = own.lit(light);
        let weigh = |lit: &DVector<f64>, count: usize| {
            let weighed = own.weigh_lit((lit, count), &quadrature, ALL, f64::NEG_INFINITY)?;
            Some(weighed.log - white.less())
        };
        let flipped = (0..n).filter_map(|k| {
            let (sign, count) = if light[k] {
                (-1.0, count - 1)
            } else {
                (1.0, count + 1)
            };
            weigh(&(&lit + own.r.column(k) * sign), count)
        });
        flipped.chain(weigh(&lit, count)).reduce(f64::max)
    };
    let each: Vec<Option<f64>> = (0..n).into_par_iter().map(best).collect();
    let each = each.into_iter().enumerate();
    let mut known: Vec<(usize, f64)> = each.filter_map(|(j, log)| Some((j, log?))).collect();
    known.sort_by(|a, b| b.1.total_cmp(&a.1));
    known.into_iter().take(MOST).map(|(j, _)| j).collect()
}

/// Photographs where `element` is apart and the others differ from their levels by `spread`; none
/// where it is not seen.
pub(super) fn whitened(
    likelihood: &PatternLikelihood<'_>,
    element: usize,
    spread: f64,
) -> Result<Option<Whitened>, RecoveryError> {
    if spread == 0.0 {
        return Ok(Whitened::of_one(likelihood, (element, TAU * TAU)));
    }
    let mut variances = DVector::from_element(likelihood.r.ncols(), spread * spread);
    variances[element] += TAU * TAU;
    Whitened::new(likelihood, variances).map(Some)
}
