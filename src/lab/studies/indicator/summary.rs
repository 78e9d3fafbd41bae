//! Figures against what is measured: correlation coefficients side by side.

use serde::Serialize;

use super::configuration::Configuration;
use super::noisy::{Comparison, NoisyOutcome, NoisyPoint};
use crate::metrics::{correlation, rank_correlation};
use crate::num::statistics::{normal_two_sided, sidak_p, student_to_normal};
use crate::recovery::Method;

/// How well a figure predicts.
#[derive(Clone, Debug, Serialize)]
pub struct Coefficients {
    /// The figure.
    pub indicator: String,
    /// Configurations in which it is defined.
    pub configurations: usize,
    /// Pearson's correlation with the measured raw MTF.
    pub pearson: Option<f64>,
    /// Spearman's.
    pub spearman: Option<f64>,
}

/// Predicted against measured under noise, one method.
#[derive(Clone, Debug, Serialize)]
pub struct NoisySummary {
    /// The method.
    pub method: String,
    /// Points compared.
    pub compared: usize,
    /// Of these within three standard errors.
    pub within_three: usize,
    /// Largest |z|.
    pub largest_z: f64,
    /// Probability that the largest of as many would be so large by chance (Šidák; Student's t with
    /// one degree of freedom less than draws).
    pub largest_p: f64,
    /// Left out because the ratio has no mean to speak of.
    pub undefined: usize,
    /// Points without a covariance.
    pub without_covariance: usize,
    /// Points from which the method gave nothing.
    pub failed: usize,
    /// Each figure against the measured mean MTF.
    pub coefficients: Vec<Coefficients>,
}

/// Each figure against `measured`. Logarithms leave out configurations where the figure is 0.
pub(super) fn coefficients(
    configurations: &[&Configuration],
    measured: &[f64],
) -> Vec<Coefficients> {
    type Figure = (&'static str, fn(&Configuration) -> f64);
    let figures: [Figure; 7] = [
        ("‖P c‖²/‖c‖²", |c| c.kept),
        ("raw MTF of the projected object", |c| c.projected),
        ("condition number", |c| c.condition),
        ("log of the condition number", |c| libm::log10(c.condition)),
        ("smallest eigenvalue", |c| c.smallest_eigenvalue),
        ("log of |smallest eigenvalue|", |c| {
            libm::log10(c.smallest_eigenvalue.abs())
        }),
        ("log of (σ_r/σ1)²", |c| libm::log10(c.smallest_square)),
    ];
    let of = |(name, f): Figure| {
        let values: Vec<f64> = configurations.iter().map(|c| f(c)).collect();
        coefficient(name, &values, measured)
    };
    figures.map(of).to_vec()
}

/// A figure against `measured`, where it is defined.
fn coefficient(name: &str, values: &[f64], measured: &[f64]) -> Coefficients {
    let pairs = values.iter().copied().zip(measured);
    let (figure, measured): (Vec<f64>, Vec<f64>) = pairs.filter(|(x, _)| x.is_finite()).unzip();
    Coefficients {
        indicator: name.to_owned(),
        configurations: figure.len(),
        pearson: correlation(&figure, &measured),
        spearman: rank_correlation(&figure, &measured),
    }
}

/// One method's points under noise, taken together.
pub(super) fn summary(
    method: Method,
    points: &[NoisyPoint],
    configurations: &[Configuration],
) -> NoisySummary {
    let own = || points.iter().filter(move |p| p.method == method.name());
    let count = |f: fn(&NoisyOutcome) -> bool| own().filter(|p| f(&p.outcome)).count();
    let compared: Vec<(&Configuration, &Comparison)> = own()
        .filter_map(|p| match &p.outcome {
            NoisyOutcome::Compared(c) => Some((&configurations[p.configuration], c)),
            _ => None,
        })
        .collect();
    let measured: Vec<f64> = compared.iter().map(|(_, c)| c.measured.mean).collect();
    let benches: Vec<&Configuration> = compared.iter().map(|(b, _)| *b).collect();
    let predicted: Vec<f64> = compared.iter().map(|(_, c)| c.mean).collect();
    let closed_form = coefficient("closed form of the mean", &predicted, &measured);
    let coefficients = [vec![closed_form], coefficients(&benches, &measured)].concat();
    let sizes = || compared.iter().map(|(_, c)| c.z.abs());
    let largest_z = sizes().fold(0.0, f64::max);
    let dof = compared
        .first()
        .map_or(f64::INFINITY, |(_, c)| c.measured.draws as f64 - 1.0);
    NoisySummary {
        method: method.name().to_owned(),
        compared: compared.len(),
        within_three: sizes().filter(|z| *z <= 3.0).count(),
        largest_z,
        largest_p: sidak_p(
            normal_two_sided(student_to_normal(largest_z, dof)),
            compared.len() as u64,
        ),
        undefined: count(|o| matches!(o, NoisyOutcome::Undefined { .. })),
        without_covariance: count(|o| matches!(o, NoisyOutcome::NoCovariance)),
        failed: count(|o| matches!(o, NoisyOutcome::Failed { .. })),
        coefficients,
    }
}
