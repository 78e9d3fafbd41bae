//! Standard output and standard error.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::failure::Failure;
use crate::scene::{Scene, SceneError};
use crate::store::write_whole;

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

/// A result on standard output. A reader that has gone away (`| head`) is no error.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => Err(e.into()),
        _ => Ok(()),
    }
}

/// A result on standard output: `text`, or with `as_json` the value.
pub(super) fn result(
    as_json: bool,
    value: &impl Serialize,
    text: impl FnOnce() -> String,
) -> Result<(), Failure> {
    print(&if as_json { json(value)? } else { text() })
}

/// Writes text to a file, or prints it.
pub(super) fn deliver(text: &str, file: Option<&Path>) -> Result<(), Failure> {
    match file {
        None => print(text),
        Some(path) => write(path, text),
    }
}

/// Writes a file, whole or not at all.
pub(super) fn write(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), Failure> {
    Ok(write_whole(path, |file| file.write_all(bytes.as_ref()))?)
}

/// A value as pretty JSON with a final newline.
pub(super) fn json(value: &impl Serialize) -> Result<String, Failure> {
    Ok(serde_json::to_string_pretty(value)? + "\n")
}
