//! What renders come to against right and wrong models.

use serde::{Deserialize, Serialize};

use super::results::{Detection, PowerPlan, PowerRow};
use crate::lab::comparison::evidence::Test;
use crate::lab::comparison::grounds::{Basis, Grounds};
use crate::lab::comparison::measured::Measured;
use crate::lab::comparison::score::{Derivatives, Parameter};
use crate::lab::error::LabError;
use crate::matrix::Matrix;
use crate::model::Kernel;
use crate::num::statistics::{binomial_interval, median};
use crate::scene::Scene;
use crate::transport::{Estimator, Traced};

/// The right model and wrong ones, each with what is wrong and ‖wrong − right‖/‖right‖.
#[derive(Debug)]
pub struct Models {
    pub(super) right: Matrix,
    /// What its quadrature may be off by.
    pub(super) bound: Matrix,
    /// What of each entry is visible where something stands in the way.
    pub(super) share: Option<Matrix>,
    /// What may be off in the scene, and ∂Φ/∂θ of each.
    pub(super) parameters: Vec<Parameter>,
    pub(super) slopes: Vec<Option<Matrix>>,
    pub(super) wrong: Vec<(String, f64, Matrix)>,
}

/// What one render comes to.
#[derive(Debug, Serialize, Deserialize)]
pub struct Verdicts {
    pub(super) chi2_per_dof: f64,
    /// Whether the right model was accepted.
    pub(super) agrees: bool,
    /// Whether each wrong one was rejected.
    pub(super) rejected: Vec<bool>,
    pub(super) smallest_scale: f64,
}

/// Tests a render of `scene` against every model as `validate` does, by the derivatives of the
/// right one.
///
/// # Errors
/// [`LabError`].
pub(super) fn verdicts(
    scene: &Scene,
    traced: &Traced,
    models: &Models,
    test: Test,
) -> Result<Verdicts, LabError> {
    let basis = Basis {
        scene,
        kernel: Kernel::Physical,
        bound: &models.bound,
        share: models.share.as_ref(),
        derivatives: Derivatives {
            parameters: &models.parameters,
            of: &|index| models.slopes[index].clone(),
            moved: &|_, _| None,
            picture: None,
            bends: false,
            are_named: false,
        },
    };
    let measured = Measured::new(&traced.flux, &traced.stderr, None);
    let grounds = Grounds::new(&basis, measured, test);
    let verdict = |model: &Matrix| Ok::<_, LabError>(grounds.verdict(model)?.0);
    let rejects = |model: &Matrix| Ok(!verdict(model)?.agrees);
    let own = verdict(&models.right)?;
    let wrong = models.wrong.iter();
    Ok(Verdicts {
        chi2_per_dof: own.chi2_per_dof,
        agrees: own.agrees,
        rejected: wrong
            .map(|(.., model)| rejects(model))
            .collect::<Result<_, LabError>>()?,
        smallest_scale: smallest_scale(|scale| rejects(&(&models.right * scale)))?,
    })
}

/// Counts over the seeds.
pub(super) fn row(
    (estimator, samples): (Estimator, u64),
    own: &[Verdicts],
    models: &Models,
    plan: &PowerPlan,
) -> PowerRow {
    let count = |f: &dyn Fn(&Verdicts) -> bool| own.iter().filter(|v| f(v)).count() as u64;
    let wrong = models.wrong.iter().enumerate();
    PowerRow {
        estimator: estimator.name().to_owned(),
        samples,
        seeds: plan.seeds,
        chi2_per_dof: own.iter().fold(0.0, |sum, v| sum + v.chi2_per_dof) / plan.seeds as f64,
        false_alarms: count(&|v| !v.agrees),
        expected: binomial_interval(plan.seeds, plan.significance, 0.99),
        detections: wrong
            .map(|(i, (error, size, _))| Detection {
                error: error.clone(),
                size: *size,
                rejected: count(&|v| v.rejected[i]),
            })
            .collect(),
        smallest_scale: median(own.iter().map(|v| v.smallest_scale).collect()).unwrap_or(f64::NAN),
    }
}

/// Smallest s for which 1 + s is rejected, to a tenth of its size; 0 if the right model is.
fn smallest_scale<E>(rejects: impl Fn(f64) -> Result<bool, E>) -> Result<f64, E> {
    if rejects(1.0)? {
        return Ok(0.0);
    }
    let mut high = 1e-6;
    while high < 1.0 && !rejects(1.0 + high)? {
        high *= 2.0;
    }
    let mut low = 0.5 * high;
    while high > 1.1 * low {
        let middle = 0.5 * (low + high);
        if rejects(1.0 + middle)? {
            high = middle;
        } else {
            low = middle;
        }
    }
    Ok(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_threshold_is_found() {
        for limit in [1e-5, 3.3e-3, 0.2] {
            let found = smallest_scale(|s| Ok::<_, ()>(s > 1.0 + limit)).unwrap();
            assert!(
                found >= limit && found <= 1.11 * limit,
                "{found} for {limit}"
            );
        }
        assert_eq!(smallest_scale(|_| Ok::<_, ()>(true)), Ok(0.0));
    }
}
