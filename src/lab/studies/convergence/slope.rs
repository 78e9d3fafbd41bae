//! The slope of log error against log samples.
//!
//! > e(N) = ‖Φ̂_N − Φ‖/‖Φ‖,   slope = Σ_i (x_i − x̄) ln e_i / Σ_i (x_i − x̄)²,   x_i = ln N_i.
//!
//! Φ is a quadrature that is off by at most β, its own bound over ‖Φ‖. By the triangle inequality
//! the true error lies in e ± β, and with it the slope within
//!
//! > ± Σ_i |x_i − x̄| · −ln(1 − β/e_i) / Σ_i (x_i − x̄)²
//!
//! of the one that is told; nothing can be said of it where an error is not above β. How the
//! errors lie about their line says how far the slope is to be trusted,
//!
//! > ± √(Σ r_i²/(n − 2) / Σ_i (x_i − x̄)²),
//!
//! and the standard errors, which scatter less, whether there is one line at all.

use super::curves::{Bend, Step};
use crate::num::statistics::median;

/// Root mean square of ln standard errors about a line above which there is none: twice what the
/// scatter of 32 blocks, all entries alike, leaves of a line, 1/√62.
const BENT: f64 = 0.25;

/// Least-squares slope of ln error against ln samples; `None` for fewer than two different numbers
/// of samples.
pub(super) fn slope(steps: &[Step]) -> Option<f64> {
    let weights = slope_weights(steps)?;
    let logs = steps.iter().map(|s| libm::log(s.error));
    Some(weights.iter().zip(logs).map(|(w, y)| w * y).sum())
}

/// How far the slope may be off where each error is known to ± `bound`; `None` where one is not
/// above that.
pub(super) fn slope_bound(steps: &[Step], bound: f64) -> Option<f64> {
    let weights = slope_weights(steps)?;
    let off =
        |(w, s): (&f64, &Step)| (s.error > bound).then(|| w.abs() * -libm::log1p(-bound / s.error));
    weights.iter().zip(steps).map(off).sum()
}

/// The standard error of the slope by the scatter about its line; `None` of fewer than three.
pub(super) fn slope_scatter(steps: &[Step]) -> Option<f64> {
    let weights = slope_weights(steps)?;
    let left = left_over(steps, |s| s.error)?;
    let square: f64 = left.iter().map(|r| r * r).sum();
    let spread: f64 = weights.iter().map(|w| w * w).sum();
    (steps.len() > 2).then(|| (square / (steps.len() - 2) as f64 * spread).sqrt())
}

/// Where the standard errors fall along no line: the step that differs most from the middle one.
pub(super) fn bend(steps: &[Step]) -> Option<Bend> {
    let left = left_over(steps, |s| s.stated)?;
    let mean = left.iter().map(|r| r * r).sum::<f64>() / left.len() as f64;
    if mean.sqrt() < BENT {
        return None;
    }
    let falls = steps.windows(2).map(|pair| {
        let by = pair[0].stated / pair[1].stated;
        (
            libm::log(by) / libm::log(pair[1].samples as f64 / pair[0].samples as f64),
            by,
            pair,
        )
    });
    let falls: Vec<_> = falls.collect();
    let middle = median(falls.iter().map(|fall| fall.0).collect())?;
    let apart = |slope: f64| (slope - middle).abs();
    let most = falls
        .iter()
        .max_by(|a, b| apart(a.0).total_cmp(&apart(b.0)));
    most.map(|(_, by, pair)| Bend {
        samples: [pair[0].samples, pair[1].samples],
        by: *by,
    })
}

/// ln of each step's `of`, less what the least-squares line has there; `None` where one is not
/// positive, or the numbers of samples are all alike.
fn left_over(steps: &[Step], of: impl Fn(&Step) -> f64) -> Option<Vec<f64>> {
    let weights = slope_weights(steps)?;
    let logs: Option<Vec<f64>> = steps
        .iter()
        .map(|s| Some(of(s)).filter(|x| *x > 0.0).map(libm::log))
        .collect();
    let logs = logs?;
    let slope: f64 = weights.iter().zip(&logs).map(|(w, y)| w * y).sum();
    let mean = logs.iter().sum::<f64>() / logs.len() as f64;
    let spread: f64 = weights.iter().map(|w| w * w).sum();
    let left = logs.iter().zip(&weights);
    // x − x̄ = w/Σw².
    Some(left.map(|(y, w)| y - mean - slope * w / spread).collect())
}

/// (x_i − x̄)/Σ (x − x̄)² of x = ln samples: what each ln error weighs in the slope.
fn slope_weights(steps: &[Step]) -> Option<Vec<f64>> {
    let x: Vec<f64> = steps.iter().map(|s| libm::log(s.samples as f64)).collect();
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    let spread: f64 = x.iter().map(|x| (x - mean) * (x - mean)).sum();
    (spread > 0.0).then(|| x.iter().map(|x| (x - mean) / spread).collect())
}
