//! Why a run folder cannot be read or written.

use crate::film::StackError;
use crate::film::exr::FrameError;
use crate::matrix::npy::NpyError;
use crate::scene::SceneError;
use crate::store::{LockError, ReadError, StoreError};

/// Why a run folder cannot be read or written: cause and cure.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// What is in it, or what was asked for.
    #[error("{0}")]
    Refused(String),
    /// A file cannot be read.
    #[error("{0}")]
    Read(#[from] ReadError),
    /// A file cannot be written.
    #[error("{0}")]
    Store(#[from] StoreError),
    /// Another process writes it.
    #[error("{0}")]
    Lock(#[from] LockError),
    /// A matrix cannot be read or written.
    #[error("{0}")]
    Matrix(#[from] NpyError),
    /// A frame cannot be written.
    #[error("{0}")]
    Frame(#[from] FrameError),
    /// Its frames do not make a matrix.
    #[error("{0}")]
    Stack(#[from] StackError),
    /// Its scene cannot be used.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// Its record cannot be written as JSON.
    #[error("{0}")]
    Json(#[from] serde_json::Error),
}

impl FolderError {
    /// By cause and cure.
    pub(crate) fn new(cause: impl Into<String>, cure: &str) -> Self {
        Self::Refused(format!("{}\n  cure: {cure}", cause.into()))
    }
}
