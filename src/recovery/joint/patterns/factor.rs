//! A common factor of the light that is known beforehand, of a picture of two given levels.
//!
//! > d = s m + ν,   s ~ N(1, σ²),   ν ~ N(0, 1) in each row,   m = R x
//!
//! Of a pattern x, s is integrated over in closed form:
//!
//! > −2 ln ∫ p(d|s, x) p(s) ds = ‖d − ŝ m‖² + (ŝ − 1)²/σ² + ln σ² w,   w = ‖m‖² + 1/σ²,
//! > ŝ = 1 + mᵀ(d − m)/w,   of variance 1/w.

use nalgebra::DVector;

/// s given a pattern.
pub(super) struct Factor {
    /// ŝ − 1.
    pub(super) off: f64,
    pub(super) variance: f64,
    /// ‖d − ŝ m‖² + (ŝ − 1)²/σ².
    pub(super) chi2: f64,
    /// ln of ∫ p(d|s, x) p(s) ds over that of a picture that fits exactly.
    pub(super) log: f64,
}

impl Factor {
    /// Of light `m`, photographs `d`, and s known to `sigma`.
    pub(super) fn new(m: &DVector<f64>, d: &DVector<f64>, sigma: f64) -> Self {
        let weight = m.norm_squared() + (sigma * sigma).recip();
        let off = m.dot(&(d - m)) / weight;
        let chi2 = (d - m * (1.0 + off)).norm_squared() + (off / sigma).powi(2);
        Self {
            off,
            variance: weight.recip(),
            chi2,
            log: -0.5 * (chi2 + libm::log(sigma * sigma * weight)),
        }
    }
}
