//! Commands for a computation divided among machines that share nothing but a folder: see
//! [`crate::jobs`].

pub(in crate::cli) mod clean;
pub(in crate::cli) mod merge;
pub(in crate::cli) mod plan;
mod planned;
mod render;
pub(in crate::cli) mod shard;
pub(in crate::cli) mod slurm;
pub(in crate::cli) mod status;
mod study;
mod work;
