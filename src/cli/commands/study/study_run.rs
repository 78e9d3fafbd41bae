//! A study with what it leaves behind: worked off here, or task by task elsewhere.

use std::ops::Range;
use std::path::{Path, PathBuf};

use super::asked::{self, CURE};
use crate::cli::Outcome;
use crate::cli::args::StudyArgs;
use crate::cli::cleanup::remove_named;
use crate::cli::commands::tasks::{Tasks, compute, identity, request};
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::findings;
use crate::cli::interrupt::{SignalGuard, control};
use crate::cli::output;
use crate::cli::process::{pool, process, version};
use crate::cli::run_folder::{REPORT, RunFolder};
use crate::jobs::{BlockFile, Checkpoint, EXTENSION, Identity, JobError, end};
use crate::lab::{AnyStudy, Sharing, Work};
use crate::report::Invocation;
use crate::scene::Scene;
use crate::store::{ensure_writable, write_together};
use crate::transport::Control;

/// A study, checked and ready.
pub(super) struct StudyRun {
    study: Box<dyn AnyStudy>,
    name: &'static str,
    invocation: Invocation,
    threads: Option<usize>,
    output: PathBuf,
    replace: bool,
    json: bool,
}

impl StudyRun {
    /// The study of `scene` that the arguments describe.
    pub(super) fn new(args: &StudyArgs, scene: &Scene) -> Result<Self, Failure> {
        let study = (args.study.prepare)(scene, &args.values()?);
        Ok(Self {
            study: study.map_err(Failure::of)?,
            name: args.study.name,
            invocation: invocation(args, scene),
            threads: args.threads,
            output: args.output.clone(),
            replace: args.replace,
            json: args.json,
        })
    }

    /// Works off the tasks that no earlier process has finished, until Ctrl-C; leaves the files of
    /// the study and prints its table or JSON. What is finished stays in NAME.phs until it is
    /// complete, or for good if the study [keeps](AnyStudy::keeps) it.
    pub(super) fn execute(&self, console: Console) -> Result<Outcome, Failure> {
        let pool = pool(self.threads)?;
        let (all, identity) = (0..self.study.tasks() as u64, self.identity());
        let file = format!("{}.{EXTENSION}", self.name);
        let path = self.output.join(&file);
        let lock = RunFolder::lock(&self.output, &format!("phicam study {}", self.name))?;
        output::refuse_run(&self.output)?;
        if !self.replace {
            refuse_other(&path, &identity, all.end, console)?;
            asked::refuse_other(&self.output, &self.asked())?;
        }
        let scene = &self.invocation.scene;
        console.warn(scene);
        let mut checkpoint = Checkpoint::new(path.clone(), identity, process(&pool));
        let done = checkpoint.resume(&all, all.end);
        let (known, place) = (end(&done, &all), path.display());
        if known > 0 {
            console.say(format!(
                "going on from {known} of {} tasks in {place}",
                all.end
            ));
        }
        let what = format!("{} of {}", self.name, scene.name);
        // A single task is not waited for.
        let guard = (all.end > 1).then(SignalGuard::new);
        let parts = pool.install(|| compute(self, &what, &all, done, &mut checkpoint, console))?;
        drop(guard);
        let finished = end(&parts, &all);
        let kept = match finished {
            0 => "nothing was written; run it again".to_owned(),
            _ => format!(
                "{finished} of {} tasks are finished and kept in {place}; go on with the same command",
                all.end
            ),
        };
        if finished < all.end {
            return Err(Failure::Stopped(kept));
        }
        if known < finished {
            checkpoint.keep(&parts)?;
        }
        let outputs: Vec<Vec<u8>> = parts.into_iter().map(|(_, bytes)| bytes).collect();
        tell_of_page(&self.output, self.name, console);
        let outcome = pool
            .install(|| self.deliver(&outputs, &self.output))
            .map_err(|e| e.if_stopped(kept))?;
        if !self.study.keeps() {
            remove_named(&self.output, &[&file])?;
        }
        drop(lock);
        Ok(outcome)
    }

    /// All that the outputs depend on.
    fn identity(&self) -> Identity {
        identity(self.asked(), self.study.tasks())
    }

    /// Study, scene and options.
    fn asked(&self) -> Identity {
        let study = ("study".to_owned(), self.name.to_owned());
        let words = [study].into_iter().chain(self.invocation.options.clone());
        request(Some(&self.invocation.scene), words)
    }
}

/// Tells that the page of another study is replaced: its other files stay.
fn tell_of_page(folder: &Path, name: &str, console: Console) {
    let is_there = |file: &str| folder.join(file).exists();
    if is_there(REPORT) && !is_there(&format!("{name}.json")) {
        let page = folder.join(REPORT);
        console.say(format!(
            "{}: that of another study is replaced, whose other files stay",
            page.display()
        ));
    }
}

/// Refuses to replace outputs that were computed with other settings, or cannot be read for now.
fn refuse_other(
    path: &Path,
    identity: &Identity,
    tasks: u64,
    console: Console,
) -> Result<(), Failure> {
    match BlockFile::open(path, identity, tasks) {
        Err(JobError::Foreign {
            name,
            found,
            expected,
            ..
        }) => Err(Failure::new(
            format!(
                "{} holds results of another study (its {name} is {found}; now asked for: {expected})",
                path.display()
            ),
            CURE,
        )),
        Err(JobError::Spoilt { path, what }) => {
            let path = path.display();
            console.say(format!(
                "warning: {path} {what}; its tasks are computed again"
            ));
            Ok(())
        }
        Err(JobError::Unreadable(e)) if e.is_missing() => Ok(()),
        Err(e) => Err(e.into()),
        Ok(_) => Ok(()),
    }
}

/// What the page of a study says of how it was called.
fn invocation(args: &StudyArgs, scene: &Scene) -> Invocation {
    let file = Path::new(&args.scene).file_name();
    let file = file.map_or(args.scene.clone(), |f| f.to_string_lossy().into_owned());
    Invocation {
        command: vec!["study".to_owned(), args.study.name.to_owned(), file.clone()],
        scene: scene.clone(),
        file,
        options: args.spelled(),
        version: version().to_owned(),
    }
}

impl Tasks for StudyRun {
    fn count(&self) -> usize {
        self.study.tasks()
    }

    fn work(&self) -> Work {
        self.study.work()
    }

    fn sharing(&self) -> Sharing {
        self.study.sharing()
    }

    fn run(&self, tasks: Range<usize>, control: Control<'_>) -> Result<Vec<Vec<u8>>, Failure> {
        self.study.outputs(tasks, control).map_err(Failure::of)
    }

    fn deliver(&self, outputs: &[Vec<u8>], folder: &Path) -> Result<Outcome, Failure> {
        let found = self.study.merge(outputs, control());
        let found = found.map_err(Failure::of)?;
        ensure_writable(folder)?;
        if !self.replace {
            asked::refuse_other(folder, &self.asked())?;
        }
        write_together(folder, |staged| {
            asked::keep(staged, &self.asked())?;
            findings::write(self.name, &found, staged, &self.invocation)?;
            Ok::<_, Failure>(Vec::new())
        })?;
        findings::tell(&found, self.json)
    }
}
