//! Files: read through one door, which opens nothing but regular files ([`read`], [`open`]), and
//! written whole or not at all.
//!
//! A result that took hours must not be half a file because a disk filled up, and an older result
//! must not be gone before the new one is safe. So every output is written under a temporary name
//! in its own folder, flushed to the device, renamed over the final name (one step that a file
//! system does entirely or not at all), and the folder is flushed so that the rename outlives a
//! power cut.

use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{OnceLock, RwLock};
use std::time::Duration;

use sha2::{Digest, Sha256};

mod harmless;
mod lock;
pub mod memory;
mod reading;
mod room;

pub use harmless::{harmless, harmless_json, shown_json};
pub use lock::{FolderLock, LockError};
pub use reading::{ReadError, ReadFault, open, read, start};
pub use room::{Room, threads_that_fit};

/// Why a file or a folder could not be written. Each message names the path, the cause and the
/// cure.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// A file stands where a folder is needed.
    #[error("{} is a file, not a folder; move it away or choose another output folder", path.display())]
    NotAFolder {
        /// What stands in the way.
        path: PathBuf,
    },
    /// A folder, a device or a pipe stands where a file is to be written.
    #[error("cannot write {}: it is there already and is no ordinary file; choose another file name", path.display())]
    NotAFile {
        /// What stands in the way.
        path: PathBuf,
    },
    /// A file is there that is not to be replaced.
    #[error("{} is there already; choose another file name, or replace it (--force)", path.display())]
    Taken {
        /// The file.
        path: PathBuf,
    },
    /// The system refuses.
    #[error("cannot write {}: {why}", path.display())]
    Failed {
        /// What was to be written.
        path: PathBuf,
        /// Cause and cure.
        why: String,
    },
}

impl StoreError {
    fn new(path: &Path, source: io::Error) -> Self {
        let path = path.to_path_buf();
        let why = match source.kind() {
            ErrorKind::NotADirectory => {
                let path = first_file_in(&path);
                return Self::NotAFolder { path };
            }
            ErrorKind::IsADirectory => return Self::NotAFile { path },
            ErrorKind::AlreadyExists => return Self::Taken { path },
            ErrorKind::NotFound => {
                "its folder does not exist; create the folder or choose another output"
            }
            ErrorKind::PermissionDenied => {
                "permission denied; make its folder writable for you or choose another output"
            }
            ErrorKind::ReadOnlyFilesystem => {
                "its file system is read-only; choose an output on a writable one"
            }
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
                "the disk or the quota is full; free some space or choose another output"
            }
            ErrorKind::FileTooLarge => {
                "it is larger than files may be here; raise the limit (`ulimit -f`), or choose an output on another file system"
            }
            _ => &format!("{source}; check the path and its device"),
        };
        let why = why.to_owned();
        Self::Failed { path, why }
    }
}

/// The outermost ancestor of `path` that exists and is no folder, else `path` itself.
fn first_file_in(path: &Path) -> PathBuf {
    let outermost = path
        .ancestors()
        .filter(|a| a.exists() && !a.is_dir())
        .last();
    outermost.unwrap_or(path).to_path_buf()
}

/// The folder that holds `path`; a bare file name lives in the current one.
fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// A temporary file in `folder`, readable as any new file would be (a bare temporary file is
/// private to its owner). Its name says whose it is: `.phicam-MACHINE-PROCESS-RANDOM.part`.
fn temporary(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    let prefix = format!("{PREFIX}{}-{}-", machine(), std::process::id());
    builder.prefix(&prefix).suffix(SUFFIX);
    #[cfg(unix)]
    let builder = builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

const PREFIX: &str = ".phicam-";
const SUFFIX: &str = ".part";
/// A temporary file that nobody has written to for so long is nobody's.
const FORSAKEN: Duration = Duration::from_secs(3600);

/// Where process numbers are those of this process: the machine by its name and its last start, and
/// the namespace of process numbers. Without dashes; empty where it is not known.
pub fn machine() -> &'static str {
    static MACHINE: OnceLock<String> = OnceLock::new();
    MACHINE.get_or_init(found_machine)
}

/// Most bytes of what the system says of itself.
const SYSTEM_TEXT: u64 = 4096;

fn found_machine() -> String {
    let read = |path: &str| {
        let text = read(Path::new(path), SYSTEM_TEXT).unwrap_or_default();
        String::from_utf8(text).unwrap_or_default()
    };
    let (name, start) = (
        read("/proc/sys/kernel/hostname"),
        read("/proc/sys/kernel/random/boot_id"),
    );
    let space = fs::read_link("/proc/self/ns/pid").unwrap_or_default();
    let space: String = space
        .to_string_lossy()
        .chars()
        .filter(char::is_ascii_digit)
        .collect();
    if name.is_empty() || start.is_empty() || space.is_empty() {
        return String::new();
    }
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let name: String = name.trim().chars().map(plain).collect();
    let start: String = start.chars().take(8).map(plain).collect();
    format!("{name}_{start}_{space}")
}

/// Whether nothing is where it was looked for: neither the file nor, maybe, its folder.
pub fn is_missing(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory)
}

/// Whether the file is one that [`write_whole`] was writing when its process ended: by the
/// process's number if it ran on this machine, else by its age.
pub fn is_abandoned(path: &Path) -> bool {
    let name = path.file_name().and_then(|n| n.to_str()).unwrap_or("");
    if !name.starts_with(PREFIX) || !name.ends_with(SUFFIX) {
        return false;
    }
    if let Some(lives) = process_lives(name) {
        return !lives;
    }
    let modified = fs::metadata(path).and_then(|m| m.modified());
    modified.is_ok_and(|m| m.elapsed().is_ok_and(|age| age > FORSAKEN))
}

/// Whether the process lives whose temporary file or lock has this name; `None` if it did not run
/// on this machine, or nobody knows.
fn process_lives(name: &str) -> Option<bool> {
    let mut words = name.strip_prefix(PREFIX)?.split('-');
    let here = words.next().filter(|h| !h.is_empty() && *h == machine());
    let process: u32 = here.and(words.next())?.parse().ok()?;
    Some(Path::new("/proc").join(process.to_string()).exists())
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

/// SHA-256 of a file, in hexadecimal digits.
///
/// # Errors
/// [`ReadError`] if it cannot be read.
pub fn digest(path: &Path) -> Result<String, ReadError> {
    let mut file = open(path)?;
    let mut digest = Sha256::new();
    let mut stretch = vec![0; 1 << 16];
    loop {
        match file.read(&mut stretch) {
            Ok(0) => return Ok(hex(&digest.finalize())),
            Ok(n) => digest.update(&stretch[..n]),
            Err(e) => return Err(ReadError::system(path, e)),
        }
    }
}

/// SHA-256 of these bytes, in hexadecimal digits.
pub fn digest_of(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Hexadecimal digits of a digest.
pub fn hex(digest: &[u8]) -> String {
    digest.iter().map(|b| format!("{b:02x}")).collect()
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
