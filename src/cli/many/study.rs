//! A study, or published items, in tasks.

use std::ops::Range;
use std::path::Path;

use clap::Parser;

use super::work::Work;
use crate::cli::args::{Args, Command};
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::interrupt::stop_flag;
use crate::cli::process::pool;
use crate::cli::tasks::{Tasks, compute, identity};
use crate::cli::{Outcome, reproduce, study};
use crate::jobs::{Checkpoint, Identity, Parts, Settings, Shards};
use crate::scene::Scene;
use crate::store::ensure_writable;
use crate::transport::Control;

/// A command whose blocks are its tasks.
pub(super) struct Study {
    scene: Option<Scene>,
    arguments: Vec<String>,
    tasks: Box<dyn Tasks>,
}

/// What the plan decides, or the shard, or the merge; the command as planned has none of it.
const NOT_PLANNED: [&str; 5] = ["--output", "--threads", "--json", "--quiet", "--also-read"];

impl Study {
    /// The command `arguments` of the phicam command line, whose scene is read from where it names
    /// it.
    pub(super) fn plan(arguments: &[String], console: Console) -> Result<Self, Failure> {
        let command = parse(arguments)?;
        let scene = command
            .planned_scene()
            .map(|scene| console.load_scene(scene))
            .transpose()?;
        Self::new(&command, scene, arguments, console)
    }

    /// The same from a plan's folder, where the scene is `scene`.
    pub(super) fn read(
        arguments: &[String],
        scene: &Path,
        json: bool,
        console: Console,
    ) -> Result<Self, Failure> {
        let mut all = arguments.to_vec();
        let _ = parse(arguments)?;
        if json {
            all.push("--json".to_owned());
        }
        let command = command(&all)?;
        let scene = match command.planned_scene() {
            Some(_) => Some(console.load_scene(&scene.to_string_lossy())?),
            None => None,
        };
        Self::new(&command, scene, arguments, console)
    }

    fn new(
        command: &Command,
        scene: Option<Scene>,
        arguments: &[String],
        console: Console,
    ) -> Result<Self, Failure> {
        Ok(Self {
            tasks: tasks(command, scene.clone(), console)?,
            scene,
            arguments: arguments.to_vec(),
        })
    }
}

impl Work for Study {
    fn scene(&self) -> Option<&Scene> {
        self.scene.as_ref()
    }

    fn settings(&self) -> Settings {
        Settings::Command(self.arguments.clone())
    }

    fn identity(&self) -> Identity {
        let words = [("command".to_owned(), format!("{:?}", self.arguments))];
        identity(self.scene.as_ref(), words, self.tasks.count())
    }

    fn blocks(&self) -> u64 {
        self.tasks.count() as u64
    }

    fn compute(
        &self,
        range: &Range<u64>,
        done: Parts,
        checkpoint: &mut Checkpoint,
        console: Console,
    ) -> Result<Parts, Failure> {
        let what = self.arguments.join(" ");
        compute(&*self.tasks, &what, range, done, checkpoint, console)
    }

    fn merge(
        &self,
        shards: &Shards,
        output: &Path,
        _: bool,
        _: Console,
    ) -> Result<Outcome, Failure> {
        let mut results = Vec::new();
        for (task, part) in (0..self.blocks()).zip(shards.parts(0..self.blocks())) {
            let (range, bytes) = part?;
            if range != (task..task + 1) {
                let cause = format!(
                    "the shards in {} hold tasks {}..{} as one",
                    shards.place.display(),
                    range.start,
                    range.end
                );
                return Err(Failure::new(cause, "compute these shards again"));
            }
            results.push(bytes);
        }
        ensure_writable(output)?;
        let control = Control {
            progress: &|_| (),
            stop: stop_flag(),
        };
        let pool = pool(None)?;
        pool.install(|| self.tasks.deliver(&results, control, output))
            .map_err(|e| e.if_stopped("nothing was written; merge again"))
    }
}

/// The command that the arguments spell.
fn parse(arguments: &[String]) -> Result<Command, Failure> {
    let named = |a: &String, option: &str| {
        a.strip_prefix(option)
            .is_some_and(|r| r.is_empty() || r.starts_with('='))
    };
    let foreign =
        |a: &&String| NOT_PLANNED.iter().any(|o| named(a, o)) || a.starts_with("-o") || *a == "-q";
    if let Some(option) = arguments.iter().find(foreign) {
        return Err(Failure::usage(
            format!("{option} is no part of what is planned"),
            "leave it out: the number of threads is for `phicam shard`, --output and --json for `phicam merge`",
        ));
    }
    command(arguments)
}

fn command(arguments: &[String]) -> Result<Command, Failure> {
    let program = std::iter::once("phicam".to_owned());
    // Where the files go is said by who merges.
    let output = ["-o".to_owned(), ".".to_owned()];
    let all = program.chain(arguments.iter().cloned()).chain(output);
    match Args::try_parse_from(all) {
        Ok(args) => Ok(args.command),
        Err(error) => Err(Failure::Usage(error.to_string())),
    }
}

/// The tasks of a command; a study's scene is `scene`, or where there is none the one that the
/// command names.
fn tasks(
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
