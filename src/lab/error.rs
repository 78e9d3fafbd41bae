//! Why a study has no result.

use std::error::Error;

use crate::lab::comparison::measured::ValidationError;
use crate::model::ModelError;
use crate::num::linalg::LinalgError;
use crate::num::multiprecision::TooFewDigits;
use crate::recovery::RecoveryError;
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
    /// The light was not traced. A render that was stopped is [`Self::Stopped`].
    #[error(transparent)]
    Render(RenderError),
    /// Traced photographs do not fit their model.
    #[error(transparent)]
    Validation(#[from] ValidationError),
    /// A matrix cannot be decomposed.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    /// Nothing was recovered.
    #[error(transparent)]
    Recovery(#[from] RecoveryError),
    /// The digits of multiple precision do not suffice.
    #[error(transparent)]
    Digits(#[from] TooFewDigits),
    /// It was stopped.
    #[error("{0}")]
    Stopped(#[from] Stopped),
    /// An exposure with nothing but saturated pixels.
    #[error(
        "an exposure of {exposure:e} s saturates the brightest pixel; use exposures below {most:.3e} s"
    )]
    Saturated {
        /// The exposure, s.
        exposure: f64,
        /// What fills the brightest pixel, s.
        most: f64,
    },
    /// There is nothing to study in this scene: cause and cure.
    #[error("{0}")]
    Unsuited(&'static str),
    /// Unknowns that photographs do not tell: cause and cure.
    #[error("{0}")]
    Untold(String),
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
    /// No light meets the three surfaces of the model.
    pub(super) const DARK: Self =
        Self::Unsuited("no light reaches the camera by three bounces (see `phicam scene check`)");
    /// No light of the studied object arrives.
    pub(super) const DARK_OBJECT: Self =
        Self::Unsuited("no light from the object reaches the camera (see `phicam scene check`)");
    /// A noise so small that its square is lost beside that of the light.
    pub(super) const TOO_FINE: Self = Self::Unsuited(
        "the stated noise is less than about 1e-7 of the light, which normal equations do not resolve (state larger standard errors)",
    );
    /// The camera gets no stray light.
    pub(super) const NO_GLARE: Self = Self::Unsuited(
        "no light enters the lens straight from any spot, so there is no glare to study (let the camera face the wall where the spots are)",
    );
    /// No board divides any number of elements.
    pub(super) const NO_OBJECT: Self = Self::Unsuited(
        "no number of elements is a multiple of a number of checks, so there is no object to study (use e.g. 2 checks and 8 elements)",
    );
}

impl From<RenderError> for LabError {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::Stopped(stopped) => Self::Stopped(stopped),
            other => Self::Render(other),
        }
    }
}
