//! A run or an import that takes the place of another, once it is whole.

use std::fs;
use std::path::Path;

use super::RunFolder;
use super::{
    CALIBRATED, CALIBRATED_FILES, EXPOSED, IMPORT, IMPORT_PNG, LEFT_OUT, LOCATED, LOCATED_FILES,
    MODEL, PHI, RECOVERED, REPORT, SCENE, STDERR, SUMMARY, TAILS, VALIDATION, is_of_recovered,
};
use crate::cli::cleanup::{remove_files, remove_named, remove_numbered};
use crate::cli::console::Console;
use crate::cli::exposed_folder::ExposedFolder;
use crate::cli::failure::Failure;
use crate::cli::replacement::{move_in, remove_folder};
use crate::folder::names::MODEL_FILES;
use crate::folder::{Record, write_scene};
use crate::scene::{COPIES, Scene};
use crate::store::{ensure_writable, flush};

/// A run that takes the place of another, until it is whole.
pub(super) const REPLACEMENT: &str = ".replacement";
/// The same while its files are moved to their places; nothing of the other is left.
pub(super) const INCOMING: &str = ".incoming";

/// Removes what [`is_of_recovered`] from `dir`, and `dir` if that empties it.
fn remove_recovered(dir: &Path) -> Result<(), Failure> {
    remove_files(dir, is_of_recovered)?;
    let _ = fs::remove_dir(dir);
    Ok(())
}

impl RunFolder {
    /// Where the run `record` is traced that is to replace `there`.
    pub(super) fn replacement(
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

    /// Puts an import that `fill` writes into the place of what the folder holds, once it is whole.
    /// Another import gives way if `replace` says so; anything else that is not of `scene` is
    /// refused.
    pub(in crate::cli) fn put(
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
    pub(in crate::cli) fn settle(&mut self) -> Result<(), Failure> {
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
    pub(super) fn finish_replacement(&self) -> Result<(), Failure> {
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
            remove_files(&found, is_of_recovered)?;
            let _ = fs::remove_dir(found);
        }
        let validation = self.path.join(VALIDATION);
        remove_named(&validation, &["p.exr", "p.png"])?;
        let _ = fs::remove_dir(validation);
        remove_named(&self.path, &[PHI, STDERR, TAILS, LEFT_OUT])?;
        remove_named(&self.path, &[SUMMARY, REPORT, IMPORT, IMPORT_PNG])
    }
}
