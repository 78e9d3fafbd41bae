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
    /// To be submitted; it waits for the arrays and for these jobs, which are queued or running already.
    Submit(BTreeSet<String>),
    /// This job does it.
    Queued(String),
    /// It has been done.
    There,
}

/// Whether what the plan is for has been merged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Merged {
    Yes,
    No,
}

/// The names of a plan's jobs. An array's name tells its offset, because squeue tells the tasks only.
pub(super) struct Names {
    stem: String,
    /// Slurm's MaxArraySize: no task may have this number or a higher one.
    size: usize,
}

impl Names {
    /// `plan`: the short form of its id. `size` must not be 0.
    pub(super) fn new(plan: &str, size: usize) -> Self {
        let stem = format!("phicam-{plan}");
        Self { stem, size }
    }

    pub(super) fn array(&self, offset: usize) -> String {
        match offset {
            0 => self.stem.clone(),
            _ => format!("{}+{offset}", self.stem),
        }
    }

    pub(super) fn merge(&self) -> String {
        format!("{}-merge", self.stem)
    }

    /// Every name that a job of a plan of so many shards may have.
    pub(super) fn all(&self, shards: usize) -> Vec<String> {
        let offsets = (0..shards.max(1)).step_by(self.size);
        offsets
            .map(|o| self.array(o))
            .chain([self.merge()])
            .collect()
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
        merged: Merged,
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
        let queued = jobs.iter().rfind(|job| job.name == names.merge());
        let merge = match queued {
            // It waits for older arrays only: the new one follows it, so that never two write the same folder.
            Some(merge) if !arrays.is_empty() => {
                before.insert(merge.id.clone());
                Merge::Submit(before)
            }
            Some(merge) => Merge::Queued(merge.id.clone()),
            None if missing.is_empty() && merged == Merged::Yes => Merge::There,
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
