//! Patterns whose sizes are known beforehand to a standard deviation.

use nalgebra::{DMatrix, DVector};

/// Factors 1 + ε about an estimate of picture and factors, linear: beside A x the data hold
///
/// > ε_l m\[p,l\] + ε (A z)\[p,l\],   ε_l ~ N(0, σ_g²),   ε ~ N(0, σ_s²)
#[derive(Debug, Clone)]
pub(super) struct Soft {
    /// m, the light that each frame's own factor multiplies, pixels × spots, W; and σ_g.
    pub(super) frames: Option<(DMatrix<f64>, f64)>,
    /// z, the numbers whose light the common factor multiplies; and σ_s.
    pub(super) whole: Option<(DVector<f64>, f64)>,
    /// The standard deviation of the noise in the unit of the weighted rows: 1 where it is known,
    /// else an estimate of it, W.
    pub(super) noise: f64,
}

impl Soft {
    /// Without any factor.
    pub(super) const NONE: Self = Self {
        frames: None,
        whole: None,
        noise: 1.0,
    };
}
