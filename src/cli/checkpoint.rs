//! What is finished of a long piece of work, put on disk while it goes on.

use std::ops::{ControlFlow, Range};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use super::failure::Failure;
use super::interrupt;
use super::record::version;
use crate::shard::{self, Identity, Provenance, ShardFile};

/// Ranges of blocks and what they came to.
pub(super) type Parts = Vec<(Range<u64>, Vec<u8>)>;

/// Writing takes at most one part in this of the time.
const SHARE: u32 = 10;
/// Time between two checkpoints at the least.
const SHORTEST: Duration = Duration::from_millis(100);

/// One file that holds the blocks finished so far, replaced whole by the next: after every block, or after several where blocks are so short
/// that writing would take more than a tenth of the time. A process that is killed repeats the blocks since.
#[derive(Debug)]
pub(super) struct Checkpoint {
    path: PathBuf,
    identity: Identity,
    threads: usize,
    /// Of the processes before, s.
    earlier: f64,
    start: Instant,
    last: Instant,
    cost: Duration,
    failure: Option<Failure>,
}

impl Checkpoint {
    /// The file `path`, for the work of `identity`.
    pub(super) fn new(path: PathBuf, identity: Identity, threads: usize) -> Self {
        let start = Instant::now();
        Self {
            path,
            identity,
            threads,
            earlier: 0.0,
            start,
            last: start,
            cost: Duration::ZERO,
            failure: None,
        }
    }

    /// What an earlier process has left there of the blocks `range` (of `total`), from the first of them on. A file that is not whole or not of
    /// this work counts as none: it is replaced.
    pub(super) fn resume(&mut self, range: &Range<u64>, total: u64) -> Parts {
        let Ok(file) = ShardFile::open(&self.path, &self.identity, total) else {
            return Parts::new();
        };
        if file.range.start != range.start || file.range.end > range.end {
            return Parts::new();
        }
        let parts: Result<Parts, _> = file.parts(range.clone()).collect();
        let Ok(parts) = parts else {
            return Parts::new();
        };
        self.earlier = file.provenance.seconds;
        parts
    }

    /// Called after every few blocks: writes if it is time. Breaks if that failed, or if the scheduler has warned.
    pub(super) fn look(&mut self, parts: impl FnOnce() -> Parts) -> ControlFlow<()> {
        let since = self.last.elapsed();
        if since >= (SHARE * self.cost).max(SHORTEST) && self.keep(&parts()).is_break() {
            return ControlFlow::Break(());
        }
        match interrupt::warned() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }

    /// The last word of work that is stopped: the failure of a write before, or `parts`, written.
    pub(super) fn leave(&mut self, parts: &Parts) -> Result<(), Failure> {
        self.outcome()?;
        let _ = self.keep(parts);
        self.outcome()
    }

    /// Writes `parts`, if there are any.
    fn keep(&mut self, parts: &Parts) -> ControlFlow<()> {
        if parts.is_empty() {
            return ControlFlow::Continue(());
        }
        let start = Instant::now();
        let written = shard::write(&self.path, &self.identity, parts, self.provenance());
        self.last = Instant::now();
        self.cost = self.last - start;
        match written {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                self.failure = Some(error.into());
                ControlFlow::Break(())
            }
        }
    }

    /// Where the work comes from, at this moment.
    pub(super) fn provenance(&self) -> Provenance {
        Provenance {
            version: version().to_owned(),
            threads: self.threads,
            seconds: self.earlier + self.start.elapsed().as_secs_f64(),
        }
    }

    /// The failure of a write, if there was one.
    pub(super) fn outcome(&mut self) -> Result<(), Failure> {
        self.failure.take().map_or(Ok(()), Err)
    }
}
