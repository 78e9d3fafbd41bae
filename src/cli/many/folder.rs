//! The folder of a plan.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::work::Work;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::shard::{Identity, PlanId};
use crate::store::write_whole;

/// plan.json.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PlanFile {
    /// Version of this file's layout.
    pub layout: u32,
    /// SHA-256 of the identity.
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
pub(super) enum Settings {
    /// Φcam by the tracer.
    Render {
        estimator: String,
        sampler: String,
        seed: u64,
        samples: u64,
    },
    /// Another command, by its arguments.
    Command(Vec<String>),
}

/// A plan that was read and found to be what it says.
#[derive(Debug)]
pub(super) struct PlanFolder {
    pub path: PathBuf,
    pub file: PlanFile,
    pub work: Work,
}

impl PlanFile {
    pub(super) const NAME: &'static str = "plan.json";
    /// Its name in the folder of what was merged, where it is the last file to be written.
    pub(super) const MERGED: &'static str = "merged.json";
    const LAYOUT: u32 = 1;
    const LARGEST: u64 = 16 << 20;

    pub(super) fn new(work: &Work, shards: u64) -> Self {
        let identity = work.identity();
        Self {
            layout: Self::LAYOUT,
            plan_id: identity.id().to_string(),
            identity,
            work: work.settings(),
            blocks: work.blocks(),
            shards,
        }
    }

    /// The plan in the file `name` of `dir`, if there is one.
    pub(super) fn read(dir: &Path, name: &str) -> Result<Option<Self>, Failure> {
        let path = dir.join(name);
        let mut text = Vec::new();
        let read = File::open(&path).and_then(|f| f.take(Self::LARGEST + 1).read_to_end(&mut text));
        match read {
            Err(e) if matches!(e.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                return Ok(None);
            }
            Err(e) => {
                let cause = format!("cannot read {}: {e}", path.display());
                return Err(Failure::System(format!(
                    "{cause}\n  cure: make it readable, or plan into another folder"
                )));
            }
            Ok(_) => {}
        }
        let cure = "plan again into another folder";
        if text.len() as u64 > Self::LARGEST {
            return Err(Failure::new(
                format!("{} is too large to be a plan", path.display()),
                cure,
            ));
        }
        let damaged = |e: serde_json::Error| {
            Failure::new(format!("{} is damaged: {e}", path.display()), cure)
        };
        let file: Self = serde_json::from_slice(&text).map_err(damaged)?;
        if file.layout != Self::LAYOUT {
            let cause = format!(
                "{} has layout {}, this version reads {}",
                path.display(),
                file.layout,
                Self::LAYOUT
            );
            return Err(Failure::new(
                cause,
                "use the version of phicam that planned it",
            ));
        }
        if file.identity.id().to_string() != file.plan_id {
            let cause = format!(
                "{} was edited: its plan_id is not that of what it plans",
                path.display()
            );
            return Err(Failure::new(cause, cure));
        }
        Ok(Some(file))
    }

    pub(super) fn write(&self, dir: &Path, name: &str) -> Result<(), Failure> {
        let text = output::json(self)?;
        Ok(write_whole(&dir.join(name), |w| {
            w.write_all(text.as_bytes())
        })?)
    }

    /// The blocks of shard `index`.
    pub(super) fn range(&self, index: u64) -> Range<u64> {
        let cut = |k: u64| {
            (u128::from(k) * u128::from(self.blocks) / u128::from(self.shards.max(1))) as u64
        };
        cut(index)..cut(index + 1)
    }
}

impl PlanFolder {
    /// Reads the plan in `path`, and refuses it if the scene beside it, or the program, is not the one that was planned.
    pub(super) fn open(path: &Path) -> Result<Self, Failure> {
        Self::open_as(path, false)
    }

    /// The same; a study is to print JSON if `json`.
    pub(super) fn open_as(path: &Path, json: bool) -> Result<Self, Failure> {
        let none = || {
            let cause = format!(
                "{} is not the folder of a plan: it has no {}",
                path.display(),
                PlanFile::NAME
            );
            Failure::usage(cause, "give a folder that `phicam plan` has written")
        };
        let file = PlanFile::read(path, PlanFile::NAME)?.ok_or_else(none)?;
        let work = Work::read(path, &file.work, json)?;
        if let Some((name, planned, found)) = file.identity.difference(&work.identity()) {
            let dir = path.display();
            return Err(match name.as_str() {
                Identity::NUMERICS => Failure::new(
                    format!(
                        "{dir} was planned with version {planned} of the numerics, this phicam has {found}: their bits do not mix"
                    ),
                    "use the version of phicam that planned it, or plan again into another folder",
                ),
                "scene" | "scene's digest" => Failure::new(
                    format!(
                        "the scene in {dir} was edited after planning ({name}: {planned} planned, {found} found)"
                    ),
                    "restore it, or plan the changed scene into another folder",
                ),
                _ => Failure::new(
                    format!(
                        "{} in {dir} was edited after planning ({name}: {planned} planned, {found} found)",
                        PlanFile::NAME
                    ),
                    "plan again into another folder",
                ),
            });
        }
        if file.blocks != work.blocks() || !(1..=file.blocks).contains(&file.shards) {
            let cause = format!(
                "{} in {} was edited: {} shards of {} blocks",
                PlanFile::NAME,
                path.display(),
                file.shards,
                file.blocks
            );
            return Err(Failure::new(
                cause,
                "plan again: what is computed already stays valid",
            ));
        }
        Ok(Self {
            path: path.to_owned(),
            file,
            work,
        })
    }

    pub(super) fn id(&self) -> PlanId {
        self.file.identity.id()
    }

    /// Whether `output` is what a merge has left, to its last file.
    pub(super) fn is_merged(&self, output: &Path) -> Result<bool, Failure> {
        let there = PlanFile::read(output, PlanFile::MERGED)?;
        Ok(there.is_some_and(|p| p.plan_id == self.file.plan_id))
    }

    pub(super) fn shards_path(&self) -> PathBuf {
        self.path.join("shards")
    }
}
