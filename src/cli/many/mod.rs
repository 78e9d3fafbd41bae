//! A computation divided among machines that share nothing but a folder.
//!
//! | file of a plan's folder | content |
//! | --- | --- |
//! | plan.json | what is computed, its id, into how many shards it is divided |
//! | scene.toml, files/ | the scene, whole |
//! | shards/PLAN-FROM-TO.phs | what the blocks FROM to TO − 1 came to |
//! | shards/PLAN-FROM-TO.checkpoint | what is finished of a shard that is not |
//! | slurm/ | job scripts, and what the jobs said |
//!
//! Nothing here is appended to, locked or removed: every file appears whole under its name, and only `phicam clean` removes any.

pub(super) mod clean;
mod folder;
pub(super) mod merge;
pub(super) mod plan;
mod render;
pub(super) mod shard;
mod shards;
pub(super) mod slurm;
pub(super) mod status;
mod study;
mod work;
