//! What a user is told when a command cannot do its work.

use std::error::Error;
use std::fmt::Write as _;

use super::output::complain;

/// Why a command ended without its result.
#[derive(Debug)]
pub(super) enum Failure {
    /// Something is wrong: exit code 2.
    Error(String),
    /// Ctrl-C: exit code 130; the text says what is kept.
    Stopped(String),
}

impl Failure {
    /// An error of cause and cure.
    pub(super) fn new(cause: impl Into<String>, cure: impl AsRef<str>) -> Self {
        Self::Error(format!("{}\n  cure: {}", cause.into(), cure.as_ref()))
    }

    pub(super) fn code(&self) -> u8 {
        match self {
            Self::Error(_) => 2,
            Self::Stopped(_) => 130,
        }
    }

    pub(super) fn report(&self) {
        match self {
            Self::Error(message) => complain(&format!("error: {message}")),
            Self::Stopped(message) => complain(&format!("stopped: {message}")),
        }
    }
}

/// The error of any floor below, whose message already names cause and cure.
impl<E: Error> From<E> for Failure {
    fn from(error: E) -> Self {
        let mut message = error.to_string();
        let mut source = error.source();
        while let Some(inner) = source {
            let text = inner.to_string();
            if !message.contains(&text) {
                let _ = write!(message, ": {text}");
            }
            source = inner.source();
        }
        Self::Error(message)
    }
}
