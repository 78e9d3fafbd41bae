//! Which files of a run are still what was written.

use std::path::Path;

use super::{Record, Written};
use crate::folder::error::FolderError;
use crate::folder::names::{IMPORT, IMPORT_PNG, LEFT_OUT, PHI, SCENE, STDERR};
use crate::scene::{COPIES, Scene};
use crate::store;

impl Record {
    /// Vouches for the files `names` of `dir` as they are; those that are not there it forgets.
    ///
    /// # Errors
    /// [`FolderError`] where one cannot be read.
    pub fn vouch<'n>(
        &mut self,
        dir: &Path,
        names: impl IntoIterator<Item = &'n str>,
    ) -> Result<(), FolderError> {
        for name in names {
            match Written::of(&dir.join(name)) {
                Err(e) if e.is_missing() => self.files.remove(name),
                written => self.files.insert(name.to_owned(), written?),
            };
        }
        Ok(())
    }

    /// The same for the files in the folder `folder` of `dir` whose names are `ours`; what else
    /// lies there is read by nobody.
    ///
    /// # Errors
    /// [`FolderError`] where one cannot be read.
    pub fn vouch_all(
        &mut self,
        dir: &Path,
        folder: &str,
        ours: impl Fn(&str) -> bool,
    ) -> Result<(), FolderError> {
        let inside = format!("{folder}/");
        self.files.retain(|name, _| !name.starts_with(&inside));
        let Ok(entries) = std::fs::read_dir(dir.join(folder)) else {
            return Ok(());
        };
        let paths = entries.filter_map(Result::ok).map(|entry| entry.path());
        let names: Vec<String> = paths
            .filter(|path| path.is_file())
            .filter_map(|path| Some(path.file_name()?.to_str()?.to_owned()))
            .filter(|name| ours(name))
            .map(|name| inside.clone() + &name)
            .collect();
        self.vouch(dir, names.iter().map(String::as_str))
    }

    /// Lets the run in `dir`, if there is one, vouch for the files whose names are `ours` in its
    /// folder `folder`.
    ///
    /// # Errors
    /// [`FolderError`] where a file cannot be read or the record not be written.
    pub fn vouch_anew(
        dir: &Path,
        folder: &str,
        ours: impl Fn(&str) -> bool,
    ) -> Result<(), FolderError> {
        if let Some(mut record) = Self::read(dir)? {
            record.vouch_all(dir, folder, ours)?;
            record.write(dir)?;
        }
        Ok(())
    }

    /// Refuses the file `name` of `dir` if it is vouched for and not what was written.
    ///
    /// # Errors
    /// [`FolderError`].
    pub fn check(&self, dir: &Path, name: &str) -> Result<(), FolderError> {
        let Some(written) = self.files.get(name) else {
            return Ok(());
        };
        let path = dir.join(name);
        if written.is_at(&path)? {
            return Ok(());
        }
        Err(changed(&path, "SHA-256"))
    }

    /// Refuses the files in the folder `folder` of `dir` that are vouched for and of another
    /// length: before they are read.
    ///
    /// # Errors
    /// [`FolderError`].
    pub fn check_lengths(&self, dir: &Path, folder: &str) -> Result<(), FolderError> {
        for (name, written) in &self.files {
            let path = dir.join(name);
            if Path::new(name).starts_with(folder)
                && path.exists()
                && store::length(&path)? != written.bytes
            {
                return Err(changed(&path, "length"));
            }
        }
        Ok(())
    }

    /// Refuses the files of `dir` that are vouched for, but for `except`, if one is there and not
    /// what was written.
    ///
    /// # Errors
    /// [`FolderError`].
    pub fn check_all(&self, dir: &Path, except: &str) -> Result<(), FolderError> {
        let there = self.files.keys().filter(|name| dir.join(name).exists());
        let mut light = there.filter(|name| *name != except);
        light.try_for_each(|name| self.check(dir, name))
    }

    /// Refuses a `scene` that is not that of the run in `dir`, and a run of which spots are
    /// missing.
    ///
    /// # Errors
    /// [`FolderError`].
    pub fn check_scene(&self, dir: &Path, scene: &Scene) -> Result<(), FolderError> {
        let place = dir.display();
        if scene.hash != self.scene_hash {
            let path = dir.join(SCENE);
            let cause = format!(
                "{} is not the scene that {place} was rendered from",
                path.display()
            );
            return Err(FolderError::new(
                cause,
                "restore it, or render the changed scene into another folder",
            ));
        }
        if !self.is_complete() && !dir.join(PHI).exists() {
            let cause = format!("{place} holds {} of {} spots", self.finished, self.spots);
            return Err(FolderError::new(
                cause,
                "finish it with the same command that began it",
            ));
        }
        Ok(())
    }

    /// Vouches for the files of an import in `dir`.
    ///
    /// # Errors
    /// [`FolderError`] where one cannot be read.
    pub fn vouch_for_import(&mut self, dir: &Path, scene: &Scene) -> Result<(), FolderError> {
        self.files.clear();
        self.vouch(dir, [SCENE, PHI, STDERR, LEFT_OUT, IMPORT, IMPORT_PNG])?;
        self.vouch_all(dir, COPIES, |name| {
            scene.files.iter().any(|file| file.copy_name() == name)
        })
    }
}

/// That a file is not what was written, by what of it.
fn changed(path: &Path, what: &str) -> FolderError {
    let cause = format!(
        "{} is not what phicam wrote: its {what} is not that in {}",
        path.display(),
        Record::FILE
    );
    FolderError::new(
        cause,
        "restore it, or give data of your own (--phi, --left-out); the same render into the same folder makes it again, and \
         `phicam stack` phi.npy and phi.stderr.npy, of the frames, once both are removed",
    )
}
