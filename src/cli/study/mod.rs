//! `phicam study`: experiments around a scene.

mod job;

use super::Outcome;
use super::args::StudyArgs;
use super::console::Console;
use super::failure::Failure;
use super::need;
use super::tasks::Tasks;
use crate::scene::Scene;
use job::Job;

pub(in crate::cli) fn execute(args: &StudyArgs, console: Console) -> Result<Outcome, Failure> {
    let scene = console.load_scene(&args.scene)?;
    need::study(&scene)?;
    Job::new(args, &scene)?.execute(console)
}

/// The tasks of a study of `scene`.
pub(in crate::cli) fn tasks(args: &StudyArgs, scene: &Scene) -> Result<Box<dyn Tasks>, Failure> {
    need::study(scene)?;
    Ok(Box::new(Job::new(args, scene)?))
}
