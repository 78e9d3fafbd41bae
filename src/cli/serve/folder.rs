//! The folder that is served: the only door of the crates `cap_std` and `cap_fs_ext`, which open
//! what is below a folder and nothing else.

use std::fs::File;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use cap_fs_ext::OpenOptionsSyncExt;
use cap_std::ambient_authority;
use cap_std::fs::{Dir, OpenOptions};

use super::answer::Refusal;

/// Longest path that is looked for, bytes.
const PATH_MAX: usize = 4096;

/// ELOOP, what Unix says of a link that leads to itself.
const LINK_LOOP: i32 = if cfg!(any(target_os = "linux", target_os = "android")) {
    40
} else {
    62
};

/// A folder, by its absolute path: opened again for every request, so that one made anew is served
/// too.
#[derive(Debug)]
pub(super) struct Served {
    path: PathBuf,
}

/// A file that is open for reading.
#[derive(Debug)]
pub(super) struct Found {
    pub file: File,
    /// Bytes.
    pub length: u64,
}

impl Served {
    pub(super) fn at(path: &Path) -> io::Result<Self> {
        let served = Self {
            path: std::path::absolute(path)?,
        };
        served.dir()?;
        Ok(served)
    }

    /// Where it is.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    fn dir(&self) -> io::Result<Dir> {
        Dir::open_ambient_dir(&self.path, ambient_authority())
    }

    /// Opens the regular file `name`, a relative path with forward slashes. Every step of the way
    /// is taken below the folder, links included, by the system itself or on handles: what is
    /// swapped for a link meanwhile cannot lead out either. A pipe is not waited for.
    ///
    /// # Errors
    /// 404 for what is not there, is no regular file, is hidden or unfinished, or lies outside; 500
    /// for what the system cannot read.
    pub(super) fn open(&self, name: &str) -> Result<Found, Refusal> {
        if name.len() > PATH_MAX || !name.split('/').all(is_plain) {
            return Err(Refusal::not_found(name));
        }
        let mut options = OpenOptions::new();
        options.read(true).nonblock(true);
        let opened = self
            .dir()
            .and_then(|dir| dir.open_with(name, &options))
            .and_then(|file| Ok((file.metadata()?, file)));
        match opened {
            Ok((metadata, file)) if metadata.is_file() => Ok(Found {
                file: file.into_std(),
                length: metadata.len(),
            }),
            Ok(_) => Err(Refusal::not_found(name)),
            Err(e) if is_absence(&e) => Err(Refusal::not_found(name)),
            Err(e) => Err(Refusal::broken(format!("cannot read {name}: {e}"))),
        }
    }

    /// Whether [`open`](Self::open) would find it.
    pub(super) fn has(&self, name: &str) -> bool {
        self.open(name).is_ok()
    }
}

/// Whether `segment` may be a step of a path: not empty, not hidden (nor `.` and `..`), not the
/// unfinished file of a writer, without what has a meaning to some system.
fn is_plain(segment: &str) -> bool {
    let meaning =
        |c: char| c == '\\' || c.is_control() || (cfg!(windows) && ":<>\"|?*".contains(c));
    !segment.is_empty()
        && !segment.starts_with('.')
        && !segment.ends_with(".part")
        && !segment.contains(meaning)
}

/// Not there, or not to be told from that: a way that leads out of the folder is refused as a lack
/// of permission.
fn is_absence(error: &io::Error) -> bool {
    use ErrorKind::{
        InvalidFilename, InvalidInput, IsADirectory, NotADirectory, NotFound, PermissionDenied,
    };
    let absent = [
        NotFound,
        NotADirectory,
        IsADirectory,
        PermissionDenied,
        InvalidInput,
        InvalidFilename,
    ];
    absent.contains(&error.kind()) || cfg!(unix) && error.raw_os_error() == Some(LINK_LOOP)
}
