//! What the study finds.

use serde::Serialize;

use super::configuration::Configuration;
use super::noisy::NoisyPoint;
use super::summary::{Coefficients, NoisySummary};

/// The study of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct Indicator {
    /// Name of the scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// Draws of the noise.
    pub seeds: u64,
    /// Seed of the first.
    pub first_seed: u64,
    /// Every configuration.
    pub configurations: Vec<Configuration>,
    /// Largest difference between the raw MTF of the projected object and of the recovery.
    pub identity: f64,
    /// Each figure against the raw MTF without noise.
    pub coefficients: Vec<Coefficients>,
    /// Under noise, a method after the other.
    pub noisy: Vec<NoisySummary>,
    /// Every point under noise.
    pub points: Vec<NoisyPoint>,
}
