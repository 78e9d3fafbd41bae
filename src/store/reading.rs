//! The door through which files are read: regular files only, without waiting, no more of them than
//! their kind may hold.
//!
//! A folder comes from anyone. Opening a named pipe waits for somebody to write, a device never
//! ends, and a file of 3 GB under the name of a small one would take as much memory. So what is
//! behind a name is looked at before it is opened, opened without blocking, and looked at again
//! once it is open (it may have been exchanged); and its length is held against the bound of its
//! kind before memory is taken.

use std::fs::{self, File, FileType};
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

#[cfg(unix)]
use rustix::fs::OFlags;

/// Why a file cannot be read: the path, the cause and the cure.
#[derive(Debug, thiserror::Error)]
#[error("cannot read {}: {fault}; {}", path.display(), fault.cure())]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    #[source]
    pub fault: ReadFault,
}

/// What keeps a file from being read.
#[derive(Debug, thiserror::Error)]
pub enum ReadFault {
    /// A folder, a named pipe, a socket or a device, by its name in words.
    #[error("it is a {0}, no ordinary file")]
    NotAFile(&'static str),
    /// More bytes than any file of its kind.
    #[error("it has {length} bytes, and files of its kind at most {most}")]
    TooLarge {
        /// Its bytes.
        length: u64,
        /// Most bytes of its kind.
        most: u64,
    },
    /// The system refuses.
    #[error("{0}")]
    System(#[source] io::Error),
}

impl ReadFault {
    /// What to do about it.
    pub fn cure(&self) -> &'static str {
        match self {
            Self::NotAFile(_) => "move it away, or give an ordinary file",
            Self::TooLarge { .. } => "move it away, or give the file that was meant",
            Self::System(_) => "check that the file exists and that you may read it",
        }
    }
}

impl ReadError {
    /// What the system said of `path`.
    pub fn system(path: &Path, source: io::Error) -> Self {
        let fault = ReadFault::System(source);
        Self::of(path, fault)
    }

    fn of(path: &Path, fault: ReadFault) -> Self {
        let path = path.to_owned();
        Self { path, fault }
    }

    /// Whether this user may not read it.
    pub fn is_denied(&self) -> bool {
        matches!(&self.fault, ReadFault::System(e) if e.kind() == ErrorKind::PermissionDenied)
    }

