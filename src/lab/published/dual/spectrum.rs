//! Singular values of T.

use crate::lab::LabError;
use crate::lab::finding::{Axis, Curve, Mark, Plot};
use crate::matrix::Matrix;
use crate::num::linalg::svd;

/// Singular values of T over the first.
pub(super) fn spectrum(t: &Matrix) -> Result<Vec<f64>, LabError> {
    let sigma = svd(t)?.sigma;
    Ok(sigma.iter().map(|s| s / sigma[0]).collect())
}

/// (Σ σ²)²/Σ σ⁴: how many equal singular values T Tᵀ would have; all of them where the transpose is
/// the inverse.
pub(super) fn participation(sigma: &[f64]) -> f64 {
    let sum = |power: i32| sigma.iter().map(|s| s.powi(power)).sum::<f64>();
    sum(2) * sum(2) / sum(4)
}

/// Singular values that are drawn, and the least of them; below it there is only rounding.
const SHOWN_VALUES: usize = 48;
const LEAST: f64 = 1e-17;

/// Both spectra, and that of a matrix whose transpose is its inverse.
pub(super) fn plot(traced: &[f64], modelled: &[f64]) -> Plot {
    let curve = |name: &str, sigma: &[f64]| {
        let shown = sigma.iter().enumerate().take(SHOWN_VALUES);
        let points = shown.filter(|(_, s)| **s > LEAST);
        let points = points.map(|(k, s)| [(k + 1) as f64, *s]);
        Curve::new(name, Mark::Line, points.collect())
    };
    let axes = [
        Axis::linear("k", [0.0, SHOWN_VALUES as f64]),
        Axis::decades("σk / σ1"),
    ];
    let curves = vec![
        curve("T traced (its tail is noise)", traced),
        curve("T modelled", modelled),
        curve(
            "if the transpose were the inverse but for a scale",
            &[1.0; SHOWN_VALUES],
        ),
    ];
    Plot::new("Singular values of T", axes, curves)
}
