//! Slurm's own commands: sbatch, squeue and scontrol.

use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::jobs::JobError;

/// Slurm's MaxArraySize where it is not configured.
pub(super) const ARRAY_SIZE: usize = 1001;

/// A job that is queued or running.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Job {
    pub name: String,
    /// Of an array: the array's.
    pub id: String,
    /// Its number in the array, if it is in one.
    pub task: Option<usize>,
}

/// Slurm's commands, by name or by path.
#[derive(Debug)]
pub struct Slurm {
    pub(super) sbatch: PathBuf,
    pub(super) squeue: PathBuf,
    pub(super) scontrol: PathBuf,
    /// Variables of the environment that are kept from them.
    pub(super) hidden: Vec<OsString>,
}

impl Slurm {
    /// As PATH finds them. `variables` are the names of the environment: what the user wants squeue
    /// to show by default is not what is asked here.
    pub fn on_path(variables: impl Iterator<Item = OsString>) -> Self {
        let default = |name: &OsString| name.to_string_lossy().starts_with("SQUEUE_");
        Self {
            sbatch: "sbatch".into(),
            squeue: "squeue".into(),
            scontrol: "scontrol".into(),
            hidden: variables.filter(default).collect(),
        }
    }

    /// Whether there is a Slurm to be asked.
    pub fn is_there(&self) -> bool {
        let found = Command::new(&self.squeue).arg("--version").output();
        found.is_ok_and(|output| output.status.success())
    }

    /// Submits a job; its number.
    pub(super) fn submit(&self, arguments: &[String]) -> Result<String, JobError> {
        let answer = self.ask(&self.sbatch, arguments)?;
        // The number, or `number;cluster`, in the last line: a site's sbatch may console before.
        let last = answer
            .lines()
            .rfind(|line| !line.trim().is_empty())
            .unwrap_or("");
        let id = last.trim().split(';').next().unwrap_or("");
        if is_id(id) {
            Ok(id.to_owned())
        } else {
            Err(nonsense(&self.sbatch, &answer))
        }
    }

    /// MaxArraySize: one more than the highest number that a task may have; not 0.
    pub(super) fn array_size(&self) -> Result<usize, JobError> {
        let answer = self.ask(&self.scontrol, &["show".into(), "config".into()])?;
        let value = answer.lines().find_map(|line| {
            let (key, value) = line.split_once('=')?;
            (key.trim() == "MaxArraySize").then(|| value.trim().parse::<usize>().ok())?
        });
        match value.unwrap_or(ARRAY_SIZE) {
            0 => {
                let cause = "this Slurm allows no arrays of jobs (MaxArraySize is 0)";
                let cure = "ask its staff to allow them, or run `phicam shard DIR --index 0`, 1, … as single jobs";
                Err(JobError::system(cause, cure))
            }
            size => Ok(size),
        }
    }

    /// The user's own jobs that are queued or running and whose names begin so.
    pub(super) fn jobs(&self, prefix: &str) -> Result<Vec<Job>, JobError> {
        // Without -r a long list of waiting tasks comes abridged, without -a hidden partitions are
        // left out.
        let arguments = ["-h", "-r", "-a", "--me", "-o", "%t|%F|%K|%j"].map(str::to_owned);
        let answer = self.ask(&self.squeue, &arguments)?;
        let mut jobs = Vec::new();
        for line in answer.lines().map(str::trim) {
            // With SLURM_CLUSTERS set, a headline names the cluster.
            if line.is_empty() || line.starts_with("CLUSTER:") {
                continue;
            }
            match line.splitn(4, '|').collect::<Vec<_>>()[..] {
                [.., name] if !name.starts_with(prefix) => {}
                // Its program has ended. Where Slurm will start it again, to submit it here, too,
                // costs time only.
                ["CG", ..] => {}
                [_, id, task, name] if is_id(id) => {
                    jobs.push(Job {
                        name: name.to_owned(),
                        id: id.to_owned(),
                        task: task.parse().ok(),
                    });
                }
                _ => return Err(nonsense(&self.squeue, line)),
            }
        }
        Ok(jobs)
    }

    /// What a command prints, if it succeeds.
    fn ask(&self, program: &PathBuf, arguments: &[String]) -> Result<String, JobError> {
        let name = program.display();
        let mut command = Command::new(program);
        for name in &self.hidden {
            command.env_remove(name);
        }
        let output = command.args(arguments).output().map_err(|e| match e.kind() {
            ErrorKind::NotFound => JobError::system(
                format!("there is no `{name}` on this machine"),
                "run this on a login node of the cluster, load its Slurm module, or see with --dry-run what would be submitted; \
                 for other schedulers the documentation has recipes",
            ),
            _ => JobError::system(format!("`{name}` cannot be started: {e}"), "check the installation of Slurm"),
        })?;
        if output.status.success() {
            return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
        }
        let words = String::from_utf8_lossy(&output.stderr);
        let cause = format!("`{name}` refuses ({}): {}", output.status, words.trim());
        let cure = "correct the options after `--`, or ask the cluster's staff; what is queued already is not submitted twice";
        Err(JobError::system(cause, cure))
    }
}

fn is_id(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit())
}

fn nonsense(program: &Path, answer: &str) -> JobError {
    let name = program.display();
    let start: String = answer.trim().chars().take(200).collect();
    let cause = format!("`{name}` answers `{start}`, which is not understood");
    JobError::system(
        cause,
        "look with `squeue --me` for what has been submitted, and run this again",
    )
}

#[cfg(all(test, unix))]
mod tests;
