//! run.json: what was rendered, and how.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::failure::Failure;
use super::output;
use super::process::version;
use crate::lab::Tails;
use crate::scene::Scene;
use crate::store;
use crate::transport::Plan;

/// The record of a run.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct Record {
    pub version: String,
    pub scene: String,
    pub scene_hash: String,
    pub unit: String,
    #[serde(flatten)]
    pub plan: Plan,
    pub pixels: [usize; 2],
    pub spots: usize,
    /// Spots rendered so far; equal to `spots` when the run is complete.
    pub finished: usize,
    pub threads: usize,
    /// Wall time of rendering, s.
    pub seconds: f64,
    /// Of a complete run: how many standard errors cannot be trusted, and where.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tails: Option<Tails>,
}

impl Record {
    pub(super) const FILE: &'static str = "run.json";
    /// Most bytes that it may have: 16 MiB.
    const LARGEST: u64 = 16 << 20;

    pub(super) fn new(
        scene: &Scene,
        plan: &Plan,
        finished: usize,
        threads: usize,
        seconds: f64,
    ) -> Self {
        Self {
            version: version().to_owned(),
            scene: scene.name.clone(),
            scene_hash: scene.hash.clone(),
            unit: scene.unit.symbol().to_owned(),
            plan: *plan,
            pixels: [scene.camera.columns, scene.camera.rows],
            spots: scene.laser.spots.len(),
            finished,
            threads,
            seconds,
            tails: None,
        }
    }

    /// A line on its standard errors; none of an unfinished run.
    pub(super) fn error_bars(&self) -> String {
        let line = |tails: &Tails| format!("error bars: {}\n", tails.sentence());
        self.tails.as_ref().map_or_else(String::new, line)
    }

    /// The record in `dir`, if there is one.
    pub(super) fn read(dir: &Path) -> Result<Option<Self>, Failure> {
        let path = dir.join(Self::FILE);
        let bytes = match store::read(&path, Self::LARGEST) {
            // Neither a folder that is not there nor a file in its place holds a run.
            Err(e) if e.is_missing() => return Ok(None),
            other => other?,
        };
        serde_json::from_slice(&bytes).map(Some).map_err(|e| {
            let cause = format!("{} is damaged: {e}", path.display());
            Failure::new(cause, "render again into another folder")
        })
    }

    pub(super) fn write(&self, dir: &Path) -> Result<(), Failure> {
        let text = output::json(self)?;
        output::write(&dir.join(Self::FILE), text)
    }

    /// Whether the same scene was rendered by the same plan and program.
    pub(super) fn same_settings(&self, other: &Self) -> bool {
        let key = |r: &'_ Self| (r.scene_hash.clone(), r.version.clone(), r.plan);
        key(self) == key(other)
    }
}
