//! Mean and spread over the seeds, and the noise at which a modulation is lost.

use serde::Serialize;

use super::trial::{Measures, Trial};
use crate::num::summation::{mean_and_stderr, tree_sum};

/// Relative spread of a denominator above which the mean of a ratio is not spoken of: the next terms of its expansion are then some 3·0.1⁴ of it.
pub(in super::super) const MOST_SPREAD: f64 = 0.1;

/// Mean and spread of a measure over the draws in which it is defined.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
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
    /// Root mean square error.
    pub rmse: Option<Spread>,
}

impl Point {
    /// Of the trials at one level.
    pub(super) fn of(level: f64, trials: &[&Trial]) -> Self {
        let good = || trials.iter().filter_map(|t| t.outcome.as_ref().ok());
        let spread = |f: fn(&Measures) -> Option<f64>| {
            Spread::of(&good().filter_map(f).collect::<Vec<f64>>())
        };
        let denominator = spread(|m| m.light_plus_dark);
        let failure = trials.iter().find_map(|t| t.outcome.as_ref().err());
        Self {
            level,
            draws: trials.len(),
            failed: trials.len() - good().count(),
            failure: failure.cloned(),
            mtf_raw: spread(|m| m.mtf_raw),
            denominator_spread: denominator.and_then(|s| Some(s.deviation? / s.mean.abs())),
            mtf_normalized: spread(|m| m.mtf_normalized),
            correlation: spread(|m| m.correlation),
            rmse: spread(|m| m.rmse),
        }
    }
}

/// Where a mean modulation falls to a limit, coming from the quiet end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Lost {
    /// At this level, by interpolation in its logarithm between the last level at or above the limit and the next.
    At(f64),
    /// It is below the limit at the quietest level already.
    Before,
    /// It is not below the limit at any level.
    Never,
    /// Before the limit was reached the method failed in some draw, or the mean is not known to a tenth, or (raw MTF) the denominator W + B
    /// spreads by more than a tenth, so that there is no mean to speak of.
    Unknown,
}

/// Where the mean first falls below `limit`; `curve` lists levels from quiet to loud with the mean over all draws there, if there is one.
pub(super) fn lost(curve: &[(f64, Option<f64>)], limit: f64) -> Lost {
    let mut before: Option<(f64, f64)> = None;
    for &(level, mean) in curve {
        let Some(mean) = mean else {
            return Lost::Unknown;
        };
        if mean < limit {
            return before.map_or(Lost::Before, |(quiet, high)| {
                let t = (high - limit) / (high - mean);
                Lost::At(libm::exp(libm::log(quiet) + t * libm::log(level / quiet)))
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
}
