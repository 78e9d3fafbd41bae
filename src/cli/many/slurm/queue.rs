//! Slurm's own commands: sbatch, squeue and scontrol.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::cli::failure::Failure;
use crate::cli::output::harmless;

/// Slurm's MaxArraySize where it is not configured.
const ARRAY_SIZE: usize = 1001;

/// A job that is queued or running.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Job {
    pub name: String,
    /// Of an array: the array's.
    pub id: String,
    /// Its number in the array, if it is in one.
    pub task: Option<usize>,
}

/// What has to be known before anything is submitted.
pub(super) trait Queue {
    /// MaxArraySize: one more than the highest number that a task may have; not 0.
    fn array_size(&self) -> Result<usize, Failure>;

    /// The user's own jobs that are queued or running and whose names begin so.
    fn jobs(&self, prefix: &str) -> Result<Vec<Job>, Failure>;
}

/// No Slurm at all.
pub(super) struct Nobody;

impl Queue for Nobody {
    fn array_size(&self) -> Result<usize, Failure> {
        Ok(ARRAY_SIZE)
    }

    fn jobs(&self, _: &str) -> Result<Vec<Job>, Failure> {
        Ok(Vec::new())
    }
}

/// Slurm's commands, by name or by path.
pub(super) struct Slurm {
    pub sbatch: PathBuf,
    pub squeue: PathBuf,
    pub scontrol: PathBuf,
}

impl Slurm {
    /// As PATH finds them.
    pub(super) fn on_path() -> Self {
        Self {
            sbatch: "sbatch".into(),
            squeue: "squeue".into(),
            scontrol: "scontrol".into(),
        }
    }

    /// Whether there is a Slurm to be asked.
    pub(super) fn is_there(&self) -> bool {
        let found = Command::new(&self.squeue).arg("--version").output();
        found.is_ok_and(|output| output.status.success())
    }

    /// Submits a job; its number.
    pub(super) fn submit(&self, arguments: &[String]) -> Result<String, Failure> {
        let answer = ask(&self.sbatch, arguments)?;
        // The number, or `number;cluster`, in the last line: a site's sbatch may talk before.
        let last = answer
            .lines()
            .rfind(|line| !line.trim().is_empty())
            .unwrap_or("");
        let id = last.trim().split(';').next().unwrap_or("");
        match is_id(id) {
            true => Ok(id.to_owned()),
            false => Err(nonsense(&self.sbatch, &answer)),
        }
    }
}

impl Queue for Slurm {
    fn array_size(&self) -> Result<usize, Failure> {
        let answer = ask(&self.scontrol, &["show".into(), "config".into()])?;
        let value = answer.lines().find_map(|line| {
            let (key, value) = line.split_once('=')?;
            (key.trim() == "MaxArraySize").then(|| value.trim().parse::<usize>().ok())?
        });
        match value.unwrap_or(ARRAY_SIZE) {
            0 => {
                let cause = "this Slurm allows no arrays of jobs (MaxArraySize is 0)";
                let cure = "ask its staff to allow them, or run `phicam shard DIR --index 0`, 1, … as single jobs";
                Err(Failure::system(cause, cure))
            }
            size => Ok(size),
        }
    }

    fn jobs(&self, prefix: &str) -> Result<Vec<Job>, Failure> {
        // Without -r a long list of waiting tasks comes abridged, without -a hidden partitions are left out.
        let arguments = ["-h", "-r", "-a", "--me", "-o", "%t|%F|%K|%j"].map(str::to_owned);
        let answer = ask(&self.squeue, &arguments)?;
        let mut jobs = Vec::new();
        for line in answer.lines().map(str::trim) {
            // With SLURM_CLUSTERS set, a headline names the cluster.
            if line.is_empty() || line.starts_with("CLUSTER:") {
                continue;
            }
            match line.splitn(4, '|').collect::<Vec<_>>()[..] {
                [.., name] if !name.starts_with(prefix) => {}
                // Its program has ended. Where Slurm will start it again, to submit it here, too, costs time only.
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
}

fn is_id(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit())
}

/// What a command prints, if it succeeds.
fn ask(program: &PathBuf, arguments: &[String]) -> Result<String, Failure> {
    let name = program.display();
    let mut command = Command::new(program);
    // What the user wants squeue to show by default is not what is asked here.
    for (name, _) in std::env::vars_os() {
        if name.to_string_lossy().starts_with("SQUEUE_") {
            command.env_remove(name);
        }
    }
    let output = command.args(arguments).output().map_err(|e| match e.kind() {
        ErrorKind::NotFound => Failure::system(
            format!("there is no `{name}` on this machine"),
            "run this on a login node of the cluster, load its Slurm module, or see with --dry-run what would be submitted; \
             for other schedulers the documentation has recipes",
        ),
        _ => Failure::system(format!("`{name}` cannot be started: {e}"), "check the installation of Slurm"),
    })?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let words = String::from_utf8_lossy(&output.stderr);
    let cause = format!(
        "`{name}` refuses ({}): {}",
        output.status,
        harmless(words.trim())
    );
    let cure = "correct the options after `--`, or ask the cluster's staff; what is queued already is not submitted twice";
    Err(Failure::system(cause, cure))
}

fn nonsense(program: &Path, answer: &str) -> Failure {
    let name = program.display();
    let start: String = answer.trim().chars().take(200).collect();
    let cause = format!(
        "`{name}` answers `{}`, which is not understood",
        harmless(&start)
    );
    Failure::system(
        cause,
        "look with `squeue --me` for what has been submitted, and run this again",
    )
}

#[cfg(all(test, unix))]
mod tests;
