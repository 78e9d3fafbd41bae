//! One recovery with its bands, and what many of a method cover.

use serde::{Deserialize, Serialize};

use super::{CoveragePlan, CoverageRow};
use crate::lab::ensemble::{Draws, Photographs};
use crate::matrix::Matrix;
use crate::model::MatrixModel;
use crate::recovery::{BandKind, Bands, Method, Options, RecoveryError};

/// One recovery.
#[derive(Debug, Serialize, Deserialize)]
pub struct Trial {
    /// None where no reflectances explain the photographs: an empty region, which holds no truth.
    pub(super) bands: Option<Bands>,
    pub(super) reflectance: Vec<f64>,
}

pub(super) fn trial(
    model: &MatrixModel,
    exact: &Matrix,
    method: Method,
    plan: &CoveragePlan,
    seed: u64,
) -> Result<Trial, RecoveryError> {
    let options = Options {
        bands: Some(plan.confidence),
        ..Options::default()
    };
    let found = Photographs::relative(exact, plan.noise, seed).recover(model, method, &options)?;
    if found.bands.is_none() && found.no_bands != Some(Bands::REFUTED) {
        return Err(RecoveryError::NotForMethod {
            method,
            what: found.no_bands.unwrap_or("gave no bands"),
            cure: "ask for bands of another method",
        });
    }
    Ok(Trial {
        bands: found.bands,
        reflectance: found.reflectance.as_slice().to_vec(),
    })
}

pub(super) fn row(method: Method, truth: &[f64], trials: &[Result<Trial, String>]) -> CoverageRow {
    let Draws {
        found: trials,
        failures,
    } = Draws::of(trials);
    let refuted = trials.iter().filter(|t| t.bands.is_none()).count();
    let nothing = CoverageRow {
        method: method.name().to_owned(),
        refuted,
        failed: failures.len(),
        reason: failures.last().map(|why| (*why).to_owned()),
        ..CoverageRow::default()
    };
    let Some(first) = trials.iter().find_map(|t| t.bands.as_ref()) else {
        return nothing;
    };
    let (n, r) = (trials.len() as f64, truth.len() as f64);
    let shares: Vec<f64> = trials
        .iter()
        .map(|t| t.bands.as_ref().map_or(0, |b| b.covered(truth)) as f64 / r)
        .collect();
    let mean = shares.iter().sum::<f64>() / n;
    let square: f64 = shares.iter().map(|s| (s - mean) * (s - mean)).sum();
    let of_element = |j: usize| {
        let within = |bands: &&Bands| {
            let [lower, upper] = bands.intervals[j];
            (lower..=upper).contains(&truth[j])
        };
        let all = trials.iter().filter_map(|t| t.bands.as_ref());
        all.filter(within).count() as f64 / n
    };
    let bias_of = |j: usize| {
        trials
            .iter()
            .map(|t| t.reflectance[j] - truth[j])
            .sum::<f64>()
            / n
    };
    let squares = (0..truth.len()).map(|j| bias_of(j) * bias_of(j));
    let bands = trials.iter().filter_map(|t| t.bands.as_ref());
    let widths = bands.flat_map(|b| &b.intervals).map(|[a, b]| b - a);
    CoverageRow {
        bands: Some(words(first.kind).to_owned()),
        covered: Some(mean),
        stderr: (trials.len() > 1).then(|| {
            let by_spread = (square / (n * (n - 1.0))).sqrt();
            by_spread.max(1.0 / (n + 2.0))
        }),
        least: (0..truth.len()).map(of_element).reduce(f64::min),
        together: Some(shares.iter().filter(|s| **s == 1.0).count() as f64 / n),
        bias: Some((squares.sum::<f64>() / r).sqrt()),
        width: Some(widths.sum::<f64>() / ((n - refuted as f64) * r)),
        ..nothing
    }
}

fn words(kind: BandKind) -> &'static str {
    match kind {
        BandKind::Gaussian | BandKind::Posterior => "each alone",
        BandKind::Simultaneous => "all together",
    }
}
