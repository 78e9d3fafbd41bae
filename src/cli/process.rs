//! This process: its version, its threads, its clock.

use std::sync::LazyLock;
use std::time::Instant;

use rayon::ThreadPool;

use super::failure::Failure;
use super::interrupt::warned;
use crate::jobs::Process;

/// The version of the program.
pub(super) fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}

/// The threads to work with.
pub(super) fn pool(threads: Option<usize>) -> Result<ThreadPool, Failure> {
    if threads.is_some_and(|n| !(1..=4096).contains(&n)) {
        return Err(Failure::usage(
            "--threads is out of range",
            "use 1 to 4096, or leave it out",
        ));
    }
    Ok(rayon::ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or(0))
        .build()?)
}

/// This process, with the threads of `pool`, for work in blocks.
pub(super) fn process(pool: &ThreadPool) -> Process {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    Process {
        version: version(),
        threads: pool.current_num_threads(),
        warned,
        clock: || START.elapsed(),
    }
}
