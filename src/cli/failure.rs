//! How a command ended, and what a user reads when it could not do its work.

use std::error::Error;
use std::fmt::Write as _;
use std::io;

use crate::cli::console::complain;
use crate::cli::interrupt;
use crate::jobs::JobError;
use crate::lab::StudyError;
use crate::lab::options::OptionError;
use crate::store::{LockError, StoreError};
use crate::transport::Stopped;

/// How a command ended that did its work, by its exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    Done = 0,
    /// Traced and modelled disagree.
    Disagreed = 1,
    /// Shards are missing.
    Incomplete = 3,
    /// Nothing that counts was lit: traced and modelled could not be compared.
    NoEvidence = 4,
}

/// Why a command ended without its result.
#[derive(Debug)]
pub(super) enum Failure {
    /// What was given cannot be accepted.
    Error(String),
    /// The command was called in a way that has no meaning.
    Usage(String),
    /// Blocks of a plan are missing.
    Missing(String),
    /// The system could not read or write.
    System(String),
    /// Ctrl-C or SIGTERM; the text says what is kept.
    Stopped(String),
}

/// What is said of a search that was stopped.
pub(super) const NOTHING_KEPT: &str = "nothing of the search is kept: the same command begins anew";

/// Which numbers say how a command failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Codes {
    /// 2 for every error.
    Plain,
    /// For a scheduler, which must know whether it is worth another try: those of `sysexits.h`, as
    /// far as they fit.
    Scheduler,
}

impl Failure {
    /// An error of cause and cure.
    pub(super) fn new(cause: impl Into<String>, cure: impl AsRef<str>) -> Self {
        Self::Error(words(cause, cure))
    }

    /// A wrong argument, by cause and cure.
    pub(super) fn usage(cause: impl Into<String>, cure: impl AsRef<str>) -> Self {
        Self::Usage(words(cause, cure))
    }

    /// What the system could not do, by cause and cure.
    pub(super) fn system(cause: impl Into<String>, cure: impl AsRef<str>) -> Self {
        Self::System(words(cause, cure))
    }

    /// Says what is kept, if the command was stopped.
    pub(super) fn if_stopped(self, kept: impl Into<String>) -> Self {
        match self {
            Self::Stopped(_) => Self::Stopped(kept.into()),
            other => other,
        }
    }

    pub(super) fn code(&self, codes: Codes) -> u8 {
        match (self, codes) {
            (Self::Stopped(_), _) if interrupt::warned() => 75,
            (Self::Stopped(_), _) => 130,
            (_, Codes::Plain) => 2,
            (Self::Usage(_), _) => 64,
            (Self::Error(_), _) => 65,
            (Self::Missing(_), _) => 66,
            (Self::System(_), _) => 74,
        }
    }

    pub(super) fn report(&self) {
        let kind = match self {
            Self::Error(_) | Self::Usage(_) | Self::System(_) => "error",
            Self::Missing(_) => "missing",
            Self::Stopped(_) => "stopped",
        };
        complain(&format!("{kind}: {}", self.message()));
    }

    /// Cause and cure.
    pub(super) fn message(&self) -> &str {
        match self {
            Self::Error(m)
            | Self::Usage(m)
            | Self::System(m)
            | Self::Missing(m)
            | Self::Stopped(m) => m,
        }
    }
}

fn words(cause: impl Into<String>, cure: impl AsRef<str>) -> String {
    format!("{}\n  cure: {}", cause.into(), cure.as_ref())
}

/// The error of any floor below, whose message already names cause and cure.
impl<E: Error + 'static> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::because(&error)
    }
}

impl Failure {
    /// The error of a study.
    pub(super) fn of(error: StudyError) -> Self {
        Self::because(&*error)
    }

    fn because(error: &(dyn Error + 'static)) -> Self {
        let mut message = error.to_string();
        match error.downcast_ref::<JobError>() {
            Some(JobError::Usage(_)) => return Self::Usage(message),
            Some(JobError::Missing(_)) => return Self::Missing(message),
            Some(JobError::System(_)) => return Self::System(message),
            _ => {}
        }
        if error.is::<OptionError>() {
            return Self::Usage(message);
        }
        let mut system = is_of_the_system(error);
        let mut stopped = error.is::<Stopped>();
        let mut source = error.source();
        while let Some(inner) = source {
            let text = inner.to_string();
            stopped |= inner.is::<Stopped>();
            // What was stopped says itself how to go on.
            if !stopped && !message.contains(&text) {
                let _ = write!(message, ": {text}");
            }
            system |= is_of_the_system(inner);
            source = inner.source();
        }
        if stopped {
            Self::Stopped(message)
        } else if system {
            Self::System(message)
        } else {
            Self::Error(message)
        }
    }
}

/// Whether trying again, elsewhere or later, may help.
fn is_of_the_system(error: &(dyn Error + 'static)) -> bool {
    error.is::<StoreError>() || error.is::<LockError>() || error.is::<io::Error>()
}
