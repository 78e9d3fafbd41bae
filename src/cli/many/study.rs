//! A study, or published items, in tasks.

use std::fmt;
use std::ops::{ControlFlow, Range};
use std::path::Path;
use std::time::Instant;

use clap::Parser;

use super::shards::Shards;
use crate::cli::args::{Args, Command};
use crate::cli::checkpoint::{Checkpoint, Parts};
use crate::cli::failure::Failure;
use crate::cli::interrupt::stop_flag;
use crate::cli::output::Talk;
use crate::cli::record::version;
use crate::cli::tasks::{Cut, cut};
use crate::cli::{Outcome, progress, settings, trust};
use crate::scene::Scene;
use crate::shard::{Identity, Settings};
use crate::store::ensure_writable;
use crate::study::LAYOUT as TASKS;
use crate::transport::{Control, NUMERICS};

/// A command whose blocks are its tasks.
pub(super) struct Study {
    pub scene: Option<Scene>,
    arguments: Vec<String>,
    cut: Box<dyn Cut>,
}

impl fmt::Debug for Study {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut out = f.debug_struct("Study");
        out.field("arguments", &self.arguments)
            .finish_non_exhaustive()
    }
}

/// What the plan decides, or the shard, or the merge; the command as planned has none of it.
const NOT_PLANNED: [&str; 5] = ["--output", "--threads", "--json", "--quiet", "--also-read"];

/// Time between two looks at what is finished where tasks are shorter, s.
const LOOK: f64 = 2.0;

impl Study {
    /// The command `arguments` of the phicam command line, whose scene is read from where it names it.
    pub(super) fn plan(arguments: &[String]) -> Result<Self, Failure> {
        let command = parse(arguments)?;
        let scene = command.planned_scene().map(trust::load).transpose()?;
        Self::new(&command, scene, arguments)
    }

    /// The same from a plan's folder, where the scene is `scene`.
    pub(super) fn read(arguments: &[String], scene: &Path, json: bool) -> Result<Self, Failure> {
        let mut all = arguments.to_vec();
        let _ = parse(arguments)?;
        if json {
            all.push("--json".to_owned());
        }
        let command = command(&all)?;
        let scene = match command.planned_scene() {
            Some(_) => Some(trust::load(&scene.to_string_lossy())?),
            None => None,
        };
        Self::new(&command, scene, arguments)
    }

    fn new(command: &Command, scene: Option<Scene>, arguments: &[String]) -> Result<Self, Failure> {
        Ok(Self {
            cut: cut(command, scene.clone())?,
            scene,
            arguments: arguments.to_vec(),
        })
    }

    pub(super) fn settings(&self) -> Settings {
        Settings::Command(self.arguments.clone())
    }

    pub(super) fn identity(&self) -> Identity {
        let none = "none".to_owned();
        let scene = self.scene.as_ref().map(|s| {
            // Of the sensor and the known answers the scene's digest says nothing; a study may use them.
            let text = Identity::default().with("text", &s.text).id();
            [s.name.clone(), s.hash.clone(), text.to_string()]
        });
        let [name, hash, text] = scene.unwrap_or([(); 3].map(|()| none.clone()));
        Identity::default()
            .with("work", "command")
            .with("scene", name)
            .with("scene's digest", hash)
            .with("scene's text", text)
            .with("command", format!("{:?}", self.arguments))
            .with("tasks", self.cut.tasks())
            .with("program", version())
            .with("layout of tasks", TASKS)
            .with(Identity::NUMERICS, NUMERICS)
    }

    pub(super) fn blocks(&self) -> u64 {
        self.cut.tasks() as u64
    }

    pub(super) fn compute(
        &self,
        range: Range<u64>,
        done: Parts,
        checkpoint: &mut Checkpoint,
        talk: Talk,
    ) -> Result<Parts, Failure> {
        let bar = progress::steps(talk, &self.arguments.join(" "));
        let next_of = |parts: &Parts| parts.last().map_or(range.start, |(part, _)| part.end);
        // Tasks of an earlier process say nothing of how fast this one is.
        let resumed = next_of(&done);
        bar.set_length(range.end - resumed);
        let tick = |_| bar.tick();
        let control = Control {
            progress: &tick,
            stop: stop_flag(),
        };
        let mut parts = done;
        let mut together = 1;
        loop {
            let first = next_of(&parts);
            bar.set_position(first - resumed);
            let tasks = first..range.end.min(first + together);
            if tasks.is_empty() {
                break;
            }
            let start = Instant::now();
            let Some(found) = self
                .cut
                .run(tasks.start as usize..tasks.end as usize, control)?
            else {
                checkpoint.leave(&parts)?;
                break;
            };
            parts.extend(tasks.clone().map(|task| task..task + 1).zip(found));
            if tasks.end < range.end && checkpoint.look(|| parts.clone()) == ControlFlow::Break(())
            {
                checkpoint.leave(&parts)?;
                break;
            }
            let each = start.elapsed().as_secs_f64() / (tasks.end - tasks.start) as f64;
            together = ((LOOK / each) as u64).clamp(1, 2 * together);
        }
        bar.finish_and_clear();
        Ok(parts)
    }

    pub(super) fn merge(&self, shards: &Shards, output: &Path) -> Result<Outcome, Failure> {
        let mut results = Vec::new();
        for (task, part) in (0..self.blocks()).zip(shards.parts(0..self.blocks())) {
            let (range, bytes) = part?;
            if range != (task..task + 1) {
                let cause = format!(
                    "the shards in {} hold tasks {}..{} as one",
                    shards.place().display(),
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
        let pool = settings::pool(None)?;
        let delivered = pool.install(|| self.cut.deliver(&results, control, output))?;
        delivered.ok_or_else(|| Failure::Stopped("nothing was written; merge again".to_owned()))
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
