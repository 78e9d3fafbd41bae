//! `phicam status`.

use std::collections::BTreeSet;
use std::ops::Range;

use serde_json::json;

use super::folder::PlanFolder;
use super::shards::find;
use crate::cli::Outcome;
use crate::cli::args::StatusArgs;
use crate::cli::failure::Failure;
use crate::cli::indices::array_syntax;
use crate::cli::output::{self, Talk};
use crate::shard::gaps;

pub(in crate::cli) fn execute(args: &StatusArgs, talk: Talk) -> Result<Outcome, Failure> {
    let plan = PlanFolder::open(&args.dir)?;
    let missing = missing_shards(&plan, talk)?;
    let (all, lack) = (plan.file.shards, missing.len() as u64);
    talk.say(format!("{} of {all} shards are there", all - lack));
    if args.json {
        output::print(&output::json(&json!({
            "plan": plan.id().short(),
            "shards": all,
            "missing": missing,
            "complete": missing.is_empty(),
        }))?)?;
        return Ok(match missing.is_empty() {
            true => Outcome::Done,
            false => Outcome::Incomplete,
        });
    }
    if missing.is_empty() {
        return Ok(Outcome::Done);
    }
    output::print(&format!("{}\n", array_syntax(&missing)))?;
    Ok(Outcome::Incomplete)
}

/// The indices of the shards that are not there whole; what is wrong with files that should be one is said.
pub(super) fn missing_shards(plan: &PlanFolder, talk: Talk) -> Result<BTreeSet<usize>, Failure> {
    let (there, wrong) = find(plan, &(0..plan.file.blocks))?;
    for error in wrong {
        talk.say(format!("warning: {error}"));
    }
    Ok(missing(plan, there.into_iter().map(|s| s.range)))
}

/// The indices of the shards of which blocks are in none of the `ranges`.
pub(super) fn missing(
    plan: &PlanFolder,
    ranges: impl IntoIterator<Item = Range<u64>>,
) -> BTreeSet<usize> {
    let gaps = gaps(0..plan.file.blocks, ranges);
    let lacks = |own: Range<u64>| {
        let at = gaps.partition_point(|g| g.end <= own.start);
        gaps.get(at).is_some_and(|g| g.start < own.end)
    };
    let all = 0..plan.file.shards;
    all.filter(|k| lacks(plan.file.range(*k)))
        .map(|k| k as usize)
        .collect()
}
