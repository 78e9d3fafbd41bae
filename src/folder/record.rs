//! run.json: what was rendered, and how; or what was imported.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::error::FolderError;
use super::names::{IMPORT, IMPORT_PNG, LEFT_OUT, PHI, SCENE, STDERR};
use super::origin::Origin;
use crate::film::{FrameMeta, RunMeta};
use crate::lab::Tails;
use crate::scene::{COPIES, Scene};
use crate::store::{self, ReadError, digest_of, harmless_json, write_whole};

/// The record of a run.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Record {
    /// Version of the program.
    pub version: String,
    /// Name of the scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// Its length unit.
    pub unit: String,
    /// Where Φcam comes from.
    #[serde(flatten)]
    pub origin: Origin,
    /// Columns and rows of a frame.
    pub pixels: [usize; 2],
    /// Spots of the scene.
    pub spots: usize,
    /// Spots rendered so far; equal to `spots` when the run is complete.
    pub finished: usize,
    /// Threads that rendered.
    pub threads: usize,
    /// Wall time of rendering, s.
    pub seconds: f64,
    /// Of a complete run: how many standard errors cannot be trusted, and where.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tails: Option<Tails>,
    /// What was written of a complete run, by the names of the files in its folder.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub files: BTreeMap<String, Written>,
    /// SHA-256 of all above as JSON, so that no setting can be changed unnoticed. Nothing vouches
    /// for a record without.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    digest: Option<String>,
}

/// A file as it was written.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, Serialize)]
pub struct Written {
    bytes: u64,
    sha256: String,
}

impl Written {
    /// The file `path` as it is.
    pub(super) fn of(path: &Path) -> Result<Self, ReadError> {
        Ok(Self {
            bytes: store::length(path)?,
            sha256: store::digest(path)?,
        })
    }

    /// Whether the file `path` is still this; one of another length is not read.
    pub(super) fn is_at(&self, path: &Path) -> Result<bool, ReadError> {
        Ok(store::length(path)? == self.bytes && store::digest(path)? == self.sha256)
    }
}

/// SHA-256 of a value as JSON.
pub(super) fn seal(value: &impl Serialize) -> Result<String, serde_json::Error> {
    Ok(digest_of(&serde_json::to_vec(value)?))
}

impl Record {
    /// Name of its file.
    pub const FILE: &'static str = "run.json";
    /// Most bytes that it may have: a hundred for each frame.
    pub const LARGEST: u64 = 64 << 20;

    /// The record of a run of `scene`.
    pub fn new(
        scene: &Scene,
        origin: impl Into<Origin>,
        finished: usize,
        threads: usize,
        seconds: f64,
    ) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            scene: scene.name.clone(),
            scene_hash: scene.hash.clone(),
            unit: scene.unit.symbol().to_owned(),
            origin: origin.into(),
            pixels: [scene.camera.columns, scene.camera.rows],
            spots: scene.laser.spots.len(),
            finished,
            threads,
            seconds,
            tails: None,
            files: BTreeMap::new(),
            digest: None,
        }
    }

    /// Whether every spot is finished.
    pub fn is_complete(&self) -> bool {
        self.finished == self.spots
    }

    /// A line on its standard errors; none of an unfinished run.
    pub fn error_bars(&self) -> String {
        let line = |tails: &Tails| format!("error bars: {}\n", tails.sentence());
        self.tails.as_ref().map_or_else(String::new, line)
    }

    /// The record in `dir`, if there is one.
    ///
    /// # Errors
    /// [`FolderError`] where it is damaged or cannot be read.
    pub fn read(dir: &Path) -> Result<Option<Self>, FolderError> {
        let path = dir.join(Self::FILE);
        let bytes = match store::read(&path, Self::LARGEST) {
            // Neither a folder that is not there nor a file in its place holds a run.
            Err(e) if e.is_missing() => return Ok(None),
            other => other?,
        };
        Self::parse(&bytes).map(Some).map_err(|what| {
            let cause = format!("{} is damaged: {what}", path.display());
            FolderError::new(cause, "render again into another folder")
        })
    }

    /// The record in the bytes of a run.json, or what is wrong with them.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn parse(bytes: &[u8]) -> Result<Self, String> {
        let record: Self = serde_json::from_slice(bytes).map_err(|e| e.to_string())?;
        let own = record.sealed().map_err(|e| e.to_string())?;
        if record.digest.is_none() || own.digest == record.digest {
            Ok(record)
        } else {
            Err("it does not say what was written: its digest is another".to_owned())
        }
    }

    /// With its digest.
    fn sealed(&self) -> Result<Self, serde_json::Error> {
        let mut record = Self {
            digest: None,
            ..self.clone()
        };
        record.digest = Some(seal(&record)?);
        Ok(record)
    }

    /// The text of its file.
    ///
    /// # Errors
    /// [`FolderError`].
    pub fn json(&self) -> Result<String, FolderError> {
        let json = serde_json::to_string_pretty(&self.sealed()?)?;
        Ok(harmless_json(&json) + "\n")
    }

    /// Writes it into `dir`, whole or not at all.
    ///
    /// # Errors
    /// [`FolderError`] where it cannot be written.
    pub fn write(&self, dir: &Path) -> Result<(), FolderError> {
        let json = self.json()?;
        Ok(write_whole(&dir.join(Self::FILE), |file| {
            file.write_all(json.as_bytes())
        })?)
    }

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

    /// What the frame of `spot` says of its origin.
    pub fn meta(&self, scene: &Scene, spot: usize) -> FrameMeta {
        let plan = self.origin.plan();
        FrameMeta {
            run: RunMeta {
                scene_name: scene.name.clone(),
                scene_hash: scene.hash.clone(),
                unit: scene.unit.symbol().to_owned(),
                spot_count: self.spots as u32,
                seed: plan.map_or(0, |p| p.seed),
                samples: plan.map_or(0, |p| p.budget.samples()),
                estimator: plan.map_or(IMPORTED.to_owned(), |p| p.estimator.to_string()),
                sampler: plan.map_or(IMPORTED.to_owned(), |p| p.sampling.to_string()),
                version: self.version.clone(),
            },
            spot_index: spot as u32,
            spot_position: scene.laser.spots[spot].target.position.to_array(),
        }
    }

    /// Whether its photographs were imported.
    pub fn is_imported(&self) -> bool {
        self.origin.plan().is_none()
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

    /// Whether the same scene was rendered by the same plan and program, or the same files were
    /// imported by the same settings.
    pub fn same_settings(&self, other: &Self) -> bool {
        let key = |r: &'_ Self| (r.scene_hash.clone(), r.version.clone(), r.origin.clone());
        key(self) == key(other)
    }
}

/// What stands for the estimator and the sampler of photographs.
const IMPORTED: &str = "imported";

/// That a file is not what was written, by what of it.
fn changed(path: &Path, what: &str) -> FolderError {
    let cause = format!(
        "{} is not what phicam wrote: its {what} is not that in {}",
        path.display(),
        Record::FILE
    );
    FolderError::new(
        cause,
        "restore it, or give data of your own with --phi; the same render into the same folder makes it again",
    )
}
