//! The folder of a run: what may be written into it, and what is read back from it; its files are
//! those of [`folder`](crate::folder), and `partial/`, what is finished of an unfinished run
//! ([`super::partial`]).

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::cleanup::{remove_abandoned, remove_files, remove_named, remove_numbered};
use super::console::Console;
use super::exposed_folder::ExposedFolder;
use super::failure::Failure;
use super::output;
use super::partial::{PARTIAL, Partial};
use super::replacement::{move_in, remove_folder};
use crate::film::{self, frame_name};
use crate::folder::names::MODEL_FILES;
pub(super) use crate::folder::names::{
    CALIBRATED, CALIBRATED_FILES, CALIBRATION, EXPOSED, IMPORT, IMPORT_PNG, LEFT_OUT, LOCATED,
    LOCATED_FILES, MODEL, PHI, RECOVERED, REPORT, SATURATED, SCENE, STDERR, SUMMARY, TAILS,
    VALIDATION, Z, is_of_model, is_of_recovered,
};
use crate::folder::{Record, columns, finish, frame, frame_max, refuse_beyond_f32, write_scene};
use crate::matrix::Matrix;
use crate::scene::{COPIES, Scene};
use crate::store::{FolderLock, ensure_writable, flush};
use crate::transport::Traced;

/// A run that takes the place of another, until it is whole.
const REPLACEMENT: &str = ".replacement";
/// The same while its files are moved to their places; nothing of the other is left.
const INCOMING: &str = ".incoming";

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
        output::refuse_obstacles(path, &OWN_FOLDERS, &OWN_FILES)?;
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

    /// Where the run `record` is traced that is to replace `there`.
    fn replacement(
        self,
        record: &Record,
        there: &Record,
        console: Console,
    ) -> Result<Self, Failure> {
        let path = self.path.join(REPLACEMENT);
        console.say(format!(
            "the run in {} ({}) stays until this one is whole",
            self.path.display(),
            there.origin
        ));
        // Begun with yet other settings: nobody will go on with it. One that cannot be read is
        // none.
        if !matches!(Record::read(&path), Ok(Some(begun)) if begun.same_settings(record)) {
            remove_folder(&path)?;
        }
        ensure_writable(&path)?;
        Ok(Self {
            path,
            replaces: Some(self.path),
            lock: None,
        })
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

    /// What stands in the way of a run's files shows before anything is written.
    pub(super) fn refuse_obstacles(path: &Path) -> Result<(), Failure> {
        output::refuse_obstacles(path, &OWN_FOLDERS, &OWN_FILES)
    }

    /// Whether the import that `record` describes is in the folder, whole. Another import is
    /// refused unless it is to be replaced; a render is not replaced by photographs.
    pub(super) fn holds_import(&self, record: &Record, replace: bool) -> Result<bool, Failure> {
        let Some(there) = Record::read(&self.path)? else {
            return Ok(false);
        };
        let path = self.path.display();
        if !there.is_imported() {
            let cause = format!("{path} holds a rendered run, which photographs do not replace");
            return Err(Failure::new(cause, "choose another folder (-o)"));
        }
        if there.same_settings(record) {
            return Ok(there.check_all(&self.path, SCENE).is_ok());
        }
        if replace {
            return Ok(false);
        }
        let cause = format!("{path} holds photographs that were imported with other settings");
        let cure = "give the same, choose another folder (-o), or replace them (--replace)";
        Err(Failure::new(cause, cure))
    }

    /// Puts an import that `fill` writes into the place of what the folder holds, once it is whole.
    /// Another import gives way if `replace` says so; anything else that is not of `scene` is
    /// refused.
    pub(super) fn put(
        &self,
        scene: &Scene,
        console: Console,
        replace: bool,
        fill: impl FnOnce(&Path) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let is_import = Record::read(&self.path)?.is_some_and(|there| there.is_imported());
        if !(replace && is_import) {
            self.refuse_foreign(scene, console)?;
        }
        let staged = Self::at(&self.path.join(REPLACEMENT));
        remove_folder(&staged.path)?;
        ensure_writable(&staged.path)?;
        write_scene(&staged.path, scene)?;
        fill(&staged.path)?;
        flush(&staged.path)?;
        self.replace()
    }

    /// Puts the run that was traced beside another into its place, once it is complete.
    pub(super) fn settle(&mut self) -> Result<(), Failure> {
        if let Some(path) = self.replaces.take() {
            self.path = path;
            self.replace()?;
        }
        Ok(())
    }

    /// Removes the old run and moves the new one to its place. A process that ends midway leaves
    /// what [`Self::finish_replacement`] goes on with.
    fn replace(&self) -> Result<(), Failure> {
        self.remove_run()?;
        fs::rename(self.path.join(REPLACEMENT), self.path.join(INCOMING))?;
        self.move_in()
    }

    /// Goes on where a process was ended while it put a new run in the place of the old one.
    fn finish_replacement(&self) -> Result<(), Failure> {
        if self.path.join(INCOMING).is_dir() {
            return self.move_in();
        }
        let without = !self.path.join(Record::FILE).exists();
        let staged = || Record::read(&self.path.join(REPLACEMENT));
        if without && staged()?.is_some_and(|r| r.is_complete()) {
            return self.replace();
        }
        Ok(())
    }

    /// Moves what is in [`INCOMING`] to its place, the record last.
    fn move_in(&self) -> Result<(), Failure> {
        let files = [
            SCENE,
            TAILS,
            LEFT_OUT,
            IMPORT_PNG,
            IMPORT,
            STDERR,
            PHI,
            Record::FILE,
        ];
        let incoming = self.path.join(INCOMING);
        move_in(&incoming, &self.path, &["frames", COPIES], &files)
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

    /// A folder that holds another scene, or frames of unknown origin, or something else under the
    /// name of an output, is not written to.
    pub(super) fn refuse_foreign(&self, scene: &Scene, console: Console) -> Result<(), Failure> {
        output::refuse_obstacles(&self.path, &OWN_FOLDERS, &OWN_FILES)?;
        let path = self.path.display();
        let cure = "choose another folder (-o), or remove this one";
        if let Some(record) = Record::read(&self.path)? {
            if record.scene_hash != scene.hash {
                let cause = format!("{path} holds a run of another scene (`{}`)", record.scene);
                return Err(Failure::new(cause, cure));
            }
            return Ok(());
        }
        let own = self.path.join(SCENE);
        if own.exists() {
            // What cannot be read as a scene is not this one either.
            if !console
                .of_folders()
                .load_any_scene(&own.to_string_lossy())
                .is_ok_and(|s| s.hash == scene.hash)
            {
                return Err(Failure::new(
                    format!("{path} belongs to another scene ({SCENE})"),
                    cure,
                ));
            }
        }
        let holds =
            |dir: &str| fs::read_dir(self.path.join(dir)).is_ok_and(|mut d| d.next().is_some());
        if holds("frames") || holds(PARTIAL) || self.path.join(PHI).exists() {
            let cause = format!(
                "{path} holds frames or a {PHI}, but no {} that says of which scene",
                Record::FILE
            );
            return Err(Failure::new(cause, cure));
        }
        Ok(())
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

    /// Removes what was rendered, and what was found from it; the record first, so that nobody
    /// takes what is left for a run.
    fn remove_run(&self) -> Result<(), Failure> {
        remove_named(&self.path, &[Record::FILE])?;
        self.partial().remove()?;
        remove_numbered(&self.frames(), "exr")?;
        remove_recovered(&self.path.join(RECOVERED))?;
        ExposedFolder::at(&self.path.join(EXPOSED)).remove()?;
        let model = self.path.join(MODEL);
        remove_named(&model, &MODEL_FILES)?;
        // Anything else in it is not ours, and keeps it.
        let _ = fs::remove_dir(model);
        for (name, files) in [
            (LOCATED, &LOCATED_FILES[..]),
            (CALIBRATED, &CALIBRATED_FILES[..]),
        ] {
            let found = self.path.join(name);
            remove_named(&found, files)?;
            let _ = fs::remove_dir(found);
        }
        let validation = self.path.join(VALIDATION);
        remove_named(&validation, &["p.exr", "p.png"])?;
        let _ = fs::remove_dir(validation);
        remove_named(&self.path, &[PHI, STDERR, TAILS, LEFT_OUT])?;
        remove_named(&self.path, &[SUMMARY, REPORT, IMPORT, IMPORT_PNG])
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

/// Names of a run's folders and files, under which nothing else may stand.
const OWN_FOLDERS: [&str; 5] = ["frames", PARTIAL, MODEL, RECOVERED, COPIES];
const OWN_FILES: [&str; 10] = [
    SCENE,
    PHI,
    STDERR,
    TAILS,
    Record::FILE,
    SUMMARY,
    REPORT,
    LEFT_OUT,
    IMPORT,
    IMPORT_PNG,
];

/// That a folder holds a run that is not to be replaced.
fn other_run(path: &Path, there: &Record, scene: &Scene) -> Failure {
    let path = path.display();
    if there.is_imported() {
        let cause = format!("{path} holds imported photographs, which nothing replaces");
        return Failure::new(cause, "choose another folder (-o)");
    }
    let cause = if there.scene_hash == scene.hash {
        format!("{path} holds a run with other settings ({})", there.origin)
    } else {
        format!("{path} holds a run of another scene (`{}`)", there.scene)
    };
    let cure = "give the same settings, choose another folder (-o), or replace it (--replace)";
    Failure::new(cause, cure)
}

/// Removes what [`is_of_recovered`] from `dir`, and `dir` if that empties it.
pub(super) fn remove_recovered(dir: &Path) -> Result<(), Failure> {
    remove_files(dir, is_of_recovered)?;
    let _ = fs::remove_dir(dir);
    Ok(())
}

#[cfg(test)]
mod tests;
