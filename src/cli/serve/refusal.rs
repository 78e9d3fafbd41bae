//! What a request is told that gets no result.

use hyper::StatusCode;

use crate::matrix::npy::NpyError;

/// A status and a short text.
#[derive(Debug)]
pub(super) struct Refusal {
    pub status: StatusCode,
    pub words: String,
}

impl Refusal {
    pub(super) fn new(status: StatusCode, words: impl Into<String>) -> Self {
        Self {
            status,
            words: words.into(),
        }
    }

    /// 400: what was asked has no meaning here.
    pub(super) fn meaningless(words: impl Into<String>) -> Self {
        Self::new(StatusCode::BAD_REQUEST, words)
    }

    /// 404 for the file `name`.
    pub(super) fn not_found(name: &str) -> Self {
        let words = format!("{name}: no such file in this folder, or none that may be read");
        Self::new(StatusCode::NOT_FOUND, words)
    }

    /// 500: what is there cannot be read.
    pub(super) fn broken(words: impl Into<String>) -> Self {
        Self::new(StatusCode::INTERNAL_SERVER_ERROR, words)
    }
}

impl From<NpyError> for Refusal {
    fn from(error: NpyError) -> Self {
        Self::broken(error.to_string())
    }
}
