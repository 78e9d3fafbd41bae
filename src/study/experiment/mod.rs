//! The failed laboratory experiment, re-enacted: traced light, glare of the lens, a real sensor, and every way of reading the photographs.
//!
//! The photographs of a scene are Φ\[p,l\] = Φ_object\[p,l\] + Φ_glare\[p,l\], exposed by a sensor. Φ_object is traced, so no analysis is
//! helped by a model that made its data. The glare is the light that enters the lens straight from the laser spot, scattered over the image
//! ([`crate::sensor::glare`]); its strength is given as glare over signal, Σ Φ_glare/Σ Φ_object.

mod analysis;
mod results;
mod series;
mod tasks;
mod words;

use crate::model::ModelError;
use crate::sensor::{Sensor, SensorError};

pub use results::{Experiment, Reading, Setting, Threshold};
pub use tasks::ExperimentTasks;

/// How the experiment is re-enacted.
#[derive(Clone, Debug)]
pub struct ExperimentPlan {
    /// The sensor.
    pub sensor: Sensor,
    /// Its name.
    pub sensor_name: String,
    /// Paths per pixel of the traced light.
    pub samples: u64,
    /// Seed of the tracer, and first one of the sensor.
    pub seed: u64,
    /// Seeds of the sensor's noise.
    pub seeds: u64,
    /// Frames averaged at each spot in the sweep over glare; the sweep over exposures takes one.
    pub frames: u32,
    /// Glare over signal, growing.
    pub glares: Vec<f64>,
    /// Exposure times over the longest one that the sensor bears, growing up to 1.
    pub exposures: Vec<f64>,
    /// Distance on the wall, scene units, at which the falling glare has halved; the even one is always studied too.
    pub falloff: f64,
}

/// Why there is no study.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    /// The scene has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The sensor cannot take the photographs.
    #[error(transparent)]
    Sensor(#[from] SensorError),
    /// Nothing to be traced with.
    #[error("{0} samples cannot be traced (use 1 to 2³²)")]
    Samples(u64),
    /// No light.
    #[error("no light from the object reaches the camera (see `phicam scene check`)")]
    Dark,
    /// No glare to be had.
    #[error(
        "no light enters the lens straight from any spot, so there is no glare to study (let the camera face the wall where the spots are)"
    )]
    NoGlare,
    /// A list of levels that is empty, does not grow, or leaves its range.
    #[error(
        "the values of {name} ({what}) must be finite and {range}, and grow; list at least one, each once"
    )]
    List {
        /// Its name.
        name: &'static str,
        /// What its values are.
        what: &'static str,
        /// Where they may lie.
        range: &'static str,
    },
}

impl ExperimentPlan {
    /// Whether the lists of levels make sense.
    ///
    /// # Errors
    /// [`ExperimentError::List`].
    pub fn check(&self) -> Result<(), ExperimentError> {
        for (list, fine, name, what, range) in [
            (
                &self.glares,
                (|x| x >= 0.0) as fn(f64) -> bool,
                "--glares",
                "glare over signal",
                "0 or more",
            ),
            (
                &self.exposures,
                |x| x >= f64::MIN_POSITIVE,
                "--exposures",
                "over the longest exposure",
                "above 0",
            ),
        ] {
            let within = list.iter().all(|&x| fine(x) && x.is_finite());
            if list.is_empty() || !within || !list.windows(2).all(|w| w[0] < w[1]) {
                return Err(ExperimentError::List { name, what, range });
            }
        }
        Ok(())
    }
}
