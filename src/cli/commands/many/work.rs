//! What is planned.

use std::ops::Range;
use std::path::Path;

use crate::cli::Outcome;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::jobs::{Checkpoint, Identity, Parts, Shards};
use crate::scene::Scene;

/// A computation in blocks, each a function of scene, settings and its number alone.
pub(super) trait Work: Sync {
    /// The scene, if there is one.
    fn scene(&self) -> Option<&Scene>;

    /// Says what will not fit this machine's memory, and what is suspicious in the scene.
    fn warn(&self, console: Console) -> Result<(), Failure>;

    /// All that the result depends on.
    fn identity(&self) -> Identity;

    /// Blocks in all.
    fn blocks(&self) -> u64;

    /// Computes the blocks `range`, of which `done` has the first. What comes back is shorter if it
    /// was stopped, and is then in `checkpoint`.
    fn compute(
        &self,
        range: &Range<u64>,
        done: Parts,
        checkpoint: &mut Checkpoint,
        console: Console,
    ) -> Result<Parts, Failure>;

    /// Puts the shards together in `output` and prints what the command itself would print, in
    /// words or as JSON.
    fn merge(
        &self,
        shards: &Shards,
        output: &Path,
        json: bool,
        console: Console,
    ) -> Result<Outcome, Failure>;
}
