//! One writer a folder, told to the others by files that the writers hold locked.
//!
//! A writer holds `.phicam-MACHINE-PROCESS-FROM-TO.lock` in the folder under an advisory lock of
//! the operating system (`flock`), which ends with its process, however that ends. FROM to TO are
//! the parts of the folder that it writes (spots of a render); disjoint parts may be written side
//! by side. Who looks for others, or changes what all of them share, does so alone, under a lock on
//! `.phicam.lock`. Where a file system knows no locks, a writer counts as gone when its process on
//! this machine is; of one on another machine the user has to tell.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

use super::temporary::{PREFIX, machine, process_lives};
use super::{StoreError, is_missing};

/// What the name of a writer's file ends in.
const SUFFIX: &str = ".lock";
/// The file of those that look.
const GATE: &str = ".phicam.lock";
/// So often one asks while another changes what all share, for five minutes: it may write large
/// matrices meanwhile.
const TRIES: usize = 30_000;
const BETWEEN: Duration = Duration::from_millis(10);
/// Bytes that a writer says of itself at most.
const LONGEST: u64 = 1 << 10;

/// Why a folder cannot be written now.
#[derive(Debug, thiserror::Error)]
pub enum LockError {
    /// Another process writes what was asked for.
    #[error("{} is being written: {who}; wait for it to end, or choose another folder", path.display())]
    Busy {
        /// The folder.
        path: PathBuf,
        /// What the other process says of itself.
        who: String,
    },
    /// The lock itself cannot be written.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// The right to write some parts of a folder, until it is dropped.
#[derive(Debug)]
pub struct FolderLock {
    folder: PathBuf,
    own: PathBuf,
    _held: File,
}

impl FolderLock {
    /// The right to write the parts `parts` of `folder`, which exists; all of it: 0..[`u64::MAX`].
    /// `what` says to others what is being done. `first` is called alone, before anybody else may
    /// look.
    ///
    /// # Errors
    /// [`LockError`] if a living process writes any of them, or the folder cannot be written; and
    /// what `first` refuses.
    pub fn take<T, E: From<LockError>>(
        folder: &Path,
        parts: &Range<u64>,
        what: &str,
        first: impl FnOnce() -> Result<T, E>,
    ) -> Result<(Self, T), E> {
        let _gate = Gate::pass(folder)?;
        refuse_others(folder, parts)?;
        let lock = Self::write(folder, parts, what).map_err(|e| {
            let error = StoreError::new(folder, e);
            LockError::from(error)
        })?;
        Ok((lock, first()?))
    }

    fn write(folder: &Path, parts: &Range<u64>, what: &str) -> io::Result<Self> {
        let Range { start, end } = parts;
        let (machine, process) = (machine(), std::process::id());
        let name = format!("{PREFIX}{machine}-{process}-{start}-{end}{SUFFIX}");
        let own = folder.join(name);
        let mut file = File::create(&own)?;
        held(file.try_lock())?;
        let host = machine.split('_').next().unwrap_or_default();
        let place = if host.is_empty() { "" } else { " on " };
        write!(file, "{what}, process {process}{place}{host}")?;
        file.flush()?;
        Ok(Self {
            folder: folder.to_owned(),
            own,
            _held: file,
        })
    }

    /// Calls `change` while no other process looks at the folder or changes what all writers share.
    ///
    /// # Errors
    /// [`LockError`] if another does so for minutes; and those of `change`.
    pub fn alone<T, E: From<LockError>>(
        &self,
        change: impl FnOnce() -> Result<T, E>,
    ) -> Result<T, E> {
        let _gate = Gate::pass(&self.folder)?;
        change()
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.own);
    }
}

/// A lock that a file system does not know is no obstacle. Whether it is held.
fn held(outcome: Result<(), TryLockError>) -> io::Result<bool> {
    match outcome {
        Ok(()) => Ok(true),
        Err(TryLockError::WouldBlock) => Ok(false),
        Err(TryLockError::Error(_)) => Ok(true),
    }
}

/// The lock of those that look, for as long as it lives.
struct Gate {
    path: PathBuf,
    _held: File,
}

impl Gate {
    fn pass(folder: &Path) -> Result<Self, LockError> {
        let path = folder.join(GATE);
        for _ in 0..TRIES {
            let file = open(&path).map_err(|e| StoreError::new(&path, e))?;
            let mine = held(file.try_lock()).map_err(|e| StoreError::new(&path, e))?;
            // Who held it before has removed it: the lock on a file without a name keeps nobody
            // out.
            if mine && is_at(&file, &path) {
                return Ok(Self { path, _held: file });
            }
            sleep(BETWEEN);
        }
        Err(LockError::Busy {
            path: folder.to_owned(),
            who: "another process has been finishing there for minutes".to_owned(),
        })
    }
}

impl Drop for Gate {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
    }
}

fn open(path: &Path) -> io::Result<File> {
    // Before it is opened: opening a pipe waits for somebody at its other end.
    if fs::metadata(path).is_ok_and(|there| !there.is_file()) {
        return Err(io::Error::from(io::ErrorKind::IsADirectory));
    }
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(false);
    options.open(path)
}

/// Whether the open file is the one that has the name `path`.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let id = |m: fs::Metadata| (m.dev(), m.ino());
    let (own, named) = (file.metadata().map(id), fs::metadata(path).map(id));
    matches!((own, named), (Ok(own), Ok(named)) if own == named)
}

#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> bool {
    path.exists()
}

/// The parts in the name of a writer's file.
fn parts_of(path: &Path) -> Option<Range<u64>> {
    let name = path.file_name()?.to_str()?;
    let own = name.strip_prefix(PREFIX)?.strip_suffix(SUFFIX)?;
    let mut numbers = own.rsplit('-').map(str::parse);
    let (end, start) = (numbers.next()?.ok()?, numbers.next()?.ok()?);
    Some(start..end)
}

/// Refuses where a living process writes any of `parts`; removes the files of those that are gone.
fn refuse_others(folder: &Path, parts: &Range<u64>) -> Result<(), LockError> {
    let list = fs::read_dir(folder).map_err(|e| StoreError::new(folder, e))?;
    for path in list.filter_map(Result::ok).map(|entry| entry.path()) {
        let Some(theirs) = parts_of(&path) else {
            continue;
        };
        let overlap = theirs.start < parts.end && parts.start < theirs.end;
        match writer(&path).map_err(|e| StoreError::new(&path, e))? {
            None => {
                let _ = fs::remove_file(&path);
            }
            Some(who) if overlap => {
                return Err(LockError::Busy {
                    path: folder.to_owned(),
                    who,
                });
            }
            Some(_) => {}
        }
    }
    Ok(())
}

/// What the process that holds `path` says of itself; `None` if it is gone.
fn writer(path: &Path) -> io::Result<Option<String>> {
    let mut file = match open(path) {
        Err(e) if is_missing(&e) => return Ok(None),
        other => other?,
    };
    let locks = match file.try_lock() {
        Ok(()) => return Ok(None),
        Err(TryLockError::WouldBlock) => true,
        Err(TryLockError::Error(_)) => false,
    };
    let name = path.file_name().and_then(|n| n.to_str()).unwrap_or("");
    if !locks && process_lives(name) == Some(false) {
        return Ok(None);
    }
    let mut who = String::new();
    let _ = (&mut file).take(LONGEST).read_to_string(&mut who);
    if who.is_empty() {
        who = "by a process that began just now".to_owned();
    }
    if !locks {
        who = format!("{who} (if it has ended, remove {})", path.display());
    }
    Ok(Some(who))
}

#[cfg(test)]
mod tests;
