//! `phicam study`: experiments around a scene.

mod asked;
mod study_run;

use super::tasks::Tasks;
use crate::cli::Outcome;
use crate::cli::args::StudyArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::jobs::need;
use crate::scene::Scene;
use study_run::StudyRun;

pub(in crate::cli) fn execute(args: &StudyArgs, console: Console) -> Result<Outcome, Failure> {
    let scene = console.load_scene(&args.scene)?;
    refuse_shining(&scene)?;
    need::study(&scene)?;
    StudyRun::new(args, &scene)?.execute(console)
}

/// Studies vary the laser and what it lights.
fn refuse_shining(scene: &Scene) -> Result<(), Failure> {
    match scene.shining() {
        None => Ok(()),
        Some((_, surface)) => Err(Failure::new(
            format!(
                "studies need a scene with a laser, and here `{}` shines",
                surface.name
            ),
            "use `phicam run`, `validate` and `recover` for this scene",
        )),
    }
}

/// The tasks of a study of `scene`.
pub(super) fn tasks(args: &StudyArgs, scene: &Scene) -> Result<Box<dyn Tasks>, Failure> {
    refuse_shining(scene)?;
    need::study(scene)?;
    Ok(Box::new(StudyRun::new(args, scene)?))
}
