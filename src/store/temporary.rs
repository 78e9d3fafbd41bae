//! Temporary files, and whose they are.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Duration;
use std::{fs, io};

use super::reading::read;

/// A temporary file in `folder`, readable as any new file would be (a bare temporary file is
/// private to its owner). Its name says whose it is: `.phicam-MACHINE-PROCESS-RANDOM.part`.
pub(super) fn temporary(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    let prefix = prefix();
    builder.prefix(&prefix).suffix(SUFFIX);
    #[cfg(unix)]
    let builder = builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// A folder in `folder`, named as a temporary file is, which goes with what it holds when it is
/// dropped.
pub(super) fn temporary_folder(folder: &Path) -> io::Result<tempfile::TempDir> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix()).suffix(SUFFIX).tempdir_in(folder)
}

/// How names of what this process writes begin.
fn prefix() -> String {
    format!("{PREFIX}{}-{}-", machine(), std::process::id())
}

/// The path without the temporary folders in it: where the file is to be.
pub(super) fn lasting(path: &Path) -> PathBuf {
    let is_temporary = |name: &OsStr| name.to_str().is_some_and(is_temporary);
    path.iter().filter(|name| !is_temporary(name)).collect()
}

fn is_temporary(name: &str) -> bool {
    name.starts_with(PREFIX) && name.ends_with(SUFFIX)
}

pub(super) const PREFIX: &str = ".phicam-";
const SUFFIX: &str = ".part";
/// A temporary file that nobody has written to for so long is nobody's.
pub(super) const FORSAKEN: Duration = Duration::from_secs(3600);

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

/// Whether the file or folder is one that [`write_whole`](super::write_whole) or
/// [`write_together`](super::write_together) was writing when its process ended: by the process's
/// number if it ran on this machine, else by its age.
pub fn is_abandoned(path: &Path) -> bool {
    let name = path.file_name().and_then(|n| n.to_str()).unwrap_or("");
    if !is_temporary(name) {
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
pub(super) fn process_lives(name: &str) -> Option<bool> {
    let mut words = name.strip_prefix(PREFIX)?.split('-');
    let here = words.next().filter(|h| !h.is_empty() && *h == machine());
    let process: u32 = here.and(words.next())?.parse().ok()?;
    Some(Path::new("/proc").join(process.to_string()).exists())
}
