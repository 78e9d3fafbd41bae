//! The mean of a picture and the factor of its light, integrated over in closed form.
//!
//! With the light x = (1 + ε) ρ = (m + f) (1 + ε) and S₀ = V cov(x | m, ε) Vᵀ + E the photographs
//! know the mean M = (1 + ε) m by a = vᵀS₀⁻¹v, v = V 1, and its best value M̂ = vᵀS₀⁻¹y/a. Before
//! them it is N(s/2, s²/4), s = 1 + ε. So
//!
//! > −2 ln p(y | s) = ‖y − M̂ v‖² + (M̂ − s/2)²/(s²/4 + 1/a) + ln(1 + a s²/4) + ln det S₀,
//! > 1/var(M | y, s) = a + 4/s²,   E\[M | y, s\] = (a M̂ + 2/s) var(M | y, s),
//!
//! ‖·‖ in the metric S₀⁻¹. Each s costs a few operations.

use nalgebra::{DMatrix, DVector};

use super::{Length, MEAN, Seen, Variance};
use crate::num::linalg::Cholesky;

/// The rule over ε: out to so many σ, by steps of half a σ and at most this.
const WIDEST: f64 = 5.0;
const FINEST: f64 = 0.1;
/// Least factor.
const LEAST: f64 = 0.05;

/// Factors s of the light and ln of their shares, by the trapezoidal rule over ε ~ N(0, σ²); 1
/// where the scale is known.
pub(super) fn scales(known_to: Option<f64>) -> Vec<[f64; 2]> {
    let Some(sigma) = known_to else {
        return vec![[1.0, 0.0]];
    };
    let step = FINEST.min(0.5 * sigma);
    let most = (WIDEST * sigma / step).ceil() as i32;
    let at = (-most..=most).map(|k| step * f64::from(k));
    let at: Vec<f64> = at.filter(|e| 1.0 + e >= LEAST).collect();
    let log = |e: f64| -0.5 * (e / sigma).powi(2);
    let all: f64 = at.iter().map(|e| libm::exp(log(*e))).sum();
    at.into_iter()
        .map(|e| [1.0 + e, log(e) - libm::log(all)])
        .collect()
}

/// What the photographs say of a mean where the light varies as this about it.
pub(super) struct Level {
    /// L of S₀ = LLᵀ.
    pub(super) factor: Cholesky,
    /// L⁻¹v and L⁻¹y, k × 1.
    pub(super) level: DMatrix<f64>,
    pub(super) data: DMatrix<f64>,
    /// a, and M̂ where a > 0.
    precision: f64,
    best: f64,
    /// ‖y − M̂ v‖² + ln det S₀.
    left: f64,
}

impl Level {
    /// None where rounding makes S₀ indefinite.
    pub(super) fn new(seen: &Seen, of: &Length, variance: Variance) -> Option<Self> {
        let [alike, own] = variance.parts();
        let mut s = &of.vkv * alike + &seen.errors;
        for i in 0..s.nrows() {
            s[(i, i)] += own;
        }
        let factor = Cholesky::new(&s)?;
        let column = |of: &DVector<f64>| DMatrix::from_column_slice(of.len(), 1, of.as_slice());
        let level = factor.forward(column(&seen.v.column_sum()));
        let data = factor.forward(column(&seen.y));
        let precision = level.norm_squared();
        let best = if precision > 0.0 {
            level.dot(&data) / precision
        } else {
            0.0
        };
        let left = (&data - &level * best).norm_squared() + factor.log_det();
        Some(Self {
            factor,
            level,
            data,
            precision,
            best,
            left,
        })
    }

    /// ln p(y | s) but for a constant.
    pub(super) fn log(&self, s: f64) -> f64 {
        let variance = (MEAN * s).powi(2);
        let told = self.precision * variance;
        // (M̂ − s/2)²/(s²/4 + 1/a), 0 where nothing is told of the mean.
        let off = self.precision * (self.best - MEAN * s).powi(2) / (told + 1.0);
        -0.5 * (self.left + off + libm::log1p(told))
    }

    /// E\[M | y, s\] and its variance.
    pub(super) fn mean(&self, s: f64) -> [f64; 2] {
        let before = MEAN * s;
        let variance = 1.0 / (self.precision + 1.0 / (before * before));
        [
            (self.precision * self.best + 1.0 / before) * variance,
            variance,
        ]
    }
}
