//! Options as they would be given again.

use std::fmt;
use std::path::Path;

use crate::cli::process::version;
use crate::report::Invocation;
use crate::scene::Scene;

/// Options with their values, in the order in which they are told; the value of a flag is empty.
#[derive(Debug, Default)]
pub(super) struct Spelled(Vec<(String, String)>);

impl Spelled {
    /// One more.
    pub(super) fn with(mut self, name: &str, value: impl ToString) -> Self {
        self.0.push((name.to_owned(), value.to_string()));
        self
    }

    /// One more, where it has a value.
    pub(super) fn maybe(self, name: &str, value: Option<impl ToString>) -> Self {
        match value {
            Some(value) => self.with(name, value),
            None => self,
        }
    }

    /// A flag, where it is set.
    pub(super) fn flag(self, name: &str, is_set: bool) -> Self {
        self.maybe(name, is_set.then_some(""))
    }

    /// A file, where there is one.
    pub(super) fn file(self, name: &str, path: Option<&Path>) -> Self {
        self.maybe(name, path.map(Path::display))
    }

    /// Two numbers, where they are given, with something `between` them.
    pub(super) fn pair<T: ToString>(
        self,
        name: &str,
        given: Option<[T; 2]>,
        between: &str,
    ) -> Self {
        let words = given.map(|pair| pair.map(|x| x.to_string()).join(between));
        self.maybe(name, words)
    }

    /// Those of a command for the folder `dir`, which holds the scene.
    pub(super) fn of_folder(self, command: &str, dir: &Path, scene: &Scene) -> Invocation {
        let dir = dir.file_name().unwrap_or(dir.as_os_str());
        Invocation {
            command: vec![command.to_owned(), dir.to_string_lossy().into_owned()],
            scene: scene.clone(),
            file: "scene.toml".to_owned(),
            options: self.0,
            version: version().to_owned(),
        }
    }
}

/// On one line, after a command.
impl fmt::Display for Spelled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for word in self.0.iter().flat_map(|(name, value)| [name, value]) {
            if !word.is_empty() {
                write!(f, " {word}")?;
            }
        }
        Ok(())
    }
}
