//! A study, or published items, in tasks.

use std::ops::Range;
use std::path::Path;

use clap::Parser;

use super::work::Work;
use crate::cli::args::{Args, Command};
use crate::cli::commands::tasks::{Tasks, compute, identity, request};
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::process::pool;
use crate::cli::run_folder::RunFolder;
use crate::cli::{Outcome, commands::reproduce, commands::study, refuse_undefinable};
use crate::jobs::{Checkpoint, Identity, Parts, Shards};
use crate::scene::Scene;

/// A command whose blocks are its tasks.
pub(super) struct Study {
    scene: Option<Scene>,
    arguments: Vec<String>,
    tasks: Box<dyn Tasks>,
}

/// What the plan decides, or the shard, or the merge; the command as planned has none of it.
const NOT_PLANNED: [&str; 5] = ["--output", "--threads", "--json", "--quiet", "--also-read"];

impl Study {
    /// The command `arguments` of the phicam command line, which is to print JSON if `json`. Its
    /// scene is read from `scene`, or without one from where the command names it.
    pub(super) fn new(
        arguments: &[String],
        scene: Option<&str>,
        json: bool,
        console: Console,
    ) -> Result<Self, Failure> {
        refuse_unplanned(arguments)?;
        let json = json.then(|| "--json".to_owned());
        let Args {
            command, define, ..
        } = parsed(arguments.iter().cloned().chain(json))?;
        refuse_undefinable(&command, &define)?;
        let own = Console {
            define: &define,
            ..console
        };
        let (scene, tasks) = match command {
            Command::Study(args) => {
                // That of a plan has its values already.
                let scene = match scene {
                    Some(planned) => console.load_scene(planned)?,
                    None => own.defined(console.load_scene(&args.scene)?)?,
                };
                let tasks = study::tasks(&args, &scene)?;
                (Some(scene), tasks)
            }
            Command::Reproduce(args) => (None, reproduce::tasks(&args)?),
            _ => {
                return Err(Failure::new(
                    "this command cannot be cut into tasks",
                    "plan a render (phicam plan SCENE), a study (… -- study NAME …) or the published items (… -- reproduce …)",
                ));
            }
        };
        Ok(Self {
            scene,
            arguments: arguments.to_vec(),
            tasks,
        })
    }
}

impl Work for Study {
    fn scene(&self) -> Option<&Scene> {
        self.scene.as_ref()
    }

    fn warn(&self, console: Console) -> Result<(), Failure> {
        if let Some(scene) = &self.scene {
            console.warn(scene);
        }
        Ok(())
    }

    fn identity(&self) -> Identity {
        let words = [("command".to_owned(), format!("{:?}", self.arguments))];
        identity(request(self.scene.as_ref(), words), self.tasks.count())
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
        let _lock = RunFolder::lock(output, "phicam merge")?;
        let pool = pool(None)?;
        pool.install(|| self.tasks.deliver(&results, output))
            .map_err(|e| e.if_stopped("nothing was written; merge again"))
    }
}

/// Refuses what is no part of a plan.
fn refuse_unplanned(arguments: &[String]) -> Result<(), Failure> {
    let named = |a: &str, option: &str| {
        let rest = a.strip_prefix(option);
        rest.is_some_and(|r| r.is_empty() || r.starts_with('='))
    };
    let foreign =
        |a: &&String| NOT_PLANNED.iter().any(|o| named(a, o)) || a.starts_with("-o") || *a == "-q";
    let Some(option) = arguments.iter().find(foreign) else {
        return Ok(());
    };
    Err(Failure::usage(
        format!("{option} is no part of what is planned"),
        "leave it out: the number of threads is for `phicam shard`, --output and --json for `phicam merge`",
    ))
}

/// What the arguments spell.
fn parsed(arguments: impl Iterator<Item = String>) -> Result<Args, Failure> {
    let program = std::iter::once("phicam".to_owned());
    // Where the files go is said by who merges.
    let output = ["-o".to_owned(), ".".to_owned()];
    let args = Args::try_parse_from(program.chain(arguments).chain(output));
    args.map_err(|error| {
        let words = error.to_string();
        Failure::Usage(words.strip_prefix("error: ").unwrap_or(&words).to_owned())
    })
}

#[cfg(test)]
mod tests;
