//! The folder of a run: what may be written into it, and what is read back from it; its files are
//! those of [`folder`](crate::folder), and `partial/`, what is finished of an unfinished run
//! ([`crate::cli::partial`]).

mod refusing;
mod replacing;

use std::ops::Range;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use crate::cli::cleanup::remove_abandoned;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::partial::Partial;
use crate::film::{self, frame_name};
pub(super) use crate::folder::names::{
    CALIBRATED, CALIBRATED_FILES, CALIBRATION, EXPOSED, IMPORT, IMPORT_PNG, LEFT_OUT, LOCATED,
    LOCATED_FILES, MODEL, PHI, RECOVERED, REPORT, SATURATED, SCENE, STDERR, SUMMARY, TAILS,
    VALIDATION, Z, is_of_model, is_of_recovered,
};
use crate::folder::{Record, columns, finish, frame, frame_max, refuse_beyond_f32, write_scene};
use crate::matrix::Matrix;
use crate::scene::{COPIES, Scene};
use crate::store::{FolderLock, ensure_writable};
use crate::transport::Traced;
use refusing::other_run;

/// What a process is going to do with a run folder.
#[derive(Clone, Debug)]
pub(super) struct Claim {
    /// What it says to others.
    pub what: &'static str,
    /// The spots that it writes; all of the folder unless given.
    pub spots: Option<Range<usize>>,
    /// Whether it may replace a run with other settings, once the new one is whole.
    pub replace: bool,
}

/// A run folder.
#[derive(Debug)]
pub(super) struct RunFolder {
    pub path: PathBuf,
    /// The folder that is to be replaced by this one.
    replaces: Option<PathBuf>,
    /// The right to write it.
    lock: Option<FolderLock>,
}

