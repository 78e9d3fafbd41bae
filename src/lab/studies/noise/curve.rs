//! A method along the noise: mean and spread over the draws, and the level at which a modulation is
//! lost.

use serde::Serialize;

use super::axis::NoiseAxis;
use super::picture::Picture;
use super::plan::NoisePlan;
use super::trial::Trial;
use crate::lab::Measures;
use crate::lab::ensemble::{Draws, MOST_SPREAD, Spread};
use crate::lab::problem::integrated;
use crate::lab::studies::loss;
use crate::num::statistics::student_threshold;
use crate::recovery::Method;

/// The modulations whose loss is reported, relative to those of the picture itself.
pub const LIMITS: [f64; 2] = [0.9, 0.5];
/// Standard error above which a mean MTF is not held against a limit: a mean that strays has not
/// fallen.
const MOST_STDERR: f64 = 0.1;

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
    /// Standard deviation of its denominator W + B over the draws, relative to the mean; absent for
    /// a single draw.
    pub denominator_spread: Option<f64>,
    /// Normalized MTF.
    pub mtf_normalized: Option<Spread>,
    /// Correlation with the truth.
    pub correlation: Option<Spread>,
    /// Root mean square error of a draw, over elements.
    pub rmse: Option<Spread>,
    /// Root mean square error over elements and draws, √(mean of its squares).
    pub rmse_over_draws: Option<f64>,
    /// What no unbiased recovery has less of: √(tr CRB/r), CRB the bound of Cramér and Rao for the
    /// level's standard errors. Absent without noise, or where directions are lost in f64.
    pub cramer_rao: Option<f64>,
    /// The one over the other. Below 1 where a method is told more than the photographs (bounds,
    /// two values) or is biased towards the truth.
    pub rmse_over_bound: Option<f64>,
}

impl Point {
    /// Of the trials at one level, with the bound there.
    pub(super) fn of(level: f64, trials: &[&Trial], cramer_rao: Option<f64>) -> Self {
        let draws = Draws::of(trials.iter().map(|t| &t.outcome));
        let denominator = draws.spread(|m| m.light_plus_dark);
        let rmse = draws.spread(|m| m.rmse);
        // Scaled by the mean, as squares of large errors overflow.
        let rmse_over_draws = rmse.map(|s| {
            let n = s.draws as f64;
            let relative = s.deviation.map_or(0.0, |d| d / s.mean);
            s.mean * (1.0 + relative * relative * (n - 1.0) / n).sqrt()
        });
        Self {
            level,
            draws: trials.len(),
            failed: draws.failures.len(),
            failure: draws.failures.first().map(|why| (*why).to_owned()),
            mtf_raw: draws.spread(|m| m.mtf_raw),
            denominator_spread: denominator.and_then(|s| Some(s.deviation? / s.mean.abs())),
            mtf_normalized: draws.spread(|m| m.mtf_normalized),
            correlation: draws.spread(|m| m.correlation),
            rmse,
            rmse_over_draws,
            cramer_rao,
            rmse_over_bound: rmse_over_draws.and_then(|e| Some(e / cramer_rao?)),
        }
    }
}

/// Standard deviations on either side of a normal number that hold it in 95 of 100.
const SURELY: f64 = 1.96;

/// Where a mean modulation falls to a limit, coming from the quiet end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Lost {
    /// At this level, by interpolation of the logarithm of what is lost (over that of the level, or
    /// the number of bits) between the last level at or above the limit and the next. Where large
    /// levels are the quiet ones it is the smallest from which on the mean stays at or above the
    /// limit.
    At(f64),
    /// Between these two levels, the quieter first, which are too far apart to interpolate: more
    /// than a decade, of bits more than 3.
    Between([f64; 2]),
    /// It is below the limit at the quietest level already.
    Before,
    /// It is not below the limit at any level.
    Never,
    /// Before the limit was reached the method failed in some draw, or the mean is not known to a
    /// tenth (none of a single draw is), or is more than a tenth above that of the picture, or (raw
    /// MTF) the denominator W + B spreads by more than a tenth, so that there is no mean to speak
    /// of.
    Unknown,
}

/// How far a method holds the limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Reach {
    /// Up to the level, where its mean falls below.
    Falls,
    /// Up to the level, and beyond it nothing is known: it is the loudest studied, the next is too
    /// far ([`Lost::Between`]), or there is no mean to speak of there ([`Lost::Unknown`]).
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

/// One method on one object.
#[derive(Clone, Debug, Serialize)]
pub struct NoiseCurve {
    /// The object: checks a side, or `own`.
    #[serde(rename = "board")]
    pub picture: Picture,
    /// Elements a side of the recovery.
    pub elements: usize,
    /// The method.
    pub method: String,
    /// How photographs and model integrate: `centres` or `quadrature`.
    pub integration: String,
    /// From quiet to loud.
    pub points: Vec<Point>,
    /// Raw and normalized MTF of the picture itself, which a perfect recovery has: 1 of a board of
    /// albedo 0 and 1; [`LIMITS`] are relative to them.
    pub mtf_of_truth: [f64; 2],
    /// Where the mean raw MTF falls to each of [`LIMITS`].
    pub lost_raw: [Lost; 2],
    /// The same of the normalized MTF.
    pub lost_normalized: [Lost; 2],
    /// Up to which level the mean raw MTF stays at or above the first of [`LIMITS`], m, and not
    /// above 2 − m, relative to the picture's own; there dark would come out too dark. None where
    /// it is not there at the quietest.
    pub held: Option<Held>,
    /// The same with all means lower, and all higher, by what holds each in 95 of 100 (Student's
    /// t): how far the scatter of the draws may move it. None of one draw.
    pub held_within: Option<[Option<Held>; 2]>,
}

