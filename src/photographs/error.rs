//! Why photographs cannot be imported.

use crate::image::ImageError;
use crate::matrix::ArrayError;
use crate::num::linalg::LinalgError;
use crate::scene::SceneError;
use crate::store::ReadError;

/// Why photographs cannot be imported. Each message names cause and cure.
#[derive(Debug, thiserror::Error)]
pub enum PhotographError {
    /// What is given does not fit together.
    #[error("{cause}\n  cure: {cure}")]
    Refused {
        /// What is wrong.
        cause: String,
        /// What to do about it.
        cure: String,
    },
    /// A picture cannot be read.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// An array cannot be read.
    #[error(transparent)]
    Array(#[from] ArrayError),
    /// A file cannot be read.
    #[error(transparent)]
    File(#[from] ReadError),
    /// The scene, or the list of photographs, cannot be read.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The marks give no mapping.
    #[error(transparent)]
    Marks(#[from] LinalgError),
}

/// [`PhotographError::Refused`].
pub(super) fn refused(cause: impl Into<String>, cure: impl Into<String>) -> PhotographError {
    let (cause, cure) = (cause.into(), cure.into());
    PhotographError::Refused { cause, cure }
}
