//! Why a part does not fit into a tally.

use std::ops::Range;

/// Why a part does not fit into a [`Tally`](super::Tally).
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TallyError {
    /// Its range is not a node of the tree of blocks, or does not follow the blocks that are there.
    #[error("blocks {}..{} are no part that follows block {after}; render these blocks again", range.start, range.end)]
    Misplaced {
        /// What was given.
        range: Range<u32>,
        /// The end of what is there.
        after: u32,
    },
    /// Its length is not that of its columns.
    #[error("blocks {}..{} have {found} bytes of sums in place of {expected}; render these blocks again", range.start, range.end)]
    Length {
        /// What was given.
        range: Range<u32>,
        /// Bytes given.
        found: usize,
        /// Bytes due.
        expected: usize,
    },
    /// It holds a number that is not a flux.
    #[error("blocks {}..{} hold a sum that is not a finite flux of at least 0; render these blocks again", range.start, range.end)]
    NoFlux {
        /// What was given.
        range: Range<u32>,
    },
}
