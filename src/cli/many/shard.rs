//! `phicam shard`.

use serde_json::json;

use super::folder::PlanFolder;
use super::shards::{CHECKPOINT, file_name, find};
use crate::cli::args::ShardArgs;
use crate::cli::checkpoint::Checkpoint;
use crate::cli::failure::Failure;
use crate::cli::interrupt::Gentle;
use crate::cli::output::{self, Talk};
use crate::cli::{Outcome, settings};
use crate::shard::{EXTENSION, ShardError, gaps, write};
use crate::store::ensure_writable;

pub(in crate::cli) fn execute(args: &ShardArgs, talk: Talk) -> Result<Outcome, Failure> {
    let plan = PlanFolder::open(&args.dir)?;
    let shards = plan.file.shards;
    if args.index >= shards {
        let cause = format!(
            "--index {} is beyond the {shards} shards of the plan",
            args.index
        );
        return Err(Failure::usage(cause, format!("use 0 to {}", shards - 1)));
    }
    let pool = settings::pool(args.threads)?;
    let range = plan.file.range(args.index);
    let (there, wrong) = find(&plan, &range)?;
    refuse_strangers(wrong, talk)?;
    let missing = gaps(range.clone(), there.iter().map(|s| s.range.clone()));
    let place = plan.shards_path();
    if missing.is_empty() {
        talk.say(format!("shard {} is there", args.index));
    } else {
        ensure_writable(&place)?;
    }
    let mut computed = Vec::new();
    let _gentle = Gentle::new();
    for range in missing {
        let path = place.join(file_name(plan.id(), &range, EXTENSION));
        let unfinished = place.join(file_name(plan.id(), &range, CHECKPOINT));
        let threads = pool.current_num_threads();
        let mut checkpoint = Checkpoint::new(unfinished, plan.file.identity.clone(), threads);
        let done = checkpoint.resume(&range, plan.file.blocks);
        if let Some((part, _)) = done.last() {
            talk.say(format!(
                "going on at block {} of {}..{}",
                part.end, range.start, range.end
            ));
        }
        let parts = pool.install(|| {
            plan.work
                .compute(range.clone(), done, &mut checkpoint, talk)
        })?;
        let end = parts.last().map_or(range.start, |(part, _)| part.end);
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

/// A spoilt shard of ours is computed again and replaced; a file that somebody else put under the name of this one is not.
fn refuse_strangers(wrong: Vec<ShardError>, talk: Talk) -> Result<(), Failure> {
    for error in wrong {
        if error.spoilt().is_none() {
            return Err(error.into());
        }
        talk.say(format!("warning: {error}"));
    }
    Ok(())
}
