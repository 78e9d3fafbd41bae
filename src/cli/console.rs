//! What the options of every command ask for, and remarks on standard error.

use std::io::{self, Write};
use std::path::PathBuf;

use crate::scene::{Scene, SceneError};

/// What the options of every command ask for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Console<'a> {
    /// Whether no remarks are wanted.
    pub quiet: bool,
    /// Folders in which scenes may read meshes, pictures and materials, besides the folder of their
    /// file.
    pub also_read: &'a [PathBuf],
}

impl Console<'_> {
    /// A built-in scene by name, or a scene file by path.
    pub(super) fn load_scene(self, name_or_path: &str) -> Result<Scene, SceneError> {
        Scene::load_with(name_or_path, self.also_read)
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
/// anyone: control characters, which a terminal would obey, are shown as such.
pub(super) fn complain(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", harmless(text));
}

/// The text with its control characters, but line feeds and tabs, spelled out.
pub(super) fn harmless(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\n' | '\t' => out.push(c),
            c if c.is_control() => out.extend(c.escape_unicode()),
            c => out.push(c),
        }
    }
    out
}
