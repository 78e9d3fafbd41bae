//! A study with what it leaves behind: run as a whole, or task by task.

use std::ops::Range;
use std::path::{Path, PathBuf};

use super::findings::deliver;
use crate::cli::args::StudyArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::interrupt::stop_flag;
use crate::cli::process::{pool, version};
use crate::cli::tasks::Tasks;
use crate::cli::{Outcome, progress};
use crate::lab::{AnyStudy, Found};
use crate::report::Invocation;
use crate::scene::Scene;
use crate::store::ensure_writable;
use crate::transport::Control;

/// A study, checked and ready.
pub(super) struct Job {
    study: Box<dyn AnyStudy>,
    name: &'static str,
    invocation: Invocation,
    threads: Option<usize>,
    output: PathBuf,
    json: bool,
}

impl Job {
    /// The study of `scene` that the arguments describe.
    pub(super) fn new(args: &StudyArgs, scene: &Scene) -> Result<Self, Failure> {
        let study = (args.study.prepare)(scene, &args.values()?);
        Ok(Self {
            study: study.map_err(Failure::of)?,
            name: args.study.name,
            invocation: invocation(args, scene),
            threads: args.threads,
            output: args.output.clone(),
            json: args.json,
        })
    }

    /// Runs the study with a progress bar until Ctrl-C; leaves its files and prints its table or
    /// JSON.
    pub(super) fn execute(&self, console: Console) -> Result<Outcome, Failure> {
        let pool = pool(self.threads)?;
        ensure_writable(&self.output)?;
        let scene = &self.invocation.scene;
        console.warn(scene);
        let what = format!("{} of {}", self.name, scene.name);
        let bar = progress::work(console, &what, self.study.work());
        let control = Control {
            progress: &|n| bar.inc(n),
            stop: stop_flag(),
        };
        let found = pool.install(|| self.study.run(control));
        bar.finish_and_clear();
        let nothing = |e| Failure::of(e).if_stopped("nothing was written; run it again");
        self.leave(&found.map_err(nothing)?, &self.output)
    }

    /// Leaves the files of a result in `folder` and prints its table or JSON.
    fn leave(&self, found: &Found, folder: &Path) -> Result<Outcome, Failure> {
        leave(self.name, found, folder, &self.invocation, self.json)
    }
}

/// Leaves the files of a result of the study `name` in `folder` and prints its table, or with
/// `json` its JSON.
pub(super) fn leave(
    name: &str,
    found: &Found,
    folder: &Path,
    invocation: &Invocation,
    json: bool,
) -> Result<Outcome, Failure> {
    deliver(name, found, folder, invocation, json)?;
    Ok(if found.agrees {
        Outcome::Done
    } else {
        Outcome::Disagreed
    })
}

/// What the page of a study says of how it was called.
pub(super) fn invocation(args: &StudyArgs, scene: &Scene) -> Invocation {
    let file = Path::new(&args.scene).file_name();
    Invocation {
        study: args.study.name.to_owned(),
        scene: scene.clone(),
        file: file.map_or(args.scene.clone(), |f| f.to_string_lossy().into_owned()),
        options: args.spelled(),
        version: version().to_owned(),
    }
}

impl Tasks for Job {
    fn count(&self) -> usize {
        self.study.tasks()
    }

    fn run(&self, tasks: Range<usize>, control: Control<'_>) -> Result<Vec<Vec<u8>>, Failure> {
        self.study.outputs(tasks, control).map_err(Failure::of)
    }

    fn deliver(
        &self,
        outputs: &[Vec<u8>],
        control: Control<'_>,
        folder: &Path,
    ) -> Result<Outcome, Failure> {
        let found = self.study.merge(outputs, control).map_err(Failure::of)?;
        ensure_writable(folder)?;
        self.leave(&found, folder)
    }
}
