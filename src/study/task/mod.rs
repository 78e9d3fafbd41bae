//! Studies in independent tasks: what one process works off at once, many machines share.
//!
//! A [`Division`] cuts a study into numbered tasks. Each is a pure function of scene, settings and its number, so that it does not matter where or in which
//! order it runs; [`Division::finish`] makes the finding of all results in the order of their numbers. A study that runs in one process goes the same way
//! ([`whole`]), so what is put together from many machines has the same bytes. Results travel as bytes by [`encode`] and [`decode`].

mod bytes;
pub(super) mod matrix;

use std::error::Error;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::transport::Control;

/// How tasks share the threads of a process.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sharing {
    /// They run side by side.
    SideBySide,
    /// One after the other, each on all threads: there is memory for one.
    InTurn,
}

/// How studies are divided and what their tasks come to: raised whenever a change of either makes the results of tasks of another number
/// useless, or different.
pub const LAYOUT: u32 = 1;

/// A study, divided into tasks.
pub trait Division: Sync {
    /// What every task stands on: computed once a process, and the same in each.
    type Ground: Send + Sync;
    /// The result of a task.
    type Part: Serialize + DeserializeOwned + Send;
    /// What all of them come to.
    type Finding: Send;
    /// Why there is none.
    type Error: Error + Send + 'static;

    /// How many tasks there are.
    fn tasks(&self) -> usize;

    /// How they share the threads of a process; it does not change a bit of the results.
    fn sharing(&self) -> Sharing {
        Sharing::SideBySide
    }

    /// The ground of all tasks. `Ok(None)` if stopped.
    ///
    /// # Errors
    /// Those of the study.
    fn ground(&self, control: Control<'_>) -> Result<Option<Self::Ground>, Self::Error>;

    /// The result of task `index`, a function of scene, settings and this number alone. `Ok(None)` if stopped.
    ///
    /// # Errors
    /// Those of the study.
    fn task(
        &self,
        ground: &Self::Ground,
        index: usize,
        control: Control<'_>,
    ) -> Result<Option<Self::Part>, Self::Error>;

    /// Whether `part`, which may be from anywhere, has the kind and the lengths of a result of task `index`.
    fn fits(&self, ground: &Self::Ground, index: usize, part: &Self::Part) -> bool;

    /// The finding, from the results of all tasks in their order, each of which [`fits`](Self::fits).
    ///
    /// # Errors
    /// Those of the study.
    fn finish(
        &self,
        ground: &Self::Ground,
        parts: Vec<Self::Part>,
    ) -> Result<Self::Finding, Self::Error>;
}

/// Why results cannot be taken in.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum TaskError {
    /// A result that cannot be written.
    #[error("the result of task {index} cannot be written: {cause} (report it as a bug)")]
    Unwritten {
        /// The task.
        index: usize,
        /// What is wrong.
        cause: String,
    },
    /// Bytes that no task gave.
    #[error("the result of task {index} is damaged: {cause} (run that task again)")]
    Damaged {
        /// The task.
        index: usize,
        /// What is wrong.
        cause: String,
    },
    /// Not one result for each task.
    #[error("there are {found} results of {tasks} tasks (give that of every task, once)")]
    Number {
        /// Results.
        found: usize,
        /// Tasks.
        tasks: usize,
    },
}

/// Tells how many of how many tasks are done; called from any thread.
pub type Steps<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// The results of `tasks`, on the threads of the pool. `Ok(None)` if stopped.
///
/// # Errors
/// Those of the study; of the first task in order that has one among those that ran.
pub fn parts<D: Division>(
    division: &D,
    ground: &D::Ground,
    tasks: Range<usize>,
    control: Control<'_>,
    steps: Steps<'_>,
) -> Result<Option<Vec<D::Part>>, D::Error> {
    let (done, all) = (AtomicUsize::new(0), tasks.len());
    let one = |index| {
        if control.stop.load(Ordering::Relaxed) {
            return Ok(None);
        }
        let part = division.task(ground, index, control)?;
        steps(done.fetch_add(1, Ordering::Relaxed) + 1, all);
        Ok(part)
    };
    let found: Result<Vec<Option<D::Part>>, D::Error> = match division.sharing() {
        Sharing::SideBySide => tasks.into_par_iter().map(one).collect(),
        Sharing::InTurn => tasks.map(one).collect(),
    };
    Ok(found?.into_iter().collect())
}

/// The whole study in this process. `Ok(None)` if stopped.
///
/// # Errors
/// Those of the study.
pub fn whole<D: Division>(
    division: &D,
    control: Control<'_>,
    steps: Steps<'_>,
) -> Result<Option<D::Finding>, D::Error> {
    let Some(ground) = division.ground(control)? else {
        return Ok(None);
    };
    match parts(division, &ground, 0..division.tasks(), control, steps)? {
        Some(parts) => division.finish(&ground, parts).map(Some),
        None => Ok(None),
    }
}

/// The result of task `index` as bytes, every bit of every number kept.
///
/// # Errors
/// [`TaskError::Unwritten`].
pub fn encode<T: Serialize>(index: usize, part: &T) -> Result<Vec<u8>, TaskError> {
    bytes::write(part).map_err(|cause| TaskError::Unwritten { index, cause })
}

/// The results of all tasks from their bytes, in the order of the tasks. Bytes from anywhere are refused or taken, never obeyed: what is reserved for them is bounded by
/// their own number.
///
/// # Errors
/// [`TaskError`].
pub fn decode<D: Division>(
    division: &D,
    ground: &D::Ground,
    parts: &[Vec<u8>],
) -> Result<Vec<D::Part>, TaskError> {
    let (found, tasks) = (parts.len(), division.tasks());
    if found != tasks {
        return Err(TaskError::Number { found, tasks });
    }
    let of = |(index, given): (usize, &Vec<u8>)| {
        let damaged = |cause| TaskError::Damaged { index, cause };
        let part = bytes::read(given).map_err(damaged)?;
        match division.fits(ground, index, &part) {
            true => Ok(part),
            false => Err(damaged("it is of another task or study".to_owned())),
        }
    };
    parts.iter().enumerate().map(of).collect()
}

#[cfg(test)]
pub(super) mod tests;
