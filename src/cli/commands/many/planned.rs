//! A plan in its folder, and what it is a plan of.

use std::fs;
use std::path::Path;

use super::render::Render;
use super::study::Study;
use super::work::Work;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::run_folder::SCENE;
use crate::jobs::{PlanFolder, Settings};
use crate::scene::COPIES;
use crate::store::{self, ReadFault};
use crate::transport::Plan;

/// A plan that was read and found to be what it says.
pub(super) struct Planned {
    pub folder: PlanFolder,
    pub work: Box<dyn Work>,
}

impl Planned {
    /// Reads the plan in `path`, and refuses it if the scene beside it, or the program, is not the
    /// one that was planned.
    pub(super) fn open(path: &Path, console: Console) -> Result<Self, Failure> {
        Self::open_as(path, false, console)
    }

    /// The same; a study is to print JSON if `json`.
    pub(super) fn open_as(path: &Path, json: bool, console: Console) -> Result<Self, Failure> {
        let folder = PlanFolder::open(path)?;
        refuse_unreadable(path)?;
        let scene = path.join(SCENE);
        let scene = Some(&*scene.to_string_lossy());
        let work = work(&folder.file.work, scene, json, console)?;
        folder.check(&work.identity(), work.blocks())?;
        Ok(Self { folder, work })
    }
}

/// What cannot be read for now is told from what is wrong in it: another try may help.
fn refuse_unreadable(dir: &Path) -> Result<(), Failure> {
    let mut files = vec![dir.join(SCENE)];
    if let Ok(copies) = fs::read_dir(dir.join(COPIES)) {
        files.extend(copies.flatten().map(|entry| entry.path()));
    }
    for path in files {
        match store::open(&path) {
            Err(e) if matches!(e.fault, ReadFault::System(_)) && !e.is_missing() => {
                return Err(e.into());
            }
            // What is no file is refused by those who need it.
            _ => {}
        }
    }
    Ok(())
}

/// The work of these settings, with the scene `scene`: a name or a path; a command may name its
/// own. It is to print JSON if `json`.
pub(super) fn work(
    settings: &Settings,
    scene: Option<&str>,
    json: bool,
    console: Console,
) -> Result<Box<dyn Work>, Failure> {
    Ok(match settings {
        Settings::Render {
            estimator,
            sampler,
            seed,
            samples,
        } => {
            let scene = console.load_scene(scene.unwrap_or_default())?;
            let plan = Plan::new(*estimator, *sampler, *seed, *samples)?;
            Box::new(Render::new(scene, plan)?)
        }
        Settings::Command(arguments) => Box::new(Study::new(arguments, scene, json, console)?),
    })
}
