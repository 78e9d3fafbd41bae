//! Ctrl-C, and the warning that a scheduler sends before it ends a job.

use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::cli::console::complain;
use crate::store::is_at_rest;
use crate::transport::Control;

static STOP: AtomicBool = AtomicBool::new(false);
static WARNED: AtomicBool = AtomicBool::new(false);
static GUARDED: AtomicBool = AtomicBool::new(false);
static KEEPING: AtomicBool = AtomicBool::new(false);

/// The flag that ends the work at once: Ctrl-C sets it, and SIGTERM where nothing can be finished
/// first. A second Ctrl-C ends the process. What is finished is on disk by then.
pub(super) fn stop_flag() -> &'static AtomicBool {
    static ONCE: Once = Once::new();
    ONCE.call_once(listen);
    &STOP
}

/// Reports to nobody, and ends at Ctrl-C.
pub(super) fn control() -> Control<'static> {
    Control {
        stop: stop_flag(),
        ..Control::none()
    }
}

/// While it lives SIGTERM is a warning: the block at work is finished first. A second SIGTERM does
/// not wait for it.
#[derive(Debug)]
pub(super) struct SignalGuard;

impl SignalGuard {
    /// From now on.
    pub(super) fn new() -> Self {
        let _ = stop_flag();
        GUARDED.store(true, Ordering::Relaxed);
        Self
    }
}

impl Drop for SignalGuard {
    fn drop(&mut self) {
        GUARDED.store(false, Ordering::Relaxed);
        if warned() {
            STOP.store(true, Ordering::Relaxed);
        }
    }
}

/// While it lives a step at work is waited for, so that what was found before it is not lost.
#[derive(Debug)]
pub(super) struct StepGuard;

impl StepGuard {
    /// From now on.
    pub(super) fn new() -> Self {
        KEEPING.store(true, Ordering::Relaxed);
        Self
    }
}

impl Drop for StepGuard {
    fn drop(&mut self) {
        KEEPING.store(false, Ordering::Relaxed);
    }
}

/// Whether SIGTERM came.
pub(super) fn warned() -> bool {
    WARNED.load(Ordering::Relaxed)
}

#[cfg(unix)]
fn listen() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;

    // Without this a signal still ends the process, and finished spots are still kept.
    let Ok(mut signals) = Signals::new([SIGINT, SIGHUP, SIGTERM]) else {
        return;
    };
    let wait = move || {
        for signal in signals.forever() {
            if signal == SIGTERM {
                let again = WARNED.swap(true, Ordering::Relaxed);
                if again || !GUARDED.load(Ordering::Relaxed) {
                    STOP.store(true, Ordering::Relaxed);
                }
            } else if STOP.swap(true, Ordering::Relaxed) {
                std::process::exit(130);
            }
            if STOP.load(Ordering::Relaxed) {
                let _ = std::thread::Builder::new().spawn(end_soon);
            }
        }
    };
    let _ = std::thread::Builder::new().spawn(wait);
}

#[cfg(not(unix))]
fn listen() {}

/// Time in which work that is to stop comes to an end of its own, and time that a file at work has
/// besides. Ctrl-C is answered within two seconds, on a busy machine too.
#[cfg(unix)]
const ORDERLY: Duration = Duration::from_millis(1000);
#[cfg(unix)]
const WRITING: Duration = Duration::from_secs(20);
/// Time that a step has, where what was found before it is only in memory.
#[cfg(unix)]
const STEP: Duration = Duration::from_secs(60);

/// Ends the process where the work has not looked at the flag: it is in the midst of a step that
/// nothing divides. Files appear whole or not at all, so that what is finished is on disk.
#[cfg(unix)]
fn end_soon() {
    std::thread::sleep(ORDERLY);
    let start = Instant::now();
    if KEEPING.load(Ordering::Relaxed) {
        complain(
            "the step at work is finished first, and what was found before it is written; Ctrl-C again ends at once",
        );
    }
    while KEEPING.load(Ordering::Relaxed) && start.elapsed() < STEP {
        std::thread::sleep(Duration::from_millis(10));
    }
    let start = Instant::now();
    if !is_at_rest() {
        complain("what is finished is being written; Ctrl-C again ends at once, without it");
    }
    while !is_at_rest() && start.elapsed() < WRITING {
        std::thread::sleep(Duration::from_millis(1));
    }
    complain(
        "stopped in the midst of a step: what was finished before is kept, and every file is whole",
    );
    std::process::exit(if warned() { 75 } else { 130 });
}

/// A file that grows beyond a limit on its size shall be an error with a name, not the end of the
/// process.
#[cfg(unix)]
pub(super) fn outlive_size_limits() {
    static CAUGHT: AtomicBool = AtomicBool::new(false);
    // Without this the system ends the process, and finished files are still whole.
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, &CAUGHT);
}

#[cfg(not(unix))]
pub(super) fn outlive_size_limits() {}
