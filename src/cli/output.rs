//! Results on standard output, and files.

use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::cli::failure::Failure;
use crate::folder::Record;
use crate::store::{self, StoreError, write_whole};
use crate::store::{harmless, harmless_json};

/// What names of pictures and meshes end in.
const PICTURES: [&str; 13] = [
    "svg", "png", "jpg", "jpeg", "tif", "tiff", "exr", "pdf", "ply", "obj", "stl", "gltf", "glb",
];

/// A result on standard output, for people: names in it may be anyone's, and what a terminal would
/// obey in them is spelled out.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    draw(&harmless(text))
}

/// What a terminal or a shell is to obey, on standard output: a drawing, a script.
pub(super) fn draw(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    printed(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// How printing ended: a reader that has gone away is no error.
pub(super) fn printed(ended: io::Result<()>) -> Result<(), Failure> {
    match ended {
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

/// Writes text to a file, or prints it. A file that is there is replaced if `force`.
pub(super) fn deliver(text: &str, file: Option<&Path>, force: bool) -> Result<(), Failure> {
    match file {
        None if io::stdout().is_terminal() => print(text),
        // A copy, to the byte.
        None => draw(text),
        Some(path) => write_new(path, text, force),
    }
}

/// Refuses a file that is there, unless `force`: before the work, not after it.
pub(super) fn refuse_taken(path: &Path, force: bool) -> Result<(), Failure> {
    let path = path.to_owned();
    if force || std::fs::symlink_metadata(&path).is_err() {
        return Ok(());
    }
    Err(StoreError::Taken { path }.into())
}

/// The folder of a run is none for other results: they have files of the same names.
pub(super) fn refuse_run(path: &Path) -> Result<(), Failure> {
    if !path.join(Record::FILE).exists() {
        return Ok(());
    }
    let path = path.display();
    let cause = format!("{path} is the folder of a run, with its own light, scene and report");
    Err(Failure::new(cause, "choose another folder (-o)"))
}

/// Refuses a name that ends as that of another kind of picture or mesh than is written: programs go
/// by it.
pub(super) fn refuse_other_kind(path: &Path, kind: &str) -> Result<(), Failure> {
    let extension = path.extension().and_then(|e| e.to_str());
    let extension = extension.unwrap_or_default().to_ascii_lowercase();
    if extension == kind || !PICTURES.contains(&&extension[..]) {
        return Ok(());
    }
    Err(Failure::new(
        format!(
            "{} would be named .{extension} and be {kind}",
            path.display()
        ),
        format!("name it {}", path.with_extension(kind).display()),
    ))
}

/// Writes a file, whole or not at all; one that is there is replaced if `force`.
pub(super) fn write_new(path: &Path, bytes: impl AsRef<[u8]>, force: bool) -> Result<(), Failure> {
    if force {
        return write(path, bytes);
    }
    Ok(store::write_new(path, |file| {
        file.write_all(bytes.as_ref())
    })?)
}

/// Writes a file, whole or not at all.
pub(super) fn write(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), Failure> {
    Ok(write_whole(path, |file| file.write_all(bytes.as_ref()))?)
}

/// A value as pretty JSON with a final newline.
pub(super) fn json(value: &impl Serialize) -> Result<String, Failure> {
    Ok(harmless_json(&serde_json::to_string_pretty(value)?) + "\n")
}

/// Refuses what stands in `dir` where `folders` and `files` have to stand: before the long work,
/// not after it.
pub(super) fn refuse_obstacles(
    dir: &Path,
    folders: &[&str],
    files: &[&str],
) -> Result<(), Failure> {
    let paths = |names: &[&str]| -> Vec<PathBuf> { names.iter().map(|n| dir.join(n)).collect() };
    if let Some(path) = paths(folders)
        .into_iter()
        .find(|p| p.exists() && !p.is_dir())
    {
        return Err(StoreError::NotAFolder { path }.into());
    }
    if let Some(path) = paths(files)
        .into_iter()
        .find(|p| p.exists() && !p.is_file())
    {
        return Err(StoreError::NotAFile { path }.into());
    }
    Ok(())
}
