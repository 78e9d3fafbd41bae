//! One call of `phicam slurm`: from what is missing to jobs, or to a shell script that would submit them.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::jobs::Jobs;
use super::queue::{Job, Queue, Slurm};
use super::script::quote;
use super::submission::{Merge, Merged, Names, Submission};
use crate::cli::failure::Failure;
use crate::cli::indices::array_syntax;
use crate::shard::Identity;

/// How far a plan has come.
pub(super) struct Progress {
    /// The short form of its id.
    pub plan: String,
    /// Shards in all.
    pub shards: usize,
    pub missing: BTreeSet<usize>,
    pub merged: Merged,
}

/// Paths are absolute.
pub(super) struct Request {
    pub progress: Progress,
    pub executable: PathBuf,
    pub dir: PathBuf,
    pub output: PathBuf,
    pub options: Vec<String>,
}

impl Request {
    /// Submits what has to be, and says each job as soon as it is submitted.
    pub(super) fn submit(
        &self,
        slurm: &Slurm,
        say: &mut dyn FnMut(&str) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let (submission, jobs) = self.prepare(slurm)?;
        if let Some(text) = waiting(&submission) {
            say(&format!("{text}\n"))?;
        }
        if !submission.arrays.is_empty() || matches!(submission.merge, Merge::Submit(_)) {
            jobs.write_scripts()?;
        }
        let mut submitted = Vec::new();
        for array in &submission.arrays {
            let id = slurm.submit(&jobs.array(array).arguments(&[]))?;
            say(&format!(
                "shards {}: array of jobs {id}\n",
                array_syntax(&array.shards())
            ))?;
            submitted.push(id);
        }
        let output = self.output.display();
        match submission.merge {
            Merge::Submit(before) => {
                submitted.extend(before);
                let id = slurm.submit(&jobs.merge().arguments(&submitted))?;
                let when = match submitted.is_empty() {
                    true => String::new(),
                    false => format!(", when {} ended", have(&submitted)),
                };
                say(&format!("merge into {output}: job {id}{when}\n"))
            }
            Merge::Queued(id) => say(&format!(
                "the merge is queued or running already: job {id}\n"
            )),
            Merge::There => say(&format!(
                "nothing is missing, and {output} is there: nothing to submit\n"
            )),
        }
    }

    /// A shell script that does what [`Request::submit`] would do.
    pub(super) fn rehearsal(&self, queue: &dyn Queue) -> Result<String, Failure> {
        let (submission, jobs) = self.prepare(queue)?;
        let mut text = String::from("#!/bin/bash\nset -e\n");
        if let Some(waiting) = waiting(&submission) {
            let _ = writeln!(text, "# {waiting}");
        }
        let before = match &submission.merge {
            Merge::Submit(before) => before,
            Merge::Queued(id) => {
                let _ = writeln!(text, "# the merge is queued or running already: job {id}");
                return Ok(text);
            }
            Merge::There => {
                let _ = writeln!(
                    text,
                    "# nothing is missing, and the merge is there: nothing to submit"
                );
                return Ok(text);
            }
        };
        let _ = writeln!(text, "mkdir -p {}", quote(jobs.folder()));
        for script in jobs.scripts() {
            let _ = writeln!(
                text,
                "cat >{} <<'END_OF_SCRIPT'\n{}END_OF_SCRIPT",
                quote(&script.path),
                script.text
            );
        }
        let mut after = Vec::new();
        for (number, array) in submission.arrays.iter().enumerate() {
            let _ = writeln!(text, "array_{number}=$({})", jobs.array(array).line(&[]));
            // With several clusters sbatch answers `number;cluster`.
            after.push(format!("${{array_{number}%;*}}"));
        }
        after.extend(before.iter().cloned());
        let _ = writeln!(text, "{}", jobs.merge().line(&after));
        Ok(text)
    }

    fn prepare(&self, queue: &dyn Queue) -> Result<(Submission, Jobs), Failure> {
        let Progress {
            plan,
            shards,
            missing,
            merged,
        } = &self.progress;
        let place = format!("{}-{}", plan, short(&self.dir));
        let names = Names::new(&place, *shards, &short(&self.output), queue.array_size()?);
        let queued = queue.jobs(names.prefix())?;
        if let Some(other) = queued.iter().find(|job| !names.owns(job)) {
            let Job { name, id, .. } = other;
            let cause = format!(
                "job {id} (`{name}`) is queued or running, and divides this plan into another number of shards"
            );
            return Err(Failure::new(
                cause,
                "wait until the jobs of that division have ended, or cancel them with scancel; then call again",
            ));
        }
        let submission = Submission::new(missing, &queued, *merged, &names);
        let jobs = Jobs::new(
            &self.executable,
            &self.dir,
            &self.output,
            &self.options,
            names,
        )?;
        Ok((submission, jobs))
    }
}

/// Eight digits that tell a folder from others.
fn short(path: &Path) -> String {
    let place = Identity::default().with("folder", path.display());
    place.id().short()[..8].to_owned()
}

fn waiting(submission: &Submission) -> Option<String> {
    let waiting = &submission.waiting;
    (!waiting.is_empty()).then(|| {
        format!(
            "shards {}: queued or running already",
            array_syntax(waiting)
        )
    })
}

/// "12 has", "12 and 13 have".
fn have(jobs: &[String]) -> String {
    let verb = if jobs.len() == 1 { "has" } else { "have" };
    format!("{} {verb}", jobs.join(" and "))
}

#[cfg(all(test, unix))]
mod tests;
