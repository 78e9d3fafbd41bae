//! Mean and spread over the seeds, and the noise at which a modulation is lost.

use serde::{Deserialize, Serialize};

use super::axis::Spacing;
use super::trial::{Measures, Trial};
use crate::num::summation::{mean_and_stderr, tree_sum};

/// Relative spread of a denominator above which the mean of a ratio is not spoken of: the next terms of its expansion are then some 3·0.1⁴ of it.
pub(in super::super) const MOST_SPREAD: f64 = 0.1;

/// Mean and spread of a measure over the draws in which it is defined.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Draws.
    pub draws: usize,
    /// Mean.
    pub mean: f64,
    /// Standard deviation of a draw, √(Σ(x − x̄)²/(n − 1)); absent for a single one.
    pub deviation: Option<f64>,
    /// Standard error of the mean; absent for a single draw.
    pub stderr: Option<f64>,
}

impl Spread {
    /// Of `values`; `None` if there are none.
    pub(in super::super) fn of(values: &[f64]) -> Option<Self> {
        if values.is_empty() {
            return None;
        }
        let (mean, stderr) = mean_and_stderr(values);
        let squares: Vec<f64> = values.iter().map(|x| (x - mean) * (x - mean)).collect();
        let n = values.len();
        let several = |x: f64| (n > 1).then_some(x);
        Some(Self {
            draws: n,
            mean,
            deviation: several((tree_sum(&squares) / (n as f64 - 1.0)).sqrt()),
            stderr: several(stderr),
        })
    }
}

/// One level of the noise.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// The level.
    pub level: f64,
    /// Draws of the noise.
    pub draws: usize,
    /// Draws from which the method gave nothing.
    pub failed: usize,
    /// What it said to the first of them.
    pub failure: Option<String>,
    /// Raw MTF.
    pub mtf_raw: Option<Spread>,
    /// Standard deviation of its denominator W + B over the draws, relative to the mean; absent for a single draw.
    pub denominator_spread: Option<f64>,
    /// Normalized MTF.
    pub mtf_normalized: Option<Spread>,
    /// Correlation with the truth.
    pub correlation: Option<Spread>,
    /// Root mean square error of a draw, over elements.
    pub rmse: Option<Spread>,
    /// Root mean square error over elements and draws, √(mean of its squares).
    pub rmse_over_draws: Option<f64>,
    /// What no unbiased recovery has less of: √(tr CRB/r), CRB the bound of Cramér and Rao for the level's standard errors. Absent without noise, or
    /// where directions are lost in f64.
    pub cramer_rao: Option<f64>,
    /// The one over the other. Below 1 where a method is told more than the photographs (bounds, two values) or is biased towards the truth.
    pub rmse_over_bound: Option<f64>,
}

impl Point {
    /// Of the trials at one level, with the bound there.
    pub(super) fn of(level: f64, trials: &[&Trial], cramer_rao: Option<f64>) -> Self {
        let good = || trials.iter().filter_map(|t| t.outcome.as_ref().ok());
        let spread = |f: fn(&Measures) -> Option<f64>| {
            Spread::of(&good().filter_map(f).collect::<Vec<f64>>())
        };
        let denominator = spread(|m| m.light_plus_dark);
        let failure = trials.iter().find_map(|t| t.outcome.as_ref().err());
        let rmse = spread(|m| m.rmse);
        // Scaled by the mean, as squares of large errors overflow.
        let rmse_over_draws = rmse.map(|s| {
            let n = s.draws as f64;
            let relative = s.deviation.map_or(0.0, |d| d / s.mean);
            s.mean * (1.0 + relative * relative * (n - 1.0) / n).sqrt()
        });
        Self {
            level,
            draws: trials.len(),
            failed: trials.len() - good().count(),
            failure: failure.cloned(),
            mtf_raw: spread(|m| m.mtf_raw),
            denominator_spread: denominator.and_then(|s| Some(s.deviation? / s.mean.abs())),
            mtf_normalized: spread(|m| m.mtf_normalized),
            correlation: spread(|m| m.correlation),
            rmse,
            rmse_over_draws,
            cramer_rao,
            rmse_over_bound: rmse_over_draws.and_then(|e| Some(e / cramer_rao?)),
        }
    }
}

/// Where a mean modulation falls to a limit, coming from the quiet end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Lost {
    /// At this level, by interpolation (in its logarithm, of bits in their number) between the last level at or above the limit and the next. Where
    /// large levels are the quiet ones it is the smallest from which on the mean stays at or above the limit.
    At(f64),
    /// It is below the limit at the quietest level already.
    Before,
    /// It is not below the limit at any level.
    Never,
    /// Before the limit was reached the method failed in some draw, or the mean is not known to a tenth, or (raw MTF) the denominator W + B
    /// spreads by more than a tenth, so that there is no mean to speak of.
    Unknown,
}

/// How far a method holds the limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Reach {
    /// Up to the level, where its mean falls below.
    Falls,
    /// Up to the level, and beyond it nothing is known: it is the loudest studied, or there is no mean to speak of at the next ([`Lost::Unknown`]).
    AtLeast,
}

/// Up to which level a mean modulation stays at or above a limit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Held {
    /// The level.
    pub level: f64,
    /// What is known of the levels beyond.
    pub reach: Reach,
}

