//! `phicam clean`: the one command that removes what others have finished.

use std::fs;
use std::io::ErrorKind;

use serde_json::json;

use super::planned::Planned;
use crate::cli::Outcome;
use crate::cli::args::CleanArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::output;

pub(in crate::cli) fn execute(args: &CleanArgs, console: Console) -> Result<Outcome, Failure> {
    let (needless, wrong) = Planned::open(&args.dir, console)?
        .folder
        .needless(args.shards)?;
    for error in wrong {
        console.say(format!("warning: {error}"));
    }
    let mut bytes = 0;
    for path in &needless {
        bytes += fs::metadata(path).map_or(0, |m| m.len());
        if args.dry_run {
            continue;
        }
        match fs::remove_file(path) {
            Err(e) if e.kind() != ErrorKind::NotFound => {
                let cause = format!("cannot remove {}: {e}", path.display());
                return Err(Failure::system(cause, "make its folder writable for you"));
            }
            _ => {}
        }
    }
    let removed: Vec<_> = needless.iter().map(|path| path.to_string_lossy()).collect();
    output::print(&if args.json {
        output::json(&json!({
            "files": removed,
            "bytes": bytes,
            "removed": !args.dry_run,
        }))?
    } else {
        removed.iter().map(|path| format!("{path}\n")).collect()
    })?;
    let did = if args.dry_run {
        "would be removed"
    } else {
        "removed"
    };
    console.say(format!(
        "{} files, {:.1} MiB, {did}",
        removed.len(),
        bytes as f64 / f64::from(1 << 20)
    ));
    Ok(Outcome::Done)
}
