//! Files of an earlier run that a new one makes worthless. Only what has a name of ours is removed.

use std::ffi::OsStr;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::Path;

use crate::cli::failure::Failure;
use crate::store::{is_abandoned, is_missing};

/// Removes the spot-NNNN files of `dir` with the given extension, and `dir` if that empties it.
pub(super) fn remove_numbered(dir: &Path, extension: &str) -> Result<(), Failure> {
    remove_files(dir, |name| {
        let (stem, ext) = name.rsplit_once('.').unwrap_or((name, ""));
        let number = stem.strip_prefix("spot-").unwrap_or("");
        ext == extension && !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit())
    })?;
    // Anything else in it is not ours, and keeps it.
    let _ = fs::remove_dir(dir);
    Ok(())
}

/// Removes the files of `dir` with these names, where they are there.
pub(super) fn remove_named(dir: &Path, names: &[&str]) -> Result<(), Failure> {
    for name in names {
        let path = dir.join(name);
        match fs::remove_file(&path) {
            Err(e) if !is_missing(&e) => return Err(irremovable(&path, &e)),
            _ => {}
        }
    }
    Ok(())
}

/// Removes the files of `dir` that are `ours` by name, and what a killed process was writing there.
pub(super) fn remove_files(dir: &Path, ours: impl Fn(&str) -> bool) -> Result<(), Failure> {
    let Ok(entries) = fs::read_dir(dir) else {
        return Ok(());
    };
    for path in entries.filter_map(Result::ok).map(|e| e.path()) {
        let name = path.file_name().and_then(OsStr::to_str).unwrap_or("");
        let is_abandoned = is_abandoned(&path);
        if !is_abandoned && !ours(name) {
            continue;
        }
        let removed = if is_abandoned && path.is_dir() {
            fs::remove_dir_all(&path)
        } else {
            fs::remove_file(&path)
        };
        match removed {
            // Another process was faster.
            Err(e) if e.kind() == ErrorKind::NotFound => {}
            other => other.map_err(|e| irremovable(&path, &e))?,
        }
    }
    Ok(())
}

fn irremovable(path: &Path, error: &io::Error) -> Failure {
    let cause = format!("cannot remove {}: {error}", path.display());
    let cure = "make its folder writable for you, and move it away if it is no file";
    Failure::system(cause, cure)
}

/// Removes from `dir` what killed processes were writing there.
pub(super) fn remove_abandoned(dir: &Path) -> Result<(), Failure> {
    remove_files(dir, |_| false)
}
