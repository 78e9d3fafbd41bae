//! `phicam slurm`: the missing shards of a plan as an array of jobs, and the merge after them.
//!
//! Nothing is remembered between calls. What is missing is asked of the plan's folder, what is queued or running of Slurm (the jobs of a plan bear its
//! name), and the difference is submitted: so calling it again is the resume, whatever has happened in between. Two calls at the same moment may submit a
//! shard twice; that costs time only, since both write the same bytes.

mod jobs;
mod options;
mod queue;
mod request;
mod script;
mod submission;

#[cfg(all(test, unix))]
mod fake;

use std::path::PathBuf;

use super::folder::PlanFolder;
use super::status;
use crate::cli::Outcome;
use crate::cli::args::SlurmArgs;
use crate::cli::failure::Failure;
use crate::cli::output::{self, Talk};
use queue::Slurm;
use request::{Progress, Request};
use submission::Merged;

/// Where the merge writes unless told, below the plan's folder.
const MERGED: &str = "merged";

pub(in crate::cli) fn execute(args: &SlurmArgs, talk: Talk) -> Result<Outcome, Failure> {
    options::check(&args.options)?;
    let plan = PlanFolder::open(&args.dir)?;
    let output = match &args.output {
        Some(output) => output.clone(),
        None => args.dir.join(MERGED),
    };
    let progress = Progress {
        plan: plan.id().short(),
        shards: plan.file.shards as usize,
        missing: status::missing_shards(&plan, talk)?,
        merged: match plan.is_merged(&output)? {
            true => Merged::Yes,
            false => Merged::No,
        },
    };
    let request = Request {
        progress,
        executable: executable()?,
        dir: std::path::absolute(&args.dir)?,
        output: std::path::absolute(output)?,
        options: args.options.clone(),
    };
    let slurm = Slurm::on_path();
    if !args.dry_run {
        request.submit(&slurm, &mut |line| output::print(line))?;
    } else if slurm.is_there() {
        output::print(&request.rehearsal(&slurm)?)?;
    } else {
        talk.say("there is no Slurm here to be asked: as if nothing were queued, and arrays as long as they are where nothing is configured");
        output::print(&request.rehearsal(&queue::Nobody)?)?;
    }
    Ok(Outcome::Done)
}

/// This very program, which must be where every node finds it.
fn executable() -> Result<PathBuf, Failure> {
    let path = std::env::current_exe()?;
    if !path.is_file() {
        let cause = format!("the running program is no longer at {}", path.display());
        return Err(Failure::system(
            cause,
            "run phicam again, from where it is now",
        ));
    }
    Ok(path)
}
