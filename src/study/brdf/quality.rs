//! How well a model's matrices recover the hidden surface from light.

use rayon::prelude::*;

use super::{BrdfPlan, Quality, Ratio};
use crate::matrix::Matrix;
use crate::metrics::{correlation, mtf_raw, rmse};
use crate::model::MatrixModel;
use crate::recovery::{Method, Options, Problem, RecoveryError, recover};
use crate::study::deviate::normal_deviates;
use crate::study::noise::Spread;

/// How far recovered reflectances are from the true ones, where that is defined.
type Measure = fn(&[f64], &[f64]) -> Option<f64>;

/// How far the known BRDF may stay behind the Lambertian case.
const BEHIND: f64 = 0.1;
/// Correlation with the truth below which the Lambertian case itself recovers nothing, so that there is nothing to reach.
const NOTHING: f64 = 0.5;

/// Recovers from `light` with normal noise by every method at every level. The draws are the same for every model and level, so that
/// qualities differ by the models alone; the recovery is told the true standard deviations.
pub(super) fn qualities(model: &MatrixModel, light: &Matrix, plan: &BrdfPlan) -> Vec<Quality> {
    let draws: Vec<Matrix> = (0..plan.draws)
        .map(|k| normal_deviates(plan.seed.wrapping_add(k), light.nrows(), light.ncols()))
        .collect();
    let each = plan
        .methods
        .iter()
        .flat_map(|m| plan.noise.iter().map(move |n| (*m, *n)));
    each.map(|(method, noise)| {
        let stderr = light.map(|x| x.abs() * noise);
        let found: Vec<Result<Vec<f64>, RecoveryError>> = draws
            .par_iter()
            .map(|normal| {
                let phi = light + stderr.component_mul(normal);
                recovered(model, &phi, &stderr, method)
            })
            .collect();
        quality(method, noise, &model.albedo, found)
    })
    .collect()
}

fn recovered(
    model: &MatrixModel,
    phi: &Matrix,
    stderr: &Matrix,
    method: Method,
) -> Result<Vec<f64>, RecoveryError> {
    let grids: Vec<[usize; 2]> = model.grids.iter().map(|g| g.count).collect();
    let problem = Problem::new(phi, &model.camera_side, &model.laser_side, Some(stderr))?
        .with_grids(&grids)?;
    let found = recover(method, &problem, &Options::default())?;
    Ok(found.reflectance.as_slice().to_vec())
}

fn quality(
    method: Method,
    noise: f64,
    truth: &[f64],
    found: Vec<Result<Vec<f64>, RecoveryError>>,
) -> Quality {
    let reasons = found.iter().filter_map(|f| f.as_ref().err());
    let reason = reasons.map(RecoveryError::to_string).next_back();
    let draws = found.len();
    let found: Vec<Vec<f64>> = found.into_iter().flatten().collect();
    let spread = |measure: Measure| {
        let values: Vec<f64> = found.iter().filter_map(|f| measure(f, truth)).collect();
        Spread::of(&values)
    };
    Quality {
        method: method.name().to_owned(),
        noise,
        mtf_raw: spread(mtf_raw),
        correlation: spread(correlation),
        rmse: spread(rmse),
        failed: draws - found.len(),
        reason,
    }
}

/// `known` over `reference`, row by row.
pub(super) fn ratios(known: &[Quality], reference: &[Quality]) -> Vec<Ratio> {
    let over = |a: Option<Spread>, b: Option<Spread>| Some(a?.mean / b?.mean);
    let ratio = |(a, b): (&Quality, &Quality)| {
        let (mtf, correlation) = (
            over(a.mtf_raw, b.mtf_raw),
            over(a.correlation, b.correlation),
        );
        let rmse = over(a.rmse, b.rmse);
        let recovers = b.correlation.is_some_and(|c| c.mean >= NOTHING);
        // A measure that only the reference has was not reached, nor was anything where more draws failed.
        let has = |a: Option<Spread>, b: Option<Spread>| a.is_some() || b.is_none();
        let complete = a.failed <= b.failed
            && has(a.mtf_raw, b.mtf_raw)
            && has(a.correlation, b.correlation)
            && has(a.rmse, b.rmse);
        let reached = |r: Option<f64>| r.is_none_or(|r| r >= 1.0 - BEHIND);
        let reaches = complete
            && reached(mtf)
            && reached(correlation)
            && rmse.is_none_or(|r| r <= 1.0 + BEHIND);
        Ratio {
            method: a.method.clone(),
            noise: a.noise,
            mtf_raw: mtf,
            correlation,
            rmse,
            reaches: recovers.then_some(reaches),
        }
    };
    known.iter().zip(reference).map(ratio).collect()
}
