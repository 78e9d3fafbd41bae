//! `phicam clean`: the one command that removes what others have finished.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::folder::PlanFolder;
use super::shards::{CHECKPOINT, files, find, named_range};
use crate::cli::Outcome;
use crate::cli::args::CleanArgs;
use crate::cli::failure::Failure;
use crate::cli::output::{self, Talk};
use crate::shard::{EXTENSION, ShardFile, gaps};
use crate::store::is_abandoned;

pub(in crate::cli) fn execute(args: &CleanArgs, talk: Talk) -> Result<Outcome, Failure> {
    let plan = PlanFolder::open(&args.dir)?;
    let mut needless = abandoned(&plan)?;
    let place = plan.shards_path();
    let (there, wrong) = find(&plan, &(0..plan.file.blocks))?;
    for error in wrong {
        if let Some(path) = error.spoilt() {
            needless.push(path.to_owned());
        } else {
            talk.say(format!("warning: {error}"));
        }
    }
    for path in files(&place, CHECKPOINT)? {
        let Some(range) = named_range(&path, plan.id(), CHECKPOINT) else {
            continue;
        };
        if args.shards || gaps(range, there.iter().map(|s| s.range.clone())).is_empty() {
            needless.push(path);
        }
    }
    if args.shards {
        let own = files(&place, EXTENSION)?;
        needless.extend(
            own.into_iter()
                .filter(|p| named_range(p, plan.id(), EXTENSION).is_some()),
        );
    }
    needless.sort();
    needless.dedup();
    let mut bytes = 0;
    let mut removed = Vec::new();
    for path in &needless {
        let spoilt = || ShardFile::open(path, &plan.file.identity, plan.file.blocks).is_err();
        if !args.shards && path.extension().is_some_and(|e| e == EXTENSION) && !spoilt() {
            // Somebody has computed it again meanwhile.
            continue;
        }
        bytes += fs::metadata(path).map_or(0, |m| m.len());
        removed.push(path.to_string_lossy());
        if !args.dry_run {
            remove(path)?;
        }
    }
    let text = match args.json {
        true => output::json(&json!({
            "files": removed,
            "bytes": bytes,
            "removed": !args.dry_run,
        }))?,
        false => removed.iter().map(|path| format!("{path}\n")).collect(),
    };
    output::print(&text)?;
    let did = if args.dry_run {
        "would be removed"
    } else {
        "removed"
    };
    talk.say(format!(
        "{} files, {:.1} MiB, {did}",
        removed.len(),
        bytes as f64 / f64::from(1 << 20)
    ));
    Ok(Outcome::Done)
}

fn remove(path: &Path) -> Result<(), Failure> {
    match fs::remove_file(path) {
        Err(e) if e.kind() != ErrorKind::NotFound => Err(Failure::system(
            format!("cannot remove {}: {e}", path.display()),
            "make its folder writable for you",
        )),
        _ => Ok(()),
    }
}

/// What processes that have ended were writing.
fn abandoned(plan: &PlanFolder) -> Result<Vec<PathBuf>, Failure> {
    let mut found = files(&plan.path, "part")?;
    found.extend(files(&plan.shards_path(), "part")?);
    found.retain(|path| is_abandoned(path));
    Ok(found)
}
