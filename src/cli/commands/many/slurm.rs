//! `phicam slurm`: the missing shards of a plan as an array of jobs, and the merge after them.

use std::path::PathBuf;

use super::planned::Planned;
use super::status;
use crate::cli::Outcome;
use crate::cli::args::SlurmArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::jobs::slurm::{Request, Slurm, check};

/// Where the merge writes unless told, below the plan's folder.
const MERGED: &str = "merged";

pub(in crate::cli) fn execute(args: &SlurmArgs, console: Console) -> Result<Outcome, Failure> {
    check(&args.options)?;
    let plan = Planned::open(&args.dir, console)?.folder;
    let output = match &args.output {
        Some(output) => output.clone(),
        None => args.dir.join(MERGED),
    };
    let request = Request {
        plan: plan.id().short(),
        shards: plan.file.shards as usize,
        missing: status::missing_shards(&plan, console)?,
        merged: plan.is_merged(&output)?,
        executable: executable()?,
        dir: std::path::absolute(&args.dir)?,
        output: std::path::absolute(output)?,
        options: args.options.clone(),
    };
    let slurm = Slurm::on_path(std::env::vars_os().map(|(name, _)| name));
    if !args.dry_run {
        request.submit(&slurm, &mut |line| output::print(line))?;
    } else if slurm.is_there() {
        output::draw(&request.rehearsal(Some(&slurm))?)?;
    } else {
        console.say("there is no Slurm here to be asked: as if nothing were queued, and arrays as long as they are where nothing is configured");
        output::draw(&request.rehearsal(None)?)?;
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
