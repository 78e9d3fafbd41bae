//! plan.json: what is divided into shards, and into how many.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::Identity;
use crate::store::{StoreError, write_whole};

/// plan.json.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanFile {
    layout: u32,
    /// SHA-256 of the identity, 64 hexadecimal digits.
    pub plan_id: String,
    /// All that the result depends on; the number of shards is no part of it.
    pub identity: Identity,
    /// What to do, as the program reads it.
    pub work: Settings,
    /// Blocks in all.
    pub blocks: u64,
    /// Shards that the blocks are divided into.
    pub shards: u64,
}

/// What is computed, beside the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum Settings {
    /// Φcam by the tracer.
    Render {
        /// What paths share.
        estimator: String,
        /// Where random numbers come from.
        sampler: String,
        /// Seed.
        seed: u64,
        /// Samples, whole blocks of them.
        samples: u64,
    },
    /// Another command, by its arguments.
    Command(Vec<String>),
}

/// What is wrong with a plan. Each message names the file, the cause and the cure.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// It cannot be read.
    #[error("cannot read {}: {source}; make it readable, or plan into another folder", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// It is not the text of a plan.
    #[error("{} is damaged: {what}; plan again into another folder", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What shows it.
        what: String,
    },
    /// Its layout is that of another version.
    #[error("{} has layout {found}, and this version of phicam reads layout {known}; use the version that planned it", path.display())]
    Layout {
        /// The file.
        path: PathBuf,
        /// Layout of the file.
        found: u32,
        /// Layout of this version.
        known: u32,
    },
    /// Its id is not that of its identity.
    #[error("{} was edited: its plan_id is not that of what it plans; plan again into another folder", path.display())]
    Edited {
        /// The file.
        path: PathBuf,
    },
    /// More shards than blocks, more than a million, or none.
    #[error("{} was edited: {shards} shards of {blocks} blocks; plan again: what is computed already stays valid", path.display())]
    Division {
        /// The file.
        path: PathBuf,
        /// Shards of the file.
        shards: u64,
        /// Blocks of the file.
        blocks: u64,
    },
}

impl PlanFile {
    /// Its name.
    pub const NAME: &'static str = "plan.json";
    /// Its name in the folder of what was merged, where it is the last file to be written.
    pub const MERGED: &'static str = "merged.json";
    /// Shards of one plan, at most: a folder has to list them.
    pub const MOST_SHARDS: u64 = 1_000_000;
    const LAYOUT: u32 = 1;
    /// Bytes of the largest.
    const LARGEST: u64 = 16 << 20;

    /// `blocks` blocks of `work`, which depend on `identity` alone, in `shards` shards.
    pub fn new(identity: Identity, work: Settings, blocks: u64, shards: u64) -> Self {
        Self {
            layout: Self::LAYOUT,
            plan_id: identity.id().to_string(),
            identity,
            work,
            blocks,
            shards,
        }
    }

    /// The plan in the file `path`, if there is one.
    ///
    /// # Errors
    /// [`PlanError`] if it cannot be read, or is none.
    pub fn read(path: &Path) -> Result<Option<Self>, PlanError> {
        let mut text = Vec::new();
        let read = File::open(path).and_then(|f| f.take(Self::LARGEST + 1).read_to_end(&mut text));
        match read {
            Err(e) if matches!(e.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                Ok(None)
            }
            Err(source) => Err(PlanError::Unreadable {
                path: path.to_owned(),
                source,
            }),
            Ok(_) => Self::parse(path, &text).map(Some),
        }
    }

    /// The plan in a text; `path` names it in errors.
    fn parse(path: &Path, text: &[u8]) -> Result<Self, PlanError> {
        let path = path.to_owned();
        let damaged = |what: String| PlanError::Damaged {
            path: path.clone(),
            what,
        };
        if text.len() as u64 > Self::LARGEST {
            return Err(damaged("it is too large".to_owned()));
        }
        let file: Self = serde_json::from_slice(text).map_err(|e| damaged(e.to_string()))?;
        if file.layout != Self::LAYOUT {
            return Err(PlanError::Layout {
                path,
                found: file.layout,
                known: Self::LAYOUT,
            });
        }
        if file.identity.id().to_string() != file.plan_id {
            return Err(PlanError::Edited { path });
        }
        if !(1..=file.blocks.min(Self::MOST_SHARDS)).contains(&file.shards) {
            return Err(PlanError::Division {
                path,
                shards: file.shards,
                blocks: file.blocks,
            });
        }
        Ok(file)
    }

    /// Writes it, whole or not at all.
    ///
    /// # Errors
    /// [`StoreError`] if it cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), StoreError> {
        write_whole(path, |w| {
            serde_json::to_writer_pretty(&mut *w, self)?;
            w.write_all(b"\n")
        })
    }

    /// The blocks of shard `index`, below the number of shards.
    pub fn range(&self, index: u64) -> Range<u64> {
        let cut = |k: u64| {
            (u128::from(k) * u128::from(self.blocks) / u128::from(self.shards.max(1))) as u64
        };
        cut(index)..cut(index + 1)
    }
}