impl RunFolder {
    /// The folder of a run, to look at.
    pub(super) fn at(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            replaces: None,
            lock: None,
        }
    }

    /// The folder `path`, to write other things than a render into it: nobody else writes it.
    pub(super) fn lock(path: &Path, what: &str) -> Result<FolderLock, Failure> {
        ensure_writable(path)?;
        let first = || {
            Self::at(path).finish_replacement()?;
            remove_abandoned(path)
        };
        FolderLock::take(path, &(0..u64::MAX), what, first).map(|(lock, ())| lock)
    }

    /// The folder `path`, to write the run `record` into it. Of a run with the same settings all
    /// that is finished stays; one with other settings, or of another scene, is refused, unless
    /// `claim` says that it is to be replaced: the new one is then traced beside it. Nothing is
    /// changed before every check has passed.
    pub(super) fn open(
        path: &Path,
        scene: &Scene,
        record: &Record,
        claim: &Claim,
        console: Console,
    ) -> Result<Self, Failure> {
        Self::refuse_obstacles(path)?;
        ensure_writable(path)?;
        let differs = || -> Result<Option<Record>, Failure> {
            Ok(Record::read(path)?.filter(|there| !there.same_settings(record)))
        };
        // Who replaces a run writes all of it.
        let alone = claim.replace && differs()?.is_some();
        let parts = match &claim.spots {
            Some(spots) if !alone => spots.start as u64..spots.end as u64,
            _ => 0..u64::MAX,
        };
        let begin = || -> Result<Self, Failure> {
            let mut folder = Self::at(path);
            folder.finish_replacement()?;
            match differs()? {
                None => folder.refuse_foreign(scene, console)?,
                Some(there) if claim.replace && parts.end == u64::MAX && !there.is_imported() => {
                    folder = folder.replacement(record, &there, console)?;
                }
                Some(there) => return Err(other_run(path, &there, scene)),
            }
            folder.begin(scene, record, console)?;
            Ok(folder)
        };
        let (lock, mut folder) = FolderLock::take(path, &parts, claim.what, begin)?;
        folder.lock = Some(lock);
        Ok(folder)
    }

    /// Writes what a run has from its first moment on; what is there of it stays.
    fn begin(&self, scene: &Scene, record: &Record, console: Console) -> Result<(), Failure> {
        let record_there = Record::read(&self.path)?;
        if let Some(record) = &record_there {
            record.check_lengths(&self.path, COPIES)?;
        }
        let own = self.path.join(SCENE);
        // A sensor may have been written into it: the light is the same.
        let there = own.exists();
        let same = || {
            console
                .of_folders()
                .load_any_scene(&own.to_string_lossy())
                .is_ok_and(|s| s.hash == scene.hash)
        };
        if there && !same() {
            let cause = format!("{} is not the scene of the run beside it", own.display());
            let cure = "restore or remove it, or render the changed scene into another folder";
            return Err(Failure::new(cause, cure));
        }
        if record_there.is_none() {
            record.write(&self.path)?;
        }
        ensure_writable(&self.frames())?;
        self.remove_abandoned()?;
        if there {
            Ok(())
        } else {
            Ok(write_scene(&self.path, scene)?)
        }
    }

    /// Calls `change` while no other writer of the folder changes what all of them share.
    pub(super) fn alone<T>(
        &self,
        change: impl FnOnce() -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        match &self.lock {
            Some(lock) => lock.alone(change),
            None => change(),
        }
    }

    pub(super) fn frames(&self) -> PathBuf {
        self.path.join("frames")
    }

    /// Its unfinished part.
    pub(super) fn partial(&self) -> Partial {
        Partial::of(&self.path)
    }

    /// Whether the frame of a spot is there and has what was kept of it.
    pub(super) fn has_frame(
        &self,
        scene: &Scene,
        record: &Record,
        spot: usize,
        kept: &Matrix,
    ) -> bool {
        let path = self.frames().join(frame_name(spot as u32));
        film::exr::read_within(&path, frame_max(scene)).is_ok_and(|there| {
            let mut due = frame(scene, record, spot, kept).channels;
            due.sort_by(|a, b| a.name.cmp(&b.name));
            there.meta == record.meta(scene, spot) && there.channels == due
        })
    }

    /// Removes from a run that is complete what an ended process has left beside it.
    pub(super) fn tidy(&self) -> Result<(), Failure> {
        self.partial().remove()?;
        self.remove_abandoned()
    }

    fn remove_abandoned(&self) -> Result<(), Failure> {
        remove_abandoned(&self.path)?;
        remove_abandoned(&self.frames())
    }

    /// Writes the frames of `spots` from the columns of `traced`, on the threads of the pool.
    /// Returns what is kept of each: see [`columns`].
    pub(super) fn write_frames(
        &self,
        scene: &Scene,
        record: &Record,
        spots: &Range<usize>,
        traced: &Traced,
    ) -> Result<Vec<Matrix>, Failure> {
        refuse_beyond_f32(traced)?;
        let kept: Vec<Matrix> = columns(traced).collect();
        let frames = spots.clone().into_par_iter().zip(&kept);
        frames.try_for_each(|(spot, kept)| self.write_frame(scene, record, spot, kept))?;
        Ok(kept)
    }

    /// Writes the frame of a spot from what is kept of it.
    pub(super) fn write_frame(
        &self,
        scene: &Scene,
        record: &Record,
        spot: usize,
        kept: &Matrix,
    ) -> Result<(), Failure> {
        let path = self.frames().join(frame_name(spot as u32));
        Ok(film::exr::write(&path, &frame(scene, record, spot, kept))?)
    }

    /// Writes Φcam, its standard error and how far that is to be trusted, and that the run is
    /// complete; the record vouches for its files from now on.
    pub(super) fn finish(
        &self,
        scene: &Scene,
        record: &mut Record,
        [phi, stderr, tails]: [&Matrix; 3],
    ) -> Result<(), Failure> {
        finish(&self.path, scene, record, [phi, stderr, tails])?;
        self.partial().remove()
    }
}

#[cfg(test)]
mod tests;
