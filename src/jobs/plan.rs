//! plan.json: what is divided into shards, and into how many.

use std::ops::Range;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{Identity, JobError};
use crate::num::stream::Sampling;
use crate::store::{self, StoreError, write_whole};
use crate::transport::{Estimator, Plan};

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
        estimator: Estimator,
        /// Where random numbers come from.
        sampler: Sampling,
        /// Seed.
        seed: u64,
        /// Samples, whole blocks of them.
        samples: u64,
    },
    /// Another command, by its arguments.
    Command(Vec<String>),
}

impl Settings {
    /// A render.
    pub fn render(plan: &Plan) -> Self {
        Self::Render {
            estimator: plan.estimator,
            sampler: plan.sampling,
            seed: plan.seed,
            samples: plan.budget.samples(),
        }
    }
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
    /// [`JobError`] if it cannot be read, or is none.
    pub fn read(path: &Path) -> Result<Option<Self>, JobError> {
        match store::read(path, Self::LARGEST) {
            Err(e) if e.is_missing() => Ok(None),
            Err(e) => Err(e.into()),
            Ok(text) => {
                let refused = |what| JobError::Refused(format!("{} {what}", path.display()));
                Self::parse(&text).map(Some).map_err(refused)
            }
        }
    }

    /// The plan in a text, or what is wrong with it.
    fn parse(text: &[u8]) -> Result<Self, String> {
        let damaged = |what: String| format!("is damaged: {what}; plan again into another folder");
        let file: Self = serde_json::from_slice(text).map_err(|e| damaged(e.to_string()))?;
        let Self {
            layout,
            blocks,
            shards,
            ..
        } = file;
        if layout != Self::LAYOUT {
            let known = Self::LAYOUT;
            Err(format!(
                "has layout {layout}, and this version of phicam reads layout {known}; use the version that planned it"
            ))
        } else if file.identity.id().to_string() != file.plan_id {
            Err("was edited: its plan_id is not that of what it plans; plan again into another folder".to_owned())
        } else if !(1..=blocks.min(Self::MOST_SHARDS)).contains(&shards) {
            Err(format!(
                "was edited: {shards} shards of {blocks} blocks; plan again: what is computed already stays valid"
            ))
        } else {
            Ok(file)
        }
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
