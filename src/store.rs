//! Files: read through one door, which opens nothing but regular files ([`read`], [`open`]), and
//! written whole or not at all.
//!
//! A result that took hours must not be half a file because a disk filled up, and an older result
//! must not be gone before the new one is safe. So every output is written under a temporary name
//! in its own folder, flushed to the device, renamed over the final name (one step that a file
//! system does entirely or not at all), and the folder is flushed so that the rename outlives a
//! power cut.

use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::RwLock;

mod digest;
mod error;
mod harmless;
mod lock;
pub mod memory;
mod reading;
mod room;
mod temporary;
mod together;

pub use digest::{digest, digest_of, hex};
pub use error::StoreError;
pub use harmless::{harmless, harmless_json, shell_word, shown_json};
pub use lock::{FolderLock, LockError};
pub use reading::{ReadError, ReadFault, open, read, start};
pub use room::{Room, threads_that_fit};
use temporary::temporary;
pub use temporary::{is_abandoned, machine};
pub use together::write_together;

/// The folder that holds `path`; a bare file name lives in the current one.
fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Whether nothing is where it was looked for: neither the file nor, maybe, its folder.
pub fn is_missing(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory)
}

/// Makes a rename inside `folder` durable. File systems that know no such thing are left alone.
fn flush_folder(folder: &Path) -> io::Result<()> {
    #[cfg(unix)]
    match File::open(folder)?.sync_all() {
        Err(e) if matches!(e.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) => {}
        other => return other,
    }
    Ok(())
}

/// Held by whoever writes a file.
static AT_WORK: RwLock<()> = RwLock::new(());

/// Whether no file is being written at this moment.
pub fn is_at_rest() -> bool {
    AT_WORK.try_write().is_ok()
}

/// When a file is to be safe from a power cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Safe {
    /// When the call returns.
    Now,
    /// After the next [`flush`] of its folder.
    Later,
}

/// Writes the file `path` whole or not at all: `contents` writes into a temporary file of the same
/// folder, which then takes the name `path`, replacing what had it. If anything fails, what `path`
/// held before is untouched and nothing is left behind. A symbolic link at `path` is itself
/// replaced, never written through.
///
/// # Errors
/// [`StoreError`] if the folder is missing or cannot be written, if something other than a file has
/// the name, if the device is full, or if `contents` fails.
pub fn write_whole(
    path: &Path,
    contents: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), StoreError> {
    put(path, Safe::Now, contents, true)
}

/// The same where nothing has the name `path` yet.
///
/// # Errors
/// [`StoreError::Taken`] if something has; and those of [`write_whole`].
pub fn write_new(
    path: &Path,
    contents: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), StoreError> {
    put(path, Safe::Now, contents, false)
}

/// The same for one of many files that can be made again: other processes see it whole or not at
/// all, and a power cut may leave it empty or cut off until its folder is [flushed](flush).
///
/// # Errors
/// Those of [`write_whole`].
pub fn write_soon(
    path: &Path,
    contents: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), StoreError> {
    put(path, Safe::Later, contents, true)
}

/// Makes all files of the folder `dir` safe from a power cut.
///
/// # Errors
/// [`StoreError`] if the system cannot.
pub fn flush(dir: &Path) -> Result<(), StoreError> {
    flush_files(dir).map_err(|e| StoreError::new(dir, e))
}

/// The whole file system at once: for each of thousands of files it would take milliseconds.
#[cfg(target_os = "linux")]
fn flush_files(dir: &Path) -> io::Result<()> {
    Ok(rustix::fs::syncfs(File::open(dir)?)?)
}

#[cfg(not(target_os = "linux"))]
fn flush_files(dir: &Path) -> io::Result<()> {
    for entry in fs::read_dir(dir)? {
        let path = entry?.path();
        if path.is_file() {
            File::open(path)?.sync_all()?;
        }
    }
    flush_folder(dir)
}

/// Bytes of a file.
///
/// # Errors
/// [`ReadError`] if it cannot be read.
pub fn length(path: &Path) -> Result<u64, ReadError> {
    let metadata = open(path)?.metadata();
    Ok(metadata.map_err(|e| ReadError::system(path, e))?.len())
}

fn put(
    path: &Path,
    safe: Safe,
    contents: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    replace: bool,
) -> Result<(), StoreError> {
    let _at_work = AT_WORK.read();
    let obstacle = fs::metadata(path).is_ok_and(|there| !there.is_file());
    if obstacle || path.file_name().is_none() {
        return Err(StoreError::NotAFile {
            path: path.to_path_buf(),
        });
    }
    let folder = folder_of(path);
    let write = || {
        let mut writer = BufWriter::new(temporary(folder)?);
        contents(&mut writer)?;
        let file = writer
            .into_inner()
            .map_err(io::IntoInnerError::into_error)?;
        if safe == Safe::Now {
            file.as_file().sync_all()?;
        }
        if replace {
            file.persist(path).map_err(|e| e.error)?;
        } else {
            file.persist_noclobber(path).map_err(|e| e.error)?;
        }
        if safe == Safe::Now {
            flush_folder(folder)?;
        }
        Ok(())
    };
    write().map_err(|e| StoreError::new(path, e))
}

/// Makes sure, before the long work starts, that files can be written into the folder `dir`:
/// creates it and its parents where they are missing, and writes and removes a temporary file. If
/// that fails, the folders it created are removed.
///
/// # Errors
/// [`StoreError`] if a file stands in the way (it is not touched), or if the folder cannot be
/// created or written.
pub fn ensure_writable(dir: &Path) -> Result<(), StoreError> {
    let mut created = Vec::new();
    let outcome = create_folders(dir, &mut created).and_then(|()| probe(dir));
    if outcome.is_err() {
        for folder in created.iter().rev() {
            let _ = fs::remove_dir(folder); // removes an empty folder only: nobody else's files are at stake
        }
    }
    outcome
}

fn create_folders(dir: &Path, created: &mut Vec<PathBuf>) -> Result<(), StoreError> {
    let mut ancestors: Vec<&Path> = dir
        .ancestors()
        .filter(|a| !a.as_os_str().is_empty())
        .collect();
    ancestors.reverse();
    for folder in ancestors {
        if folder.is_dir() {
            continue;
        }
        match fs::create_dir(folder) {
            Ok(()) => created.push(folder.to_path_buf()),
            Err(_) if folder.is_dir() => {} // somebody else was faster
            Err(e) if e.kind() == ErrorKind::AlreadyExists => {
                return Err(StoreError::NotAFolder {
                    path: folder.to_path_buf(),
                });
            }
            Err(e) => return Err(StoreError::new(folder, e)),
        }
    }
    Ok(())
}

/// Writes one block, so that a full disk shows now, and removes it.
fn probe(dir: &Path) -> Result<(), StoreError> {
    let dir = if dir.as_os_str().is_empty() {
        Path::new(".")
    } else {
        dir
    };
    let write = || {
        let mut file = temporary(dir)?;
        file.write_all(&[0; 4096])?;
        file.as_file().sync_all()?;
        file.close()
    };
    write().map_err(|e| StoreError::new(dir, e))
}

#[cfg(test)]
mod tests;
