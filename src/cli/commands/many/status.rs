//! `phicam status`.

use std::collections::BTreeSet;

use serde_json::json;

use super::planned::Planned;
use crate::cli::Outcome;
use crate::cli::args::StatusArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::jobs::{PlanFolder, Shards, array_syntax};

pub(in crate::cli) fn execute(args: &StatusArgs, console: Console) -> Result<Outcome, Failure> {
    let plan = Planned::open(&args.dir, console)?.folder;
    let missing = missing_shards(&plan, console)?;
    let (all, complete) = (plan.file.shards, missing.is_empty());
    let there = all - missing.len() as u64;
    console.say(format!("{there} of {all} shards are there"));
    if args.json {
        output::print(&output::json(&json!({
            "plan": plan.id().short(),
            "shards": all,
            "missing": missing,
            "complete": complete,
        }))?)?;
    } else if !complete {
        output::print(&format!("{}\n", array_syntax(&missing)))?;
    }
    Ok(if complete {
        Outcome::Done
    } else {
        Outcome::Incomplete
    })
}

/// The indices of the shards that are not there whole; says what is wrong with files that should be
/// one. What `merge` would refuse is refused.
pub(super) fn missing_shards(
    plan: &PlanFolder,
    console: Console,
) -> Result<BTreeSet<usize>, Failure> {
    let (there, wrong) = Shards::there(plan)?;
    for error in wrong {
        console.say(format!("warning: {error}"));
    }
    Ok(plan.missing(there.ranges()))
}
