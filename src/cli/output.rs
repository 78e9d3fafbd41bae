//! Standard output and standard error.

use std::io::{self, Write};
use std::path::Path;

use super::failure::Failure;
use crate::scene::Scene;
use crate::store::write_whole;

/// Whether remarks are wanted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Talk {
    pub quiet: bool,
}

impl Talk {
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

/// A line on standard error. That nobody reads it is no reason to stop. It may quote a file from anyone: control characters, which a terminal
/// would obey, are shown as such.
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

/// Writes text to a file, or prints it.
pub(super) fn deliver(text: &str, file: Option<&Path>) -> Result<(), Failure> {
    match file {
        None => print(text),
        Some(path) => Ok(write_whole(path, |w| w.write_all(text.as_bytes()))?),
    }
}

/// A value as pretty JSON with a final newline.
pub(super) fn json(value: &impl serde::Serialize) -> Result<String, Failure> {
    Ok(serde_json::to_string_pretty(value)? + "\n")
}
