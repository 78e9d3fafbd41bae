//! Results on standard output, and files.

use std::io::{self, IsTerminal, Write};
use std::path::Path;

use serde::Serialize;

use super::failure::Failure;
use crate::report::{harmless, harmless_json};
use crate::store::write_whole;

/// A result on standard output, for people: names in it may be anyone's, and what a terminal would
/// obey in them is spelled out.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    draw(&harmless(text))
}

/// What a terminal or a shell is to obey, on standard output: a drawing, a script. A reader that
/// has gone away (`| head`) is no error.
pub(super) fn draw(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => Err(unwritten(&e)),
        _ => Ok(()),
    }
}

/// That a result could not be written to standard output.
pub(super) fn unwritten(error: &io::Error) -> Failure {
    let cure = match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "free some space there, or send the output somewhere else"
        }
        _ => "send the output somewhere else",
    };
    Failure::system(format!("cannot write to standard output: {error}"), cure)
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
        None if io::stdout().is_terminal() => print(text),
        // A copy, to the byte.
        None => draw(text),
        Some(path) => write(path, text),
    }
}

/// Writes a file, whole or not at all.
pub(super) fn write(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), Failure> {
    Ok(write_whole(path, |file| file.write_all(bytes.as_ref()))?)
}

/// A value as pretty JSON with a final newline.
pub(super) fn json(value: &impl Serialize) -> Result<String, Failure> {
    Ok(harmless_json(&serde_json::to_string_pretty(value)?) + "\n")
}
