//! What is finished of an unfinished run, in the folder `partial` of the run: spots-NNNN-MMMM.phs
//! has the finished blocks, or all of them, of the spots NNNN to MMMM − 1, which are traced
//! together.

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::cli::cleanup::remove_files;
use crate::cli::failure::Failure;
use crate::jobs::{self, BlockFile, Identity, Spots};
use crate::scene::Scene;
use crate::store::ensure_writable;
use crate::transport::{Plan, Traced};

/// The name of the folder.
pub(super) const PARTIAL: &str = "partial";

/// The unfinished part of a run.
pub(super) struct Partial(PathBuf);

/// A file of finished blocks, found whole.
pub(super) struct Kept {
    pub spots: Range<usize>,
    file: BlockFile,
}

impl Kept {
    /// The columns of its spots, if all of their blocks are in it.
    pub(super) fn traced(&self, scene: &Scene, plan: &Plan) -> Option<Traced> {
        let spots = together(scene, plan, &self.spots);
        if self.file.range != spots.blocks() {
            return None;
        }
        let parts = self.file.parts(spots.blocks());
        let tally = spots.tally(0, parts).ok()?;
        tally.traced(scene, self.spots.clone())
    }
}

impl Partial {
    /// That of the run in `dir`.
    pub(super) fn of(dir: &Path) -> Self {
        Self(dir.join(PARTIAL))
    }

    /// Whether anything is unfinished.
    pub(super) fn is_there(&self) -> bool {
        self.0.is_dir()
    }

    /// The file for the finished blocks of `spots`.
    pub(super) fn file(&self, spots: &Range<usize>) -> Result<PathBuf, Failure> {
        ensure_writable(&self.0)?;
        Ok(self.0.join(name(spots)))
    }

    /// What `plan` has finished there, in the order of the spots. A file that is damaged, or of
    /// another plan, counts as none.
    pub(super) fn kept(&self, scene: &Scene, plan: &Plan) -> Vec<Kept> {
        let names = fs::read_dir(&self.0)
            .into_iter()
            .flatten()
            .filter_map(|e| e.ok()?.file_name().into_string().ok());
        let spots = |name: String| -> Option<Range<usize>> {
            let own = name.strip_suffix(jobs::EXTENSION)?.strip_suffix('.')?;
            let (from, to) = own.strip_prefix("spots-")?.split_once('-')?;
            Some(from.parse().ok()?..to.parse().ok()?)
        };
        let open = |spots: Range<usize>| {
            let path = self.0.join(name(&spots));
            let identity = identity(scene, plan, &spots);
            let file = BlockFile::open(&path, &identity, u64::from(plan.budget.blocks)).ok()?;
            Some(Kept { spots, file })
        };
        let mut found: Vec<Kept> = names
            .filter_map(spots)
            .filter(|r| r.start < r.end && r.end <= scene.laser.spots.len())
            .filter_map(open)
            .collect();
        found.sort_by_key(|kept| kept.spots.start);
        found
    }

    /// Removes all of it.
    pub(super) fn remove(&self) -> Result<(), Failure> {
        remove_files(&self.0, |name| {
            let stem = name.strip_suffix(jobs::EXTENSION);
            stem.is_some_and(|stem| stem.starts_with("spots-") && stem.ends_with('.'))
        })?;
        // Anything else in it is not ours, and keeps it.
        let _ = fs::remove_dir(&self.0);
        Ok(())
    }
}

fn name(spots: &Range<usize>) -> String {
    let Range { start, end } = spots;
    format!("spots-{start:04}-{end:04}.{}", jobs::EXTENSION)
}

/// `spots`, traced together.
pub(super) fn together<'a>(scene: &'a Scene, plan: &'a Plan, spots: &Range<usize>) -> Spots<'a> {
    Spots {
        scene,
        plan,
        range: spots.clone(),
        first: 0,
    }
}

/// What the finished blocks of `spots` depend on.
pub(super) fn identity(scene: &Scene, plan: &Plan, spots: &Range<usize>) -> Identity {
    Spots::identity(scene, plan).with("spots", format!("{}..{}", spots.start, spots.end))
}
