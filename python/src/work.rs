//! Computations beside the interpreter.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use phicam::scene::Scene;
use phicam::store::memory::NoRoom;
use phicam::transport::Control;
use pyo3::prelude::*;
use rayon::ThreadPoolBuilder;

use crate::errors::{Raise, input, internal};

/// How often signals are looked for.
const LOOK: Duration = Duration::from_millis(50);
/// How long a stopped computation may take to end before it is left to itself.
const PATIENCE: Duration = Duration::from_millis(500);
const MOST_THREADS: usize = 1024;

/// Refuses what does not fit into memory, by what `check` finds.
///
/// # Errors
/// `InputError`.
pub fn fits(
    py: Python<'_>,
    scene: &Arc<Scene>,
    check: impl FnOnce(&Scene) -> Result<(), NoRoom> + Send + 'static,
) -> PyResult<()> {
    let scene = Arc::clone(scene);
    run(py, None, None, move |_| check(&scene))?.raise()
}

/// Refuses a scene with an unknown albedo, whose light is unknown too.
///
/// # Errors
/// `SceneError`.
pub fn knows_its_light(scene: &Scene) -> PyResult<()> {
    match scene.unknown() {
        None => Ok(()),
        Some(_) => scene.clone().known().map(|_| ()).raise(),
    }
}

/// Runs `compute` on `threads` threads (all cores unless given) without the interpreter's lock.
/// `progress` is called with how much is done. Ctrl-C stops it; one that does not look at its
/// [`Control`] goes on unheard, and its result is dropped.
///
/// # Errors
/// What a signal's handler or `progress` raises; `InternalError` where the computation panics.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
    compute: impl FnOnce(Control<'_>) -> T + Send + 'static,
) -> PyResult<T> {
    let count = threads.unwrap_or(0);
    if threads == Some(0) || count > MOST_THREADS {
        let cause = format!("threads is {count}");
        return Err(input(cause, "use 1 to 1024, or None for all cores"));
    }
    let pool = ThreadPoolBuilder::new().num_threads(count).build();
    let pool = pool.map_err(|e| internal(&format!("no threads could be started: {e}")))?;
    let (stop, done) = (
        Arc::new(AtomicBool::new(false)),
        Arc::new(AtomicU64::new(0)),
    );
    let (sender, receiver) = channel();
    let receiver = Mutex::new(receiver);
    let (stopping, counted) = (Arc::clone(&stop), Arc::clone(&done));
    let job = move || {
        let control = Control {
            progress: &|n| {
                counted.fetch_add(n, Ordering::Relaxed);
            },
            stop: &stopping,
        };
        let result = catch_unwind(AssertUnwindSafe(|| pool.install(|| compute(control))));
        // Nobody may be waiting any more.
        let _ = sender.send(result);
    };
    let thread = std::thread::Builder::new().stack_size(16 << 20).spawn(job);
    thread.map_err(|e| internal(&format!("no thread could be started: {e}")))?;
    let report = progress.map(|call| call.clone().unbind());
    let mut raised: Option<(PyErr, Instant)> = None;
    let mut told = 0;
    loop {
        let arrived = py.detach(|| match receiver.lock() {
            Ok(receiver) => receiver.recv_timeout(LOOK),
            Err(_) => Err(RecvTimeoutError::Disconnected),
        });
        match (arrived, &raised) {
            (Ok(_), Some(_)) => break,
            (Ok(Ok(result)), None) => {
                tell(py, report.as_ref(), done.load(Ordering::Relaxed), &mut told)?;
                return Ok(result);
            }
            (Ok(Err(panic)), None) => return Err(internal(&words(&*panic))),
            (Err(RecvTimeoutError::Disconnected), None) => {
                return Err(internal("a computation ended without a result"));
            }
            (Err(RecvTimeoutError::Disconnected), Some(_)) => break,
            (Err(RecvTimeoutError::Timeout), Some((_, since))) if since.elapsed() > PATIENCE => {
                break;
            }
            (Err(RecvTimeoutError::Timeout), Some(_)) => {}
            (Err(RecvTimeoutError::Timeout), None) => {
                let now = done.load(Ordering::Relaxed);
                let looked = py
                    .check_signals()
                    .and_then(|()| tell(py, report.as_ref(), now, &mut told));
                if let Err(error) = looked {
                    stop.store(true, Ordering::Relaxed);
                    raised = Some((error, Instant::now()));
                }
            }
        }
    }
    match raised {
        Some((error, _)) => Err(error),
        None => Err(internal("a computation ended without a result")),
    }
}

fn tell(py: Python<'_>, report: Option<&Py<PyAny>>, now: u64, told: &mut u64) -> PyResult<()> {
    match report {
        Some(call) if now > *told => {
            *told = now;
            call.call1(py, (now,)).map(|_| ())
        }
        _ => Ok(()),
    }
}

/// What a panic says.
fn words(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
    text.unwrap_or("a panic without words").to_owned()
}
