//! What has to be submitted, from what is missing and what is queued already.

use std::collections::{BTreeMap, BTreeSet};

use super::queue::Job;

/// One array of jobs: task `t` computes the shard `offset + t`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Array {
    pub offset: usize,
    pub tasks: BTreeSet<usize>,
}

impl Array {
    /// The shards that it computes.
    pub(super) fn shards(&self) -> BTreeSet<usize> {
        self.tasks.iter().map(|t| self.offset + t).collect()
    }
}

/// The arrays, and the merge that follows them.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Submission {
    pub arrays: Vec<Array>,
    /// Shards that are missing, and queued or running already.
    pub waiting: BTreeSet<usize>,
    pub merge: Merge,
}

#[derive(Debug, PartialEq, Eq)]
pub(super) enum Merge {
    /// To be submitted; it waits for the arrays and for these jobs, which are queued or running
    /// already.
    Submit(BTreeSet<String>),
    /// This job does it.
    Queued(String),
    /// It has been done.
    There,
}

/// The names of a plan's jobs: of this plan, in this folder, in so many shards, merged into this
/// folder. An array's name tells its offset, because squeue tells the tasks only.
pub(super) struct Names {
    /// What the jobs of all divisions of the plan begin with.
    prefix: String,
    stem: String,
    output: String,
    /// Slurm's MaxArraySize: no task may have this number or a higher one.
    size: usize,
}

impl Names {
    /// `plan`: the short form of its id and of its folder, `output`: that of the merge's folder.
    /// `size` must not be 0.
    pub(super) fn new(plan: &str, shards: usize, output: &str, size: usize) -> Self {
        let prefix = format!("phicam-{plan}.");
        Self {
            stem: format!("{prefix}{shards}"),
            prefix,
            output: output.to_owned(),
            size,
        }
    }

    /// What the jobs of the plan begin with, into however many shards it is divided.
    pub(super) fn prefix(&self) -> &str {
        &self.prefix
    }

    /// Whether a job of the plan is one of this division.
    pub(super) fn owns(&self, job: &Job) -> bool {
        let rest = job.name.strip_prefix(&self.stem);
        rest.is_some_and(|r| r.is_empty() || r.starts_with(['+', '-']))
    }

    pub(super) fn array(&self, offset: usize) -> String {
        match offset {
            0 => self.stem.clone(),
            _ => format!("{}+{offset}", self.stem),
        }
    }

    pub(super) fn merge(&self) -> String {
        format!("{}-merge-{}", self.stem, self.output)
    }

    /// The shard that a job computes, if it does.
    fn shard(&self, job: &Job) -> Option<usize> {
        let offset = match job.name.strip_prefix(&self.stem)? {
            "" => 0,
            rest => rest.strip_prefix('+')?.parse::<usize>().ok()?,
        };
        offset.checked_add(job.task?)
    }
}

impl Submission {
    /// `missing` shards, the `jobs` of this plan that are queued or running.
    pub(super) fn new(
        missing: &BTreeSet<usize>,
        jobs: &[Job],
        merged: bool,
        names: &Names,
    ) -> Self {
        let mut waiting = BTreeSet::new();
        let mut before = BTreeSet::new();
        for job in jobs {
            if let Some(shard) = names.shard(job).filter(|s| missing.contains(s)) {
                waiting.insert(shard);
                before.insert(job.id.clone());
            }
        }
        let mut arrays: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
        for shard in missing.difference(&waiting) {
            let task = shard % names.size;
            arrays.entry(shard - task).or_default().insert(task);
        }
        let arrays: Vec<Array> = arrays
            .into_iter()
            .map(|(offset, tasks)| Array { offset, tasks })
            .collect();
        let number = |id: &String| id.parse::<u64>().unwrap_or(u64::MAX);
        let merges = || jobs.iter().filter(|job| job.name == names.merge());
        // A merge waits for older arrays only: a new one follows all that are queued, so that never
        // two write the same folder.
        let late = |merge: &Job| before.iter().all(|id| number(id) < number(&merge.id));
        let merge = match merges().max_by_key(|job| number(&job.id)) {
            Some(merge) if arrays.is_empty() && late(merge) => Merge::Queued(merge.id.clone()),
            Some(_) => {
                before.extend(merges().map(|job| job.id.clone()));
                Merge::Submit(before)
            }
            None if missing.is_empty() && merged => Merge::There,
            None => Merge::Submit(before),
        };
        Self {
            arrays,
            waiting,
            merge,
        }
    }
}

#[cfg(test)]
mod tests;