/// Where the mean first falls below `limit`; `curve` lists levels from quiet to loud with the mean over all draws there, if there is one.
pub(super) fn lost(curve: &[(f64, Option<f64>)], limit: f64, spacing: Spacing) -> Lost {
    let mut before: Option<(f64, f64)> = None;
    for &(level, mean) in curve {
        let Some(mean) = mean else {
            return Lost::Unknown;
        };
        if mean < limit {
            return before.map_or(Lost::Before, |(quiet, high)| {
                Lost::At(spacing.at([quiet, level], (high - limit) / (high - mean)))
            });
        }
        before = Some((level, mean));
    }
    if before.is_some() {
        Lost::Never
    } else {
        Lost::Unknown
    }
}

/// Up to which level the mean of such a curve stays at or above `limit`; `None` if it is not there at the quietest. A mean as far above 1 as `limit` is
/// below is none to speak of: it is that of a recovery with negative values.
pub(super) fn held(curve: &[(f64, Option<f64>)], limit: f64, spacing: Spacing) -> Option<Held> {
    let trusted = |mean: &f64| *mean <= 2.0 - limit;
    let curve: Vec<(f64, Option<f64>)> = curve
        .iter()
        .map(|(level, mean)| (*level, mean.filter(trusted)))
        .collect();
    if let Lost::At(level) = lost(&curve, limit, spacing) {
        let reach = Reach::Falls;
        return Some(Held { level, reach });
    }
    let above = curve
        .iter()
        .take_while(|(_, mean)| mean.is_some_and(|m| m >= limit));
    above.last().map(|&(level, _)| Held {
        level,
        reach: Reach::AtLeast,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spread_is_that_of_a_hand_calculation() {
        // Mean 2, squares 1 + 0 + 1, variance 1, standard error 1/√3.
        let found = Spread::of(&[1.0, 2.0, 3.0]).unwrap();
        assert_eq!(
            (found.draws, found.mean, found.deviation),
            (3, 2.0, Some(1.0))
        );
        assert!((found.stderr.unwrap() - 1.0 / 3f64.sqrt()).abs() < 1e-15);
        let one = Spread::of(&[7.0]).unwrap();
        assert_eq!((one.deviation, one.stderr), (None, None));
        assert_eq!(Spread::of(&[]), None);
    }

    #[test]
    fn the_level_is_interpolated_in_its_logarithm() {
        let curve = [(1e-4, Some(1.0)), (1e-2, Some(0.8)), (1.0, Some(0.2))];
        let lost = |curve: &[_], limit| lost(curve, limit, Spacing::Logarithmic);
        let at = |limit| match lost(&curve, limit) {
            Lost::At(level) => level,
            other => panic!("{other:?}"),
        };
        // Half way from 1 to 0.8: the geometric mean of 1e-4 and 1e-2. From 0.8 to 0.2 half way is 0.5.
        assert!((at(0.9) / 1e-3 - 1.0).abs() < 1e-12 && (at(0.5) / 0.1 - 1.0).abs() < 1e-12);
        assert_eq!(lost(&curve, 0.1), Lost::Never);
        assert_eq!(lost(&curve[1..], 0.9), Lost::Before);
        assert_eq!(lost(&curve[..1], 0.9), Lost::Never);
        assert_eq!(lost(&[], 0.9), Lost::Unknown);
        // An axis on which quiet is a large number.
        let photons = [(1e6, Some(1.0)), (1e4, Some(0.0))];
        let Lost::At(level) = lost(&photons, 0.5) else {
            panic!("{:?}", lost(&photons, 0.5))
        };
        assert!((level / 1e5 - 1.0).abs() < 1e-12);
        let gap = [(1e-4, Some(1.0)), (1e-3, None), (1e-2, Some(0.1))];
        assert_eq!(lost(&gap, 0.5), Lost::Unknown);
    }

    /// Bits run from many to few and by differences: half way from 12 to 8 the mean is half way from 1 to 0.6.
    #[test]
    fn bits_are_interpolated_in_their_number() {
        let bits = [
            (16.0, Some(1.0)),
            (12.0, Some(1.0)),
            (8.0, Some(0.6)),
            (4.0, Some(0.95)),
        ];
        let (limit, spacing) = (0.8, Spacing::Linear);
        let Lost::At(level) = lost(&bits, limit, spacing) else {
            panic!("{:?}", lost(&bits, limit, spacing))
        };
        // That the mean is above the limit again at 4 bits is no matter: from 10 on it stays there.
        assert!((level - 10.0).abs() < 1e-12, "{level}");
        assert_eq!(held(&bits, limit, spacing).unwrap().reach, Reach::Falls);
    }

    #[test]
    fn a_limit_is_held_up_to_what_is_known() {
        let held = |curve: &[_]| held(curve, 0.9, Spacing::Logarithmic);
        let at_least = |level| {
            let reach = Reach::AtLeast;
            Some(Held { level, reach })
        };
        let high = (1e-4, Some(1.0));
        assert_eq!(held(&[high, (1e-2, Some(0.9))]), at_least(1e-2));
        assert_eq!(held(&[high, (1e-2, None)]), at_least(1e-4));
        let wild = [high, (1e-2, Some(1.2)), (1.0, Some(0.1))];
        assert_eq!(held(&wild), at_least(1e-4));
        assert_eq!(held(&[(1e-4, Some(0.8)), (1e-2, Some(1.0))]), None);
        assert_eq!(held(&[(1e-4, None)]), None);
    }
}
