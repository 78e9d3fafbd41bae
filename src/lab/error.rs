//! Why a study has no result.

use std::error::Error;

use crate::model::ModelError;
use crate::scene::SceneError;
use crate::sensor::SensorError;
use crate::transport::{RenderError, SamplesError, Stopped};

/// Why a study was not done; cause and cure in its text.
pub type StudyError = Box<dyn Error + Send + Sync>;

/// Why a study has no result: what is wrong with its scene or settings, or that it was stopped.
#[derive(Debug, thiserror::Error)]
pub enum LabError {
    /// The scene has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The scene cannot be altered as the study does.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The sensor cannot take the photographs.
    #[error(transparent)]
    Sensor(#[from] SensorError),
    /// Not a number of paths.
    #[error(transparent)]
    Samples(#[from] SamplesError),
    /// The light was not traced.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// It was stopped.
    #[error("{0}")]
    Stopped(#[from] Stopped),
    /// There is nothing to study in this scene: cause and cure.
    #[error("{0}")]
    Unsuited(&'static str),
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

impl LabError {
    /// That no light meets the three surfaces of the model.
    pub(super) const DARK: Self =
        Self::Unsuited("no light reaches the camera by three bounces (see `phicam scene check`)");
}
