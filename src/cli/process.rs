//! This process: its version, its threads, its clock.

use std::sync::LazyLock;
use std::time::Instant;

use rayon::ThreadPool;

use crate::cli::failure::Failure;
use crate::cli::interrupt::warned;
use crate::jobs::Process;
use crate::store::threads_that_fit;

/// The version of the program.
pub(super) fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}

/// Threads of a pool that nobody gave a number; the environment may, as to every program of rayon.
pub(super) fn available_threads() -> usize {
    let given = std::env::var("RAYON_NUM_THREADS").ok();
    let given = given.and_then(|n| n.parse().ok()).filter(|n| *n > 0);
    given.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from))
}

/// The threads to work with.
pub(super) fn pool(threads: Option<usize>) -> Result<ThreadPool, Failure> {
    if threads.is_some_and(|n| !(1..=4096).contains(&n)) {
        return Err(Failure::usage(
            "--threads is out of range",
            "use 1 to 4096, or leave it out",
        ));
    }
    let wanted = threads.unwrap_or_else(available_threads);
    let fit = threads_that_fit(wanted);
    let refused = |why: String| {
        let cause = format!("{wanted} threads cannot be started: {why}");
        let cure = "use fewer --threads, or raise the limits on address space and processes";
        Failure::new(cause, format!("{cure} (ulimit -v, ulimit -u)"))
    };
    if threads.is_some() && fit < wanted {
        return Err(refused(format!("the address space has room for {fit}")));
    }
    let built = rayon::ThreadPoolBuilder::new().num_threads(fit).build();
    built.map_err(|e| refused(e.to_string()))
}

/// Starts the threads that serve what asks for no pool of its own.
pub(super) fn start_threads() -> Result<(), Failure> {
    let fit = threads_that_fit(available_threads());
    let started = rayon::ThreadPoolBuilder::new()
        .num_threads(fit)
        .build_global();
    started.map_err(|e| {
        let cause = format!("{fit} threads cannot be started: {e}");
        Failure::system(
            cause,
            "raise the limits on address space and processes (ulimit -v, ulimit -u)",
        )
    })
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
