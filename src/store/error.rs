//! Why something cannot be written.

use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use super::temporary::lasting;

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
    pub(super) fn new(path: &Path, source: io::Error) -> Self {
        let path = lasting(path);
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
