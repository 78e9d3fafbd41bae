//! One call of `phicam slurm`: from what is missing to jobs, or to a shell script that would submit
//! them.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::jobs::{Jobs, line};
use super::queue::{ARRAY_SIZE, Job, Slurm};
use super::script::quote;
use super::submission::{Merge, Names, Submission};
use crate::jobs::indices::array_syntax;
use crate::jobs::{Identity, JobError};

/// What is asked for: a plan, how far it has come, and where everything is. Paths are absolute.
#[derive(Debug)]
pub struct Request {
    /// The short form of the plan's id.
    pub plan: String,
    /// Shards in all.
    pub shards: usize,
    /// Those that are missing.
    pub missing: BTreeSet<usize>,
    /// Whether the plan has been merged into `output`.
    pub merged: bool,
    /// The program, where every node finds it.
    pub executable: PathBuf,
    /// The folder of the plan.
    pub dir: PathBuf,
    /// The folder of the merge.
    pub output: PathBuf,
    /// The user's options for sbatch.
    pub options: Vec<String>,
}

impl Request {
    /// Submits what has to be, and says each job as soon as it is submitted.
    ///
    /// # Errors
    /// [`JobError`] if Slurm refuses, or of what cannot be submitted; `E` if it cannot be said.
    pub fn submit<E: From<JobError>>(
        &self,
        slurm: &Slurm,
        say: &mut dyn FnMut(&str) -> Result<(), E>,
    ) -> Result<(), E> {
        let (submission, jobs) = self.prepare(Some(slurm))?;
        if let Some(text) = waiting(&submission) {
            say(&format!("{text}\n"))?;
        }
        if !submission.arrays.is_empty() || matches!(submission.merge, Merge::Submit(_)) {
            jobs.write_scripts()?;
        }
        let mut submitted = Vec::new();
        for array in &submission.arrays {
            let id = slurm.submit(&jobs.array(array))?;
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
                let id = slurm.submit(&jobs.merge(&submitted))?;
                let when = if submitted.is_empty() {
                    String::new()
                } else {
                    format!(", when {} ended", have(&submitted))
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

    /// A shell script that does what [`Request::submit`] would do. Without a Slurm it is as if
    /// nothing were queued, and as if arrays were as long as they are where nothing is configured.
    ///
    /// # Errors
    /// [`JobError`] if Slurm refuses to answer, or of what cannot be submitted.
    pub fn rehearsal(&self, slurm: Option<&Slurm>) -> Result<String, JobError> {
        let (submission, jobs) = self.prepare(slurm)?;
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
            let _ = writeln!(text, "array_{number}=$({})", line(&jobs.array(array)));
            // With several clusters sbatch answers `number;cluster`.
            after.push(format!("${{array_{number}%;*}}"));
        }
        after.extend(before.iter().cloned());
        let _ = writeln!(text, "{}", line(&jobs.merge(&after)));
        Ok(text)
    }

    fn prepare(&self, slurm: Option<&Slurm>) -> Result<(Submission, Jobs), JobError> {
        let place = format!("{}-{}", self.plan, short(&self.dir));
        let size = slurm.map_or(Ok(ARRAY_SIZE), Slurm::array_size)?;
        let names = Names::new(&place, self.shards, &short(&self.output), size);
        let queued = slurm.map_or(Ok(Vec::new()), |s| s.jobs(names.prefix()))?;
        if let Some(other) = queued.iter().find(|job| !names.owns(job)) {
            let Job { name, id, .. } = other;
            let cause = format!(
                "job {id} (`{name}`) is queued or running, and divides this plan into another number of shards"
            );
            return Err(JobError::refused(
                cause,
                "wait until the jobs of that division have ended, or cancel them with scancel; then call again",
            ));
        }
        let submission = Submission::new(&self.missing, &queued, self.merged, &names);
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
