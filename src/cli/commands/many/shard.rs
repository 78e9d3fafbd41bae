//! `phicam shard`.

use serde_json::json;

use super::planned::Planned;
use crate::cli::Outcome;
use crate::cli::args::ShardArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::interrupt::SignalGuard;
use crate::cli::output;
use crate::cli::process::{pool, process};
use crate::jobs::{Checkpoint, JobError, end, gaps, write};
use crate::store::ensure_writable;

pub(in crate::cli) fn execute(args: &ShardArgs, console: Console) -> Result<Outcome, Failure> {
    let Planned { folder: plan, work } = Planned::open(&args.dir, console)?;
    let shards = plan.file.shards;
    if args.index >= shards {
        let cause = format!(
            "--index {} is beyond the {shards} shards of the plan",
            args.index
        );
        return Err(Failure::usage(cause, format!("use 0 to {}", shards - 1)));
    }
    let pool = pool(args.threads)?;
    let range = plan.file.range(args.index);
    let (there, wrong) = plan.find(&range)?;
    refuse_strangers(wrong, console)?;
    let missing = gaps(range.clone(), there.iter().map(|s| s.range.clone()));
    if missing.is_empty() {
        console.say(format!("shard {} is there", args.index));
    } else {
        ensure_writable(&plan.shards())?;
    }
    let mut computed = Vec::new();
    let _guard = SignalGuard::new();
    for range in missing {
        let [path, unfinished] = plan.files_of(&range);
        let identity = plan.file.identity.clone();
        let mut checkpoint = Checkpoint::new(unfinished, identity, process(&pool));
        let done = checkpoint.resume(&range, plan.file.blocks);
        if !done.is_empty() {
            console.say(format!(
                "going on at block {} of {}..{}",
                end(&done, &range),
                range.start,
                range.end
            ));
        }
        let parts = pool.install(|| work.compute(&range, done, &mut checkpoint, console))?;
        let end = end(&parts, &range);
        if end < range.end {
            return Err(Failure::Stopped(format!(
                "{} of the {} blocks {}..{} are finished and kept; the same command goes on",
                end - range.start,
                range.end - range.start,
                range.start,
                range.end
            )));
        }
        write(&path, &plan.file.identity, &parts, checkpoint.provenance())?;
        if !args.json {
            output::print(&format!("{}\n", path.display()))?;
        }
        computed.push(path.to_string_lossy().into_owned());
    }
    if args.json {
        output::print(&output::json(&json!({
            "index": args.index,
            "blocks": [range.start, range.end],
            "computed": computed,
        }))?)?;
    }
    Ok(Outcome::Done)
}

/// A spoilt shard of ours is computed again and replaced; a file that somebody else put under the
/// name of this one is not.
fn refuse_strangers(wrong: Vec<JobError>, console: Console) -> Result<(), Failure> {
    for error in wrong {
        if error.spoilt().is_none() {
            return Err(error.into());
        }
        console.say(format!("warning: {error}"));
    }
    Ok(())
}
