//! The folder of a plan: which blocks are there, which are missing, and what nobody needs any more.

use std::collections::BTreeSet;
use std::fs;
use std::io::ErrorKind;
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::blocks::{BlockFile, EXTENSION};
use super::{Identity, JobError, PlanFile, PlanId};
use crate::store::is_abandoned;

/// What the name of a checkpoint ends in.
const CHECKPOINT: &str = "checkpoint";

/// A plan in its folder.
#[derive(Debug)]
pub struct PlanFolder {
    /// The folder.
    pub path: PathBuf,
    /// Its plan.json.
    pub file: PlanFile,
}

impl PlanFolder {
    /// The plan in `path`.
    ///
    /// # Errors
    /// [`JobError`] if there is none.
    pub fn open(path: &Path) -> Result<Self, JobError> {
        let file = PlanFile::read(&path.join(PlanFile::NAME))?.ok_or_else(|| {
            let cause = format!(
                "{} is not the folder of a plan: it has no {}",
                path.display(),
                PlanFile::NAME
            );
            JobError::usage(cause, "give a folder that `phicam plan` has written")
        })?;
        let path = path.to_owned();
        Ok(Self { path, file })
    }

    /// Refuses a plan that is not of this work: because its scene or plan.json was edited, or the
    /// program is another one.
    ///
    /// # Errors
    /// [`JobError::Refused`].
    pub fn check(&self, identity: &Identity, blocks: u64) -> Result<(), JobError> {
        let (dir, plan) = (self.path.display(), PlanFile::NAME);
        let Some((name, planned, found)) = self.file.identity.difference(identity) else {
            if self.file.blocks == blocks {
                return Ok(());
            }
            let cause = format!(
                "{plan} in {dir} was edited: {} blocks, of {blocks} that there are",
                self.file.blocks
            );
            let cure = "plan again: what is computed already stays valid";
            return Err(JobError::refused(cause, cure));
        };
        let edited = |what: String| {
            format!("{what} was edited after planning ({name}: {planned} planned, {found} found)")
        };
        let (cause, cure) = match name.as_str() {
            Identity::NUMERICS => (
                format!(
                    "{dir} was planned with version {planned} of the numerics, this phicam has {found}: their bits do not mix"
                ),
                "use the version of phicam that planned it, or plan again into another folder",
            ),
            "scene" | "scene's digest" | "scene's text" => (
                edited(format!("{dir}/scene.toml")),
                "restore it, or plan the changed scene into another folder",
            ),
            _ => (
                edited(format!("{plan} in {dir}")),
                "plan again into another folder",
            ),
        };
        Err(JobError::refused(cause, cure))
    }

    /// The id of the plan.
    pub fn id(&self) -> PlanId {
        self.file.identity.id()
    }

    /// The folder of its shards.
    pub fn shards(&self) -> PathBuf {
        self.path.join("shards")
    }

    /// The file of the shard that has the blocks `range`, and that of its checkpoint.
    pub fn files_of(&self, range: &Range<u64>) -> [PathBuf; 2] {
        [EXTENSION, CHECKPOINT].map(|extension| {
            let (id, Range { start, end }) = (self.id().short(), range);
            self.shards()
                .join(format!("{id}-{start}-{end}.{extension}"))
        })
    }

    /// The blocks in a file's name, if it is one of the plan.
    fn named_range(&self, path: &Path) -> Option<Range<u64>> {
        let name = path.file_stem()?.to_str()?;
        let own = name.strip_prefix(&self.id().short())?.strip_prefix('-')?;
        let (from, to) = own.split_once('-')?;
        Some(from.parse().ok()?..to.parse().ok()?)
    }

    fn read(&self, path: &Path) -> Result<BlockFile, JobError> {
        BlockFile::open(path, &self.file.identity, self.file.blocks)
    }

    /// The shards that hold blocks of `range`, by their names; and what is wrong with those that
    /// are none.
    ///
    /// # Errors
    /// [`JobError`] if one cannot be read for now.
    pub fn find(&self, range: &Range<u64>) -> Result<(Vec<BlockFile>, Vec<JobError>), JobError> {
        let (mut found, mut wrong) = (Vec::new(), Vec::new());
        for path in files(&self.shards(), EXTENSION)? {
            let named = self.named_range(&path);
            if named.is_none_or(|n| n.start >= range.end || n.end <= range.start) {
                continue;
            }
            match self.read(&path) {
                Ok(shard) => found.push(shard),
                Err(JobError::Unreadable(e)) if !e.is_missing() => return Err(e.into()),
                Err(e) => wrong.push(e),
            }
        }
        Ok((found, wrong))
    }

