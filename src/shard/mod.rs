//! Floor 3: a part of a long computation as a file, and how parts make up the whole.
//!
//! A computation is a row of numbered blocks, each a pure function of the plan. A shard is what one process made of a range of them; any
//! shards that cover every block once give the whole, wherever and in whatever order they were computed.
//!
//! The file, little-endian:
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
//! A reader believes nothing: neither a length that the file does not have, nor a byte that the closing digest does not vouch for.

mod cover;
mod error;
mod identity;
mod plan;
mod reader;
mod writer;

pub use cover::{Clash, gaps, select};
pub use error::ShardError;
pub use identity::{Identity, PlanId};
pub use plan::{PlanError, PlanFile, Settings};
pub use reader::ShardFile;
pub use writer::write;

use serde::{Deserialize, Serialize};

/// What the name of a shard ends in.
pub const EXTENSION: &str = "phs";

const MAGIC: [u8; 8] = *b"phicam\0\0";
const LAYOUT: u32 = 1;
/// Magic, layout and the length of the header.
const HEAD: u64 = 16;
/// A SHA-256 digest.
const TRAILER: u64 = 32;
/// The longest header: far more parts than any plan has.
const LONGEST_HEADER: u64 = 64 << 20;

/// Where a shard comes from; for the reader of a report, no part of what it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// Version of the program.
    pub version: String,
    /// Threads at work.
    pub threads: usize,
    /// Wall time of the work, s.
    pub seconds: f64,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    plan_id: String,
    identity: Identity,
    from: u64,
    to: u64,
    parts: Vec<Part>,
    provenance: Provenance,
}

/// A range of blocks and the length of what they came to.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Part {
    from: u64,
    to: u64,
    bytes: u64,
}

#[cfg(test)]
mod tests;
