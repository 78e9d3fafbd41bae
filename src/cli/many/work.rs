//! What is planned.

use std::ops::Range;
use std::path::Path;

use super::render::Render;
use super::shards::Shards;
use super::study::Study;
use crate::cli::Outcome;
use crate::cli::checkpoint::{Checkpoint, Parts};
use crate::cli::failure::Failure;
use crate::cli::folder::SCENE;
use crate::cli::output::Talk;
use crate::cli::trust;
use crate::scene::Scene;
use crate::shard::{Identity, Settings};

/// A computation in blocks, each a function of scene, settings and its number alone.
#[derive(Debug)]
pub(super) enum Work {
    Render(Box<Render>),
    Study(Box<Study>),
}

impl Work {
    /// What the plan's folder `dir` says; a study is to print JSON if `json`.
    pub(super) fn read(dir: &Path, settings: &Settings, json: bool) -> Result<Self, Failure> {
        let path = dir.join(SCENE);
        Ok(match settings {
            Settings::Render {
                estimator,
                sampler,
                seed,
                samples,
            } => {
                let scene = trust::load(&path.to_string_lossy())?;
                let render = Render::read(scene, (estimator, sampler), *seed, *samples)?;
                Self::Render(Box::new(render))
            }
            Settings::Command(arguments) => {
                Self::Study(Box::new(Study::read(arguments, &path, json)?))
            }
        })
    }

    /// The scene, if there is one.
    pub(super) fn scene(&self) -> Option<&Scene> {
        match self {
            Self::Render(render) => Some(&render.scene),
            Self::Study(study) => study.scene.as_ref(),
        }
    }

    pub(super) fn settings(&self) -> Settings {
        match self {
            Self::Render(render) => render.settings(),
            Self::Study(study) => study.settings(),
        }
    }

    pub(super) fn identity(&self) -> Identity {
        match self {
            Self::Render(render) => render.identity(),
            Self::Study(study) => study.identity(),
        }
    }

    /// Blocks in all.
    pub(super) fn blocks(&self) -> u64 {
        match self {
            Self::Render(render) => render.blocks(),
            Self::Study(study) => study.blocks(),
        }
    }

    /// Computes the blocks `range`, of which `done` has the first. What comes back is shorter if it was stopped, and is then in `checkpoint`.
    pub(super) fn compute(
        &self,
        range: Range<u64>,
        done: Parts,
        checkpoint: &mut Checkpoint,
        talk: Talk,
    ) -> Result<Parts, Failure> {
        match self {
            Self::Render(render) => render.compute(range, done, checkpoint, talk),
            Self::Study(study) => study.compute(range, done, checkpoint, talk),
        }
    }

    /// Puts the shards together in `output` and prints what the command itself would print, in words or as JSON.
    pub(super) fn merge(
        &self,
        shards: &Shards,
        output: &Path,
        json: bool,
        talk: Talk,
    ) -> Result<Outcome, Failure> {
        match self {
            Self::Render(render) => render.merge(shards, output, json, talk),
            Self::Study(study) => study.merge(shards, output),
        }
    }
}