impl NoiseCurve {
    /// Of those of the trials that the plan asks for; `bounds` are those of Cramér and Rao at its
    /// levels.
    pub(super) fn of(
        plan: &NoisePlan,
        (picture, elements): (Picture, usize),
        method: Method,
        (trials, bounds): (&[Trial], &[Option<f64>]),
        truth: &[f64],
    ) -> Self {
        let asked = |t: &&Trial| {
            (t.picture, t.elements, t.method) == (picture, elements, method)
                && t.seed.wrapping_sub(plan.first_seed) < plan.seeds
        };
        let own: Vec<&Trial> = trials.iter().filter(asked).collect();
        let point = |(level, bound): (&f64, &Option<f64>)| {
            let here = own.iter().filter(|t| t.level.total_cmp(level).is_eq());
            Point::of(*level, &here.copied().collect::<Vec<_>>(), *bound)
        };
        let points: Vec<Point> = plan.levels.iter().zip(bounds).map(point).collect();
        let truth = Measures::of(truth, truth);
        let own = |mtf: Option<f64>| mtf.filter(|m| *m > 0.0).unwrap_or(1.0);
        let full = [truth.mtf_raw, truth.mtf_normalized].map(own);
        // A mean is known where every draw has the measure and its standard error is small. One as
        // far above 1 as a limit is below is none to speak of: negative values make it.
        let most = 2.0 - LIMITS[0];
        let known = |p: &Point, s: Option<Spread>, full: f64| {
            let s = s.filter(|s| s.draws == p.draws && s.stderr.is_some_and(|e| e <= MOST_STDERR));
            (p.level, s.map(|s| s.mean / full).filter(|m| *m <= most))
        };
        let narrow = |p: &Point| p.denominator_spread.is_none_or(|s| s <= MOST_SPREAD);
        let raw = points
            .iter()
            .map(|p| known(p, p.mtf_raw.filter(|_| narrow(p)), full[0]));
        let raw: Vec<_> = raw.collect();
        let normalized: Vec<_> = points
            .iter()
            .map(|p| known(p, p.mtf_normalized, full[1]))
            .collect();
        // Whether a mean is to be trusted is not shifted.
        let shifted = |sign: f64| -> Option<Vec<(f64, Option<f64>)>> {
            let each = points.iter().zip(&raw).map(|(p, (level, mean))| {
                let Some(mean) = mean else {
                    return Some((*level, None));
                };
                let spread = p.mtf_raw?;
                let times = student_threshold(SURELY, spread.draws as f64 - 1.0);
                let error = sign * times * spread.stderr? / full[0];
                Some((*level, Some((mean + error).min(most))))
            });
            each.collect()
        };
        let limit = |means: &[_]| held(means, LIMITS[0], &plan.axis);
        let held_within = shifted(-1.0).zip(shifted(1.0));
        let held_within = held_within.map(|(low, high)| [limit(&low), limit(&high)]);
        let lost = |means: &[_]| LIMITS.map(|limit| lost(means, limit, &plan.axis));
        Self {
            picture,
            elements,
            method: method.name().to_owned(),
            integration: integrated(plan.kernel, elements * elements, plan.integration)
                .name()
                .to_owned(),
            lost_raw: lost(&raw),
            lost_normalized: lost(&normalized),
            held: held(&raw, LIMITS[0], &plan.axis),
            held_within,
            mtf_of_truth: full,
            points,
        }
    }
}

/// Where the mean first falls below `limit`; `curve` lists levels from quiet to loud with the mean
/// over all draws there, if there is one.
fn lost(curve: &[(f64, Option<f64>)], limit: f64, axis: &NoiseAxis) -> Lost {
    let mut before: Option<(f64, f64)> = None;
    for &(level, mean) in curve {
        let Some(mean) = mean else {
            return Lost::Unknown;
        };
        if mean < limit {
            return match before {
                None => Lost::Before,
                Some((quiet, _)) if axis.is_far([quiet, level]) => Lost::Between([quiet, level]),
                Some((quiet, high)) => {
                    Lost::At(axis.at([quiet, level], loss::way_to([high, mean], limit)))
                }
            };
        }
        before = Some((level, mean));
    }
    if before.is_some() {
        Lost::Never
    } else {
        Lost::Unknown
    }
}

/// Up to which level the mean of such a curve stays at or above `limit`; `None` if it is not there
/// at the quietest.
fn held(curve: &[(f64, Option<f64>)], limit: f64, axis: &NoiseAxis) -> Option<Held> {
    if let Lost::At(level) = lost(curve, limit, axis) {
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
mod tests;
