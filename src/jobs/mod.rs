//! Floor 7: long work in numbered blocks, divided among machines that share nothing but a folder,
//! and going on after a stop.
//!
//! What a block comes to is a function of the work and its number alone. So blocks may be computed
//! anywhere, in any order and at any time, and a range of them that covers every block once gives
//! the whole.
//!
//! A file of blocks, little-endian, is what one process made of a range of them: a shard, or a
//! checkpoint of unfinished work.
//!
//! | bytes | content |
//! | --- | --- |
//! | 8 | `phicam` and two zeros |
//! | 4 | version of this layout, 1 |
//! | 4 | length h of the header |
//! | h | header, JSON: the plan's id, what is computed (the [`Identity`], of which the id is the SHA-256), range, parts, provenance |
//! | Σ | the parts, one after the other |
//! | 32 | SHA-256 of all before |
//!
//! A reader trusts neither a length that the file does not have, nor a byte that the closing digest
//! does not confirm.
//!
//! | file of a plan's folder | content |
//! | --- | --- |
//! | plan.json | what is computed, its id, into how many shards it is divided |
//! | scene.toml, files/ | the scene, whole |
//! | shards/PLAN-FROM-TO.phs | what the blocks FROM to TO − 1 came to |
//! | shards/PLAN-FROM-TO.checkpoint | what is finished of a shard that is not |
//! | slurm/ | job scripts, and what the jobs said |
//!
//! Nothing here is appended to, locked or removed: every file appears whole under its name, and
//! only `phicam clean` removes any.

mod blocks;
mod checkpoint;
mod error;
mod folder;
mod identity;
mod indices;
pub mod need;
mod plan;
mod shards;
pub mod slurm;
mod spots;
mod tasks;

pub use blocks::{BlockFile, EXTENSION, Parts, Provenance, end, write};
pub use checkpoint::{Checkpoint, Process};
pub use error::JobError;
pub use folder::{PlanFolder, gaps};
pub use identity::{Identity, PlanId};
pub use indices::array_syntax;
pub use plan::{PlanFile, Settings};
pub use shards::{Shards, select};
pub use spots::Spots;
pub use tasks::compute_tasks;

#[cfg(test)]
mod tests;
