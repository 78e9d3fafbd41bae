//! Studies in independent tasks: one process works them off, or many machines share them.
//!
//! A [`Study`] is divided into numbered tasks. Each is a pure function of scene, settings and its
//! number, so it does not matter where or in which order the tasks run. [`Study::finish`] makes the
//! result of all outputs in the order of their numbers. A study that runs in one process goes the
//! same way ([`run`]), so what is put together from many machines has the same bytes.

use std::error::Error;
use std::ops::Range;

use rayon::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::scene::Scene;
use crate::transport::{Control, Stopped};

/// How tasks share the threads of a process.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sharing {
    /// They run side by side.
    SideBySide,
    /// One after the other, each on all threads: there is memory for one.
    InTurn,
}

/// How much a study has to do, in the unit in which it reports progress.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// So many tasks.
    Tasks(u64),
    /// So many paths.
    Samples(u64),
    /// So many methods of recovery.
    Methods(u64),
}

impl Work {
    /// Units of a method of recovery.
    pub const EACH_METHOD: u64 = 100;

    /// What is reported when all of it is done.
    pub fn units(self) -> u64 {
        match self {
            Self::Tasks(n) | Self::Samples(n) => n,
            Self::Methods(n) => n.saturating_mul(Self::EACH_METHOD),
        }
    }

    /// The paths that a scene needs: `shared` of them per pixel and `independent` ones per pixel
    /// and spot. A number too large to count is as good as any other for a progress bar.
    pub fn samples(scene: &Scene, shared: u64, independent: u64) -> Self {
        let spots = scene.laser.spots.len() as u64;
        let each = independent.saturating_mul(spots).saturating_add(shared);
        Self::Samples(each.saturating_mul(scene.camera.pixels() as u64))
    }

    /// The share that so many of `all` tasks have in it: of samples an estimate, which takes tasks
    /// as equally long.
    #[must_use]
    pub fn share(self, tasks: u64, all: u64) -> Self {
        let of = |n: u64| (u128::from(n) * u128::from(tasks) / u128::from(all.max(1))) as u64;
        match self {
            Self::Tasks(n) => Self::Tasks(of(n)),
            Self::Samples(n) => Self::Samples(of(n)),
            Self::Methods(n) => Self::Methods(of(n)),
        }
    }
}

/// A study, divided into tasks.
pub trait Study: Sync {
    /// What every task needs: computed once a process, and the same in each.
    type Context: Send + Sync;
    /// The result of a task.
    type Output: Serialize + DeserializeOwned + Send;
    /// What all of them come to.
    type Result: Serialize + Send + 'static;
    /// Why there is none.
    type Error: Error + From<Stopped> + Send + Sync + 'static;

    /// How many tasks there are.
    fn tasks(&self) -> usize;

    /// How much there is to do. Where that is counted in samples, context and tasks report those
    /// they have traced.
    fn work(&self) -> Work {
        Work::Tasks(self.tasks() as u64)
    }

    /// How the tasks share the threads of a process; it does not change a bit of the results.
    fn sharing(&self) -> Sharing {
        Sharing::SideBySide
    }

    /// The context of all tasks.
    ///
    /// # Errors
    /// Those of the study, also that it was stopped.
    fn context(&self, control: Control<'_>) -> Result<Self::Context, Self::Error>;

    /// The output of task `index`, a function of scene, settings and this number alone.
    ///
    /// # Errors
    /// Those of the study, also that it was stopped.
    fn task(
        &self,
        context: &Self::Context,
        index: usize,
        control: Control<'_>,
    ) -> Result<Self::Output, Self::Error>;

    /// Whether `output`, which may be from anywhere, has the kind and the lengths of an output of
    /// task `index`.
    fn fits(&self, context: &Self::Context, index: usize, output: &Self::Output) -> bool;

    /// The result, from the outputs of all tasks in their order, each of which
    /// [`fits`](Self::fits).
    ///
    /// # Errors
    /// Those of the study.
    fn finish(
        &self,
        context: &Self::Context,
        outputs: Vec<Self::Output>,
    ) -> Result<Self::Result, Self::Error>;

    /// Whether the outputs stay when it is finished, so that the same study once more computes
    /// nothing, and another one does not replace them: for what takes hours.
    fn keeps(&self) -> bool {
        false
    }

    /// Whether traced and modelled agree, where that is what the study asks.
    fn agrees(&self, _result: &Self::Result) -> bool {
        true
    }
}

/// The context of a study.
///
/// # Errors
/// Those of the study.
pub fn context<S: Study>(study: &S, control: Control<'_>) -> Result<S::Context, S::Error> {
    study.context(within(study, control))
}

/// The outputs of `tasks`, on the threads of the pool.
///
/// # Errors
/// Those of the study; of the first task in order that has one among those that ran.
pub fn outputs<S: Study>(
    study: &S,
    context: &S::Context,
    tasks: Range<usize>,
    control: Control<'_>,
) -> Result<Vec<S::Output>, S::Error> {
    let one = |index| {
        control.check()?;
        let output = study.task(context, index, within(study, control))?;
        if let Work::Tasks(_) = study.work() {
            (control.progress)(1);
        }
        Ok(output)
    };
    match study.sharing() {
        Sharing::SideBySide => tasks.into_par_iter().map(one).collect(),
        Sharing::InTurn => tasks.map(one).collect(),
    }
}

/// The whole study in this process.
///
/// # Errors
/// Those of the study.
pub fn run<S: Study>(study: &S, control: Control<'_>) -> Result<S::Result, S::Error> {
    let context = context(study, control)?;
    let outputs = outputs(study, &context, 0..study.tasks(), control)?;
    study.finish(&context, outputs)
}

/// The control of what runs inside a study: it reports samples only where the study counts them.
fn within<'a, S: Study>(study: &S, control: Control<'a>) -> Control<'a> {
    match study.work() {
        Work::Samples(_) => control,
        Work::Tasks(_) | Work::Methods(_) => Control {
            progress: &|_| (),
            stop: control.stop,
        },
    }
}

#[cfg(test)]
pub(super) mod tests;
