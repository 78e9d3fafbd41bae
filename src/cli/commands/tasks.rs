//! Commands whose work is independent tasks: `study …` and `reproduce`.

use std::ops::Range;
use std::path::Path;

use crate::cli::console::Console;
use crate::cli::failure::{Failure, Outcome};
use crate::cli::process::version;
use crate::cli::progress;
use crate::jobs::{Checkpoint, Identity, Parts, compute_tasks, end};
use crate::lab::{LAYOUT, Sharing, Work};
use crate::scene::Scene;
use crate::transport::{Control, NUMERICS};

/// The tasks of a command. Every process that has the same command and the same scene has the same
/// tasks.
pub(super) trait Tasks: Sync {
    /// How many there are.
    fn count(&self) -> usize;

    /// How much there is to do, in the unit in which they report progress.
    fn work(&self) -> Work {
        Work::Tasks(self.count() as u64)
    }

    /// How they share the threads of a process.
    fn sharing(&self) -> Sharing {
        Sharing::SideBySide
    }

    /// The outputs of some tasks as bytes, in the order of their numbers, on the threads of the
    /// pool.
    fn run(&self, tasks: Range<usize>, control: Control<'_>) -> Result<Vec<Vec<u8>>, Failure>;

    /// Makes of the outputs of all tasks, in their order, the files that the command itself would
    /// leave in `folder`, and prints what it would print.
    fn deliver(&self, outputs: &[Vec<u8>], folder: &Path) -> Result<Outcome, Failure>;
}

/// What a command asks for, of which scene; `words` are what it says.
pub(super) fn request(
    scene: Option<&Scene>,
    words: impl IntoIterator<Item = (String, String)>,
) -> Identity {
    let none = "none".to_owned();
    let scene = scene.map(|s| {
        // Of the sensor and the known answers the scene's digest says nothing; a study may use
        // them.
        let text = Identity::default().with("text", &s.text).id();
        [s.name.clone(), s.hash.clone(), text.to_string()]
    });
    let [name, hash, text] = scene.unwrap_or([(); 3].map(|()| none.clone()));
    let scene = Identity::default()
        .with("work", "command")
        .with("scene", name)
        .with("scene's digest", hash)
        .with("scene's text", text);
    let words = words.into_iter();
    words.fold(scene, |all, (name, value)| all.with(&name, value))
}

/// All that so many tasks of a command depend on, which asks for `request`.
pub(super) fn identity(request: Identity, tasks: usize) -> Identity {
    request
        .with("tasks", tasks)
        .with("program", version())
        .with("layout of tasks", LAYOUT)
        .with(Identity::NUMERICS, NUMERICS)
}

/// Computes the tasks `range` of `tasks`, of which `done` has the first, on the threads of the
/// pool, with a bar. What comes back is shorter if it was stopped, and is then in `checkpoint`.
pub(super) fn compute(
    tasks: &dyn Tasks,
    what: &str,
    range: &Range<u64>,
    done: Parts,
    checkpoint: &mut Checkpoint,
    console: Console,
) -> Result<Parts, Failure> {
    // Tasks of an earlier process say nothing of how fast this one is.
    let left = range.end - end(&done, range);
    let work = tasks.work().share(left, tasks.count() as u64);
    let least = match tasks.sharing() {
        Sharing::SideBySide => checkpoint.process.threads as u64,
        Sharing::InTurn => 1,
    };
    progress::run(console, what, work, |control| {
        let run = |range| tasks.run(range, control);
        compute_tasks(range, done, checkpoint, control, least, &run)
    })
}
