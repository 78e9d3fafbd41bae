//! How well a model's matrices recover the hidden surface from light.

use rayon::prelude::*;

use super::results::{BrdfPlan, Quality, Ratio};
use crate::lab::ensemble::{Draws, Photographs, Spread};
use crate::matrix::Matrix;
use crate::metrics::{correlation, mtf_raw, rmse};
use crate::model::MatrixModel;
use crate::recovery::Options;

/// How far the known BRDF may stay behind the Lambertian case.
const BEHIND: f64 = 0.1;
/// Correlation with the truth below which the Lambertian case itself recovers nothing, so that
/// there is nothing to reach.
const NOTHING: f64 = 0.5;

/// Recovers from `light` with normal noise by every method at every level. The draws are the same
/// for every model and level, so that qualities differ by the models alone; the recovery is told
/// the true standard deviations.
pub(super) fn qualities(model: &MatrixModel, light: &Matrix, plan: &BrdfPlan) -> Vec<Quality> {
    let methods = plan.methods.iter();
    let each = methods.flat_map(|m| plan.noise.iter().map(move |n| (*m, *n)));
    each.map(|(method, noise)| {
        let recovered = |k: u64| {
            let seed = plan.seed.wrapping_add(k);
            let found = Photographs::relative(light, noise, seed);
            let found = found.recover(model, method, &Options::default());
            found.map(|f| f.reflectance).map_err(|e| e.to_string())
        };
        let found: Vec<_> = (0..plan.draws).into_par_iter().map(recovered).collect();
        let draws = Draws::of(&found);
        let spread = |measure: fn(&[f64], &[f64]) -> Option<f64>| {
            draws.spread(|found| measure(found.as_slice(), &model.albedo))
        };
        Quality {
            method: method.name().to_owned(),
            noise,
            mtf_raw: spread(mtf_raw),
            correlation: spread(correlation),
            rmse: spread(rmse),
            failed: draws.failures.len(),
            reason: draws.failures.last().map(|why| (*why).to_owned()),
        }
    })
    .collect()
}

/// `known` over `reference`, row by row.
pub(super) fn ratios(known: &[Quality], reference: &[Quality]) -> Vec<Ratio> {
    let over = |a: Option<Spread>, b: Option<Spread>| Some(a?.mean / b?.mean);
    let ratio = |(a, b): (&Quality, &Quality)| {
        // A measure that only the reference has was not reached, nor was anything where more draws
        // failed.
        let measures = [
            (a.mtf_raw, b.mtf_raw),
            (a.correlation, b.correlation),
            (a.rmse, b.rmse),
        ];
        let complete = measures.iter().all(|(a, b)| a.is_some() || b.is_none());
        let [mtf_raw, correlation, rmse] = measures.map(|(a, b)| over(a, b));
        let reached = |r: Option<f64>| r.is_none_or(|r| r >= 1.0 - BEHIND);
        let reaches = complete
            && a.failed <= b.failed
            && reached(mtf_raw)
            && reached(correlation)
            && rmse.is_none_or(|r| r <= 1.0 + BEHIND);
        let recovers = b.correlation.is_some_and(|c| c.mean >= NOTHING);
        Ratio {
            method: a.method.clone(),
            noise: a.noise,
            mtf_raw,
            correlation,
            rmse,
            reaches: recovers.then_some(reaches),
        }
    };
    known.iter().zip(reference).map(ratio).collect()
}
