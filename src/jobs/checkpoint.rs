//! What is finished of long work, put on disk while it goes on.

use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

use super::blocks::{self, BlockFile, Parts, Provenance};
use super::{Identity, JobError};

/// Writing takes at most one part in this of the time.
const SHARE: u32 = 10;
/// Time between two checkpoints at the least.
const SHORTEST: Duration = Duration::from_millis(100);

/// The process at work, as whoever started it knows it. What ends the work at once is a matter of
/// its control.
#[derive(Clone, Copy, Debug)]
pub struct Process {
    /// Version of the program.
    pub version: &'static str,
    /// Threads at work.
    pub threads: usize,
    /// Whether the work is to end as soon as the blocks at work are finished.
    pub warned: fn() -> bool,
    /// The time since a fixed moment.
    pub clock: fn() -> Duration,
}

/// One file that holds the blocks finished so far, replaced whole by the next: after every block,
/// or after several where blocks are so short that writing would take more than a tenth of the
/// time. A process that is killed repeats the blocks since.
#[derive(Debug)]
pub struct Checkpoint {
    /// The process at work.
    pub process: Process,
    path: PathBuf,
    identity: Identity,
    /// Time that earlier processes took, s.
    earlier: f64,
    start: Duration,
    last: Duration,
    cost: Duration,
}

impl Checkpoint {
    /// The file `path`, for the work of `identity`.
    pub fn new(path: PathBuf, identity: Identity, process: Process) -> Self {
        let start = (process.clock)();
        Self {
            process,
            path,
            identity,
            earlier: 0.0,
            start,
            last: start,
            cost: Duration::ZERO,
        }
    }

    /// What an earlier process has left there of the blocks `range` (of `total`), from the first of
    /// them on. A file that is not whole or not of this work counts as none: it is replaced.
    pub fn resume(&mut self, range: &Range<u64>, total: u64) -> Parts {
        let read = || {
            let file = BlockFile::open(&self.path, &self.identity, total).ok()?;
            let ours = file.range.start == range.start && file.range.end <= range.end;
            let parts: Parts = file.parts(range.clone()).collect::<Result<_, _>>().ok()?;
            ours.then_some((parts, file.provenance.seconds))
        };
        let (parts, earlier) = read().unwrap_or_default();
        self.earlier = earlier;
        parts
    }

    /// Called after every few blocks: writes if it is time. Whether to go on, which a scheduler may
    /// have advised against.
    ///
    /// # Errors
    /// [`JobError`] if it cannot be written.
    pub fn look(&mut self, parts: impl FnOnce() -> Parts) -> Result<bool, JobError> {
        let since = (self.process.clock)().saturating_sub(self.last);
        if since >= (SHARE * self.cost).max(SHORTEST) {
            self.keep(&parts())?;
        }
        Ok(!(self.process.warned)())
    }

    /// Writes `parts`, if there are any.
    ///
    /// # Errors
    /// [`JobError`] if it cannot be written.
    pub fn keep(&mut self, parts: &Parts) -> Result<(), JobError> {
        if parts.is_empty() {
            return Ok(());
        }
        let start = (self.process.clock)();
        blocks::write(&self.path, &self.identity, parts, self.provenance())?;
        self.last = (self.process.clock)();
        self.cost = self.last.saturating_sub(start);
        Ok(())
    }

    /// Where the work comes from, at this moment.
    pub fn provenance(&self) -> Provenance {
        let own = (self.process.clock)().saturating_sub(self.start);
        Provenance {
            version: self.process.version.to_owned(),
            threads: self.process.threads,
            seconds: self.earlier + own.as_secs_f64(),
        }
    }
}
