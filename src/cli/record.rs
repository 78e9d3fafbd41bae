//! run.json: what was rendered, and how.

use std::io::ErrorKind;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::failure::Failure;
use super::settings;
use crate::scene::Scene;
use crate::store::write_whole;
use crate::study::Settings;
use crate::transport::Plan;

/// The record of a run.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct Record {
    pub version: String,
    pub scene: String,
    pub scene_hash: String,
    pub unit: String,
    pub seed: u64,
    pub samples: u64,
    pub blocks: u32,
    pub estimator: String,
    pub sampler: String,
    pub pixels: [usize; 2],
    pub spots: usize,
    /// Spots rendered so far; equal to `spots` when the run is complete.
    pub finished: usize,
    pub threads: usize,
    /// Wall time of rendering, s.
    pub seconds: f64,
}

impl Record {
    pub(super) const FILE: &'static str = "run.json";

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
            seed: plan.seed,
            samples: plan.budget.samples(),
            blocks: plan.budget.blocks,
            estimator: plan.estimator.name().to_owned(),
            sampler: plan.sampling.name().to_owned(),
            pixels: [scene.camera.columns, scene.camera.rows],
            spots: scene.laser.spots.len(),
            finished,
            threads,
            seconds,
        }
    }

    /// The record in `dir`, if there is one.
    pub(super) fn read(dir: &Path) -> Result<Option<Self>, Failure> {
        let path = dir.join(Self::FILE);
        let bytes = match std::fs::read(&path) {
            Ok(bytes) => bytes,
            // Neither a folder that is not there nor a file in its place holds a run.
            Err(e) if matches!(e.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                return Ok(None);
            }
            Err(e) => {
                let cause = format!("cannot read {}: {e}", path.display());
                return Err(Failure::system(
                    cause,
                    "make it readable, or choose another folder",
                ));
            }
        };
        serde_json::from_slice(&bytes).map(Some).map_err(|e| {
            let cause = format!("{} is damaged: {e}", path.display());
            Failure::new(cause, "render again into another folder")
        })
    }

    pub(super) fn write(&self, dir: &Path) -> Result<(), Failure> {
        let text = super::output::json(self)?;
        Ok(write_whole(&dir.join(Self::FILE), |w| {
            w.write_all(text.as_bytes())
        })?)
    }

    /// Whether the same scene was rendered by the same plan and program.
    pub(super) fn same_settings(&self, other: &Self) -> bool {
        let key = |r: &Self| {
            let names = [&r.scene_hash, &r.version, &r.estimator, &r.sampler].map(String::clone);
            (names, r.seed, r.samples, r.blocks)
        };
        key(self) == key(other)
    }

    /// Seed, samples, estimator and sampler in words.
    pub(super) fn settings(&self) -> String {
        let Self {
            seed,
            samples,
            estimator,
            sampler,
            ..
        } = self;
        format!("{estimator}, {sampler}, {samples} samples, seed {seed}")
    }

    /// The plan that was rendered.
    pub(super) fn plan(&self) -> Result<Plan, Failure> {
        let plan = settings::named(&self.estimator, &self.sampler, self.seed, self.samples)?;
        match plan.budget.blocks == self.blocks {
            true => Ok(plan),
            false => Err(settings::unknown("division into blocks")),
        }
    }

    pub(super) fn to_settings(&self) -> Settings {
        Settings {
            version: self.version.clone(),
            estimator: self.estimator.clone(),
            sampler: self.sampler.clone(),
            seed: self.seed,
            samples: self.samples,
            blocks: self.blocks,
        }
    }
}

/// The version of the program.
pub(super) fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}
