//! Commands cut into tasks, for many machines: `study …` and `reproduce`.

use std::ops::Range;
use std::path::Path;

use super::Outcome;
use super::args::Command;
use super::failure::Failure;
use super::{reproduce, study};
use crate::scene::Scene;
use crate::study::{Division, encode, parts};
use crate::transport::Control;

/// A command whose work is independent tasks. Every process that has the same command and the same scene has the same tasks.
pub(in crate::cli) trait Cut: Sync {
    /// How many tasks there are.
    fn tasks(&self) -> usize;

    /// The results of some tasks as bytes, in the order of their numbers, on the threads of the pool. `Ok(None)` if stopped.
    fn run(
        &self,
        tasks: Range<usize>,
        control: Control<'_>,
    ) -> Result<Option<Vec<Vec<u8>>>, Failure>;

    /// Makes of the results of all tasks, in their order, the files that the command itself would leave in `output`, and prints what it would print.
    /// `Ok(None)` if stopped.
    fn deliver(
        &self,
        parts: &[Vec<u8>],
        control: Control<'_>,
        output: &Path,
    ) -> Result<Option<Outcome>, Failure>;
}

/// The tasks of a command; a study's scene is `scene`, or where there is none the one that the command names.
pub(in crate::cli) fn cut(
    command: &Command,
    scene: Option<Scene>,
) -> Result<Box<dyn Cut>, Failure> {
    match command {
        Command::Study(args) => study::cut(args, scene),
        Command::Reproduce(args) => reproduce::cut(args),
        _ => Err(Failure::new(
            "this command cannot be cut into tasks",
            "plan a render (phicam plan SCENE), a study (… -- study NAME …) or the published items (… -- reproduce …)",
        )),
    }
}

/// The results of some tasks of `division` as bytes. `Ok(None)` if stopped.
pub(in crate::cli) fn encoded<D: Division>(
    division: &D,
    ground: &D::Ground,
    tasks: Range<usize>,
    control: Control<'_>,
) -> Result<Option<Vec<Vec<u8>>>, Failure> {
    let all = division.tasks();
    if tasks.start > tasks.end || tasks.end > all {
        return Err(Failure::new(
            format!(
                "there are no tasks {} to {} among {all}",
                tasks.start, tasks.end
            ),
            "plan again: the command, the scene or the program is another one",
        ));
    }
    let Some(found) = parts(division, ground, tasks.clone(), control, &|_, _| ())? else {
        return Ok(None);
    };
    let encoded = tasks.zip(&found).map(|(index, part)| encode(index, part));
    Ok(Some(encoded.collect::<Result<_, _>>()?))
}

#[cfg(test)]
mod tests;
