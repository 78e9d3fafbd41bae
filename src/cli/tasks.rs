//! Commands whose work is independent tasks, for many machines: `study …` and `reproduce`.

use std::ops::Range;
use std::path::Path;

use super::Outcome;
use super::args::Command;
use super::failure::Failure;
use super::output::Console;
use super::{reproduce, study};
use crate::scene::Scene;
use crate::transport::Control;

/// The tasks of a command. Every process that has the same command and the same scene has the same
/// tasks.
pub(in crate::cli) trait Tasks: Sync {
    /// How many there are.
    fn count(&self) -> usize;

    /// The outputs of some tasks as bytes, in the order of their numbers, on the threads of the
    /// pool.
    fn run(&self, tasks: Range<usize>, control: Control<'_>) -> Result<Vec<Vec<u8>>, Failure>;

    /// Makes of the outputs of all tasks, in their order, the files that the command itself would
    /// leave in `folder`, and prints what it would print.
    fn deliver(
        &self,
        outputs: &[Vec<u8>],
        control: Control<'_>,
        folder: &Path,
    ) -> Result<Outcome, Failure>;
}

/// The tasks of a command; a study's scene is `scene`, or where there is none the one that the
/// command names.
pub(in crate::cli) fn tasks(
    command: &Command,
    scene: Option<Scene>,
    console: Console,
) -> Result<Box<dyn Tasks>, Failure> {
    match command {
        Command::Study(args) => study::tasks(args, scene, console),
        Command::Reproduce(args) => reproduce::tasks(args),
        _ => Err(Failure::new(
            "this command cannot be cut into tasks",
            "plan a render (phicam plan SCENE), a study (… -- study NAME …) or the published items (… -- reproduce …)",
        )),
    }
}

#[cfg(test)]
mod tests;
