//! Files of one result, which take the place of an older one's together.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use super::temporary::temporary_folder;
use super::{AT_WORK, StoreError, ensure_writable, flush_folder, folder_of, is_missing};

/// Writes the files of one result into the folder `dir`: `fill` writes them into an empty folder
/// in it and returns the names of those in `dir` that the result has not; these are then removed,
/// and all that was written is moved to its place. If anything fails before, what `dir` holds is
/// untouched and nothing is left behind. Folders that `fill` makes keep what they hold besides.
///
/// # Errors
/// [`StoreError`] if `dir` cannot be written, or if something other than a file has the name of
/// one; and what `fill` fails with.
pub fn write_together<E: From<StoreError>>(
    dir: &Path,
    fill: impl FnOnce(&Path) -> Result<Vec<String>, E>,
) -> Result<(), E> {
    ensure_writable(dir)?;
    let staged = temporary_folder(dir).map_err(|e| StoreError::new(dir, e))?;
    let stale = fill(staged.path())?;
    let files = files_of(staged.path(), Path::new(""))?;
    let mut folders = BTreeSet::new();
    for file in &files {
        let path = dir.join(file);
        if fs::metadata(&path).is_ok_and(|there| !there.is_file()) {
            return Err(StoreError::NotAFile { path }.into());
        }
        folders.insert(folder_of(&path).to_owned());
    }
    for folder in folders.iter().filter(|folder| *folder != dir) {
        ensure_writable(folder)?;
    }
    let _at_work = AT_WORK.read();
    for name in stale {
        let path = dir.join(name);
        match fs::remove_file(&path) {
            Err(e) if !is_missing(&e) => return Err(StoreError::new(&path, e).into()),
            _ => {}
        }
    }
    for file in &files {
        let path = dir.join(file);
        fs::rename(staged.path().join(file), &path).map_err(|e| StoreError::new(&path, e))?;
    }
    for folder in &folders {
        flush_folder(folder).map_err(|e| StoreError::new(folder, e))?;
    }
    Ok(())
}

/// The files in `dir` and its folders, by their paths from it, in the order of their names.
fn files_of(dir: &Path, within: &Path) -> Result<Vec<PathBuf>, StoreError> {
    let failed = |e| StoreError::new(dir, e);
    let entries = fs::read_dir(dir).map_err(failed)?;
    let entries = entries.collect::<Result<Vec<_>, _>>().map_err(failed)?;
    let mut files = Vec::new();
    for entry in entries {
        let name = within.join(entry.file_name());
        if entry.path().is_dir() {
            files.extend(files_of(&entry.path(), &name)?);
        } else {
            files.push(name);
        }
    }
    files.sort();
    Ok(files)
}