    /// Whether nothing is where it was looked for: neither the file nor, maybe, its folder.
    pub fn is_missing(&self) -> bool {
        matches!(&self.fault, ReadFault::System(e) if super::is_missing(e))
    }
}

/// Opens the regular file `path`, links followed, without waiting for anybody.
///
/// # Errors
/// [`ReadError`] if it is not there, cannot be read, or is no regular file.
pub fn open(path: &Path) -> Result<File, ReadError> {
    let system = |source| ReadError::system(path, source);
    let regular = |kind: FileType| match other_than_file(kind) {
        Some(what) => Err(ReadError::of(path, ReadFault::NotAFile(what))),
        None => Ok(()),
    };
    // Before it is opened: opening a device may set it to work.
    let there = fs::metadata(path).map_err(|e| system(dangling(path, e)))?;
    regular(there.file_type())?;
    let mut options = File::options();
    options.read(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(
        &mut options,
        (OFlags::NONBLOCK | OFlags::NOCTTY).bits() as i32,
    );
    let file = options.open(path).map_err(system)?;
    regular(file.metadata().map_err(system)?.file_type())?;
    Ok(file)
}

/// The bytes of the regular file `path`, at most `most` of them.
///
/// # Errors
/// [`ReadError`] as of [`open`], or if it is longer.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>, ReadError> {
    let system = |source| ReadError::system(path, source);
    let file = open(path)?;
    let refuse_larger = |length| {
        let fault = ReadFault::TooLarge { length, most };
        (length <= most)
            .then_some(())
            .ok_or(ReadError::of(path, fault))
    };
    let length = file.metadata().map_err(system)?.len();
    refuse_larger(length)?;
    let mut bytes = Vec::new();
    bytes
        .try_reserve_exact(length as usize)
        .map_err(|e| system(e.into()))?;
    // What grows meanwhile, or says nothing of its length (`/proc`), is cut off behind the bound.
    file.take(most.saturating_add(1))
        .read_to_end(&mut bytes)
        .map_err(system)?;
    refuse_larger(bytes.len() as u64)?;
    Ok(bytes)
}

/// The first `most` bytes of the regular file `path`, or all of them if they are fewer.
///
/// # Errors
/// [`ReadError`] as of [`open`].
pub fn start(path: &Path, most: u64) -> Result<Vec<u8>, ReadError> {
    let mut bytes = Vec::new();
    let read = open(path)?.take(most).read_to_end(&mut bytes);
    read.map_err(|e| ReadError::system(path, e))?;
    Ok(bytes)
}

/// A link that leads nowhere is told from nothing at all.
fn dangling(path: &Path, error: io::Error) -> io::Error {
    if error.kind() == ErrorKind::NotFound && fs::symlink_metadata(path).is_ok() {
        return io::Error::new(error.kind(), "it is a link to something that is not there");
    }
    error
}

/// What a file is that is no regular one, in words.
fn other_than_file(kind: FileType) -> Option<&'static str> {
    if kind.is_file() {
        return None;
    }
    if kind.is_dir() {
        return Some("folder");
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if kind.is_fifo() {
            return Some("named pipe");
        }
        if kind.is_socket() {
            return Some("socket");
        }
    }
    Some("device")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_up_to_its_bound() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("file");
        fs::write(&path, b"12345").unwrap();
        assert_eq!(read(&path, 5).unwrap(), b"12345");
        assert_eq!(start(&path, 3).unwrap(), b"123");
        assert_eq!(start(&path, 9).unwrap(), b"12345");
        let refused = read(&path, 4).unwrap_err();
        assert!(
            matches!(refused.fault, ReadFault::TooLarge { length: 5, most: 4 }),
            "{refused}"
        );
        // 3 GB that take no place on the disk, and must not take any in memory.
        File::options()
            .write(true)
            .open(&path)
            .unwrap()
            .set_len(3_000_000_000)
            .unwrap();
        let refused = read(&path, 1 << 20).unwrap_err().to_string();
        for word in [path.to_str().unwrap(), "3000000000", "1048576", "move it"] {
            assert!(refused.contains(word), "{refused}");
        }
    }

    /// A file of `/proc` has the length 0 and bytes all the same.
    #[test]
    #[cfg(target_os = "linux")]
    fn the_bound_holds_where_no_length_is_told() {
        let status = Path::new("/proc/self/status");
        assert!(read(status, 1 << 20).unwrap().starts_with(b"Name:"));
        assert!(matches!(
            read(status, 10).unwrap_err().fault,
            ReadFault::TooLarge { .. }
        ));
    }

    #[test]
    #[cfg(unix)]
    fn nothing_but_a_file_is_opened() {
        let dir = tempfile::tempdir().unwrap();
        let place = |name: &str| dir.path().join(name);
        let made = std::process::Command::new("mkfifo")
            .arg(place("pipe"))
            .status();
        assert!(made.unwrap().success());
        let _socket = std::os::unix::net::UnixListener::bind(place("socket")).unwrap();
        for (path, what) in [
            (place("pipe"), "named pipe"),
            (place("socket"), "socket"),
            ("/dev/zero".into(), "device"),
            (dir.path().into(), "folder"),
        ] {
            let link = place(&format!("link to {what}"));
            std::os::unix::fs::symlink(&path, &link).unwrap();
            for path in [path, link] {
                let refused = open(&path).unwrap_err();
                assert!(
                    matches!(refused.fault, ReadFault::NotAFile(w) if w == what),
                    "{refused}"
                );
                assert!(!refused.is_missing());
            }
        }
    }

    #[test]
    #[cfg(unix)]
    fn a_link_to_nothing_is_missing_and_told() {
        let dir = tempfile::tempdir().unwrap();
        let link = dir.path().join("link");
        std::os::unix::fs::symlink(dir.path().join("gone"), &link).unwrap();
        let refused = open(&link).unwrap_err();
        assert!(refused.is_missing());
        assert!(
            refused.to_string().contains("link to something"),
            "{refused}"
        );
        assert!(open(&dir.path().join("never")).unwrap_err().is_missing());
    }
}
