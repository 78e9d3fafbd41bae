//! Why a file is not the shard that it should be.

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// What is wrong with a shard. Each message names the file, the cause and the cure.
#[derive(Debug, thiserror::Error)]
pub enum ShardError {
    /// It cannot be read.
    #[error("cannot read {}: {source}; check the file and its device", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// No byte in it.
    #[error("{} is empty: whoever wrote it never finished; compute this shard again", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// It does not begin as a shard does.
    #[error("{} is no shard of phicam; move it out of the folder", path.display())]
    NotAShard {
        /// The file.
        path: PathBuf,
    },
    /// Its layout is that of another version.
    #[error("{} has layout {found}, and this version of phicam reads layout {known}; use the version that wrote it, or compute this shard again", path.display())]
    Layout {
        /// The file.
        path: PathBuf,
        /// Layout of the file.
        found: u32,
        /// Layout of this version.
        known: u32,
    },
    /// It ends too early.
    #[error("{} is cut off: it has {found} of {expected} bytes; compute this shard again", path.display())]
    Truncated {
        /// The file.
        path: PathBuf,
        /// Bytes in the file.
        found: u64,
        /// Bytes that its header promises.
        expected: u64,
    },
    /// It goes on beyond its end.
    #[error("{} has {found} bytes, {} more than its header says; compute this shard again", path.display(), found - expected)]
    TooLong {
        /// The file.
        path: PathBuf,
        /// Bytes in the file.
        found: u64,
        /// Bytes that its header promises.
        expected: u64,
    },
    /// Its bytes are not those that were written.
    #[error("{} is damaged: {what}; compute this shard again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What shows it.
        what: String,
    },
    /// It was computed with other arithmetic.
    #[error("{} was computed with version {found} of the numerics, this plan has {expected}: their bits do not mix; compute this shard again with one version of phicam", path.display())]
    Numerics {
        /// The file.
        path: PathBuf,
        /// Of the file.
        found: String,
        /// Of the plan.
        expected: String,
    },
    /// It is part of another plan.
    #[error("{} belongs to another plan: its {name} is {found}, that of this plan is {expected}; move it out of the folder", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// In what they differ.
        name: String,
        /// Of the file.
        found: String,
        /// Of the plan.
        expected: String,
    },
    /// Its blocks are none of the plan's, or its parts do not make up its range.
    #[error("{} holds blocks {}..{} of {total}, in parts that do not make them up; compute this shard again", path.display(), range.start, range.end)]
    Range {
        /// The file.
        path: PathBuf,
        /// What it says to hold.
        range: Range<u64>,
        /// Blocks of the plan.
        total: u64,
    },
}

impl ShardError {
    /// The file, if it is one of ours that nobody can use: what it held has to be computed again.
    pub fn spoilt(&self) -> Option<&Path> {
        match self {
            Self::Empty { path }
            | Self::Truncated { path, .. }
            | Self::TooLong { path, .. }
            | Self::Damaged { path, .. }
            | Self::Range { path, .. } => Some(path),
            _ => None,
        }
    }
}
