//! What a study leaves behind, and the frame in which it runs.

use std::error::Error;
use std::path::Path;

use rayon::ThreadPool;
use serde::Serialize;

use crate::cli::failure::Failure;
use crate::cli::interrupt::stop_flag;
use crate::cli::output::{self, Talk};
use crate::cli::progress;
use crate::store::write_whole;
use crate::transport::Control;

/// A finished study as a user gets it.
pub(super) struct Findings {
    json: String,
    files: Vec<(String, String)>,
    table: String,
}

impl Findings {
    /// `found` as `NAME.json`, and a table for the terminal.
    pub(super) fn new(name: &str, found: &impl Serialize, table: String) -> Result<Self, Failure> {
        let json = output::json(found)?;
        Ok(Self {
            files: vec![(format!("{name}.json"), json.clone())],
            json,
            table,
        })
    }

    /// Another file of the study.
    pub(super) fn with(mut self, file: &str, text: String) -> Self {
        self.files.push((file.to_owned(), text));
        self
    }

    /// Writes the files into `folder` and prints the table, or with `--json` the JSON.
    pub(super) fn deliver(&self, folder: &Path, json: bool) -> Result<(), Failure> {
        for (file, text) in &self.files {
            write_whole(&folder.join(file), |w| w.write_all(text.as_bytes()))?;
        }
        output::print(if json { &self.json } else { &self.table })
    }
}

/// Runs a study that traces `paths` paths: on the threads of `pool`, with a progress bar called `what`, until Ctrl-C.
pub(super) fn traced<T: Send, E: Error + 'static + Send>(
    talk: Talk,
    pool: &ThreadPool,
    (what, paths): (&str, u64),
    study: impl FnOnce(Control<'_>) -> Result<Option<T>, E> + Send,
) -> Result<T, Failure> {
    let bar = progress::paths(talk, what, paths);
    let tick = |paths| bar.inc(paths);
    let control = Control {
        progress: &tick,
        stop: stop_flag(),
    };
    let found = pool.install(|| study(control))?;
    bar.finish_and_clear();
    found.ok_or_else(nothing)
}

/// Runs a study that counts its steps, with a progress bar called `what`; `Ok(None)` is Ctrl-C.
pub(super) fn stepped<T: Send, E: Error + 'static + Send>(
    talk: Talk,
    pool: &ThreadPool,
    what: &str,
    study: impl FnOnce(&(dyn Fn(usize, usize) + Sync)) -> Result<Option<T>, E> + Send,
) -> Result<T, Failure> {
    let bar = progress::steps(talk, what);
    let tick = |done: usize, all: usize| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    };
    let found = pool.install(|| study(&tick))?;
    bar.finish_and_clear();
    found.ok_or_else(nothing)
}

/// Ctrl-C before anything was written.
fn nothing() -> Failure {
    Failure::Stopped("nothing was written; run it again".to_owned())
}
