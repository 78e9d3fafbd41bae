//! A study as whoever runs it sees it: its name, its options, and its tasks as bytes.

use std::ops::Range;
use std::sync::OnceLock;

use crate::lab::bytes::{decode, encoded};
use crate::lab::error::StudyError;
use crate::lab::finding::{Describe, Finding};
use crate::lab::options::{Opt, Values};
use crate::lab::study::{Sharing, Study, Work, context};
use crate::scene::Scene;
use crate::transport::Control;

/// Makes a study ready for a scene, with the values of its options.
pub type Prepare = fn(&Scene, &Values) -> Result<Box<dyn AnyStudy>, StudyError>;

/// A study that can be asked for by name. With this in its file, and a line in
/// [`crate::lab::STUDIES`], it has a command with help, progress, shards, and files.
#[derive(Debug)]
pub struct Registered {
    /// Its name on the command line and of its files.
    pub name: &'static str,
    /// What it asks, in one sentence, and what it leaves.
    pub about: &'static str,
    /// The scene that is studied unless one is given; none where one has to be.
    pub scene: Option<&'static str>,
    /// The files that it leaves beside `NAME.json` and the page; empty for none.
    pub files: &'static str,
    /// What may be set.
    pub options: &'static [Opt],
    /// The study of a scene with these values of its options.
    pub prepare: Prepare,
}

/// What a study found.
#[derive(Debug)]
pub struct Found {
    /// The result as JSON.
    pub json: String,
    /// What is said, tabulated and drawn of it.
    pub finding: Finding,
    /// Whether traced and modelled agree, where that is what was asked.
    pub agrees: bool,
}

/// A study of any kind, ready to run.
pub trait AnyStudy: Send + Sync {
    /// How many tasks there are.
    fn tasks(&self) -> usize;

    /// How much there is to do.
    fn work(&self) -> Work;

    /// How the tasks share the threads of a process.
    fn sharing(&self) -> Sharing;

    /// Whether the outputs stay when it is finished: [`Study::keeps`].
    fn keeps(&self) -> bool;

    /// The outputs of some tasks as bytes, in the order of their numbers, on the threads of the
    /// pool.
    ///
    /// # Errors
    /// Those of the study, and [`crate::lab::TaskError`] where there are no such tasks.
    fn outputs(
        &self,
        tasks: Range<usize>,
        control: Control<'_>,
    ) -> Result<Vec<Vec<u8>>, StudyError>;

    /// What the outputs of all tasks, in their order, come to: the same as [`crate::lab::run`].
    ///
    /// # Errors
    /// Those of the study, and [`crate::lab::TaskError`] where they are not its outputs.
    fn merge(&self, outputs: &[Vec<u8>], control: Control<'_>) -> Result<Found, StudyError>;
}

/// A study with the context of its tasks, once that is worked out.
struct Prepared<S: Study> {
    study: S,
    context: OnceLock<S::Context>,
}

/// `study`, ready to run.
pub fn prepared<S: Study<Result: Describe> + Send + 'static>(study: S) -> Box<dyn AnyStudy> {
    Box::new(Prepared {
        study,
        context: OnceLock::new(),
    })
}

impl<S: Study> Prepared<S> {
    fn context(&self, control: Control<'_>) -> Result<&S::Context, S::Error> {
        if let Some(context) = self.context.get() {
            return Ok(context);
        }
        let found = context(&self.study, control)?;
        // Two threads that come at once find the same.
        Ok(self.context.get_or_init(|| found))
    }
}

impl<S: Study<Result: Describe> + Send> AnyStudy for Prepared<S> {
    fn tasks(&self) -> usize {
        self.study.tasks()
    }

    fn work(&self) -> Work {
        self.study.work()
    }

    fn sharing(&self) -> Sharing {
        self.study.sharing()
    }

    fn keeps(&self) -> bool {
        self.study.keeps()
    }

    fn outputs(
        &self,
        tasks: Range<usize>,
        control: Control<'_>,
    ) -> Result<Vec<Vec<u8>>, StudyError> {
        encoded(&self.study, self.context(control)?, tasks, control)
    }

    fn merge(&self, outputs: &[Vec<u8>], control: Control<'_>) -> Result<Found, StudyError> {
        let context = self.context(control)?;
        let outputs = decode(&self.study, context, outputs)?;
        let result = self.study.finish(context, outputs)?;
        Ok(Found {
            finding: result.describe(),
            json: serde_json::to_string_pretty(&result)? + "\n",
            agrees: self.study.agrees(&result),
        })
    }
}
