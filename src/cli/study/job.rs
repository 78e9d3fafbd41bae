//! A study with what it leaves behind: run as a whole, or task by task.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use super::findings::Findings;
use crate::cli::failure::Failure;
use crate::cli::interrupt::stop_flag;
use crate::cli::output::Talk;
use crate::cli::tasks::{Cut, encoded};
use crate::cli::{Outcome, progress, settings};
use crate::report::Asked;
use crate::scene::Scene;
use crate::store::ensure_writable;
use crate::study::{Division, decode, whole};
use crate::transport::Control;

/// What a progress bar counts.
#[derive(Clone, Copy, Debug)]
pub(super) enum Count {
    /// Paths, of this many.
    Paths(u64),
    /// Tasks.
    Tasks,
}

/// What a finding leaves behind, and how its command ends.
pub(super) type Leaves = Result<(Findings, Outcome), Failure>;

/// A study, checked and ready.
pub(super) struct Job<D: Division> {
    pub division: D,
    /// What its tasks stand on, once it is worked out.
    pub ground: OnceLock<D::Ground>,
    /// How it was asked for.
    pub asked: Asked,
    /// What is done, in words.
    pub what: String,
    pub count: Count,
    /// Threads to run on; all cores unless given.
    pub threads: Option<usize>,
    /// Folder for its files.
    pub output: PathBuf,
    /// Whether the JSON is printed in place of the table.
    pub json: bool,
    /// What becomes of the finding.
    pub findings: fn(&D::Finding) -> Leaves,
}

impl<D: Division> Job<D> {
    /// Runs the study with a progress bar until Ctrl-C; leaves its files and prints its table or JSON.
    pub(super) fn execute(&self, scene: &Scene, talk: Talk) -> Result<Outcome, Failure> {
        let pool = settings::pool(self.threads)?;
        ensure_writable(&self.output)?;
        talk.warn(scene);
        let bar = match self.count {
            Count::Paths(total) => progress::samples(talk, &self.what, total),
            Count::Tasks => progress::steps(talk, &self.what),
        };
        let tick = |paths| match self.count {
            Count::Paths(_) => bar.inc(paths),
            Count::Tasks => bar.tick(),
        };
        let steps = |done: usize, all: usize| {
            if let Count::Tasks = self.count {
                bar.set_length(all as u64);
                bar.set_position(done as u64);
            }
        };
        let control = Control {
            progress: &tick,
            stop: stop_flag(),
        };
        let found = pool.install(|| whole(&self.division, control, &steps))?;
        bar.finish_and_clear();
        self.leave(&found.ok_or_else(nothing)?, &self.output)
    }

    /// What the tasks stand on. `Ok(None)` if stopped.
    fn ground(&self, control: Control<'_>) -> Result<Option<&D::Ground>, Failure> {
        if self.ground.get().is_none() {
            let Some(found) = self.division.ground(control)? else {
                return Ok(None);
            };
            // Two that come at once find the same.
            let _ = self.ground.set(found);
        }
        Ok(self.ground.get())
    }

    /// Leaves the files of a finding in `output` and prints its table or JSON.
    pub(super) fn leave(&self, found: &D::Finding, output: &Path) -> Result<Outcome, Failure> {
        let (findings, outcome) = (self.findings)(found)?;
        findings.deliver(output, &self.asked, self.json)?;
        Ok(outcome)
    }
}

impl<D: Division> Cut for Job<D> {
    fn tasks(&self) -> usize {
        self.division.tasks()
    }

    fn run(
        &self,
        tasks: Range<usize>,
        control: Control<'_>,
    ) -> Result<Option<Vec<Vec<u8>>>, Failure> {
        let Some(ground) = self.ground(control)? else {
            return Ok(None);
        };
        encoded(&self.division, ground, tasks, control)
    }

    fn deliver(
        &self,
        parts: &[Vec<u8>],
        control: Control<'_>,
        output: &Path,
    ) -> Result<Option<Outcome>, Failure> {
        let Some(ground) = self.ground(control)? else {
            return Ok(None);
        };
        let parts = decode(&self.division, ground, parts)?;
        ensure_writable(output)?;
        let found = self.division.finish(ground, parts)?;
        self.leave(&found, output).map(Some)
    }
}

/// Ctrl-C before anything was written.
fn nothing() -> Failure {
    Failure::Stopped("nothing was written; run it again".to_owned())
}
