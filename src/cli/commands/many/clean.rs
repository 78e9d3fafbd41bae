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
    let (mut removed, mut kept) = (Vec::new(), Vec::new());
    for path in &needless {
        let size = fs::symlink_metadata(path).map_or(0, |m| m.len());
        match if args.dry_run {
            Ok(())
        } else {
            fs::remove_file(path)
        } {
            Err(e) if e.kind() != ErrorKind::NotFound => {
                kept.push(format!("{}: {e}", path.display()));
            }
            _ => {
                bytes += size;
                removed.push(path.to_string_lossy());
            }
        }
    }
    output::print(&if args.json {
        output::json(&json!({
            "files": removed,
            "bytes": bytes,
            "removed": !args.dry_run,
            "not_removed": kept,
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
    if kept.is_empty() {
        return Ok(Outcome::Done);
    }
    let cause = format!("cannot remove {}", kept.join("\n  "));
    Err(Failure::system(
        cause,
        "make the folder writable for you, and move away what is no file",
    ))
}
