//! The slope of log error against log samples.
//!
//! > e(N) = ‖Φ̂_N − Φ‖/‖Φ‖,   slope = Σ_i (x_i − x̄) ln e_i / Σ_i (x_i − x̄)²,   x_i = ln N_i.
//!
//! Φ is a quadrature that is off by at most β, its own bound over ‖Φ‖. By the triangle inequality
//! the true error lies in e ± β, and with it the slope within
//!
//! > ± Σ_i |x_i − x̄| · −ln(1 − β/e_i) / Σ_i (x_i − x̄)²
//!
//! of the one that is told; nothing can be said of it where an error is not above β.

use super::curves::Step;

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

/// (x_i − x̄)/Σ (x − x̄)² of x = ln samples: what each ln error weighs in the slope.
fn slope_weights(steps: &[Step]) -> Option<Vec<f64>> {
    let x: Vec<f64> = steps.iter().map(|s| libm::log(s.samples as f64)).collect();
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    let spread: f64 = x.iter().map(|x| (x - mean) * (x - mean)).sum();
    (spread > 0.0).then(|| x.iter().map(|x| (x - mean) / spread).collect())
}
