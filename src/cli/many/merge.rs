//! `phicam merge`.

use std::ops::Range;
use std::thread::sleep;
use std::time::Duration;

use super::folder::PlanFolder;
use super::shards::Shards;
use super::status::missing;
use crate::cli::Outcome;
use crate::cli::args::MergeArgs;
use crate::cli::failure::Failure;
use crate::cli::indices::array_syntax;
use crate::cli::output::Talk;
use crate::shard::{PlanFile, gaps};
use crate::store::ensure_writable;

/// How often the folder is listed before a shard counts as missing, and how long it waits between: a network file system may show a file of
/// another machine late.
const LOOKS: usize = 3;
const BETWEEN: Duration = Duration::from_millis(700);

pub(in crate::cli) fn execute(args: &MergeArgs, talk: Talk) -> Result<Outcome, Failure> {
    let plan = PlanFolder::open_as(&args.dir, args.json)?;
    let shards = whole(&plan)?;
    let outcome = plan.work.merge(&shards, &args.output, args.json, talk)?;
    plan.file.write(&args.output.join(PlanFile::MERGED))?;
    Ok(outcome)
}

/// Shards that make up the whole plan.
fn whole(plan: &PlanFolder) -> Result<Shards, Failure> {
    let mut looks = 1;
    loop {
        let shards = Shards::of(plan);
        if looks == LOOKS || shards.as_ref().is_ok_and(|s| gaps_of(plan, s).is_empty()) {
            let shards = shards?;
            let gaps = gaps_of(plan, &shards);
            return match gaps.is_empty() {
                true => Ok(shards),
                false => Err(lack(plan, &shards, &gaps)),
            };
        }
        looks += 1;
        sleep(BETWEEN);
        // A file written here makes a network file system ask its server again what the folder holds; where none may be written, it stays at looking.
        let _ = ensure_writable(&plan.shards_path());
    }
}

fn gaps_of(plan: &PlanFolder, shards: &Shards) -> Vec<Range<u64>> {
    gaps(0..plan.file.blocks, shards.ranges())
}

fn lack(plan: &PlanFolder, shards: &Shards, gaps: &[Range<u64>]) -> Failure {
    /// Gaps that are named one by one.
    const NAMED: usize = 20;
    let indices = missing(plan, shards.ranges());
    let named = gaps
        .iter()
        .take(NAMED)
        .map(|g| format!("{}..{}", g.start, g.end));
    let more = if gaps.len() > NAMED { ", …" } else { "" };
    let dir = plan.path.display();
    Failure::Missing(format!(
        "{} of {} shards of {dir} are not there, or not whole: {} (blocks {}{more})\n  cure: phicam shard {dir} --index K for each of them, or phicam slurm {dir}, then merge again",
        indices.len(),
        plan.file.shards,
        array_syntax(&indices),
        named.collect::<Vec<_>>().join(", ")
    ))
}
