//! Why a job cannot go on.

use std::error::Error;
use std::path::{Path, PathBuf};

use super::Identity;
use crate::store::{ReadError, StoreError};

/// Why a job cannot go on. Each message names the cause and the cure.
#[derive(Debug, thiserror::Error)]
pub enum JobError {
    /// It was asked for in a way that has no meaning.
    #[error("{0}")]
    Usage(String),
    /// What was given, or what is on disk, cannot be accepted.
    #[error("{0}")]
    Refused(String),
    /// A file of blocks of other work.
    #[error("{}", foreign(path, name, found, expected))]
    Foreign {
        /// The file.
        path: PathBuf,
        /// The first thing in which the works differ.
        name: String,
        /// What the file says of it.
        found: String,
        /// What was looked for.
        expected: String,
    },
    /// Blocks of a plan are missing.
    #[error("{0}")]
    Missing(String),
    /// The system could not do what was needed; another try may help.
    #[error("{0}")]
    System(String),
    /// A file of blocks that cannot be used: what it held has to be computed again.
    #[error("{} {what}; compute this shard again", path.display())]
    Spoilt {
        /// The file.
        path: PathBuf,
        /// What shows it.
        what: String,
    },
    /// A file of blocks that cannot be read.
    #[error(transparent)]
    Unreadable(#[from] ReadError),
    /// A file that cannot be written.
    #[error("{0}")]
    Store(#[from] StoreError),
    /// The blocks could not be computed.
    #[error("{0}")]
    Work(#[source] Box<dyn Error + Send + Sync>),
}

impl JobError {
    /// A call without meaning, by cause and cure.
    pub fn usage(cause: impl Into<String>, cure: &str) -> Self {
        Self::Usage(cause.into() + "\n  cure: " + cure)
    }

    /// What cannot be accepted, by cause and cure.
    pub fn refused(cause: impl Into<String>, cure: &str) -> Self {
        Self::Refused(cause.into() + "\n  cure: " + cure)
    }

    /// What the system could not do, by cause and cure.
    pub fn system(cause: impl Into<String>, cure: &str) -> Self {
        Self::System(cause.into() + "\n  cure: " + cure)
    }

    /// What kept blocks from being computed.
    pub fn work(error: impl Error + Send + Sync + 'static) -> Self {
        Self::Work(Box::new(error))
    }

    /// The file of blocks that is spoilt, if that is what is wrong.
    pub fn spoilt(&self) -> Option<&Path> {
        if let Self::Spoilt { path, .. } = self {
            Some(path)
        } else {
            None
        }
    }
}

fn foreign(path: &Path, name: &str, found: &str, expected: &str) -> String {
    let file = path.display();
    if name == Identity::NUMERICS {
        format!(
            "{file} was computed with version {found} of the numerics, this plan has {expected}: their bits do not mix; compute this shard again with one version of phicam"
        )
    } else {
        format!(
            "{file} belongs to another plan: its {name} is {found}, that of this plan is {expected}; move it out of the folder"
        )
    }
}
