//! How small a model error does `validate` detect, and how often does it cry wolf?

use serde::Serialize;

use super::agreement::{Errors, Evidence, Test, agree};
use crate::matrix::Matrix;
use crate::model::{Extent, Kernel, MatrixModel, ModelError, converged};
use crate::num::statistics::binomial_interval;
use crate::num::stream::Sampling;
use crate::scene::{Scene, SceneError};
use crate::transport::{Budget, Control, Estimator, Plan, Traced, render};

/// What is tried.
#[derive(Clone, Debug)]
pub struct PowerPlan {
    /// Estimators.
    pub estimators: Vec<Estimator>,
    /// Where random numbers come from.
    pub sampling: Sampling,
    /// Paths, as each estimator counts them.
    pub samples: Vec<u64>,
    /// Renders of each kind, with seeds first … first + seeds − 1.
    pub seeds: u64,
    /// First seed.
    pub first_seed: u64,
    /// Significance level of the verdicts.
    pub significance: f64,
}

/// How often a wrong model was rejected.
#[derive(Clone, Debug, Serialize)]
pub struct Detection {
    /// What is wrong with it.
    pub error: String,
    /// ‖wrong − right‖/‖right‖.
    pub size: f64,
    /// Rejections.
    pub rejected: u64,
}

/// The outcome for one estimator and number of samples.
#[derive(Clone, Debug, Serialize)]
pub struct PowerRow {
    /// Estimator.
    pub estimator: String,
    /// Paths.
    pub samples: u64,
    /// Renders.
    pub seeds: u64,
    /// Mean χ²/dof on the right model.
    pub chi2_per_dof: f64,
    /// Rejections of the right model.
    pub false_alarms: u64,
    /// Where 99 % of the binomial at the stated level lie.
    pub expected: [u64; 2],
    /// Wrong models.
    pub detections: Vec<Detection>,
    /// Median over the renders of the smallest scale error that is rejected.
    pub smallest_scale: f64,
}

/// The study of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct Power {
    /// Name of the scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// Sampler.
    pub sampler: String,
    /// Significance level.
    pub significance: f64,
    /// One row for each estimator and number of samples.
    pub rows: Vec<PowerRow>,
}

/// Why there is no study.
#[derive(Debug, thiserror::Error)]
pub enum PowerError {
    /// The scene has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The spots cannot be moved.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Not a number of paths.
    #[error("{0} samples cannot be traced (use 1 to 2³²)")]
    Samples(u64),
}

/// Relative size of the scaled wrong model, and of the wrong albedo of one element.
const SCALE: f64 = 1e-3;
const ALBEDO: f64 = 1e-2;

/// Renders each kind with many seeds and tests it against the right model (converged quadrature) and wrong ones. `Ok(None)` if
/// stopped.
///
/// # Errors
/// [`PowerError`].
pub fn power(
    scene: &Scene,
    plan: &PowerPlan,
    control: Control<'_>,
) -> Result<Option<Power>, PowerError> {
    // Validation is of three-bounce light.
    let scene = scene.with_max_bounces(3);
    let right = converged(&scene, Kernel::Physical, Extent::FULL)?.phi;
    let wrong = wrong_models(&scene, &right)?;
    let mut rows = Vec::new();
    for &estimator in &plan.estimators {
        for &samples in &plan.samples {
            let budget = Budget::new(samples, plan.sampling).ok_or(PowerError::Samples(samples))?;
            let test = Test {
                significance: plan.significance,
                replicates: budget.blocks,
                errors: Errors::of(estimator),
            };
            let mut tally = Tally::new(&wrong, plan.seeds);
            for seed in (0..plan.seeds).map(|k| plan.first_seed.wrapping_add(k)) {
                let how = Plan {
                    estimator,
                    sampling: plan.sampling,
                    seed,
                    budget,
                };
                let Some(traced) = render(&scene, &how, 0..scene.laser.spots.len(), control) else {
                    return Ok(None);
                };
                tally.add(&traced, &right, &wrong, test);
            }
            rows.push(tally.row(estimator, budget.samples(), plan));
        }
    }
    Ok(Some(Power {
        scene: scene.name.clone(),
        scene_hash: scene.hash.clone(),
        sampler: plan.sampling.name().to_owned(),
        significance: plan.significance,
        rows,
    }))
}