    /// All shards of the folder, and what is wrong with those of the plan that are not whole: what
    /// they held is missing.
    ///
    /// # Errors
    /// [`JobError`] if a file that ends as a shard does is none, or one of another plan, or cannot
    /// be read for now.
    pub fn all(&self) -> Result<(Vec<BlockFile>, Vec<JobError>), JobError> {
        let (mut found, mut wrong) = (Vec::new(), Vec::new());
        for path in files(&self.shards(), EXTENSION)? {
            match self.read(&path) {
                Ok(shard) => found.push(shard),
                // Somebody removed it just now, or it is a link to nothing.
                Err(JobError::Unreadable(e)) if e.is_missing() => wrong.push(e.into()),
                Err(e) if e.spoilt().is_some() && self.named_range(&path).is_some() => {
                    wrong.push(e);
                }
                Err(e) => return Err(e),
            }
        }
        Ok((found, wrong))
    }

    /// The indices of the shards of which blocks are in none of the `ranges`.
    pub fn missing(&self, ranges: impl IntoIterator<Item = Range<u64>>) -> BTreeSet<usize> {
        let gaps = gaps(0..self.file.blocks, ranges);
        let lacks = |own: Range<u64>| {
            let at = gaps.partition_point(|g| g.end <= own.start);
            gaps.get(at).is_some_and(|g| g.start < own.end)
        };
        let all = 0..self.file.shards;
        all.filter(|k| lacks(self.file.range(*k)))
            .map(|k| k as usize)
            .collect()
    }

    /// Whether `output` is what a merge has left, to its last file.
    ///
    /// # Errors
    /// [`JobError`] if that cannot be read.
    pub fn is_merged(&self, output: &Path) -> Result<bool, JobError> {
        let there = PlanFile::read(&output.join(PlanFile::MERGED))?;
        Ok(there.is_some_and(|p| p.plan_id == self.file.plan_id))
    }

    /// The files that nobody needs: those that an ended process was writing, spoilt shards,
    /// checkpoints of finished shards, and with `shards` all shards and checkpoints of the plan.
    /// Also what is wrong with other files.
    ///
    /// # Errors
    /// [`JobError`] if a folder cannot be listed or a shard not be read for now.
    pub fn needless(&self, shards: bool) -> Result<(BTreeSet<PathBuf>, Vec<JobError>), JobError> {
        let place = self.shards();
        let mut needless: BTreeSet<PathBuf> = files(&self.path, "part")?.into_iter().collect();
        needless.extend(files(&place, "part")?);
        needless.retain(|path| is_abandoned(path));
        let (there, mut wrong) = self.find(&(0..self.file.blocks))?;
        needless.extend(
            wrong
                .iter()
                .filter_map(JobError::spoilt)
                .map(Path::to_owned),
        );
        wrong.retain(|error| error.spoilt().is_none());
        let ranges = || there.iter().map(|s| s.range.clone());
        for path in files(&place, CHECKPOINT)? {
            let range = self.named_range(&path);
            if range.is_some_and(|r| shards || gaps(r, ranges()).is_empty()) {
                needless.insert(path);
            }
        }
        if shards {
            let all = files(&place, EXTENSION)?.into_iter();
            needless.extend(all.filter(|p| self.named_range(p).is_some()));
        } else {
            // Somebody may have computed a spoilt one again meanwhile.
            needless
                .retain(|p| p.extension().is_none_or(|e| e != EXTENSION) || self.read(p).is_err());
        }
        Ok((needless, wrong))
    }
}

/// The files of `dir` that end in `extension`, in the order of their names; none if there is no
/// such folder.
fn files(dir: &Path, extension: &str) -> Result<Vec<PathBuf>, JobError> {
    let list = || -> std::io::Result<Vec<PathBuf>> {
        fs::read_dir(dir)?.map(|entry| Ok(entry?.path())).collect()
    };
    match list() {
        Err(e) if e.kind() == ErrorKind::NotFound => Ok(Vec::new()),
        Err(e) if e.kind() == ErrorKind::NotADirectory => {
            let cause = format!("{} is no folder", dir.display());
            Err(JobError::refused(cause, "move it away"))
        }
        Err(e) => {
            let cause = format!("cannot list {}: {e}", dir.display());
            Err(JobError::system(cause, "make it readable"))
        }
        Ok(mut paths) => {
            paths.retain(|path| path.extension().is_some_and(|e| e == extension));
            paths.sort();
            Ok(paths)
        }
    }
}

/// The blocks of `whole` that are in none of the `ranges`, whatever their order and overlap.
pub fn gaps(whole: Range<u64>, ranges: impl IntoIterator<Item = Range<u64>>) -> Vec<Range<u64>> {
    let mut ranges: Vec<Range<u64>> = ranges.into_iter().filter(|r| !r.is_empty()).collect();
    ranges.sort_by_key(|r| r.start);
    let mut gaps = Vec::new();
    let mut at = whole.start;
    for range in ranges {
        let start = range.start.min(whole.end);
        if start > at {
            gaps.push(at..start);
        }
        at = at.max(range.end);
    }
    if at < whole.end {
        gaps.push(at..whole.end);
    }
    gaps
}
