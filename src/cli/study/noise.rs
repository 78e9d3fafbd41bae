//! `phicam study noise`: every method under growing noise, gone on with where it was left.

use std::fs;
use std::io::ErrorKind;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::{Duration, Instant};

use super::job::{invocation, leave};
use crate::cli::args::StudyArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::interrupt::stop_flag;
use crate::cli::output;
use crate::cli::process::pool;
use crate::cli::{Outcome, progress};
use crate::lab::{NoiseTasks, Trial, found, read_ledger, write_ledger};
use crate::scene::Scene;
use crate::store::ensure_writable;
use crate::transport::Control;

/// Finished trials are on disk from the first few on, and at least this often.
const KEEP_EVERY: Duration = Duration::from_secs(5);

pub(super) fn execute(
    args: &StudyArgs,
    scene: &Scene,
    console: Console,
) -> Result<Outcome, Failure> {
    let study = NoiseTasks::given(scene, &args.values()?).map_err(Failure::of)?;
    let pool = pool(args.threads)?;
    let path = args.output.join("noise.csv");
    let name = study.ledger_name();
    let known = known(&path, &name)?;
    ensure_writable(&args.output)?;
    console.warn(scene);
    if !known.is_empty() {
        console.say(format!(
            "going on from {} trials in {}",
            known.len(),
            path.display()
        ));
    }

    let mut trials = known.clone();
    let mut failed = None;
    let mut last: Option<Instant> = None;
    let bar = progress::steps(console, &format!("noise of {}", scene.name));
    bar.set_length(study.trials() as u64);
    let mut keep = |new: &[Trial]| {
        trials.extend_from_slice(new);
        bar.inc(new.len() as u64);
        if last.is_none_or(|l| l.elapsed() >= KEEP_EVERY) {
            last = Some(Instant::now());
            if let Err(failure) = output::deliver(&write_ledger(&name, &trials), Some(&path)) {
                failed = Some(failure);
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(())
    };
    let tick = |_| bar.tick();
    let control = Control {
        progress: &tick,
        stop: stop_flag(),
    };
    let result = pool.install(|| study.go_on(&known, control, &mut keep));
    bar.finish_and_clear();
    if let Some(failure) = failed {
        return Err(failure);
    }
    match result.map_err(Failure::from) {
        Ok(result) => {
            let found = found(&study, result).map_err(Failure::of)?;
            let invocation = invocation(args, scene);
            leave("noise", &found, &args.output, &invocation, args.json)
        }
        Err(failure @ Failure::Stopped(_)) => {
            output::deliver(&write_ledger(&name, &trials), Some(&path))?;
            Err(failure.if_stopped(format!(
                "{} trials are finished and kept in {}; go on with the same command",
                trials.len(),
                path.display()
            )))
        }
        Err(failure) => Err(failure),
    }
}

/// The trials that an earlier run of this study has finished.
fn known(path: &Path, name: &str) -> Result<Vec<Trial>, Failure> {
    let text = match fs::read_to_string(path) {
        Ok(text) => text,
        Err(e) if e.kind() == ErrorKind::NotFound || e.kind() == ErrorKind::NotADirectory => {
            return Ok(Vec::new());
        }
        Err(e) => {
            let cause = format!("cannot read {}: {e}", path.display());
            return Err(Failure::new(
                cause,
                "make it readable, or choose another folder (-o)",
            ));
        }
    };
    read_ledger(name, &text)
        .map_err(|e| Failure::Error(format!("cannot go on from {}: {e}", path.display())))
}