/// Wrong models, each with what is wrong.
fn wrong_models(scene: &Scene, right: &Matrix) -> Result<Vec<(String, Matrix)>, PowerError> {
    let hundredth = 0.01 * scene.unit.per_inch();
    let shifted = scene.with_shifted_spots([hundredth, 0.0])?;
    let integral = |s: &Scene, kernel| converged(s, kernel, Extent::FULL).map(|c| c.phi);
    let matrices = MatrixModel::new(scene, Kernel::Physical, None)?;
    // The element in the middle of those that are lit and light.
    let light: Vec<usize> = (0..matrices.albedo.len())
        .filter(|j| matrices.albedo[*j] > 0.0)
        .collect();
    let mut models = vec![
        (format!("scaled by 1 + {SCALE}"), right * (1.0 + SCALE)),
        (
            "all spots moved by 0.01 in.".to_owned(),
            integral(&shifted, Kernel::Physical)?,
        ),
        (
            "published kernel".to_owned(),
            integral(scene, Kernel::Published)?,
        ),
    ];
    if let Some(&j) = light.get(light.len() / 2) {
        let change = matrices.camera_side.column(j) * matrices.laser_side.row(j);
        let name = format!("albedo of element {j} off by 1 %");
        models.push((name, right + change * (ALBEDO * matrices.albedo[j])));
    }
    Ok(models)
}

/// Counts over the seeds.
struct Tally {
    chi2: f64,
    false_alarms: u64,
    rejected: Vec<u64>,
    names: Vec<(String, f64)>,
    smallest: Vec<f64>,
}

impl Tally {
    fn new(wrong: &[(String, Matrix)], seeds: u64) -> Self {
        Self {
            chi2: 0.0,
            false_alarms: 0,
            rejected: vec![0; wrong.len()],
            names: wrong.iter().map(|(name, _)| (name.clone(), 0.0)).collect(),
            smallest: Vec::with_capacity(seeds as usize),
        }
    }

    fn add(&mut self, traced: &Traced, right: &Matrix, wrong: &[(String, Matrix)], test: Test) {
        let verdict = |model: &Matrix| {
            agree(
                Evidence {
                    traced: &traced.flux,
                    stderr: &traced.stderr,
                    model,
                    bound: None,
                },
                test,
            )
            .0
        };
        let own = verdict(right);
        self.chi2 += own.chi2_per_dof;
        self.false_alarms += u64::from(!own.agrees);
        for (i, (_, model)) in wrong.iter().enumerate() {
            self.names[i].1 = (model - right).norm() / right.norm();
            self.rejected[i] += u64::from(!verdict(model).agrees);
        }
        self.smallest
            .push(smallest_scale(|scale| !verdict(&(right * scale)).agrees));
    }

    fn row(mut self, estimator: Estimator, samples: u64, plan: &PowerPlan) -> PowerRow {
        self.smallest.sort_by(f64::total_cmp);
        PowerRow {
            estimator: estimator.name().to_owned(),
            samples,
            seeds: plan.seeds,
            chi2_per_dof: self.chi2 / plan.seeds as f64,
            false_alarms: self.false_alarms,
            expected: binomial_interval(plan.seeds, plan.significance, 0.99),
            detections: self
                .names
                .into_iter()
                .zip(self.rejected)
                .map(|((error, size), rejected)| Detection {
                    error,
                    size,
                    rejected,
                })
                .collect(),
            smallest_scale: self
                .smallest
                .get(self.smallest.len() / 2)
                .copied()
                .unwrap_or(f64::NAN),
        }
    }
}

/// Smallest s for which 1 + s is rejected, to a tenth of its size; 0 if the right model is.
fn smallest_scale(rejects: impl Fn(f64) -> bool) -> f64 {
    if rejects(1.0) {
        return 0.0;
    }
    let mut high = 1e-6;
    while high < 1.0 && !rejects(1.0 + high) {
        high *= 2.0;
    }
    let mut low = 0.5 * high;
    while high > 1.1 * low {
        let middle = 0.5 * (low + high);
        if rejects(1.0 + middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_threshold_is_found() {
        for limit in [1e-5, 3.3e-3, 0.2] {
            let found = smallest_scale(|s| s > 1.0 + limit);
            assert!(
                found >= limit && found <= 1.11 * limit,
                "{found} for {limit}"
            );
        }
        assert_eq!(smallest_scale(|_| true), 0.0);
    }
}
