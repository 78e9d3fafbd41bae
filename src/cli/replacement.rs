//! What takes the place of a finished result: written in a folder beside it, moved to its place
//! once it is whole.

use std::fs;
use std::path::Path;

use crate::cli::failure::Failure;
use crate::store::{ensure_writable, flush, is_missing};

/// Moves what is in the folder `incoming` to its place in `dir`: what the folders `folders` hold,
/// then `files`, the last of which says that all are there.
pub(super) fn move_in(
    incoming: &Path,
    dir: &Path,
    folders: &[&str],
    files: &[&str],
) -> Result<(), Failure> {
    for folder in folders {
        let (from, to) = (incoming.join(folder), dir.join(folder));
        let Ok(entries) = fs::read_dir(&from) else {
            continue;
        };
        ensure_writable(&to)?;
        for entry in entries {
            let name = entry?.file_name();
            fs::rename(from.join(&name), to.join(&name))?;
        }
    }
    for name in files {
        match fs::rename(incoming.join(name), dir.join(name)) {
            Err(e) if !is_missing(&e) => return Err(e.into()),
            _ => {}
        }
    }
    flush(dir)?;
    remove_folder(incoming)
}

/// Removes a folder of phicam's own with all that is in it, if it is there.
pub(super) fn remove_folder(path: &Path) -> Result<(), Failure> {
    match fs::remove_dir_all(path) {
        Err(e) if !is_missing(&e) => {
            let cause = format!("cannot remove {}: {e}", path.display());
            Err(Failure::system(cause, "make its folder writable for you"))
        }
        _ => Ok(()),
    }
}
