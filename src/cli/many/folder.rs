//! The folder of a plan.

use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::work::Work;
use crate::cli::failure::Failure;
use crate::cli::folder::SCENE;
use crate::scene::COPIES;
use crate::shard::{Identity, PlanFile, PlanId};

/// A plan that was read and found to be what it says.
#[derive(Debug)]
pub(super) struct PlanFolder {
    pub path: PathBuf,
    pub file: PlanFile,
    pub work: Work,
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
        let file = PlanFile::read(&path.join(PlanFile::NAME))?.ok_or_else(none)?;
        readable(path)?;
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
                "scene" | "scene's digest" | "scene's text" => Failure::new(
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
        let there = PlanFile::read(&output.join(PlanFile::MERGED))?;
        Ok(there.is_some_and(|p| p.plan_id == self.file.plan_id))
    }

    pub(super) fn shards_path(&self) -> PathBuf {
        self.path.join("shards")
    }
}

/// What cannot be read for now is told from what is wrong in it: another try may help.
fn readable(dir: &Path) -> Result<(), Failure> {
    let mut files = vec![dir.join(SCENE)];
    if let Ok(copies) = fs::read_dir(dir.join(COPIES)) {
        files.extend(copies.flatten().map(|entry| entry.path()));
    }
    for path in files {
        match File::open(&path) {
            Err(e) if e.kind() != ErrorKind::NotFound => {
                let cause = format!("cannot read {}: {e}", path.display());
                return Err(Failure::system(
                    cause,
                    "check the folder and its file server",
                ));
            }
            _ => {}
        }
    }
    Ok(())
}
