//! What the power study tries and finds.

use serde::Serialize;

use crate::num::stream::Sampling;
use crate::transport::Estimator;

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
    /// Light that the scene has and its model does not: a right model is then rejected for it.
    pub unmodelled: Vec<String>,
    /// Its hash.
    pub scene_hash: String,
    /// Sampler.
    pub sampler: String,
    /// Significance level.
    pub significance: f64,
    /// One row for each estimator and number of samples.
    pub rows: Vec<PowerRow>,
}

impl PowerRow {
    /// Whether the right model was rejected as often as 99 % of such counts are at the stated
    /// level.
    pub fn as_stated(&self) -> bool {
        let [low, high] = self.expected;
        (low..=high).contains(&self.false_alarms)
    }
}
