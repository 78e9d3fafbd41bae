//! Slurm: the missing shards of a plan as an array of jobs, and the merge after them.
//!
//! Nothing is remembered between calls. What is missing is asked of the plan's folder, what is
//! queued or running of Slurm (the jobs of a plan bear its name), and the difference is submitted:
//! so calling it again is the resume, whatever has happened in between. Two calls at the same
//! moment may submit a shard twice; that costs time only, since both write the same bytes.

mod jobs;
mod options;
mod queue;
mod request;
mod script;
mod submission;

#[cfg(all(test, unix))]
mod fake;

pub use options::check;
pub use queue::Slurm;
pub use request::Request;
