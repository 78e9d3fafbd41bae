//! `phicam merge`.

use super::planned::Planned;
use crate::cli::Outcome;
use crate::cli::args::MergeArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::jobs::{PlanFile, Shards};

pub(in crate::cli) fn execute(args: &MergeArgs, console: Console) -> Result<Outcome, Failure> {
    let Planned { folder, work } = Planned::open_as(&args.dir, args.json, console)?;
    let (shards, wrong) = Shards::whole(&folder)?;
    for error in wrong {
        console.say(format!("warning: {error}"));
    }
    let outcome = work.merge(&shards, &args.output, args.json, console)?;
    folder.file.write(&args.output.join(PlanFile::MERGED))?;
    Ok(outcome)
}
