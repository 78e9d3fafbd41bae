//! The shards in a plan's folder.

use std::fs;
use std::io::ErrorKind;
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::folder::PlanFolder;
use crate::cli::failure::Failure;
use crate::shard::{Clash, EXTENSION, PlanId, ShardError, ShardFile, select};

/// What the name of a checkpoint ends in.
pub(super) const CHECKPOINT: &str = "checkpoint";

/// The name of the file for the blocks `range`.
pub(super) fn file_name(id: PlanId, range: &Range<u64>, extension: &str) -> String {
    format!("{}-{}-{}.{extension}", id.short(), range.start, range.end)
}

/// The blocks in a file's name, if it is one of the plan.
pub(super) fn named_range(path: &Path, id: PlanId, extension: &str) -> Option<Range<u64>> {
    let name = path.file_name()?.to_str()?;
    let own = name.strip_prefix(&id.short())?.strip_prefix('-')?;
    let (from, to) = own
        .strip_suffix(extension)?
        .strip_suffix('.')?
        .split_once('-')?;
    Some(from.parse().ok()?..to.parse().ok()?)
}

/// The files of `dir` that end in `extension`, in the order of their names; none if there is no such folder.
pub(super) fn files(dir: &Path, extension: &str) -> Result<Vec<PathBuf>, Failure> {
    let entries = match fs::read_dir(dir) {
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(e) => {
            let cause = format!("cannot list {}: {e}", dir.display());
            return Err(Failure::system(cause, "make it readable"));
        }
        Ok(entries) => entries,
    };
    let mut paths = Vec::new();
    for entry in entries {
        let path = entry?.path();
        if path.extension().is_some_and(|e| e == extension) {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

/// The shards of `plan` that hold blocks of `range`, by their names; and what is wrong with those that are none.
pub(super) fn find(
    plan: &PlanFolder,
    range: &Range<u64>,
) -> Result<(Vec<ShardFile>, Vec<ShardError>), Failure> {
    let (id, total) = (plan.id(), plan.file.blocks);
    let (mut found, mut wrong) = (Vec::new(), Vec::new());
    for path in files(&plan.shards_path(), EXTENSION)? {
        let named = named_range(&path, id, EXTENSION);
        if named.is_none_or(|n| n.start >= range.end || n.end <= range.start) {
            continue;
        }
        match ShardFile::open(&path, &plan.file.identity, total) {
            Ok(shard) => found.push(shard),
            Err(ShardError::Unreadable { path, source })
                if source.kind() != ErrorKind::NotFound =>
            {
                return Err(ShardError::Unreadable { path, source }.into());
            }
            Err(e) => wrong.push(e),
        }
    }
    Ok((found, wrong))
}

/// Shards that make up every block of a plan once.
#[derive(Debug)]
pub(super) struct Shards {
    place: PathBuf,
    shards: Vec<ShardFile>,
}

impl Shards {
    /// All shards in the folder of `plan`, of which none may be anything else; in the order of their blocks, each once.
    pub(super) fn of(plan: &PlanFolder) -> Result<Self, Failure> {
        let place = plan.shards_path();
        let mut shards = Vec::new();
        for path in files(&place, EXTENSION)? {
            shards.push(ShardFile::open(
                &path,
                &plan.file.identity,
                plan.file.blocks,
            )?);
        }
        let name = |i: usize| shards[i].path.display();
        let blocks = |i: usize| format!("{}..{}", shards[i].range.start, shards[i].range.end);
        let chosen = select(&shards).map_err(|clash| match clash {
            Clash::Overlap(a, b) => Failure::new(
                format!(
                    "{} (blocks {}) and {} (blocks {}) overlap: a block would count twice",
                    name(a),
                    blocks(a),
                    name(b),
                    blocks(b)
                ),
                "move one of them out of the folder",
            ),
            Clash::Conflict(a, b) => Failure::new(
                format!(
                    "{} and {} hold the same blocks, and not the same bits",
                    name(a),
                    name(b)
                ),
                "find out which machine is wrong, and move its shards out of the folder",
            ),
        })?;
        let mut all: Vec<Option<ShardFile>> = shards.into_iter().map(Some).collect();
        let shards = chosen.into_iter().filter_map(|i| all[i].take()).collect();
        Ok(Self { place, shards })
    }

    /// Their folder.
    pub(super) fn place(&self) -> &Path {
        &self.place
    }

    /// The blocks of each.
    pub(super) fn ranges(&self) -> impl Iterator<Item = Range<u64>> {
        self.shards.iter().map(|s| s.range.clone())
    }

    /// The parts that lie in `range`, in order.
    pub(super) fn parts(
        &self,
        range: Range<u64>,
    ) -> impl Iterator<Item = Result<(Range<u64>, Vec<u8>), ShardError>> {
        let touching = self
            .shards
            .iter()
            .filter(move |s| s.range.start < range.end && s.range.end > range.start);
        let range = range.clone();
        touching.flat_map(move |s| s.parts(range.clone()))
    }

    /// The most threads that worked on one.
    pub(super) fn threads(&self) -> usize {
        self.shards
            .iter()
            .map(|s| s.provenance.threads)
            .max()
            .unwrap_or(0)
    }

    /// The time that all took together, s.
    pub(super) fn seconds(&self) -> f64 {
        self.shards.iter().map(|s| s.provenance.seconds).sum()
    }
}
