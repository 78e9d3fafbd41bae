//! How small a model error does `validate` detect, and how often does it cry wolf?

mod tasks;
mod verdicts;

use serde::Serialize;

use super::task::whole;
use crate::model::ModelError;
use crate::num::stream::Sampling;
use crate::scene::{Scene, SceneError};
use crate::transport::{Control, Estimator};

pub use tasks::PowerTasks;

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
    whole(&PowerTasks::new(scene, plan.clone()), control, &|_, _| ())
}
