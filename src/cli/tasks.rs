//! Commands whose work is independent tasks, for many machines: `study …` and `reproduce`.

use std::ops::Range;
use std::path::Path;

use super::failure::{Failure, Outcome};
use crate::transport::Control;

/// The tasks of a command. Every process that has the same command and the same scene has the same
/// tasks.
pub(super) trait Tasks: Sync {
    /// How many there are.
    fn count(&self) -> usize;

    /// The outputs of some tasks as bytes, in the order of their numbers, on the threads of the
    /// pool.
    fn run(&self, tasks: Range<usize>, control: Control<'_>) -> Result<Vec<Vec<u8>>, Failure>;

    /// Makes of the outputs of all tasks, in their order, the files that the command itself would
    /// leave in `folder`, and prints what it would print.
    fn deliver(
        &self,
        outputs: &[Vec<u8>],
        control: Control<'_>,
        folder: &Path,
    ) -> Result<Outcome, Failure>;
}
