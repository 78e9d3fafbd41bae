//! Commands for a computation divided among machines that share nothing but a folder: see
//! [`crate::jobs`].

pub(super) mod clean;
pub(super) mod merge;
pub(super) mod plan;
mod planned;
mod render;
pub(super) mod shard;
pub(super) mod slurm;
pub(super) mod status;
mod study;
mod work;
