//! run.json: what was rendered, and how; or what was imported.

mod vouching;

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::error::FolderError;
use super::origin::Origin;
use crate::film::{FrameMeta, RunMeta};
use crate::lab::Tails;
use crate::scene::Scene;
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

    /// Whether the same scene was rendered by the same plan and program, or the same files were
    /// imported by the same settings.
    pub fn same_settings(&self, other: &Self) -> bool {
        let key = |r: &'_ Self| (r.scene_hash.clone(), r.version.clone(), r.origin.clone());
        key(self) == key(other)
    }
}

/// What stands for the estimator and the sampler of photographs.
const IMPORTED: &str = "imported";
