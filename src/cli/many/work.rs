//! What is planned.

use std::ops::Range;
use std::path::Path;

use super::folder::Settings;
use super::render::Render;
use super::shards::Shards;
use crate::cli::checkpoint::{Checkpoint, Parts};
use crate::cli::failure::Failure;
use crate::cli::output::Talk;
use crate::scene::Scene;
use crate::shard::Identity;

/// A computation in blocks, each a function of scene, settings and its number alone.
#[derive(Debug)]
pub(super) enum Work {
    Render(Render),
}

impl Work {
    pub(super) fn new(scene: Scene, settings: &Settings) -> Result<Self, Failure> {
        match settings {
            Settings::Render {
                estimator,
                sampler,
                seed,
                samples,
            } => Ok(Self::Render(Render::read(
                scene,
                (estimator, sampler),
                *seed,
                *samples,
            )?)),
        }
    }

    pub(super) fn scene(&self) -> &Scene {
        match self {
            Self::Render(render) => &render.scene,
        }
    }

    pub(super) fn settings(&self) -> Settings {
        match self {
            Self::Render(render) => render.settings(),
        }
    }

    pub(super) fn identity(&self) -> Identity {
        match self {
            Self::Render(render) => render.identity(),
        }
    }

    /// Blocks in all.
    pub(super) fn blocks(&self) -> u64 {
        match self {
            Self::Render(render) => render.blocks(),
        }
    }

    /// Computes the blocks `range`, of which `done` has the first. What comes back is shorter if it was stopped.
    pub(super) fn compute(
        &self,
        range: Range<u64>,
        done: Parts,
        checkpoint: &mut Checkpoint,
        talk: Talk,
    ) -> Result<Parts, Failure> {
        match self {
            Self::Render(render) => render.compute(range, done, checkpoint, talk),
        }
    }

    /// Whether `output` is what a merge has left, to its last file.
    pub(super) fn is_merged(&self, output: &Path) -> Result<bool, Failure> {
        match self {
            Self::Render(render) => render.is_merged(output),
        }
    }

    /// Puts the shards together in `output`; returns what to tell, or print as JSON.
    pub(super) fn merge(
        &self,
        shards: &Shards,
        output: &Path,
        talk: Talk,
    ) -> Result<Merged, Failure> {
        match self {
            Self::Render(render) => render.merge(shards, output, talk),
        }
    }
}

/// What a merge left.
#[derive(Debug)]
pub(super) struct Merged {
    pub words: String,
    pub json: String,
}
