//! What is finished of an unfinished run, in the folder `partial` of the run.
//!
//! | file | content |
//! | --- | --- |
//! | spot-NNNN.npy | a finished spot in f64: one column per bounce count, then the standard error and its code |
//! | spots-NNNN-MMMM.phs | finished blocks of the spots NNNN to MMMM − 1, which are traced together |

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::cleanup::{remove_files, remove_named, remove_numbered};
use super::failure::Failure;
use crate::jobs::{self, BlockFile, Identity, Spots};
use crate::matrix::{Matrix, npy};
use crate::scene::Scene;
use crate::store::ensure_writable;
use crate::transport::{Plan, Traced};

/// The name of the folder.
pub(super) const PARTIAL: &str = "partial";

/// The unfinished part of a run.
pub(super) struct Partial(PathBuf);

impl Partial {
    /// That of the run in `dir`.
    pub(super) fn of(dir: &Path) -> Self {
        Self(dir.join(PARTIAL))
    }

    fn spot(&self, spot: usize) -> PathBuf {
        self.0.join(format!("spot-{spot:04}.npy"))
    }

    /// Keeps a finished spot (column `column` of `traced`) until the run is complete, and returns
    /// what it keeps.
    pub(super) fn keep(
        &self,
        spot: usize,
        traced: &Traced,
        column: usize,
    ) -> Result<Matrix, Failure> {
        ensure_writable(&self.0)?;
        let columns = traced.bounces.iter();
        let columns = columns.chain([&traced.stderr, &traced.tails]);
        let columns: Vec<_> = columns.map(|m| m.column(column).into_owned()).collect();
        let kept = Matrix::from_columns(&columns);
        npy::write(&self.spot(spot), &kept)?;
        Ok(kept)
    }

    /// A finished spot, if it is there and whole: one column per bounce count, then the standard
    /// error and its code.
    pub(super) fn read(&self, spot: usize, scene: &Scene) -> Option<Matrix> {
        let path = self.spot(spot);
        let shape = (scene.camera.pixels(), scene.max_bounces as usize + 2);
        (npy::shape(&path).ok()? == shape).then(|| npy::read_finite(&path).ok())?
    }

    /// The file for the finished blocks of `spots`.
    pub(super) fn checkpoint(&self, spots: &Range<usize>) -> Result<PathBuf, Failure> {
        ensure_writable(&self.0)?;
        Ok(self.0.join(checkpoint_name(spots)))
    }

    /// Spots of which `plan` has finished blocks there.
    pub(super) fn checkpoints(&self, scene: &Scene, plan: &Plan) -> Vec<Range<usize>> {
        let names = fs::read_dir(&self.0)
            .into_iter()
            .flatten()
            .filter_map(|e| e.ok()?.file_name().into_string().ok());
        let spots = |name: String| {
            let own = name.strip_suffix(jobs::EXTENSION)?.strip_suffix('.')?;
            let (from, to) = own.strip_prefix("spots-")?.split_once('-')?;
            Some(from.parse().ok()?..to.parse().ok()?)
        };
        let whole = |r: &Range<usize>| {
            let path = self.0.join(checkpoint_name(r));
            let identity = identity(scene, plan, r);
            BlockFile::open(&path, &identity, u64::from(plan.budget.blocks)).is_ok()
        };
        let mut found: Vec<Range<usize>> = names
            .filter_map(spots)
            .filter(|r| r.start < r.end && r.end <= scene.laser.spots.len())
            .filter(whole)
            .collect();
        found.sort_by_key(|r| r.start);
        found
    }

    /// Forgets the finished blocks of `spots`, once these are whole.
    pub(super) fn remove_checkpoint(&self, spots: &Range<usize>) -> Result<(), Failure> {
        remove_named(&self.0, &[&checkpoint_name(spots)])
    }

    /// Removes all of it.
    pub(super) fn remove(&self) -> Result<(), Failure> {
        remove_files(&self.0, |stem, ext| {
            stem.starts_with("spots-") && ext == jobs::EXTENSION
        })?;
        remove_numbered(&self.0, "npy")
    }
}

fn checkpoint_name(spots: &Range<usize>) -> String {
    let Range { start, end } = spots;
    format!("spots-{start:04}-{end:04}.{}", jobs::EXTENSION)
}

/// What the finished blocks of `spots` depend on.
pub(super) fn identity(scene: &Scene, plan: &Plan, spots: &Range<usize>) -> Identity {
    Spots::identity(scene, plan).with("spots", format!("{}..{}", spots.start, spots.end))
}
