//! How a long computation reports progress and is stopped.

use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// How a long computation reports progress and is stopped.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    /// Called from any thread with how much was just finished, in the unit of the work: paths, or
    /// tasks.
    pub progress: &'a (dyn Fn(u64) + Sync),
    /// Set from outside to stop the computation.
    pub stop: &'a AtomicBool,
}

/// Never set.
static NEVER: AtomicBool = AtomicBool::new(false);

impl Control<'static> {
    /// Reports to nobody and is never stopped.
    pub fn none() -> Self {
        Self {
            progress: &|_| (),
            stop: &NEVER,
        }
    }
}

impl Control<'_> {
    /// Whether the computation is to end.
    pub fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Goes on, or is [`Stopped`].
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn check(&self) -> Result<(), Stopped> {
        if self.stopped() { Err(Stopped) } else { Ok(()) }
    }
}

impl fmt::Debug for Control<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Control")
            .field("stop", &self.stop)
            .finish_non_exhaustive()
    }
}

/// Steps of equal size that make up a share of the work.
#[derive(Debug)]
pub struct Steps<'a> {
    control: Control<'a>,
    share: u64,
    count: u64,
    done: AtomicU64,
}

impl<'a> Steps<'a> {
    /// `count` steps that are `share` units of the work together.
    pub fn new(control: Control<'a>, share: u64, count: usize) -> Self {
        Self {
            control,
            share,
            count: count.max(1) as u64,
            done: AtomicU64::new(0),
        }
    }

    /// One more is done; goes on, or is [`Stopped`].
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn done(&self) -> Result<(), Stopped> {
        let before = self.done.fetch_add(1, Ordering::Relaxed);
        let units = |steps: u64| steps.min(self.count) * self.share / self.count;
        (self.control.progress)(units(before + 1) - units(before));
        self.control.check()
    }
}

/// `act`, which tells at most `share` units of the work: the rest is told after it.
pub fn share_of<T>(control: Control<'_>, share: u64, act: impl FnOnce(Control<'_>) -> T) -> T {
    let told = AtomicU64::new(0);
    let progress = |units: u64| {
        let before = told.fetch_add(units, Ordering::Relaxed);
        (control.progress)((before + units).min(share) - before.min(share));
    };
    let stop = control.stop;
    let done = act(Control {
        progress: &progress,
        stop,
    });
    progress(share);
    done
}

/// A computation was stopped from outside before it was finished.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("stopped before it was finished; run the same command again to go on")]
pub struct Stopped;

#[cfg(test)]
mod tests {
    use super::*;

    /// Three steps of ten units: 3, 3 and 4; a fourth is none of them.
    #[test]
    fn steps_add_up_to_their_share() {
        let (seen, stop) = (AtomicU64::new(0), AtomicBool::new(false));
        let add = |units| {
            seen.fetch_add(units, Ordering::Relaxed);
        };
        let control = Control {
            progress: &add,
            stop: &stop,
        };
        let steps = Steps::new(control, 10, 3);
        for whole in [3, 6, 10, 10] {
            assert_eq!(steps.done(), Ok(()));
            assert_eq!(seen.load(Ordering::Relaxed), whole);
        }
        for (told, whole) in [(0, 20), (4, 30), (90, 40)] {
            share_of(control, 10, |own| (own.progress)(told));
            assert_eq!(seen.load(Ordering::Relaxed), whole);
        }
        stop.store(true, Ordering::Relaxed);
        assert_eq!(steps.done(), Err(Stopped));
    }
}
