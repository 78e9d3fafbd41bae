//! What the options of every command ask for, and remarks on standard error.

use std::io::{self, Write};
use std::path::PathBuf;

use crate::scene::{Scene, SceneError};
use crate::store::harmless;

/// What the options of every command ask for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Console<'a> {
    /// Whether no remarks are wanted.
    pub quiet: bool,
    /// Folders in which scenes may read meshes, pictures and materials, besides the folder of their
    /// file.
    pub also_read: &'a [PathBuf],
    /// Other values of keys of the scene that the arguments name.
    pub define: &'a [(String, String)],
}

impl Console<'_> {
    /// A built-in scene by name, or a scene file by path, all of whose albedos are known.
    pub(super) fn load_scene(self, name_or_path: &str) -> Result<Scene, SceneError> {
        let scene = self.load_any_scene(name_or_path)?;
        scene.known().map_err(|refused| SceneError {
            source: name_or_path.to_owned(),
            ..refused
        })
    }

    /// The same whose albedos may be unknown: for what needs none of them.
    pub(super) fn load_any_scene(self, name_or_path: &str) -> Result<Scene, SceneError> {
        self.defined(Scene::load_with(name_or_path, self.also_read)?)
    }

    /// The scene with the values that were given for its keys.
    pub(super) fn defined(self, scene: Scene) -> Result<Scene, SceneError> {
        if self.define.is_empty() {
            return Ok(scene);
        }
        let changes = self.define.iter().map(|(k, v)| (k.as_str(), v.as_str()));
        scene.with(&changes.collect::<Vec<_>>())
    }

    /// The same for scenes that lie in folders of the program's own, as they are there.
    pub(super) fn of_folders(self) -> Self {
        let define = &[];
        Self { define, ..self }
    }

    /// A remark on standard error.
    pub(super) fn say(self, text: impl AsRef<str>) {
        if !self.quiet {
            complain(text.as_ref());
        }
    }

    /// What is suspicious in a scene, once.
    pub(super) fn warn(self, scene: &Scene) {
        for warning in scene.warnings() {
            self.say(format!("warning: {warning}"));
        }
    }
}

/// A line on standard error; that nobody reads it is no error. It may quote a file from
/// anyone: what a terminal would obey is spelled out, and a line is not endless.
pub(super) fn complain(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", harmless(&concise(text)));
}

/// Most characters of a line that is to be read.
const LINE: usize = 1000;

/// The text with the middle of its longest lines left out.
pub(super) fn concise(text: &str) -> String {
    let short = |line: &str| {
        let count = line.chars().count();
        if count <= LINE {
            return line.to_owned();
        }
        let first = line.chars().take(LINE / 2);
        let last = line.chars().skip(count - LINE / 2);
        let left_out = format!(" … ({} characters) … ", count - LINE);
        first.chain(left_out.chars()).chain(last).collect()
    };
    text.split('\n').map(short).collect::<Vec<_>>().join("\n")
}
