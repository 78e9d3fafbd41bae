//! Tasks of which each is a block.

use std::ops::Range;

use super::JobError;
use super::blocks::{Parts, end};
use super::checkpoint::Checkpoint;
use crate::transport::Control;

/// Time between two looks at what is finished where tasks are shorter, s.
const LOOK: f64 = 2.0;

/// Computes the tasks `range`, of which `done` has the first, by `run`: as many at once as take two
/// seconds, and `least` of them at the least. What comes back is shorter if it was stopped, and is
/// then in `checkpoint`.
///
/// # Errors
/// Those of `run`, and [`JobError`] if it cannot be kept.
pub fn compute_tasks<E: From<JobError>>(
    range: &Range<u64>,
    done: Parts,
    checkpoint: &mut Checkpoint,
    control: Control<'_>,
    least: u64,
    run: &dyn Fn(Range<usize>) -> Result<Vec<Vec<u8>>, E>,
) -> Result<Parts, E> {
    let process = checkpoint.process;
    let mut parts = done;
    let least = least.max(1);
    let mut together = least;
    loop {
        let first = end(&parts, range);
        let tasks = first..range.end.min(first + together);
        if tasks.is_empty() {
            return Ok(parts);
        }
        let start = (process.clock)();
        match run(tasks.start as usize..tasks.end as usize) {
            Err(_) if control.stopped() => break,
            found => parts.extend(tasks.clone().map(|task| task..task + 1).zip(found?)),
        }
        if tasks.end < range.end && !checkpoint.look(|| parts.clone())? {
            break;
        }
        let taken = (process.clock)().saturating_sub(start).as_secs_f64();
        let each = taken / (tasks.end - tasks.start) as f64;
        together = ((LOOK / each) as u64).clamp(least, 2 * together);
    }
    checkpoint.keep(&parts)?;
    Ok(parts)
}
